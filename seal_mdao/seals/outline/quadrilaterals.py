"""Quadrilateral cells from triangles.

The volume change is projected on each cell. Triangles bring one condition of constant volume for
each unknown and lock; quadrilaterals bring half as many. Triangles are therefore paired where the
pair is a good quadrilateral, and then every cell is cut from its centre to the middles of its
sides, which leaves quadrilaterals alone and two cells across even where there was one.
"""

from itertools import pairwise

import numpy as np

WORST_ANGLE = 60.0
"""Largest deviation of a corner of a pair from a right angle, degrees."""


def corner_angles(corners: np.ndarray) -> np.ndarray:
    """Inner angles of polygons (..., k, 2) walked counter-clockwise, degrees, shape (..., k)."""
    after = np.roll(corners, -1, axis=-2) - corners
    before = np.roll(corners, 1, axis=-2) - corners
    cross = after[..., 0] * before[..., 1] - after[..., 1] * before[..., 0]
    return np.degrees(np.arctan2(cross, (after * before).sum(axis=-1))) % 360.0


def paired(points: np.ndarray, triangles: np.ndarray, parts=None) -> tuple:
    """Triangles (k, 3) joined in pairs of one part, the best first.

    Returns
    -------
    cells : ndarray of int, shape (m, 4)
        Those that are left alone repeat a corner.
    parts : ndarray of int, shape (m,)
        Theirs, from those (k,) of the triangles; zeros unless given.
    """
    parts = np.zeros(len(triangles), int) if parts is None else parts
    quads, owners = _candidates(triangles)
    same = parts[owners[:, 0]] == parts[owners[:, 1]]
    quads, owners = quads[same], owners[same]
    bad = np.abs(corner_angles(points[quads]) - 90.0).max(axis=1)
    # rounding must not decide between equal pairs
    order = np.lexsort((*owners.T[::-1], bad.round(6)))
    used, cells, own = np.zeros(len(triangles), bool), [], []
    for pair in order:
        if bad[pair] < WORST_ANGLE and not used[owners[pair]].any():
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
    """Quadrilaterals (p, 4) of all neighbouring triangles, and which two they are (p, 2)."""
    ends = np.stack([triangles, np.roll(triangles, -1, axis=1)], axis=2).reshape(-1, 2)
    apex = np.roll(triangles, 1, axis=1).ravel()
    key = np.sort(ends, axis=1)
    order = np.lexsort(key.T)
    same = (key[order[1:]] == key[order[:-1]]).all(axis=1)
    first, second = order[:-1][same], order[1:][same]
    quads = np.column_stack([ends[first, 0], apex[second], ends[first, 1], apex[first]])
    return quads, np.sort(np.column_stack([first // 3, second // 3]), axis=1)


def halved(points: np.ndarray, cells: np.ndarray, loops) -> tuple[np.ndarray, np.ndarray]:
    """Every cell cut in quadrilaterals from its centre to the middles of its sides.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Every other point of the loops first.
    cells : ndarray of int, shape (m, 4)
        Triangles repeat a corner.
    loops : sequence of ndarray, shape (2 k, 2)
        The points between are the middles of the sides at the boundary.

    Returns
    -------
    points : ndarray, shape (n, 2)
        Those of the loops first, in order.
    cells : ndarray of int, shape (m, 4)
    """
    rim = np.concatenate(loops)
    start = np.cumsum([0, *(len(loop) for loop in loops)])
    middles = {}
    for first, end in pairwise(start):
        corner = np.append(np.arange(first, end, 2), first)
        for a, middle, b in zip(corner[:-1], range(first + 1, end, 2), corner[1:], strict=True):
            middles[frozenset((int(a), int(b)))] = middle
    inner = points[len(rim) // 2 :]
    renumbered = np.concatenate([np.arange(0, len(rim), 2), len(rim) + np.arange(len(inner))])
    found, quads = [*rim, *inner], []
    for cell in renumbered[cells].tolist():
        corners = list(dict.fromkeys(cell))
        between = []
        for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
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
