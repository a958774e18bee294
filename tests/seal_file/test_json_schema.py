"""The JSON schema for editors (``test_bad_files`` has what does not fit it)."""

import json
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from json_check import fits
from test_bad_files import BAD, BULB, SCHEMA

from seal_mdao import registry
from seal_mdao.seals.file.json_schema import json_schema, main

ROOT = Path(__file__).parents[2]
FILES = [*sorted((ROOT / "examples").glob("*.toml")), Path(__file__).with_name("bulb.toml")]


def given_in(name):
    """The content of one of the files that are refused; None for what is no TOML."""
    old, new, _ = BAD[name]
    try:
        return tomllib.loads(BULB.replace(old, new, 1))
    except ValueError:
        return None


@pytest.mark.parametrize("path", FILES, ids=lambda path: path.stem)
def test_examples_fit_the_schema(path):
    assert fits(tomllib.loads(path.read_text(encoding="utf-8")), SCHEMA, SCHEMA)


def test_another_checker_of_schemas_says_the_same():
    jsonschema = pytest.importorskip("jsonschema")
    jsonschema.Draft7Validator.check_schema(SCHEMA)
    checker = jsonschema.Draft7Validator(SCHEMA)
    assert all(checker.is_valid(tomllib.loads(path.read_text("utf-8"))) for path in FILES)
    found = {name: given_in(name) for name in BAD}
    json_has = {
        name: own for name, own in found.items() if own is not None and "nan" not in str(own)
    }
    for name, own in json_has.items():
        assert checker.is_valid(own) == fits(own, SCHEMA, SCHEMA), name


def test_every_key_has_its_meaning_and_its_form():
    """What an editor shows: text and, where it is no table, the form with its units."""
    spacing = SCHEMA["$defs"]["WrittenSection"]["properties"]["spacing"]
    assert spacing["description"] == (
        "largest distance of neighbouring particles; it is smaller in thin walls; default 1/12 of the "
        "smaller dimension of the section"
    )
    assert spacing["title"] == "a number above 0 (mm)"
    for own in SCHEMA["$defs"].values():
        assert all("description" in key for key in own["properties"].values())


def test_the_command_writes_it(tmp_path, capsys):
    path = tmp_path / "seal_file.schema.json"
    done = subprocess.run(
        [sys.executable, "-m", "seal_mdao.seals.file.json_schema", path], check=False, timeout=300
    )
    assert done.returncode == 0
    assert json.loads(path.read_text(encoding="utf-8")) == SCHEMA
    assert main([]) == 2
    assert "seal_file.schema.json" in capsys.readouterr().err


def test_it_has_the_names_of_installed_extensions(monkeypatch):
    """Keys beside the name of an extension are open; names that nobody has are wrong."""
    given = tomllib.loads(FILES[0].read_text(encoding="utf-8"))
    material, (profile, *_) = next(iter(given["material"].values())), given["profile"]
    material |= {"law": "capped", "links": 8.0}
    assert not fits(given, SCHEMA, SCHEMA)
    monkeypatch.setattr(registry, "installed", lambda kind: ("capped",) * (kind == "materials"))
    schema = json_schema()
    assert fits(given, schema, schema)
    profile["friction"] = {"law": "capped", "friction": 0.3}
    assert not fits(given, schema, schema)
    monkeypatch.setattr(registry, "installed", lambda kind: ("capped",))
    schema = json_schema()
    assert fits(given, schema, schema)


@pytest.mark.parametrize("pair", [[23.0, 0.0], [-274.0, 1.0], [23.0, 1.0, 1.0], [23.0]])
def test_points_of_a_table_are_checked_number_by_number(pair):
    (path,) = (own for own in FILES if own.stem == "stretched_strip")
    given = tomllib.loads(path.read_text(encoding="utf-8"))
    assert fits(given, SCHEMA, SCHEMA)
    given["material"]["sponge"]["modulus_over_temperature"] = [[-30.0, 1.6], pair]
    assert not fits(given, SCHEMA, SCHEMA)
