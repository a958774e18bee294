"""Reference tables of the seal file, made from the classes of its tables."""

from pathlib import Path

from code_reference import markdown_table

from seal_mdao.materials.material_lists import LISTS
from seal_mdao.seals.file.material_table import FIT_TABLES, LAW_TABLES, LawTable
from seal_mdao.seals.file.measure_types import KINDS, MeasureTable
from seal_mdao.seals.file.reference import HEADER, TABLES, further_rows, key_rows, summary
from seal_mdao.seals.file.schema import Table
from seal_mdao.seals.file.tolerance_table import VARY_TABLES, VaryTable


def _marked(row) -> list[str]:
    """Mark keys and defaults of a row as code."""
    name, allowed, default, meaning = row
    if default:
        default = f"**{default}**" if default == "required" else f"`{default}`"
    return [f"`{name}`", allowed, default, meaning]


def keys_table(kind: type[Table]) -> str:
    """Keys of a table: form and bounds with units, default, meaning."""
    return markdown_table([*HEADER], [_marked(row) for row in key_rows(kind)])


def measures_table() -> str:
    """Types of measures, their further keys and their meaning."""
    rows = []
    for name, kind in KINDS.items():
        own = ", ".join(f"`{key}`" for key in kind.entries() if key not in MeasureTable.entries())
        rows.append([f"`{name}`", own, summary(kind)])
    return markdown_table(["type", "further keys", "meaning"], rows)


def further_keys(kinds: dict[str, type[Table]], base: type[Table]) -> str:
    """Keys of several tables that their base does not have, with the names of the tables."""
    rows = [
        [*_marked(row), ", ".join(f"`{name}`" for name in of)]
        for *row, of in further_rows(kinds, base)
    ]
    return markdown_table([*HEADER, "of"], rows)


def materials_table(made) -> str:
    """A list of materials that need no constants, with its notes."""
    found = made()
    title = found.title[0].upper() + found.title[1:]
    return f"{title}:\n\n{markdown_table(found.head, found.rows)}\n\n{' '.join(found.notes)}"


def fragments() -> dict[str, str]:
    """All fragments by their names."""
    found = {name: keys_table(kind) for name, kind in TABLES.items()}
    found |= {
        "constants": further_keys(LAW_TABLES, LawTable),
        "fit": further_keys(FIT_TABLES, LawTable),
        "distributions": further_keys(VARY_TABLES, VaryTable),
        "measures": measures_table(),
        "measure_keys": further_keys(KINDS, MeasureTable),
        "materials": "\n\n".join(map(materials_table, LISTS)),
    }
    return {f"seal_file_{name}": text for name, text in found.items()}


def write_all(folder: Path) -> None:
    """Write every fragment."""
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in fragments().items():
        (folder / f"{name}.md").write_text(text, encoding="utf-8")
