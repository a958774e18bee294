"""Reference tables made from the code: components, drivers, the model's options.

Run as a script it writes MyST fragments into a folder:

    python docs/_ext/code_reference.py docs/_generated/fragments
"""

import argparse
import ast
import inspect
import os
import re
import runpy
import sys
from dataclasses import MISSING, fields
from importlib import import_module
from pathlib import Path
from unittest import mock

import openmdao.api as om
from openmdao.core.driver import Driver

import seal_mdao as sm
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.cli.subcommands import COMMANDS
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.measures.measure import Measure
from seal_mdao.seals.door.door_options import DoorOptions
from seal_mdao.seals.door.section import Section
from seal_mdao.seals.result import frozen_measures

ROOT = Path(__file__).resolve().parents[2]
COMPONENTS = (sm.SplineGeometryComp, sm.AreaComp, sm.RkpmContactComp, sm.SealGroup)
DRIVERS = (sm.UnoDriver, sm.IpoptDriver, sm.SlsqpDriver)
COLUMNS = "88"
OPTIONS = ["option", "default", "values", "meaning"]
DATACLASSES = (DoorOptions, Section, MooneyRivlin, NewtonOptions)


def markdown_table(header: list[str], rows: list[list[str]], *options: str) -> str:
    """Format a MyST list-table, in which cells may hold any symbol."""
    lines = ["```{list-table}", ":header-rows: 1", *options]
    for row in [header, *rows]:
        lines += ["", f"* - {row[0]}", *(f"  - {cell}".rstrip() for cell in row[1:])]
    return "\n".join([*lines, "```", ""])


def _literal(text) -> str:
    return f"`{text}`" if str(text) else ""


# ---- OpenMDAO variables and options ----


def variables(system, kind: str) -> list[list[str]]:
    """Name, shape, units and description of the inputs or outputs of a system in a problem."""
    problem = om.Problem(reports=None)
    problem.model.add_subsystem("system", system, promotes=["*"])
    problem.setup()
    problem.final_setup()
    listing = getattr(problem.model, f"list_{kind}")(
        val=False, units=True, shape=True, desc=True, prom_name=True, out_stream=None,
        return_format="list",
    )  # fmt: skip
    rows = {}
    for _, meta in listing:
        name, shape = meta["prom_name"], ", ".join(map(str, meta["shape"]))
        row = [_literal(name), f"({shape})", _literal(meta["units"] or ""), meta["desc"]]
        rows.setdefault(name, row)
    return list(rows.values())


def option_rows(declared, inherited) -> list[list[str]]:
    """Name, default, values and description of the options that ``inherited`` does not have."""
    rows = []
    for name, meta in sorted(declared._dict.items()):
        if name in inherited:
            continue
        default = "required" if not meta["has_been_set"] else _literal(_value(meta["val"]))
        values = meta["values"] or ()
        # sets have no order of their own
        values = sorted(values) if isinstance(values, set) else values
        allowed = ", ".join(map(str, values))
        rows.append([_literal(name), default, allowed, meta["desc"]])
    return rows


def _value(value) -> str:
    return "door_seal()" if isinstance(value, sm.Seal) else repr(value)


def component(cls) -> str:
    """One section of the component reference."""
    seal = sm.door_seal()
    base = om.Group if issubclass(cls, om.Group) else om.ExplicitComponent
    inside = variables(cls(seal=seal), "inputs"), variables(cls(seal=seal), "outputs")
    if issubclass(cls, om.Group):
        made = {row[0] for row in inside[1]}
        inside = [row for row in inside[0] if row[0] not in made], inside[1]
    header = ["name", "shape", "units", "meaning"]
    parts = [_heading(cls), _paragraphs(cls), "**Inputs**\n", markdown_table(header, inside[0])]
    parts += ["**Outputs**\n", markdown_table(header, inside[1])]
    rows = option_rows(cls().options, base().options)
    return "\n".join([*parts, "**Options**\n", markdown_table(OPTIONS, rows)])


def driver(cls) -> str:
    """One section of the driver reference."""
    summary = inspect.cleandoc(cls.__doc__).splitlines()[0] + "\n"
    rows = option_rows(cls().options, Driver().options)
    return "\n".join([_heading(cls), summary, markdown_table(OPTIONS, rows)])


def _heading(cls) -> str:
    return f"## {cls.__name__}\n\n{{py:class}}`{cls.__module__}.{cls.__name__}`\n"


def optional_inputs() -> str:
    """The optional scalar inputs of the contact component with a door seal."""
    seal = sm.door_seal()
    rows = [
        [_literal(name), _literal(units or ""), text]
        for name, (_, units, text) in seal.scalars.items()
        if name not in seal.inputs
    ]
    return markdown_table(["name", "units", "meaning"], rows)


