"""Chain loose segments in any order and direction into closed loops."""

from collections import defaultdict

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.segments import pair


def loops(segments, names, join: float) -> list[tuple]:
    """Chain segments head to tail into closed loops.

    Parameters
    ----------
    segments : sequence of Segment
    names : sequence of str
        Names of the segments in messages.
    join : float
        Largest distance of ends that are joined, mm.

    Raises
    ------
    GeometryError
        For an end that meets no other end, or several.
    """
    # ends 2 i and 2 i + 1 are start and end of segment i
    ends = np.array([end for segment in segments for end in (segment.start, segment.end)])
    node = _nodes(ends, join)
    at = defaultdict(list)
    for number, joint in enumerate(node):
        at[joint].append(number)
    _check_nodes(ends, at, names)
    found, left = [], set(range(len(segments)))
    while left:
        here = min(left)  # the order of the file
        first, forward, chain = node[2 * here], True, []
        while here in left:
            left.remove(here)
            chain.append(segments[here] if forward else segments[here].reversed())
            last = 2 * here + int(forward)
            if node[last] == first:
                break
            # every node has two ends: leave it by the other one, forward if that is a start
            following = next(end for end in at[node[last]] if end != last)
            here, forward = following // 2, following % 2 == 0
        found.append(tuple(chain))
    return found


def _nodes(ends, join):
    """Number the ends (2 n, 2) so that joined ones have equal numbers."""
    pairs = cKDTree(ends).query_pairs(join, output_type="ndarray")
    ones = np.ones(len(pairs))
    graph = coo_array((ones, (pairs[:, 0], pairs[:, 1])), shape=(len(ends), len(ends)))
    return connected_components(graph, directed=False)[1]


def _check_nodes(ends, at, names) -> None:
    for numbers in at.values():
        if len(numbers) > 2:
            which = " and ".join(dict.fromkeys(names[number // 2] for number in numbers))
            raise GeometryError(
                f"{len(numbers)} ends meet at {pair(ends[numbers[0]])}: {which}; a contour has two "
                "(is a piece drawn twice?)"
            )
    loose = [numbers[0] for numbers in at.values() if len(numbers) == 1]
    if loose:
        first = loose[0]
        nearest, others = "", [number for number in loose if number != first]
        if others:
            away = np.hypot(*(ends[others] - ends[first]).T)
            other = others[int(away.argmin())]
            nearest = (
                f"; the nearest open end is that of {names[other // 2]} at {pair(ends[other])}, "
                f"{away.min():.3g} mm away"
            )
        raise GeometryError(
            f"the contour is open: {names[first // 2]} ends at {pair(ends[first])} and nothing goes "
            f"on from there{nearest}"
        )
