"""Reference of seal files: every table with its keys, for the documentation and the command."""

import re
from typing import get_origin

from seal_mdao.seals.file.design_table import DesignTable
from seal_mdao.seals.file.edge_tables import (
    CavityTable,
    FixedTable,
    FluidTable,
    PairTable,
    SelfContactTable,
    SymmetryTable,
    TermTable,
)
from seal_mdao.seals.file.file_tables import Written
from seal_mdao.seals.file.friction_table import FrictionTable
from seal_mdao.seals.file.load_steps import PenaltiesTable, StepsTable
from seal_mdao.seals.file.material_table import (
    FIT_TABLES,
    LAW_TABLES,
    SHORT,
    LawTable,
    ShoreTable,
    SpongeTable,
)
from seal_mdao.seals.file.measure_types import KINDS, MeasureTable
from seal_mdao.seals.file.model_table import ModelTable
from seal_mdao.seals.file.moved_table import MovedTable
from seal_mdao.seals.file.optimize_table import Constraint, OptimizeTable
from seal_mdao.seals.file.profile_table import ProfileTable, StageTable
from seal_mdao.seals.file.schema import Table
from seal_mdao.seals.file.section_table import (
    HoleTable,
    OuterTable,
    RaysTable,
    RegionTable,
    WrittenSection,
)
from seal_mdao.seals.file.segment_tables import ArcTable, CircleTable
from seal_mdao.seals.file.softening_table import SofteningTable
from seal_mdao.seals.file.tolerance_table import (
    VARY_TABLES,
    BoundaryTable,
    ToleranceTable,
    VaryTable,
)
from seal_mdao.seals.file.viscoelastic_table import ArrheniusTable, ViscoelasticTable, WlfTable

TABLES = {
    "model": ModelTable,
    "material": LawTable, "shore": ShoreTable, "sponge": SpongeTable,
    "viscoelastic": ViscoelasticTable, "wlf": WlfTable, "arrhenius": ArrheniusTable,
    "softening": SofteningTable,
    "section": WrittenSection, "outer": OuterTable, "hole": HoleTable,
    "rays": RaysTable, "arc": ArcTable, "circle": CircleTable,
    "region": RegionTable, "fixed": FixedTable, "moved": MovedTable, "symmetry": SymmetryTable,
    "cavity": CavityTable, "self_contact": SelfContactTable, "pair": PairTable,
    "fluid": FluidTable, "profile": ProfileTable,
    "stage": StageTable, "steps": StepsTable, "penalties": PenaltiesTable, "design": DesignTable,
    "measure": MeasureTable, "optimize": OptimizeTable, "constraint": Constraint,
    "friction": FrictionTable, "term": TermTable, "tolerance": ToleranceTable,
    "vary": VaryTable, "boundary": BoundaryTable,
}  # fmt: skip
"""Class of every table of keys, by its name."""
HEADER = ("key", "value", "default", "meaning")


MATERIALS = ("material", "shore", "sponge")
"""Tables that are written as ``[material.NAME]``."""
LIST, ONE = "a list of tables", "a table {"
"""Beginnings of the forms of keys that hold other tables."""


def written_as(name: str) -> str:
    """Write how a table of ``TABLES`` begins in a file: ``[fixed]``, ``[[profile]]``,
    ``[[section.region]]``, or ``arc = {...}``; empty for the value of other keys."""
    if name in MATERIALS:
        return "[material.NAME]"
    if name == "vary":
        return "[tolerance.vary.NAME]"
    if name in Written.model_fields:
        several = get_origin(Written.model_fields[name].annotation) is tuple
        return f"[[{name}]]" if several else f"[{name}]"
    found = []
    for parent, kind in TABLES.items():
        form = kind.allowed(name) if name in kind.entries() and parent != name else ""
        around = written_as(parent).strip("[]") if form else ""
        # tables of lists are written inline
        nested = parent in MATERIALS or parent in Written.model_fields
        if form == LIST:
            found.append(f"[[{around}.{name}]]")
        elif form.startswith(ONE):
            inline = not nested or written_as(parent).startswith("[[")
            found.append(f"{name} = {{...}}" if inline else f"[{around}.{name}]")
        elif ONE in form:
            # beside a number
            found.append(f"{name} = {{...}}")
    return ", ".join(dict.fromkeys(found))


def key_rows(kind: type[Table]) -> list[tuple]:
    """List the keys of a table: name, form and bounds with units, default, meaning."""
    return [
        (name, kind.allowed(name), default_of(own), own.description)
        for name, own in kind.entries().items()
    ]


def default_of(own) -> str:
    """Format the default of a key: "required", nothing, or a value as in TOML."""
    if own.is_required():
        return "required"
    return "" if own.default in (None, (), {}) else _toml(own.default)


def _toml(value) -> str:
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, str):
        return f'"{value}"'
    return f"{value:.9g}"


def summary(kind: type[Table]) -> str:
    """Return the first line of the description of a table."""
    return kind.__doc__.splitlines()[0]


def further_rows(kinds: dict[str, type[Table]], base: type[Table]) -> list[tuple]:
    """List the keys that tables have beside those of their base, as ``key_rows``, with the names of the
    tables that have them."""
    found = {}
    for name, kind in kinds.items():
        for row in key_rows(kind):
            if row[0] not in base.entries():
                found.setdefault(row, []).append(name.partition(":")[0])
    return [(*row, of) for row, of in found.items()]


def found_tables(name: str) -> dict[str, type[Table]]:
    """Find tables, material laws and types of measures by name; return them by their headings."""
    found = {f"table {name}": TABLES[name]} if name in TABLES else {}
    if name == "vary":
        # every distribution has its own keys
        found |= {f"distribution {kind}": own for kind, own in VARY_TABLES.items()}
    if name in LAW_TABLES:
        found |= {
            f"law {name}, by its constants": LAW_TABLES[name],
            f"law {name}, fitted to tests": FIT_TABLES[f"{name}: data"],
        }
    return found | ({f"measure {name}": KINDS[name]} if name in KINDS else {})


def known_names() -> list[str]:
    """List the names that ``found_tables`` finds."""
    return [*TABLES, *LAW_TABLES, *KINDS]


def unit_of_key(tables: dict, path: str) -> str:
    """Return the unit of a key of a file by its dotted path; empty for pure numbers.

    Parameters
    ----------
    tables : dict
        As they are written.
    path : str
        ``material.rubber.c10``, ``profile.door.stage.1.translate.2``.
    """
    steps = path.split(".")
    if steps[0] == "material" and len(steps) == 3:
        given = tables["material"].get(steps[1], {})
        law = given.get("law")
        kinds = [own for own in (LAW_TABLES.get(law), FIT_TABLES.get(f"{law}: data")) if own]
        kinds += [own for name, own in SHORT.items() if name in given]
    else:
        # the innermost table on the path
        kinds = [TABLES[step] for step in steps if step in TABLES][-1:]
        kinds += [*KINDS.values()] if kinds == [MeasureTable] else []
    for kind in kinds:
        for step in reversed(steps):
            if step in kind.entries():
                # "a number above 0 (mm)", "... (degC), or a list", "... (mm), such as"
                unit = re.search(r"\(([^()]*)\)($|, (or|such))", kind.allowed(step))
                return unit[1] if unit else ""
    return ""