def measures() -> str:
    """The measures that the door seal knows by name, with the size that they have for it."""
    seal = sm.door_seal()
    head = ["name", "always there", "values", "units", "meaning"]
    rows = []
    always_there = {measure.name for measure in seal.standard}
    for measure in frozen_measures(seal, (*seal.standard, *seal.further)):
        always = "yes" if measure.name in always_there else ""
        size = str(measure.size(seal))
        rows.append([_literal(measure.name), always, size, _literal(measure.units), measure.text])
    return markdown_table(head, rows)


def measure_classes() -> str:
    """Every class of measures of the package."""
    head = ["class", "name", "units", "meaning"]
    rows = []
    for module in sorted(path.stem for path in (ROOT / "seal_mdao" / "measures").glob("*.py")):
        for cls in vars(import_module(f"seal_mdao.measures.{module}")).values():
            own = inspect.isclass(cls) and cls.__module__ == f"seal_mdao.measures.{module}"
            if own and issubclass(cls, Measure) and cls.name:
                text = f"{{py:class}}`{cls.__name__} <{cls.__module__}.{cls.__name__}>`"
                rows.append([text, _literal(cls.name), _literal(cls.units), cls.text])
    return markdown_table(head, rows)


def _paragraphs(cls) -> str:
    """The introduction of a docstring, without its sections, as MyST."""
    text = inspect.cleandoc(cls.__doc__)
    text = re.split(r"\n\w[\w ]*\n-{3,}\n", text)[0]
    return text.replace("**", r"\*\*").replace("``", "`") + "\n"


# ---- dataclasses ----


def attribute_docs(cls) -> dict[str, tuple[str, str]]:
    """Type and meaning of every name in the Attributes section of a numpy docstring."""
    section = inspect.cleandoc(cls.__doc__).partition("Attributes\n----------\n")[2]
    section = re.split(r"\n\n\w[\w ]*\n-{3,}\n", section)[0]
    found = {}
    for block in re.split(r"\n(?=\S)", section):
        head, _, text = block.partition("\n")
        names, _, kind = head.partition(" : ")
        for name in names.split(","):
            found[name.strip()] = kind.strip(), " ".join(text.split())
    return found


def _default(field) -> str:
    if field.default is not MISSING:
        value = field.default
        return (
            f"{value:.6g}" if isinstance(value, float) and value not in (1e4, 1e2) else repr(value)
        )
    if field.default_factory is not MISSING:
        return f"{field.default_factory.__name__}()"
    return ""


def dataclass_table(cls) -> str:
    """Fields of a frozen dataclass with defaults, types and meanings."""
    docs = attribute_docs(cls)
    rows = [
        [_literal(f.name), _literal(_default(f)), docs[f.name][0], docs[f.name][1]]
        for f in fields(cls)
    ]
    return markdown_table(["option", "default", "type", "meaning"], rows)


# ---- run_scripts ----


def help_of(made: argparse.ArgumentParser, program: str) -> str:
    """What ``--help`` of a program with the parser ``made`` prints on a terminal of ``COLUMNS``."""
    made.prog = program
    with mock.patch.dict(os.environ, COLUMNS=COLUMNS):
        return made.format_help().rstrip()


def commands() -> str:
    """A section for every subcommand of ``seal-mdao`` with its ``--help``."""
    parts = []
    for name, text in COMMANDS.items():
        parts += [f"### seal-mdao {name}\n", f"{text[0].upper()}{text[1:]}.\n"]
        made = import_module(f"seal_mdao.cli.{name}").arguments_parser()
        parts += ["```text", help_of(made, f"seal-mdao {name}"), "```\n"]
    return "\n".join(parts)


def run_scripts(folder: Path = ROOT / "run_scripts") -> str:
    """A section for every script with its ``--help``, or its text where it takes no arguments."""
    parts = []
    for path in sorted(folder.glob("[!_]*.py")):
        text = path.read_text(encoding="utf-8")
        summary = ast.get_docstring(ast.parse(text)) or ""
        parts += [f"### {path.name}\n", summary.split("\n\n")[0] + "\n"]
        if "arguments_parser" in text:
            made = runpy.run_path(str(path))["arguments_parser"]()
            parts += ["```text", help_of(made, path.name), "```\n"]
        else:
            parts += ["```python", text.rstrip(), "```\n"]
    return "\n".join(parts)


def write_all(folder: Path) -> None:
    """Write every fragment."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "components": "\n".join(map(component, COMPONENTS)),
        "drivers": "\n".join(map(driver, DRIVERS)),
        "optional_inputs": optional_inputs(),
        "measures": measures(),
        "measure_classes": measure_classes(),
        "run_scripts": run_scripts(),
        "commands": commands(),
    }
    texts |= {cls.__name__: dataclass_table(cls) for cls in DATACLASSES}
    for name, text in texts.items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")


if __name__ == "__main__":
    write_all(Path(sys.argv[1]))
