"""Design of a section: its boundary moves along the drawn normals by B-splines of arc length."""

from typing import NamedTuple

import numpy as np
from scipy.interpolate import BSpline

DEGREE = 3


class EdgeDesign(NamedTuple):
    """Edges whose shape is designed.

    Attributes
    ----------
    edges : tuple of str
    parameters : int
        Free control values of each edge, mm.
    """

    edges: tuple
    parameters: int


class Stretch(NamedTuple):
    """An edge as a stretch of its loop.

    Attributes
    ----------
    loop : int
    points : ndarray of int, shape (k,)
        Places in the loop, in order; those of a whole loop once around.
    closed : bool
    """

    loop: int
    points: np.ndarray
    closed: bool


def stretches(boundaries) -> dict:
    """The ``Stretch`` of every edge by name.

    Parameters
    ----------
    boundaries : sequence of Boundary
        Points of every loop with the edge of the side that begins there.

    Raises
    ------
    ValueError
        For an edge that is not one stretch.
    """
    found = {}
    for loop, boundary in enumerate(boundaries):
        edges = np.asarray(boundary.edge)
        for name in dict.fromkeys(edges.tolist()):
            sides = np.flatnonzero(edges == name)
            if sides.size == edges.size:
                found[name] = Stretch(loop, sides, True)
                continue
            gap = np.flatnonzero(np.diff(sides) > 1)
            if gap.size:
                sides = np.roll(sides, -int(gap[0]) - 1)
            if name in found or (np.diff(sides) % edges.size != 1).any():
                raise ValueError(f"the edge {name!r} is not one unbroken stretch of the boundary")
            found[name] = Stretch(loop, np.append(sides, (sides[-1] + 1) % edges.size), False)
    return found


def checked_names(names, known, what: str) -> None:
    """Every name is that of an edge.

    Raises
    ------
    ValueError
    """
    for name in names:
        if name not in known:
            raise ValueError(f"{what}: no edge is called {name!r}; edges are {', '.join(known)}")


def boundary_velocity(boundaries, designs, fixed=(), planes=()) -> np.ndarray:
    """Velocity of every boundary point for each parameter, shape (P, k, 2), dimensionless.

    Parameters
    ----------
    boundaries : sequence of Boundary
    designs : sequence of EdgeDesign
        The parameters come in this order, edge after edge, and along each edge.
    fixed : sequence of str
        Edges that stay, as do all others that are neither designed nor in a plane: what is designed
        beside one of them is zero where they meet.
    planes : sequence of (str, int)
        Straight edges that stay in their plane, and the component across it: ends move along it as the
        edges beside them do, and what is between follows linearly.
    """
    known = stretches(boundaries)
    checked_names([name for design in designs for name in design.edges], known, "design")
    named = [name for design in designs for name in design.edges]
    for name in named:
        if name in fixed or name in dict(planes) or named.count(name) > 1:
            what = "is fixed" if name in fixed else "is in a plane"
            what = "is named twice" if named.count(name) > 1 else what
            raise ValueError(f"design: the edge {name!r} {what}")
    starts = np.cumsum([0, *(len(boundary.points) for boundary in boundaries)])
    still = [name for name in known if name not in (*named, *dict(planes))]
    held = {(known[name].loop, int(point)) for name in still for point in known[name].points}
    columns = [np.zeros((0, starts[-1], 2))]
    for design in designs:
        for name in design.edges:
            stretch = known[name]
            boundary = boundaries[stretch.loop]
            ends = [(stretch.loop, int(stretch.points[end])) in held for end in (0, -1)]
            basis = _basis(boundary, stretch, design.parameters, ends, name)
            column = np.zeros((design.parameters, starts[-1], 2))
            column[:, starts[stretch.loop] + stretch.points] = basis.T[:, :, None] * _directions(
                boundary, stretch
            )
            columns.append(column)
    velocity = np.concatenate(columns)
    for name, component in planes:
        stretch = known[name]
        boundary = boundaries[stretch.loop]
        arc = np.asarray(boundary.arc_length)[stretch.points]
        along = (arc - arc[0]) % boundary.length
        _slide(velocity, starts[stretch.loop] + stretch.points, along, component)
    return velocity


def _slide(velocity, places, along, component) -> None:
    """Keep an edge in its plane: its ends move along it, what is between them in proportion."""
    ends = places[[0, -1]]
    velocity[:, ends, component] = 0.0
    share = (np.asarray(along) / along[-1])[None, :, None]
    first, last = (velocity[:, end][:, None] for end in ends)
    velocity[:, places] = first + share * (last - first)


def _basis(boundary, stretch, count, held, name) -> np.ndarray:
    """Values (k, count) of the B-splines at the points of a stretch."""
    least = DEGREE + 1
    if count + sum(held) * (not stretch.closed) < least:
        raise ValueError(
            f"design: the edge {name!r} needs at least {least - sum(held)} parameters, got {count}"
        )
    arc = np.asarray(boundary.arc_length)[stretch.points]
    arc = (arc - arc[0]) % boundary.length
    if stretch.closed:
        return _periodic(arc / boundary.length, count)
    inner = np.linspace(0.0, arc[-1], count + sum(held) - DEGREE + 1)
    knots = np.concatenate([[0.0] * DEGREE, inner, [arc[-1]] * DEGREE])
    values = BSpline.design_matrix(arc, knots, DEGREE).toarray()
    return values[:, held[0] : values.shape[1] - held[1]]


def _periodic(share, count) -> np.ndarray:
    """Periodic B-splines at shares of the way round; number j is largest at j / count."""
    knots = np.arange(-DEGREE, count + DEGREE + 1) / count
    values = BSpline.design_matrix(share, knots, DEGREE).toarray()
    found = values[:, :count].copy()
    found[:, :DEGREE] += values[:, count:]
    return np.roll(found, -1, axis=1)


def _directions(boundary, stretch) -> np.ndarray:
    """How the points move for a unit offset, shape (k, 2): both sides of a corner by as much.

    At the ends of a stretch the normal is its own: its neighbour there has its own share.
    """
    before, after = (
        np.column_stack([t[:, 1], -t[:, 0]])
        for t in np.asarray(boundary.tangent)[stretch.points].transpose(1, 0, 2)
    )
    if not stretch.closed:
        before[0], after[-1] = after[0], before[-1]
    share = 1.0 + (before * after).sum(axis=1)
    # a spike does not run away
    return (before + after) / np.maximum(share, 0.5)[:, None]
