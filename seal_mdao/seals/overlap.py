"""Crossings of a deformed boundary with itself, and the depth of the overlap."""

import numpy as np
import shapely
from scipy.spatial import cKDTree

ON_FACE = 1e-9
"""Distance of a crossing from the face that it bounds, over the size of the section."""


def overlap_depths(x: np.ndarray, segments: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Compute the depth of the overlap at every crossing, shape (c,), mm.

    The boundary divides the plane into faces. Its winding number is 1 in material and 0 outside; in
    overlaps it is 2 or more, in loops that are turned over negative. The depth is the diameter of the
    largest circle in such a face.

    Parameters
    ----------
    x : ndarray, shape (N, 2)
    segments : ndarray of int, shape (s, 2)
        Sides of closed boundaries with the material on their left.
    pairs : ndarray of int, shape (c, 2)
        Segments that cross.
    """
    lines = shapely.linestrings(x[segments])
    # lines that are split where they cross, and the faces between them
    faces = shapely.get_parts(shapely.polygonize(shapely.get_parts(shapely.union_all(lines))))
    winding = _winding(shapely.get_coordinates(shapely.point_on_surface(faces)), x, segments)
    faces = faces[(winding < 0) | (winding > 1)]
    if not len(faces):
        return np.zeros(len(pairs))
    width = 2.0 * shapely.length(shapely.maximum_inscribed_circle(faces))
    # the deepest face at every crossing
    points = shapely.intersection(lines[pairs[:, 0]], lines[pairs[:, 1]])
    near = ON_FACE * float(np.ptp(x, axis=0).max())
    at = shapely.distance(points[:, None], faces[None]) <= near
    return np.where(at, width, 0.0).max(axis=1)


def _winding(points, x, segments) -> np.ndarray:
    """Compute the winding number of closed boundaries around points, shape (k,)."""
    # w = 1/(2 pi) sum of the angles under which the sides are seen, atan2(a x b, a . b)
    a, b = (x[segments[:, end]] - points[:, None] for end in (0, 1))
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    angles = np.arctan2(cross, (a * b).sum(axis=-1))
    return np.rint(angles.sum(axis=1) / (2.0 * np.pi)).astype(int)


def crossings(x: np.ndarray, segments: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Find pairs of segments that cross, without those that share an end.

    Parameters
    ----------
    x : ndarray, shape (N, 2)
    segments : ndarray of int, shape (s, 2)

    Returns
    -------
    pairs : ndarray of int, shape (c, 2)
    depth : ndarray, shape (c,)
        Least distance of the four ends from the line of the other segment, less than the overlap.
    """
    a, b = x[segments[:, 0]], x[segments[:, 1]]
    longest = float(np.linalg.norm(b - a, axis=1).max())
    if not np.isfinite(longest):
        return np.empty((0, 2), int), np.empty(0)
    # candidates: midpoints no farther apart than the longest segment
    pairs = cKDTree(0.5 * (a + b)).query_pairs(longest, output_type="ndarray")
    # neighbours share an end and do not cross
    apart = (segments[pairs[:, 0]][:, :, None] != segments[pairs[:, 1]][:, None, :]).all(
        axis=(1, 2)
    )
    pairs = pairs[apart]
    i, k = pairs.T
    # they cross where the ends of each lie on both sides of the other
    side = np.array([
        _side(a[i], b[i], a[k]), _side(a[i], b[i], b[k]),
        _side(a[k], b[k], a[i]), _side(a[k], b[k], b[i]),
    ])  # fmt: skip
    cross = (side[0] * side[1] < 0.0) & (side[2] * side[3] < 0.0)
    return pairs[cross], np.abs(side[:, cross]).min(axis=0, initial=np.inf)


def _side(a, b, c):
    """Compute the distance of c from the line through a and b, positive on its left."""
    # t x (c - a) / |t|
    t = b - a
    length = np.hypot(t[:, 0], t[:, 1])
    cross = t[:, 0] * (c[:, 1] - a[:, 1]) - t[:, 1] * (c[:, 0] - a[:, 0])
    return cross / np.where(length > 0.0, length, 1.0)
