"""Quadrilateral cells from triangles.

The volume change is projected on each cell. Triangles give one volume constraint for each unknown and
lock; quadrilaterals give half as many. Triangles are therefore paired where the pair is close to a
rectangle, and then every cell is divided from its centre to the midpoints of its sides, which gives
quadrilaterals only, and two cells across a wall where there was one.
"""

from itertools import pairwise

import numpy as np

WORST_ANGLE = 60.0
"""Largest deviation of a corner of a pair from a right angle, degrees."""


def corner_angles(corners: np.ndarray) -> np.ndarray:
    """Compute inner angles of counter-clockwise polygons (..., k, 2), degrees, shape (..., k)."""
    after = np.roll(corners, -1, axis=-2) - corners
    before = np.roll(corners, 1, axis=-2) - corners
    # angle from the side after to the side before: atan2(a x b, a . b) in [0, 360)
    cross = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    return np.degrees(np.arctan2(cross, (after * before).sum(axis=-1))) % 360.0


def paired(points: np.ndarray, triangles: np.ndarray, parts: np.ndarray) -> tuple:
    """Join triangles (k, 3) of one part in pairs, greedily from the most rectangular pair.

    Returns cells (m, 4), in which single triangles repeat a corner, and their parts (m,) from those (k,)
    of the triangles.
    """
    quads, owners = _candidates(triangles)
    same = parts[owners[:, 0]] == parts[owners[:, 1]]
    quads, owners = quads[same], owners[same]
    deviation = np.abs(corner_angles(points[quads]) - 90.0).max(axis=1)
    # rounding must not decide between equal pairs
    order = np.lexsort((*owners.T[::-1], deviation.round(6)))
    used, cells, own = np.zeros(len(triangles), bool), [], []
    for pair in order:
        if deviation[pair] < WORST_ANGLE and not used[owners[pair]].any():
            used[owners[pair]] = True
            cells.append(quads[pair])
            own.append(parts[owners[pair, 0]])
    single = triangles[~used]
    cells = np.array(cells, int).reshape(-1, 4)
    return (
        np.vstack([cells, np.column_stack([single, single[:, 2]])]),
        np.concatenate([np.array(own, int), parts[~used]]),
    )


def _candidates(triangles):
    """List the quadrilaterals (p, 4) of all adjacent triangles, and these triangles (p, 2)."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    apex = np.roll(triangles, 1, axis=1).ravel()
    # the two triangles of a side have the same sorted ends: adjacent after sorting all sides
    key = np.sort(ends, axis=1)
    order = np.lexsort(key.T)
    same = (key[order[1:]] == key[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    # common side (a, b) of the first triangle, apexes c_1, c_2: quadrilateral a, c_2, b, c_1
    quads = np.column_stack([ends[first, 0], apex[second], ends[first, 1], apex[first]])
    return quads, np.sort(np.column_stack([first // 3, second // 3]), axis=1)


def halved(points: np.ndarray, cells: np.ndarray, loops) -> tuple[np.ndarray, np.ndarray]:
    """Divide every cell into quadrilaterals from its centre to the midpoints of its sides.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Every other point of the loops first.
    cells : ndarray of int, shape (m, 4)
        Triangles repeat a corner.
    loops : sequence of ndarray, shape (2 k, 2)
        The points of odd index are the midpoints of the sides at the boundary.

    Returns
    -------
    points : ndarray, shape (n, 2)
        Those of the loops first, in order.
    cells : ndarray of int, shape (m, 4)
    """
    rim = np.concatenate(loops)
    start = np.cumsum([0, *(len(loop) for loop in loops)])
    # sides at the boundary take the given points on the curve, not the midpoints of chords
    middles = {}
    for first, end in pairwise(start):
        corner = np.append(np.arange(first, end, 2), first)
        for a, middle, b in zip(corner[:-1], range(first + 1, end, 2), corner[1:], strict=True):
            middles[frozenset((int(a), int(b)))] = middle
    inner = points[len(rim) // 2 :]
    # corners at the boundary have the even indices of the loops, inner points follow the loops
    renumbered = np.concatenate([np.arange(0, len(rim), 2), len(rim) + np.arange(len(inner))])
    found, quads = [*rim, *inner], []
    for cell in renumbered[cells].tolist():
        corners = list(dict.fromkeys(cell))
        between = []
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
            # each midpoint is made once for both cells of a side
            side = frozenset((a, b))
            if side not in middles:
                middles[side] = len(found)
                found.append(0.5 * (found[a] + found[b]))
            between.append(middles[side])
        quads += [
            [corner, after, len(found), between[i - 1]]
            for i, (corner, after) in enumerate(zip(corners, between, strict=True))
        ]
        found.append(np.mean([found[middle] for middle in between], axis=0))
    return np.array(found), np.array(quads)
