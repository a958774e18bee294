"""The equation index: which function computes which numbered equation of the paper.

The mapping is data, ``docs/equation_index.toml``; the page's table is made from it at every build.
"""

import tomllib
from importlib import import_module
from pathlib import Path
from typing import NamedTuple

from code_reference import markdown_table

DATA = Path(__file__).resolve().parent.parent / "equation_index.toml"
NUMBERS = range(1, 72)
STATES = {"as printed", "corrected", "discrete", "replaced", "not computed"}


class Equation(NamedTuple):
    """One numbered equation.

    Attributes
    ----------
    number : int
    what : str
        Content, as MyST text.
    state : str
        One of ``STATES``.
    functions : tuple of str
        Dotted paths of the functions that compute it.
    note : str
        What differs from the print and why, as MyST text.
    """

    number: int
    what: str
    state: str
    functions: tuple
    note: str = ""


def read(path: Path = DATA) -> list[Equation]:
    """The index in the order of the file."""
    entries = tomllib.loads(path.read_text(encoding="utf-8"))["equation"]
    return [Equation(**own | {"functions": tuple(own.get("functions", ()))}) for own in entries]


def resolve(dotted: str):
    """The object at a dotted path.

    Raises
    ------
    AttributeError, ModuleNotFoundError
        When there is none.
    """
    parts = dotted.split(".")
    for cut in range(len(parts), 0, -1):
        try:
            found = import_module(".".join(parts[:cut]))
        except ModuleNotFoundError:
            if cut == 1:
                raise
            continue
        for name in parts[cut:]:
            found = getattr(found, name)
        return found
    raise ModuleNotFoundError(dotted)


def _row(e: Equation) -> list[str]:
    functions = ", ".join(f"{{py:obj}}`{f.removeprefix('seal_mdao.')} <{f}>`" for f in e.functions)
    number = f"{{eq}}`eq-{e.number}`"
    return [number, " ".join(e.what.split()), e.state, functions, " ".join(e.note.split())]


def table(equations: list[Equation]) -> str:
    """The page's table in MyST markdown."""
    head = ["Eq.", "content", "computed", "by", "remarks"]
    options = ":widths: 6 20 10 34 30", ":class: equations"
    return markdown_table(head, list(map(_row, equations)), *options)
