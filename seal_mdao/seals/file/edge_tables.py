"""``[[design]]`` and ``[self_contact]``: edges that may move, and edges that may touch each other."""

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.edges import check_edges
from seal_mdao.seals.file.forms import Names, Penalty, number, whole
from seal_mdao.seals.file.friction import Friction
from seal_mdao.seals.file.schema import Table, key, table

MOST_PARAMETERS = 1000


@table
class DesignTable(Table):
    """Edges that may move along their normals."""

    edges: Names = key("edges that move; not at an end where the next edge stays")
    parameters: whole(1, MOST_PARAMETERS) = key("number of parameters of each of them")
    bound: number("mm", above=0.0) = key("largest offset")


@table
class SelfContactTable(Table):
    """Edges that may touch each other or themselves, as far as they are not neighbours."""

    edges: Names = key("edges; those that do not touch only cost time")
    friction: Friction = key("Coulomb coefficient, or another law")
    normal_penalty: Penalty | None = key("normal penalty; chosen unless given", None)
    tangent_penalty: Penalty | None = key("tangential penalty; chosen unless given", None)


def check_designs(file) -> None:
    """Refuse edges that there are not, that are held, or that two designs move.

    Raises
    ------
    SealFileError
    """
    outline, seen = file.section.outline, {}
    for number_, design in enumerate(file.designs, 1):
        where = f"[[design]] {number_}"
        check_edges(where, "edges", design.edges, outline)
        for name in design.edges:
            if name in file.fixed_edges:
                raise SealFileError(f"{where}: edges has {name!r}, which [fixed] holds")
            if name in dict(file.planes):
                raise SealFileError(f"{where}: edges has {name!r}, which [[symmetry]] holds")
            if name in seen:
                raise SealFileError(f"{where}: edges has {name!r}, which {seen[name]} has already")
            seen[name] = where


def check_self_contact(file) -> None:
    """Refuse edges that there are not, or that are named twice.

    Raises
    ------
    SealFileError
    """
    if file.self_contact is not None:
        check_edges("[self_contact]", "edges", file.self_contact.edges, file.section.outline)
