"""Design of single features of a section: displacement of a vertex, radius of an arc."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from seal_mdao.seals.outline.arcs import circle_through
from seal_mdao.seals.outline.boundary_path import SAME, MirrorPlane
from seal_mdao.seals.outline.offset_fields import STILL
from seal_mdao.seals.outline.segments import pair

AT_VERTEX = 5e-3
"""Largest distance of a given point from the vertex that it means, mm; segments are longer."""
ROUND = 1e-6
"""Largest distance of the points of an arc from its circle, over its radius, and of those of a line from
its chord, over its length."""
TANGENT = 1e-3
"""Largest turn of the tangent at a smooth joint, radians."""
MOST_FILLET = np.radians(170.0)
"""Largest turn of an arc whose centre follows its radius so that it stays tangent."""


@dataclass(frozen=True)
class VertexDesign:
    """A vertex that moves; the segments beside it follow linearly, so lines stay straight.

    Attributes
    ----------
    at : pair of float
        The vertex, mm.
    directions : tuple of int, or None
        0 for x, 1 for y, a parameter for each; None for both, or the one in a plane of symmetry.
    mirror : MirrorPlane or None
        Plane to which the displacements are symmetric: the mirror image of the vertex moves too.
    remedy : str
        What to do where it would move a supported edge; of the class.
    """

    at: tuple
    directions: tuple | None = None
    mirror: MirrorPlane | None = None

    remedy: ClassVar[str] = (
        "choose a vertex that is no end of this edge, or move another edge (edges, parameters)"
    )

    def moving(self, sampled) -> set:
        """Names of the edges that move completely."""
        return set()

    def columns(self, sampled) -> np.ndarray:
        """Compute the velocity of the boundary points for every parameter, shape (P, K, 2)."""
        loop, k = sampled.vertex(self.at, AT_VERTEX)
        # a design that is written keeps the ends of segments at corners and between edges
        boundary = sampled.boundaries[loop]
        turn = np.hypot(*np.subtract(*np.asarray(boundary.tangent)[k]))
        if turn < TANGENT and boundary.edge[k - 1] == boundary.edge[k]:
            raise ValueError(
                f"the edge {str(boundary.edge[k])!r} is smooth at {pair(self.at)}, so there is no "
                "vertex to move; use the keys edges and between instead of vertex"
            )
        image = None
        across = sampled.planes_at(loop, k)
        if self.mirror is not None:
            image = sampled.vertex(self.mirror.image(self.at), AT_VERTEX)
            # a vertex in the plane of symmetry stays in it
            across |= {self.mirror.axis} if image == (loop, k) else set()
        chosen = (0, 1) if self.directions is None else self.directions
        allowed = [axis for axis in chosen if axis not in across]
        if not allowed or (self.directions is not None and len(allowed) < len(chosen)):
            refused = " and ".join("xy"[axis] for axis in chosen if axis in across)
            raise ValueError(
                f"the vertex {pair(self.at)} lies in a plane of symmetry and cannot move out of it "
                f"in {refused}; remove {refused} from directions"
            )
        columns = []
        for axis in allowed:
            unit = np.eye(2)[axis]
            own = _moved_end(sampled, loop, k, unit)
            if image not in (None, (loop, k)):
                # the image moves against it across the plane, with it along the plane
                sign = -1.0 if axis == self.mirror.axis else 1.0
                own = own + _moved_end(sampled, *image, sign * unit)
            columns.append(own)
        return np.array(columns)


def _moved_end(sampled, loop: int, k: int, velocity) -> np.ndarray:
    """Compute the velocity (K, 2) of the boundary where the vertex k of a loop has a velocity (2,)."""
    column = np.zeros((len(sampled.points), 2))
    for piece in sampled.pieces(loop):
        # V(X) = t V_k, t the fraction of the chords from the other end of the segment
        if k in (piece[0], piece[-1]):
            order = piece if piece[-1] == k else piece[::-1]
            column[sampled.starts[loop] + order] = _fractions(sampled, loop, order) * velocity
    return column


def _fractions(sampled, loop: int, order) -> np.ndarray:
    """Compute the fractions of the length of the chords up to every point of a segment, (k, 1)."""
    points = sampled.points[sampled.starts[loop] + order]
    chords = np.hypot(*np.diff(points, axis=0).T)
    # t_k = sum_(i < k) |X_(i+1) - X_i| / sum_i |X_(i+1) - X_i|
    return (np.append(0.0, np.cumsum(chords)) / chords.sum())[:, None]


@dataclass(frozen=True)
class RadiusDesign:
    """An arc whose radius changes, or a circle.

    Between two lines that it joins smoothly it stays tangent to them; elsewhere its centre stays, and
    the segments beside it follow its ends linearly.

    Attributes
    ----------
    at : pair of float
        Any point of the arc, mm.
    mirror : MirrorPlane or None
        The mirror image of the arc gets the same radius.
    remedy : str
        What to do where it would move a supported edge; of the class.
    """

    at: tuple
    mirror: MirrorPlane | None = None

    remedy: ClassVar[str] = (
        "in place of arc, move the edge of the arc along its normals (edges, parameters), which keeps "
        "its ends"
    )

    def moving(self, sampled) -> set:
        """Names of the edges that move completely."""
        return set()

    def columns(self, sampled) -> np.ndarray:
        """Compute the velocity of the boundary points for every parameter, shape (P, K, 2)."""
        arcs = {sampled.segment_at(self.at): self.at}
        if self.mirror is not None:
            image = self.mirror.image(self.at)
            arcs.setdefault(sampled.segment_at(image), image)
        column, own = np.zeros((len(sampled.points), 2)), {}
        for (loop, number), at in arcs.items():
            pieces = sampled.pieces(loop)
            before, after = (number - 1) % len(pieces), (number + 1) % len(pieces)
            velocity = own[loop, number] = _larger_radius(sampled, loop, number, at)
            # the segments beside it follow its ends, a single one both of them
            for beside, end in ((before, 0), (after, -1)):
                if (loop, beside) not in arcs:
                    order = pieces[beside] if end == 0 else pieces[beside][::-1]
                    moved = _fractions(sampled, loop, order) * velocity[end]
                    column[sampled.starts[loop] + order] += moved
        moved_by_arc = set()
        for (loop, number), velocity in own.items():
            points = sampled.starts[loop] + sampled.pieces(loop)[number]
            shared = [i for i, point in enumerate(points) if point in moved_by_arc]
            if np.abs(column[points[shared]] - velocity[shared]).max(initial=0.0) > STILL:
                raise ValueError(
                    f"the arc at {pair(self.at)} and its mirror image meet, but have different "
                    "centres, so their radii cannot grow together; leave out mirror, or move their "
                    "edges along the normals (edges, parameters)"
                )
            column[points] = velocity
            moved_by_arc |= set(points)
        return column[None]


def _larger_radius(sampled, loop: int, number: int, at) -> np.ndarray:
    """Compute the velocity (k, 2) of the points of an arc per unit of its radius."""
    pieces, start = sampled.pieces(loop), sampled.starts[loop]
    points = sampled.points[start + pieces[number]]
    centre, radius = _circle(points, at)
    away = (points - centre) / radius
    if len(pieces) == 1:
        # a circle: V = (X - c) / R, c at rest
        return away
    beside = pieces[number - 1], pieces[(number + 1) % len(pieces)]
    # V = dc/dR + (X - c) / R, dc/dR = 0 unless the arc is a fillet
    return away + _centre_velocity(sampled, loop, beside, away)


def _centre_velocity(sampled, loop, beside, away) -> np.ndarray:
    """Compute dc/dR (2,): that of an arc that stays tangent to the lines beside it, else zero."""
    boundary, start = sampled.boundaries[loop], sampled.starts[loop]
    ends = beside[0][-1], beside[1][0]
    tangent = np.asarray(boundary.tangent)[list(ends)]
    # a fillet: no corner at either end, lines on both sides, less than a half circle
    smooth = (np.hypot(*(tangent[:, 1] - tangent[:, 0]).T) < TANGENT).all()
    straight = all(_is_straight(sampled.points[start + own]) for own in beside)
    turn = np.arccos(np.clip(away[0] @ away[-1], -1.0, 1.0))
    if not (smooth and straight and turn < MOST_FILLET) or turn < TANGENT:
        return np.zeros(2)
    # the centre is R away from both lines:  n_1 . dc/dR = n_2 . dc/dR = 1, n from the line to the centre
    return np.linalg.solve(-away[[0, -1]], np.ones(2))


def _circle(points, at) -> tuple[np.ndarray, float]:
    """Find centre and radius of the circle through points; ValueError if they lie on none."""
    centre, radius, rank = circle_through(points)
    if rank == 3 and not _is_straight(points):
        away = np.abs(np.hypot(*(points - centre).T) - radius)
        if away.max() <= ROUND * radius:
            return centre, radius
    raise ValueError(
        f"the segment of the boundary at {pair(at)} is not an arc, so it has no radius to change; "
        "give a point of an arc or a circle"
    )


def _is_straight(points) -> bool:
    """Return whether points lie on the line through their ends."""
    along = points[-1] - points[0]
    length = np.hypot(*along)
    if length <= SAME:
        return False
    to = points - points[0]
    # distance |r x (b - a)| / |b - a| over the length
    return bool(np.abs(to[:, 0] * along[1] - to[:, 1] * along[0]).max() <= ROUND * length**2)
