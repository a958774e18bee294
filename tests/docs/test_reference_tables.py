"""Tables that are made from the code."""

import inspect
import re
import subprocess
import sys

import openmdao.api as om
import pytest
from openmdao.core.driver import Driver

import seal_mdao as sm
from seal_mdao.scenarios.variation import SCENARIOS_OPTION
from seal_mdao.seals.door.door_seal import FURTHER, STANDARD
from seal_mdao.seals.seal import SETTINGS_OPTION


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


@pytest.mark.parametrize("name", ["SealGroup", "ScenarioGroup", "UnoDriver", "IpoptDriver"])
def test_help_lists_all_options(name):
    """With those of OpenMDAO's base class left out, and the ones that setup fills in."""
    if name == "IpoptDriver":
        pytest.importorskip("ipyopt")
    kind = getattr(sm, name)
    base = om.Group if name.endswith("Group") else Driver
    filled_in = {SETTINGS_OPTION, SCENARIOS_OPTION}
    own = {*kind().options} - {*base().options} - filled_in
    listed = inspect.getdoc(kind).partition("Parameters\n----------\n")[2].partition("\n\n")[0]
    heads = [line.partition(" :")[0] for line in listed.splitlines() if not line.startswith(" ")]
    assert {part for head in heads for part in head.split(", ")} >= own
    assert len(own) >= 7
