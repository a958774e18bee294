"""The section: closed contours of bodies and their holes, with named edges."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import shapely

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.arcs import Arc, Circle
from seal_mdao.seals.outline.chain import checked_chain
from seal_mdao.seals.outline.crossings import check_apart, check_nested, nearest_around
from seal_mdao.seals.outline.sampling import Boundary, sampled
from seal_mdao.seals.outline.segments import Line, Segment
from seal_mdao.seals.outline.spline import Spline

__all__ = [
    "Arc", "Boundary", "Circle", "Contour", "Line", "Outline", "Segment", "Spline", "sampled",
]  # fmt: skip

JOIN = 1e-3
"""Largest distance of the ends of two segments that are joined, mm."""

SAGITTA = 1e-5
"""Largest distance of chords from the curve in checks for crossings, over the size."""

APART = 4.0 * SAGITTA
"""Least distance between parts of the boundary that are not neighbours, over the size."""


@dataclass(frozen=True)
class Contour:
    """A closed chain of segments, head to tail.

    Attributes
    ----------
    segments : tuple of Segment
        At least one; a single one must be closed.

    Raises
    ------
    GeometryError
        For segments that are not joined, too short, or fold back on each other.
    """

    segments: tuple

    def __post_init__(self):
        object.__setattr__(self, "segments", checked_chain(self.segments, JOIN, closed=True))

    @cached_property
    def area(self) -> float:
        """Signed area, positive counter-clockwise, mm^2."""
        return float(sum(segment.area for segment in self.segments))

    @property
    def length(self) -> float:
        """Length of the contour, mm."""
        return float(sum(segment.length for segment in self.segments))

    @property
    def edge_names(self) -> tuple[str, ...]:
        """Names of the edges in order along the contour."""
        return tuple(dict.fromkeys(segment.edge for segment in self.segments))

    def reversed(self) -> "Contour":
        """Return the contour in the opposite direction."""
        return Contour(tuple(segment.reversed() for segment in self.segments[::-1]))

    def from_edge(self) -> "Contour":
        """Return the contour starting at the beginning of the edge of its first segment."""
        names = [segment.edge for segment in self.segments]
        # an edge that continues across the start of the contour begins after the last other edge
        others = [i for i, name in enumerate(names) if name != names[0]]
        if not others or others[-1] == len(names) - 1:
            return self
        # rotate the chain to the first segment behind that edge
        first = others[-1] + 1
        return Contour(self.segments[first:] + self.segments[:first])

    def polyline(self, sagitta: float) -> tuple[np.ndarray, np.ndarray]:
        """Approximate the contour by straight sides within a distance ``sagitta`` (mm).

        Returns points (k, 2), the first one not repeated, and the index of the segment (k,) of the side
        from each point to the next.
        """
        fractions = [segment.chords(sagitta)[:-1] for segment in self.segments]
        points = [part.points(s) for part, s in zip(self.segments, fractions, strict=True)]
        counts = [s.size for s in fractions]
        return np.concatenate(points), np.repeat(np.arange(len(counts)), counts)


@dataclass(frozen=True)
class Outline:
    """A section: the material lies on the left of every contour.

    Counter-clockwise holes are reversed. Every contour begins at the beginning of one of its edges.

    Attributes
    ----------
    outer : Contour
        Counter-clockwise.
    holes : tuple of Contour
        Inside a body, without contact between them.
    others : tuple of Contour
        Outer contours of further bodies, outside of the others or in their holes; counter-clockwise.

    Raises
    ------
    GeometryError
        For a clockwise outer contour, an edge that is not connected, a contour that touches or crosses
        itself or another one, a hole outside or within another hole, a body in another one's material.
    """

    outer: Contour
    holes: tuple = ()
    others: tuple = ()

    def __post_init__(self):
        holes = self.holes if isinstance(self.holes, tuple | list) else (self.holes,)
        for contour in (self.outer, *holes, *self.others):
            if not isinstance(contour, Contour):
                raise GeometryError(
                    f"a section must consist of contours (Contour), got {contour!r}"
                )
        # clockwise: area < 0
        holes = tuple(hole.reversed() if hole.area > 0.0 else hole for hole in holes)
        # frozen dataclass: normalised contours replace those given
        object.__setattr__(self, "outer", self.outer.from_edge())
        object.__setattr__(self, "holes", tuple(hole.from_edge() for hole in holes))
        object.__setattr__(self, "others", tuple(other.from_edge() for other in self.others))
        self._check_names()
        labelled = self.labelled(SAGITTA * self.size)
        check_apart(labelled, self.titles, APART * self.size)
        for contour, title in zip(self.contours, self.titles, strict=True):
            if contour.area < 0.0 and contour not in self.holes:
                raise GeometryError(
                    f"{title} (edges {', '.join(contour.edge_names)}) runs clockwise; reverse the "
                    "direction of this contour, so that the material lies on the left"
                )
        check_nested(labelled, self.titles, len(self.holes))

    @property
    def contours(self) -> tuple:
        """Outer contour, holes, outer contours of further bodies."""
        return (self.outer, *self.holes, *self.others)

    @property
    def titles(self) -> tuple[str, ...]:
        """Names of the contours in messages."""
        first = "the outer contour of body 1" if self.others else "the outer contour"
        holes = (f"hole {n}" for n in range(1, len(self.holes) + 1))
        others = (f"the outer contour of body {n}" for n in range(2, len(self.others) + 2))
        return (first, *holes, *others)

    @cached_property
    def bodies(self) -> tuple:
        """Contours of every body, its outer one first."""
        # a hole belongs to the smallest outer contour around it
        around, contours = nearest_around(self.polyline()), self.contours
        return tuple(
            (outer, *(h for i, h in enumerate(self.holes, 1) if contours[around[i]] is outer))
            for outer in (self.outer, *self.others)
        )

    def body_title(self, number: int) -> str:
        """Name a body, counted from 1, in messages."""
        if not self.others:
            return "the section"
        return f"body {number} (edge {self.bodies[number - 1][0].edge_names[0]!r})"

    def shape(self, sagitta: float):
        """Return the section as a shapely geometry whose sides are within ``sagitta`` (mm) of it."""
        return shapely.union_all([
            shapely.Polygon(own[0].polyline(sagitta)[0], [c.polyline(sagitta)[0] for c in own[1:]])
            for own in self.bodies
        ])  # fmt: skip

    def redrawn(self, contours) -> "Outline":
        """Return a section with other contours, in the order of ``contours``."""
        last = 1 + len(self.holes)
        return Outline(contours[0], tuple(contours[1:last]), tuple(contours[last:]))

    @cached_property
    def area(self) -> float:
        """Area of the material, mm^2."""
        # holes are clockwise and count negative
        return float(sum(contour.area for contour in self.contours))

    @cached_property
    def box(self) -> np.ndarray:
        """Bounding box: least and largest coordinates, shape (2, 2), mm."""
        points = np.concatenate([
            segment.points(np.linspace(0.0, 1.0, 8 * segment.sides + 1))
            for contour in (self.outer, *self.others)
            for segment in contour.segments
        ])  # fmt: skip
        return np.array([points.min(axis=0), points.max(axis=0)])

    @cached_property
    def size(self) -> float:
        """Diagonal of the box, mm."""
        return float(np.hypot(*(self.box[1] - self.box[0])))

    @property
    def edge_names(self) -> tuple[str, ...]:
        """Names of all edges, outer contour first, in order along the contours."""
        return tuple(name for contour in self.contours for name in contour.edge_names)

    def edge(self, name: str) -> tuple:
        """Return the segments of an edge in order; GeometryError for a name that no edge has."""
        found = tuple(s for contour in self.contours for s in contour.segments if s.edge == name)
        if not found:
            raise GeometryError(
                f"the section has no edge {name!r}; its edges are {', '.join(self.edge_names)}"
            )
        return found

    def polyline(self, sagitta: float | None = None) -> list[np.ndarray]:
        """Approximate every contour by points (k, 2) within ``sagitta`` (mm), 1e-5 of the size."""
        sagitta = SAGITTA * self.size if sagitta is None else sagitta
        return [contour.polyline(sagitta)[0] for contour in self.contours]

    def labelled(self, sagitta: float) -> list:
        """List points, segments of the sides and edge names of the segments, of every contour."""
        return [
            (*contour.polyline(sagitta), [segment.edge for segment in contour.segments])
            for contour in self.contours
        ]

    def _check_names(self):
        # names of edges are unique over all contours
        seen = {}
        for contour, where in zip(self.contours, self.titles, strict=True):
            names = [segment.edge for segment in contour.segments]
            # an edge is connected if its name begins only once over all contours
            starts = [name for i, name in enumerate(names) if i == 0 or name != names[i - 1]]
            for name in starts:
                if name in seen:
                    places = (
                        f"in two parts on {where}"
                        if seen[name] == where
                        else f"on {seen[name]} and on {where}"
                    )
                    raise GeometryError(
                        f"the edge {name!r} is {places}; an edge must be one connected part of the "
                        "boundary; give the second part a different name (in a drawing, a "
                        "different layer)"
                    )
                seen[name] = where
