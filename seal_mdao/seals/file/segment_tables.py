"""Segments as a seal file writes them: line, arc, spline, circle."""

from itertools import pairwise

from pydantic import model_validator

from seal_mdao.errors import GeometryError
from seal_mdao.seals.file.forms import Point, Points, number
from seal_mdao.seals.file.schema import Table, key, table
from seal_mdao.seals.outline.contours import Arc, Circle, Line, Spline


@table
class ArcTable(Table):
    """Arc through three points."""

    start: Point = key("first point of the arc")
    through: Point = key("point between the first and the last point")
    end: Point = key("last point of the arc")


@table
class CircleTable(Table):
    """Circle, a complete contour."""

    centre: Point = key("centre of the circle")
    radius: number("mm", above=0.0) = key("radius of the circle")


@table
class SegmentTable(Table):
    """One segment, or several lines."""

    line: Points | None = key("a line, or a polyline", None)
    arc: ArcTable | None = key("an arc", None)
    spline: Points | None = key(
        "a cubic spline; it is also smooth at the joint if the last point is the first one", None
    )
    circle: CircleTable | None = key("a circle, which is a complete contour", None)

    def pieces(self, edge: str) -> list:
        """Make the segments as parts of an edge; a line of several points gives several.

        Raises
        ------
        ValueError
            For none or several of the keys, or points that give no such segment.
        """
        # the key that is given names the kind of segment
        given = [kind for kind in KINDS if getattr(self, kind) is not None]
        if len(given) != 1:
            raise ValueError(
                f"a segment of a curve needs exactly one of the keys {', '.join(KINDS)}, but this "
                "one has " + (" and ".join(given) or "none of them")
            )
        try:
            return self._made(edge)
        except GeometryError as error:
            raise ValueError(f"{given[0]}: {error}") from None

    def _made(self, edge) -> list:
        # a polyline is several lines, all other kinds are one segment
        if self.line is not None:
            return [Line(a, b, edge) for a, b in pairwise(self.line)]
        if self.spline is not None:
            return [Spline(self.spline, edge)]
        if self.arc is not None:
            return [Arc.through(self.arc.start, self.arc.through, self.arc.end, edge)]
        return [Circle(self.circle.centre, self.circle.radius, edge)]


@table
class PieceTable(SegmentTable):
    """One segment of a chain."""

    @model_validator(mode="after")
    def _one_segment(self):
        # points that give no segment are refused with the table that has them
        self.pieces("")
        return self


KINDS = tuple(SegmentTable.entries())
"""Of segments."""
