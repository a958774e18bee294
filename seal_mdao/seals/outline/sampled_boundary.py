"""The sampled boundary of a section with its edges, segments, vertices and supports."""

import numpy as np

from seal_mdao.geometry.polygon import from_sides
from seal_mdao.seals.outline.boundary_path import BoundaryPath, Stretch, stretches
from seal_mdao.seals.outline.segments import pair

PLANAR = 1e-6
"""Largest extent of an edge across its plane, over the size of the section."""


class SampledBoundary:
    """Sampled boundary of a section, as used by designs.

    Parameters
    ----------
    boundaries : sequence of Boundary
    supports : mapping of str to tuple of int
        As of ``boundary_velocity``.

    Attributes
    ----------
    stretches : dict of str to Stretch
    points : ndarray, shape (K, 2)
        Points of all loops in succession, mm; loop i begins at ``starts[i]``.
    planes : dict of str to int
        Edges with one prescribed component that lie in a plane across its axis, with this axis.
    """

    def __init__(self, boundaries, supports):
        self.boundaries, self.stretches = boundaries, stretches(boundaries)
        self.starts = np.cumsum([0, *(len(boundary.points) for boundary in boundaries)])
        self.points = np.concatenate([np.asarray(boundary.points) for boundary in boundaries])
        single = {name: own[0] for name, own in supports.items() if len(own) == 1}
        self.planes = {name: axis for name, axis in single.items() if self._is_plane(name, axis)}
        self._still = set()

    def _is_plane(self, name: str, axis: int) -> bool:
        """Return whether an edge lies in a plane across an axis; others with one prescribed component
        do not move."""
        spread = np.ptp(self.points[self.indices(name), axis])
        return bool(spread <= PLANAR * np.ptp(self.points, axis=0).max())

    def hold(self, moving) -> None:
        """Store as fixed the points of all edges that are neither ``moving`` nor in a plane."""
        still = [
            self.stretches[name]
            for name in self.stretches
            if name not in moving and name not in self.planes
        ]
        self._still = {(stretch.loop, int(k)) for stretch in still for k in stretch.points}

    def is_still(self, stretch: Stretch, end: int) -> bool:
        """Return whether the first (0) or last (-1) point of a stretch is fixed."""
        return (stretch.loop, int(stretch.points[end])) in self._still

    def path(self, name: str) -> BoundaryPath:
        """Return an edge as a curve."""
        stretch = self.stretches[name]
        return BoundaryPath(self.boundaries[stretch.loop], stretch)

    def indices(self, name: str) -> np.ndarray:
        """Return the indices of the points of an edge among all points."""
        stretch = self.stretches[name]
        return self.starts[stretch.loop] + stretch.points

    def on_edge(self, name: str, point) -> float:
        """Return the arc length, mm, of a point of an edge; ValueError if it is not on the edge."""
        path = self.path(name)
        s, away = path.project(np.asarray(point, float))
        # on the edge within its longest side
        nearest = float(np.diff(path.along).max())
        if away > nearest:
            raise ValueError(
                f"the point {pair(point)} of the key between must lie on the edge {name!r}, but is "
                f"{away:.3g} mm away from this edge"
            )
        return s

    def pieces(self, loop: int) -> list[np.ndarray]:
        """List the points of every segment of a loop, both ends included."""
        # a segment from every corner to the next, the last one over the start of the loop
        corners = np.flatnonzero(self.boundaries[loop].corner)
        count = len(self.boundaries[loop].points)
        ends = np.append(corners[1:], count + corners[0])
        return [np.arange(a, b + 1) % count for a, b in zip(corners, ends, strict=True)]

    def vertex(self, at, within: float) -> tuple[int, int]:
        """Find the vertex at a point: its loop and its index there.

        ValueError names the nearest one where there is none.
        """
        # ends of segments; a contour of one segment has no vertex
        corner = [np.asarray(b.corner) & (np.sum(b.corner) > 1) for b in self.boundaries]
        which = np.flatnonzero(np.concatenate(corner))
        if not which.size:
            raise ValueError(
                f"the boundary has no vertex at {pair(at)}, because every contour is a single "
                "segment; use the key edges instead of vertex"
            )
        # nearest vertex, and the loop in which its index lies
        away = np.hypot(*(self.points[which] - np.asarray(at, float)).T)
        index = int(which[away.argmin()])
        if away.min() > within:
            raise ValueError(
                f"the boundary has no vertex at {pair(at)}; the nearest vertex is at "
                f"{pair(self.points[index])}"
            )
        loop = int(np.searchsorted(self.starts, index, side="right")) - 1
        return loop, index - int(self.starts[loop])

    def planes_at(self, loop: int, k: int) -> set:
        """Return the axes across the planes of symmetry in which a point lies."""
        return {
            axis
            for name, axis in self.planes.items()
            if self.stretches[name].loop == loop and k in self.stretches[name].points
        }

    def segment_at(self, point) -> tuple[int, int]:
        """Find the segment nearest to a point: its loop and its number there."""
        found = []
        for loop in range(len(self.boundaries)):
            for number, piece in enumerate(self.pieces(loop)):
                a = self.points[self.starts[loop] + piece]
                # distance from the straight sides of the segment
                across = from_sides(np.asarray(point, float), a[:-1], a[1:])[1]
                found.append((np.hypot(*across.T).min(), loop, number))
        away, loop, number = min(found)
        piece = self.points[self.starts[loop] + self.pieces(loop)[number]]
        if away > np.hypot(*np.diff(piece, axis=0).T).max():
            raise ValueError(
                f"the point {pair(point)} must lie on the boundary of the section, but is "
                f"{away:.3g} mm away"
            )
        return loop, number
