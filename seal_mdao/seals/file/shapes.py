"""Segments as a seal file writes them: line, arc, spline, circle."""

from itertools import pairwise

from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.seals.file.checks import POINT, POINTS, Check, Key, number, table
from seal_mdao.seals.outline.section import Arc, Circle, Line, Spline

ARC_KEYS = {"start": Key(POINT), "through": Key(POINT), "end": Key(POINT)}
CIRCLE_KEYS = {"centre": Key(POINT), "radius": Key(number(above=0.0))}

KEYS = {
    "line": Key(POINTS, None),
    "arc": Key(Check("a table { start, through, end }", lambda v: table("arc", v, ARC_KEYS)), None),
    "spline": Key(POINTS, None),
    "circle": Key(
        Check("a table { centre, radius }", lambda v: table("circle", v, CIRCLE_KEYS)), None
    ),
}
"""Keys of a table that holds a segment."""


def segments_of(where: str, values: dict, edge: str) -> list:
    """The segments of a table with the keys ``KEYS``; a line of several points gives several.

    Raises
    ------
    SealFileError
        For none or several of the keys, or points that give no such segment.
    """
    given = [kind for kind in KEYS if values[kind] is not None]
    if len(given) != 1:
        raise SealFileError(
            f"{where}: needs exactly one of {', '.join(KEYS)}; it has "
            + (" and ".join(given) or "none of them")
        )
    kind, value = given[0], values[given[0]]
    try:
        if kind == "line":
            return [Line(a, b, edge) for a, b in pairwise(value)]
        if kind == "spline":
            return [Spline(value, edge)]
        if kind == "arc":
            return [Arc.through(value["start"], value["through"], value["end"], edge)]
        return [Circle(value["centre"], value["radius"], edge)]
    except GeometryError as error:
        raise SealFileError(f"{where}: {kind}: {error}") from None
