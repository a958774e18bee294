"""``[tolerance]`` of a seal file: the schema of tolerance files, checked against the seal."""

from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.json_schema import json_schema
from seal_mdao.tolerances.file import read_tolerances, tolerances_of

BULB = Path(__file__).with_name("bulb.toml").read_text(encoding="utf-8")
VARY = """
[tolerance.vary.door_y]
distribution = "normal"
mean = 0.0
std = 0.3333
"""
BOUNDARY = "[tolerance.boundary]\nstd = 0.1\nlength = 8.0\n"


def with_tolerance(folder, text):
    file = folder / "seal.toml"
    file.write_text(BULB + text)
    return file


def test_the_table_holds_what_a_file_of_tolerances_holds(tmp_path):
    file = sm.read_seal_file(with_tolerance(tmp_path, VARY + BOUNDARY))
    own = tmp_path / "own.toml"
    own.write_text((VARY + BOUNDARY).replace("tolerance.", ""))
    assert tolerances_of(file.tolerance) == read_tolerances(own)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[tolerance]\n", "[tolerance]: the file has no manufacturing"),
        ("[tolerance]\nvary = 3\n", "[tolerance]: vary = 3, but it must be tables"),
        (VARY.replace("std = 0.3333", ""), "[tolerance.vary.door_y]: the key 'std' is missing"),
        (VARY.replace("0.3333", "-1.0"), "[tolerance.vary.door_y]: std must be"),
        (VARY.replace('"normal"', '"even"'), "[tolerance.vary.door_y]: distribution = 'even'"),
        (VARY.replace("vary", "vray"), "[tolerance]: unknown key 'vray' (did you mean 'vary'?)"),
    ],
)
def test_one_line_names_table_and_key(tmp_path, text, line):
    path = with_tolerance(tmp_path, text)
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file(path)
    assert str(caught.value).startswith(f"{path}: {line}")
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "line"),
    [
        (VARY.replace("door_y", "dor_y"), "no such parameter of the seal (did you mean 'door_y'?)"),
        (
            VARY.replace("mean = 0.0", 'mean = 0.0\nkind = "factor"'),
            "has no effect on door_y, which is zero",
        ),
        (
            VARY.replace("door_y", "c10"),
            "kind is missing, and the present value c10 = 80 is outside of the range -0.9999 to 0.9999 "
            'of the numbers that would replace it; give kind = "shift"',
        ),
    ],
)
def test_parameters_are_checked_before_anything_is_analysed(tmp_path, monkeypatch, text, line):
    pytest.importorskip("netgen")
    path = with_tolerance(tmp_path, text)
    analyses = []
    monkeypatch.setattr("seal_mdao.seals.file.build.choose", lambda *a, **k: analyses.append(a))
    with pytest.raises(sm.SealFileError) as caught:
        sm.build_seal(path)
    assert line in str(caught.value)
    assert str(caught.value).startswith(f"{path}: [tolerance.vary.")
    assert not analyses


@pytest.mark.parametrize(
    "keys",
    [
        'distribution = "normal"\nmean = 79.0\nstd = 2.0',
        'distribution = "normal"\nmean = 0.0\nstd = 2.0\nkind = "shift"',
        'distribution = "uniform"\nlow = 20.0\nhigh = 30.0\nkind = "value"',
    ],
)
def test_numbers_that_include_the_value_or_say_what_they_are(tmp_path, keys):
    path = with_tolerance(tmp_path, f"[tolerance.vary.c10]\n{keys}\n")
    file = sm.read_seal_file(path)
    file.tolerance.check("", unchosen_seal(file))


def test_errors_of_a_boundary_need_edges_that_may_move(tmp_path):
    path = with_tolerance(tmp_path, BOUNDARY)
    text = path.read_text()
    begin = text.index("[[design]]")
    end = text.index("\n[", begin) + 1
    path.write_text(text[:begin] + text[end:])
    with pytest.raises(
        sm.SealFileError, match=r"boundary .* but the seal file has no \[\[design\]\]"
    ):
        sm.read_seal_file(path)


def test_editors_know_the_table():
    properties = json_schema()["properties"]
    assert "tolerance" in properties


def test_numbers_of_a_measure_may_vary(tmp_path):
    """They are parameters of the seal, of the table [tolerance] as of a separate file."""
    leak = '\n[[measure]]\ntype = "leak_rate"\nrms_roughness = 5.0\nroll_off_wavelength = 500.0\n'
    leak += "shortest_wavelength = 1.0\npressure = 10.0\n"
    vary = VARY.replace("door_y", "leak_rate_viscosity").replace("mean = 0.0", "mean = 1.0")
    seal = unchosen_seal(sm.read_seal_file(with_tolerance(tmp_path, leak + vary)))
    assert seal.scalars["leak_rate_viscosity"].value == pytest.approx(1.0, abs=0.1)
