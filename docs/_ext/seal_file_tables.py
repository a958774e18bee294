"""Reference tables of the seal file, made from the classes of its tables."""

from pathlib import Path

from code_reference import markdown_table

from seal_mdao.seals.file.edge_tables import (
    CavityTable,
    DesignTable,
    FixedTable,
    FluidTable,
    SelfContactTable,
    SymmetryTable,
    TermTable,
)
from seal_mdao.seals.file.friction_table import FrictionTable
from seal_mdao.seals.file.load_steps import PenaltiesTable, StepsTable
from seal_mdao.seals.file.material_table import FIT_TABLES, LAW_TABLES, LawTable
from seal_mdao.seals.file.measure_types import KINDS, MeasureTable
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
from seal_mdao.seals.file.tolerance_table import (
    VARY_TABLES,
    BoundaryTable,
    ToleranceTable,
    VaryTable,
)

TABLES = {
    "material": LawTable, "section": WrittenSection, "outer": OuterTable, "hole": HoleTable,
    "rays": RaysTable, "arc": ArcTable, "circle": CircleTable,
    "region": RegionTable, "fixed": FixedTable, "symmetry": SymmetryTable, "cavity": CavityTable,
    "self_contact": SelfContactTable, "fluid": FluidTable, "profile": ProfileTable,
    "stage": StageTable, "steps": StepsTable, "penalties": PenaltiesTable, "design": DesignTable,
    "measure": MeasureTable, "optimize": OptimizeTable, "constraint": Constraint,
    "friction": FrictionTable, "term": TermTable, "tolerance": ToleranceTable, "vary": VaryTable,
    "boundary": BoundaryTable,
}  # fmt: skip
"""Class of every table of keys on the page, by the name of its fragment."""


def keys_table(kind: type[Table]) -> str:
    """Keys of a table: form and bounds with units, default, meaning."""
    rows = [
        [f"`{name}`", kind.allowed(name), _default(own), own.description]
        for name, own in kind.entries().items()
    ]
    return markdown_table(["key", "value", "unless given", "meaning"], rows)


def _default(own) -> str:
    if own.is_required():
        return "**required**"
    return "" if own.default in (None, (), {}) else f"`{_toml(own.default)}`"


def _toml(value) -> str:
    if isinstance(value, tuple | list):
        return f"[{', '.join(map(_toml, value))}]"
    if isinstance(value, str):
        return f'"{value}"'
    return f"{value:.9g}"


def measures_table() -> str:
    """Types of measures, their further keys and their meaning."""
    rows = []
    for name, kind in KINDS.items():
        own = ", ".join(f"`{key}`" for key in kind.entries() if key not in MeasureTable.entries())
        rows.append([f"`{name}`", own, kind.__doc__.splitlines()[0]])
    return markdown_table(["type", "further keys", "meaning"], rows)


def further_keys(kinds: dict[str, type[Table]], base: type[Table]) -> str:
    """Keys of several tables that their base does not have, with the names of the tables."""
    found = {}
    for name, kind in kinds.items():
        for key, own in kind.entries().items():
            if key not in base.entries():
                row = kind.allowed(key), _default(own), own.description
                found.setdefault((key, *row), []).append(f"`{name.partition(':')[0]}`")
    rows = [[f"`{key}`", *rest, ", ".join(of)] for (key, *rest), of in found.items()]
    return markdown_table(["key", "value", "unless given", "meaning", "of"], rows)


def fragments() -> dict[str, str]:
    """All fragments by their names."""
    found = {name: keys_table(kind) for name, kind in TABLES.items()}
    found |= {
        "constants": further_keys(LAW_TABLES, LawTable),
        "fit": further_keys(FIT_TABLES, LawTable),
        "distributions": further_keys(VARY_TABLES, VaryTable),
        "measures": measures_table(),
        "measure_keys": further_keys(KINDS, MeasureTable),
    }
    return {f"seal_file_{name}": text for name, text in found.items()}


def write_all(folder: Path) -> None:
    """Write every fragment."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in fragments().items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")
