"""Tolerances from TOML: what is read, and one line for what is wrong."""

from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.distributions import Normal, Triangular
from seal_mdao.tolerances.boundary_errors import BoundaryTolerance
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances

FRICTION = '[vary.friction]\ndistribution = "uniform"\nlow = 0.1\nhigh = 0.3\n'


def test_those_of_the_door_fit_the_door_seal():
    found = read_tolerances(OF_THE_DOOR)
    found.middle(sm.door_seal()).check(sm.door_seal())
    by_name = {t.variation.name: t for t in found.scattered}
    assert by_name["hardness"].variation.parameters == ("c10", "c01")
    assert by_name["hardness"].distribution == Triangular(0.83, 1.0, 1.21)
    assert by_name["depth"].variation.kind == "shift"
    assert by_name["depth"].distribution == Normal(0.0, 0.25)
    assert found.boundary == BoundaryTolerance(0.1, 8.0)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("", "the file has no manufacturing tolerance; add a"),
        ("vary = 3", r"vary = 3, but it must be tables, each written \[vary.name\]"),
        ("[vary]\na = 3", r"\[vary.a\] must be one table, got 3"),
        ("[bounds]\nx = 1", "bounds"),
        ("[vary.a", "not valid TOML"),
        (FRICTION.replace('"uniform"', '"even"'), r"\[vary.friction\].*distribution"),
        (FRICTION.replace("low = 0.1", ""), r"\[vary.friction\].*low"),
        (FRICTION.replace("0.3", "0.1"), r"\[vary.friction\].*high"),
        (FRICTION.replace("high", "hihg"), "hihg"),
        (FRICTION + 'kind = "percent"', "kind"),
        (FRICTION.replace("friction", '"a\\u0000b"'), "printable"),
        (FRICTION.replace("friction", '"a\\nb"'), "printable"),
        (FRICTION.replace("0.3", "9" * 400), r"high = 9999.* must be a number"),
        (FRICTION.replace("0.3", "9" * 5000), "digits"),
        (FRICTION.replace("0.3", "0x" + "f" * 5000), "high = an integer of 20000 bits"),
        ("a = " + "[" * 10**5, "not valid TOML"),
        (FRICTION + "[boundary]\nstd = -1.0\nlength = 2.0", r"\[boundary\].*std"),
    ],
)
def test_one_line_says_what_is_wrong(tmp_path, text, match):
    path = tmp_path / "wrong.toml"
    path.write_text(text)
    with pytest.raises(sm.SealFileError, match=match) as caught:
        read_tolerances(path)
    assert str(caught.value).startswith(str(path))
    assert "\n" not in str(caught.value)


def test_a_file_that_is_not_there(tmp_path):
    with pytest.raises(sm.SealFileError, match="cannot be read"):
        read_tolerances(tmp_path / "none.toml")


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="the system has no endless device")
def test_endless_file(tmp_path):
    """A link to it as well."""
    path = tmp_path / "endless.toml"
    path.symlink_to("/dev/zero")
    with pytest.raises(sm.SealFileError, match="it is a device or a pipe, not a file"):
        read_tolerances(path)
