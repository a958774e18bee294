"""List the tables of a seal file, the laws of rubber and the types of measures, or the keys of one."""

from textwrap import fill

from seal_mdao.cli.arguments import WrongArgumentError, parser
from seal_mdao.seals.file.material_table import LAW_TABLES
from seal_mdao.seals.file.measure_types import KINDS
from seal_mdao.seals.file.reference import (
    TABLES,
    found_tables,
    key_rows,
    known_names,
    summary,
    written_as,
)
from seal_mdao.seals.file.schema import suggestion

WIDTH = 100
INDENT = 4 * " "


def main(arguments) -> int:
    name = arguments.name
    if name is None:
        print(listing())
        return 0
    found = found_tables(name)
    if not found:
        raise WrongArgumentError(
            f"there is no table, law or measure {name!r}{suggestion(name, known_names())}; `seal-mdao "
            "keys` lists them"
        )
    print("\n\n".join(keys_of(heading, kind) for heading, kind in found.items()))
    return 0


def listing() -> str:
    """List the names of all tables, laws and types of measures with their descriptions; tables as they
    are written in a file."""
    parts = {"tables": TABLES, "laws of rubber": LAW_TABLES, "types of measures": KINDS}
    lines = []
    for heading, kinds in parts.items():
        names = {name: written_as(name) if kinds is TABLES else "" for name in kinds}
        width, own = max(map(len, kinds)), max(map(len, names.values()))
        lines += ["", f"{heading}:"]
        lines += [
            f"  {name:{width}}  {names[name]:{own}}{'  ' * (own > 0)}{_about(name, kind)}".rstrip()
            for name, kind in kinds.items()
        ]
    return "\n".join([*lines, "", "Keys with units and defaults: seal-mdao keys NAME"]).lstrip()


def _about(name: str, kind) -> str:
    # laws have no text of their own, but constants
    if name in LAW_TABLES:
        own = [key for key in kind.entries() if key not in TABLES["material"].entries()]
        return ", ".join(own)
    return summary(kind)


def keys_of(heading: str, kind) -> str:
    """Format the keys of a table: value and default in one line, the meaning below."""
    lines = [f"{heading}: {summary(kind)}"]
    table = heading.removeprefix("table ")
    if table in TABLES and (form := written_as(table)):
        lines.append(f"  written as {form}")
    for name, allowed, default, meaning in key_rows(kind):
        otherwise = f" [{default}]" if default else ""
        lines += [f"  {name}{otherwise}: {allowed}", _wrapped(meaning)]
    return "\n".join(lines)


def _wrapped(text: str) -> str:
    return fill(text, WIDTH, initial_indent=INDENT, subsequent_indent=INDENT)


def arguments_parser():
    made = parser(__doc__, ".", "[NAME]", "seal-mdao keys profile")
    made.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="table, law or type of measure; default: list all",
    )
    return made
