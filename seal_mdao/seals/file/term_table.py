"""``[[term]]``: terms of other packages along edges."""

from functools import cache
from typing import Annotated

from seal_mdao.seals.file.edges import check_edges
from seal_mdao.seals.file.extensions import Extensible, arguments, keys_of
from seal_mdao.seals.file.forms import Name, Names, Text, one_of
from seal_mdao.seals.file.schema import Table, key, table, table_of

NAME_TEXT = "put before the names of its parameters; its type unless given"


@table(kw_only=True)
class TermTable(Table):
    """A term by its name; its further keys are the fields of its definition, ``makes``."""

    type: Text = key("name of the term")
    name: Name | None = key(NAME_TEXT, None)
    edges: Names = key("edges on which it acts")

    @property
    def arguments(self) -> dict:
        """Fields of its definition beside ``label`` and ``where``."""
        return arguments(self, TermTable)


@cache
def _extension(name: str, made: type) -> type[TermTable]:
    keys = {"type": (one_of(name), key("name of the term")), "name": (Name, key(NAME_TEXT, name))}
    keys |= keys_of(made, TermTable, ("label", "where"))
    own = {"makes": staticmethod(made), "__module__": made.__module__}
    return table_of(TermTable, f"{made.__name__}Table", keys, **own)


AnyTerm = Annotated[TermTable, Extensible("terms", "type", _extension)]


def check_terms(file) -> None:
    """Refuse terms along edges that there are not.

    Raises
    ------
    SealFileError
    """
    for number, term in enumerate(file.terms, 1):
        check_edges(f"[[term]] {number}", "edges", term.edges, file.section.outline)
