"""Design of edges: B-splines of arc length along the nominal normals, over edges or parts of them."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy

from seal_mdao.geometry.polygon import from_sides
from seal_mdao.seals.outline.boundary_path import SAME, BoundaryPath, MirrorPlane
from seal_mdao.seals.outline.segments import pair

DEGREE = 3
STILL = 1e-9
"""Largest velocity of what stays."""
WITHIN = 2
"""B-splines that are left out at an end within an edge: value and slope are zero there."""


class _Part(NamedTuple):
    """A part of an edge that moves: ``first`` and ``last`` arc length, mm, and the number of B-splines
    that are left out at both ends; of a complete loop ``first`` is where the B-splines begin."""

    name: str
    first: float
    last: float
    left_out: tuple
    loop: bool


@dataclass(frozen=True)
class OffsetDesign:
    """Edges that move along their nominal normals by B-splines of arc length.

    Attributes
    ----------
    edges : tuple of str
    parameters : int
        Of every edge; with a plane of symmetry those of both halves count once.
    between : pair of points, or None
        The part of the only edge from the first point to the second along the boundary, mm.
    opposite : str or None
        Edge on the other side of a wall; its points move along their own normals by the offset of the
        nearest point of the edges, so that the wall gets thicker on both sides.
    mirror : MirrorPlane or None
        Plane to which the offsets are symmetric; mirror images of the edges move too.
    """

    edges: tuple
    parameters: int
    between: tuple | None = None
    opposite: str | None = None
    mirror: MirrorPlane | None = None

    def moving(self, sampled) -> set:
        """Names of the edges that move over their complete length."""
        names = {name for own in self.edges for name in self._images(sampled, own)}
        across = () if self.opposite is None else self._images(sampled, self.opposite)
        return (set() if self.between is not None else names) | {*across}

    def columns(self, sampled) -> np.ndarray:
        """Compute the velocity of the boundary points for every parameter, shape (P, K, 2)."""
        blocks, done = [], []
        for name in self.edges:
            # the image of an edge may be listed as well
            if name not in done:
                done += self._images(sampled, name)
                blocks.append(self._offsets(sampled, name))
        if self.opposite is not None:
            across = self._images(sampled, self.opposite)
            blocks = [own | _across(sampled, own, done, across) for own in blocks]
        columns = np.concatenate([_along_normals(sampled, own) for own in blocks])
        self._require_effect(columns)
        return columns

    def _require_effect(self, columns) -> None:
        """Refuse B-splines between neighbouring particles, which move none of them."""
        without = int((np.abs(columns).max(axis=(1, 2)) <= STILL).sum())
        if without:
            edges = f"edge{'s' if len(self.edges) > 1 else ''} {', '.join(map(repr, self.edges))}"
            raise ValueError(
                f"{without} of the {len(columns)} design parameters of the {edges} move no particle, "
                "because they act between neighbouring particles only; use fewer parameters, a longer "
                "part (between), or more particles along the edge"
            )

    def _images(self, sampled, name: str) -> list:
        """List an edge and its mirror image, once if it is its own."""
        if self.mirror is None:
            return [name]
        return list(dict.fromkeys([name, _image(sampled, name, self.mirror)[0]]))

    def _offsets(self, sampled, name) -> dict:
        """Compute the offsets by the parameters of one edge: (n, k) at its points, by edges."""
        part, path = self._part(sampled, name), sampled.path(name)
        own = _basis(part, path, self.parameters).T
        if self.mirror is None:
            return {name: own}
        image, c = _image(sampled, name, self.mirror)
        mirrored = sampled.path(image)
        if image == name and _is_own_image(part, c, path.length):
            return {name: _folded(part, own)}
        if self.between is None and self._part(sampled, image).left_out != part.left_out[::-1]:
            raise ValueError(
                f"the edges {name!r} and {image!r} are mirror images, but only one of them ends at "
                "a fixed edge; fix the neighbouring edges of both, or of neither"
            )
        # the offset at s of the image is that at c - s of the edge
        other = _basis(part, path, self.parameters, c - mirrored.along).T
        return {name: own + other} if image == name else {name: own, image: other}

    def _part(self, sampled, name) -> _Part:
        """Find the part of an edge that moves, and what is zero at its ends."""
        path, stretch = sampled.path(name), sampled.stretches[name]
        fixed = tuple(sampled.is_still(stretch, end) for end in (0, -1))
        if self.between is None:
            if not stretch.closed:
                return _checked(_Part(name, 0.0, path.length, fixed, False), self.parameters)
            first = 0.0
            if self.mirror is not None:
                # B-splines of a loop that is its own image begin in the plane
                image, c = _image(sampled, name, self.mirror)
                first = 0.5 * c if image == name else 0.0
            part = _Part(name, first, first + path.length, (0, 0), True)
            return _checked(part, self.parameters)
        first, last = (sampled.on_edge(name, point) for point in self.between)
        if stretch.closed:
            last = first + (last - first) % path.length
        if last - first <= SAME:
            raise ValueError(
                f"the edge {name!r} runs from {pair(self.between[1])} to {pair(self.between[0])}; "
                "give the two points of the key between in this order"
            )
        # at an end of the edge as without between, else value and slope are zero
        ends = (first <= SAME, last >= path.length - SAME)
        at = (False, False) if stretch.closed else ends
        left_out = tuple(f if e else WITHIN for f, e in zip(fixed, at, strict=True))
        return _checked(_Part(name, first, last, left_out, False), self.parameters)


def _checked(part: _Part, count: int) -> _Part:
    """Check that a part has enough parameters for its B-splines."""
    left_out = 0 if part.loop else sum(part.left_out)
    if count + left_out < DEGREE + 1:
        raise ValueError(
            f"the edge {part.name!r} needs at least {DEGREE + 1 - left_out} design parameters "
            f"(parameters), got {count}"
        )
    return part


def _image(sampled, name: str, plane: MirrorPlane) -> tuple[str, float]:
    """Find the edge that is the mirror image of an edge, and c of ``mirrored_start``."""
    path = sampled.path(name)
    for other in sampled.stretches:
        c = path.mirrored_start(sampled.path(other), plane)
        if c is not None:
            return other, c
    remedy = "draw the section symmetric to this plane"
    if path.stretch.closed:
        # the particles of a circle need not be symmetric to the plane; those of two halves are
        remedy += ", a closed edge such as a circle as two arcs that meet in the plane"
    raise ValueError(
        f"no edge is the mirror image of {name!r} in the plane {'xy'[plane.axis]} = {plane.at:g}; "
        f"{remedy}, or leave out mirror"
    )


def _is_own_image(part: _Part, c: float, length: float) -> bool:
    """Return whether a part is its own image under s -> c - s."""
    if part.loop:
        return True
    away = part.first + part.last - c
    # on a loop up to complete turns
    return abs(away - length * round(away / length)) <= SAME


def _folded(part: _Part, own) -> np.ndarray:
    """Add the B-splines that are mirror images of each other, shape ((n + 1) // 2 or so, K)."""
    count = len(own)
    if part.left_out[0] != part.left_out[1]:
        raise ValueError(
            f"the two ends of the part of the edge {part.name!r} that moves differ (an end at an edge "
            "that does not move, at one that moves, or within the edge), so the design cannot be "
            "symmetric; leave out mirror, or choose a part with equal ends (between)"
        )
    # j <-> n - 1 - j of an open part, j <-> -j of a loop whose first B-spline is in the plane
    image = -np.arange(count) % count if part.loop else np.arange(count)[::-1]
    first = np.flatnonzero(np.arange(count) <= image)
    return np.array([own[j] if image[j] == j else own[j] + own[image[j]] for j in first])


def _basis(part: _Part, path: BoundaryPath, count: int, along=None) -> np.ndarray:
    """Evaluate the B-splines of a part at arc lengths of its edge, shape (k, count)."""
    s = (path.along if along is None else along) - part.first
    if path.stretch.closed:
        s = s % path.length
    if part.loop:
        return _periodic(s / path.length, count)
    size = part.last - part.first
    # clamped uniform knots: only the first spline is not zero at the first point, only the last
    # at the last one, and the slope only that of the first two; these are left out
    before, after = part.left_out
    inner = np.linspace(0.0, size, count + before + after - DEGREE + 1)
    knots = np.concatenate([[0.0] * DEGREE, inner, [size] * DEGREE])
    inside = (s >= -SAME) & (s <= size + SAME)
    values = np.zeros((s.size, count + before + after))
    at = np.clip(s[inside], 0.0, size)
    if at.size:
        values[inside] = scipy.interpolate.BSpline.design_matrix(at, knots, DEGREE).toarray()
    return values[:, int(before) : values.shape[1] - int(after)]


def _periodic(s, count) -> np.ndarray:
    """Evaluate periodic B-splines at fractions ``s`` of the loop; number j is largest at j / count."""
    knots = np.arange(-DEGREE, count + DEGREE + 1) / count
    values = scipy.interpolate.BSpline.design_matrix(s, knots, DEGREE).toarray()
    # splines that leave the interval at its end enter it at the beginning: add the two parts
    found = values[:, :count].copy()
    found[:, :DEGREE] += values[:, count:]
    return np.roll(found, -1, axis=1)


def directions(boundary, stretch) -> np.ndarray:
    """Compute the velocity of points for a unit offset, shape (k, 2): both sides of a corner by 1.

    At the ends of a stretch only its own normal counts: the adjacent edge adds its own velocity.
    """
    before, after = (
        np.column_stack([t[:, 1], -t[:, 0]])
        for t in np.asarray(boundary.tangent)[stretch.points].transpose(1, 0, 2)
    )
    if not stretch.closed:
        before[0], after[-1] = after[0], before[-1]
    # v . n_1 = v . n_2 = 1 for v = (n_1 + n_2) / (1 + n_1 . n_2), bounded at sharp corners
    denominator = 1.0 + (before * after).sum(axis=1)
    return (before + after) / np.maximum(denominator, 0.5)[:, None]


def _along_normals(sampled, offsets: dict) -> np.ndarray:
    """Compute the velocity of the boundary points for offsets of edges, shape (n, K, 2)."""
    count = len(next(iter(offsets.values())))
    columns = np.zeros((count, len(sampled.points), 2))
    for name, own in offsets.items():
        stretch = sampled.stretches[name]
        # V_p(X_k) = N_p(s_k) n_k
        normals = directions(sampled.boundaries[stretch.loop], stretch)
        columns[:, sampled.indices(name)] += own[:, :, None] * normals
    return columns


def _across(sampled, offsets: dict, names, across) -> dict:
    """Compute the offsets of edges across a wall: those of the nearest points of the edges ``names``."""
    count = len(next(iter(offsets.values())))
    # straight sides of the edges and the offsets at their ends
    first, last, a, b = [], [], [], []
    for name in names:
        points = sampled.points[sampled.indices(name)]
        own = offsets.get(name, np.zeros((count, len(points))))
        if sampled.stretches[name].closed:
            points, own = np.vstack([points, points[:1]]), np.hstack([own, own[:, :1]])
        for found, values in (
            (a, points[:-1]),
            (b, points[1:]),
            (first, own.T[:-1]),
            (last, own.T[1:]),
        ):
            found.append(values)
    first, last, a, b = map(np.concatenate, (first, last, a, b))
    found = {}
    for name in across:
        # the nearest side of every point, and where on it
        t, away = from_sides(sampled.points[sampled.indices(name)][:, None], a, b)
        nearest = np.hypot(*np.moveaxis(away, -1, 0)).argmin(axis=1)
        t = t[np.arange(len(t)), nearest, None]
        own = ((1.0 - t) * first[nearest] + t * last[nearest]).T
        # an end where the next edge stays must not move
        for end in (0, -1):
            if sampled.is_still(sampled.stretches[name], end) and np.abs(own[:, end]).max() > SAME:
                raise ValueError(
                    f"the edge {name!r} (opposite) ends at an edge that does not move, but the "
                    "design would move this end with the edges on the other side of the wall; choose "
                    "a part of them (between) that ends before this point"
                )
        found[name] = own
    return found
