"""Tables that are made from the code."""

import re
import subprocess
import sys

import pytest

from seal_mdao.seals.door.door_seal import FURTHER, STANDARD


def test_every_measure_is_in_the_table_with_its_units(docs_module):
    table = docs_module("code_reference").measures()
    for measure in (*STANDARD, *FURTHER):
        name = measure.name
        row = table.partition(f"- `{name}`\n")[2].partition("* -")[0]
        assert f"- `{measure.units}`" in row
        assert measure.text in row


def test_every_class_of_measures_is_in_the_table(docs_module):
    table = docs_module("code_reference").measure_classes()
    assert table.count("{py:class}") == 31
    for name in ("mJ/m", "mm**3", "kPa", "N/m", "mm**3/s/m", "g/m"):
        assert f"`{name}`" in table


@pytest.mark.parametrize("command", [("-m", "seal_mdao", "sweep"), ("optimize_door_seal.py",)])
def test_help_texts_are_those_that_the_programs_print(docs_module, docs, monkeypatch, command):
    """The page makes them without a process of each program."""
    reference = docs_module("code_reference")
    page = reference.commands() if command[0] == "-m" else reference.run_scripts()
    monkeypatch.setenv("COLUMNS", reference.COLUMNS)
    program = [sys.executable, *command, "--help"]
    scripts = docs.parent / "run_scripts"
    printed = subprocess.run(program, check=True, stdout=subprocess.PIPE, text=True, cwd=scripts)
    assert f"```text\n{printed.stdout.rstrip()}\n```" in page


def test_every_package_has_a_page_of_the_reference(docs, docs_module):
    """A page that no table of contents lists is a warning of the build, which stops it."""
    packages = docs_module("api_pages").modules()
    pages = {"top" if own == "seal_mdao" else own.rpartition(".")[2] for own in packages}
    index = (docs / "reference" / "index.md").read_text(encoding="utf-8")
    assert set(re.findall(r"_generated/api/(\w+)", index)) == pages
