"""The page of the seal file has the tables of all keys, and its messages are those that come."""

import re
from pathlib import Path

import pytest

import seal_mdao as sm
from seal_mdao.materials.by_name import LAWS
from seal_mdao.seals.file.material_table import FIT_TABLES, LAW_TABLES
from seal_mdao.seals.file.measure_types import KINDS
from seal_mdao.seals.file.read import TABLES
from seal_mdao.seals.file.schema import Table

DOCS = Path(__file__).parents[2] / "docs"
PAGE = (DOCS / "seal_file.md").read_text(encoding="utf-8")
BULB = Path(__file__).parent / "bulb.toml"


@pytest.fixture
def fragments(monkeypatch):
    """Tables of the page by their names."""
    monkeypatch.syspath_prepend(DOCS / "_ext")
    import seal_file_tables

    return seal_file_tables.fragments()


def every_table(kind=Table):
    """All classes of tables of a seal file."""
    for own in kind.__subclasses__():
        if own.__module__.startswith("seal_mdao.seals.file"):
            yield own
            yield from every_table(own)


def test_every_key_type_and_law_is_in_a_table_of_the_page(fragments):
    shown = "".join(text for name, text in fragments.items() if f"fragments/{name}.md" in PAGE)
    literals = set(re.findall(r"`(\w+)`", shown))
    names = {name for kind in every_table() for name in kind.entries()}
    assert len(names) > 60
    assert not (names | {*LAWS, *KINDS}) - literals
    assert {*TABLES} <= set(re.findall(r"^## .*?\[(\w+)", PAGE, re.MULTILINE))


def test_every_table_that_is_made_is_on_the_page(fragments):
    assert set(re.findall(r"fragments/(\w+)\.md", PAGE)) == set(fragments)


def test_tables_have_bounds_units_and_defaults(fragments):
    rows = {
        "seal_file_cavity": ["a number above 0 (kPa)", "`101.325`"],
        "seal_file_fixed": ["**required**", '`["x", "y"]`'],
        "seal_file_profile": ["a number of at least -3600 and at most 3600 (degrees)", "`0`"],
        "seal_file_steps": ["a number above 0 and at most 1", "`0.005`"],
        "seal_file_measure_keys": ["`order`", "a whole number from 2 to 1000", "`stress_norm`"],
    }
    for name, cells in rows.items():
        assert not [cell for cell in cells if cell not in fragments[name]]


def test_every_key_says_what_it_means():
    kinds = [*every_table(), *LAW_TABLES.values(), *FIT_TABLES.values()]
    for kind in kinds:
        for name, own in kind.entries().items():
            assert len(own.description.split()) > 1, (kind, name)
            assert kind.allowed(name)


@pytest.mark.parametrize(("old", "new"), [
    ('contact = ["seal"]', 'contact = ["sael"]'),
    ("through = [0.0, 14.0]", "through = [0.0, 0.0]"),
    ("end = [-4.0", "end = [-5.0"),
])  # fmt: skip
def test_the_messages_on_the_page(tmp_path, monkeypatch, old, new):
    monkeypatch.chdir(tmp_path)
    Path("bulb.toml").write_text(BULB.read_text().replace(old, new, 1))
    with pytest.raises(sm.SealFileError) as caught:
        sm.read_seal_file("bulb.toml")
    assert str(caught.value) in PAGE.splitlines()
