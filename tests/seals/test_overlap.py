"""Depth of the overlap where a deformed boundary crosses itself."""

import numpy as np
import pytest

from seal_mdao.seals.overlap import crossings, overlap_depths


def boundary(*loops, parts=7):
    """Points and sides of closed loops of corners, each side in equal parts."""
    points, sides = [], []
    for corners in loops:
        corners = np.array(corners, float)
        share = np.arange(parts)[:, None] / parts
        after = np.roll(corners, -1, axis=0)
        loop = np.concatenate([a + share * (b - a) for a, b in zip(corners, after, strict=True)])
        at = sum(map(len, points)) + np.arange(len(loop))
        points.append(loop)
        sides.append(np.column_stack([at, np.roll(at, -1)]))
    return np.concatenate(points), np.concatenate(sides)


def deepest(x, segments):
    pairs, _ = crossings(x, segments)
    return overlap_depths(x, segments, pairs)


@pytest.mark.parametrize("depth", [1e-4, 0.013, 0.1, 0.37])
def test_overlap_of_two_walls(depth):
    """The old bound is that of single sides, and any number below the overlap."""
    one = [(0, 0), (1, 0), (1, 1), (0, 1)]
    other = [(1 - depth, -0.52), (2, -0.52), (2, 1.49), (1 - depth, 1.49)]
    x, segments = boundary(one, other)
    assert deepest(x, segments) == pytest.approx([depth, depth], rel=1e-3)
    bound = crossings(x, segments)[1]
    assert (bound <= depth * (1.0 + 1e-9)).all()


def test_walls_of_a_hole_that_have_passed_each_other():
    """A flat hole whose lower wall lies 0.2 above the upper one between x = 3 and 7."""
    outer = [(0, 0), (10, 0), (10, 4), (0, 4)]
    hole = [(1, 2.5), (3, 2), (7, 2), (9, 2.5), (9, 1.5), (7, 2.2), (3, 2.2), (1, 1.5)]
    depths = deepest(*boundary(outer, hole))
    assert depths == pytest.approx([0.2, 0.2], rel=1e-3)


def test_every_crossing_has_the_overlap_beside_it():
    one = [(0, 0), (1, 0), (1, 1), (0, 1)]
    right, above = [(0.9, 0.2), (2, 0.2), (2, 0.7), (0.9, 0.7)], [(0.2, 0.7), (0.6, 0.7), (0.4, 2)]
    x, segments = boundary(one, right, above)
    depths = deepest(x, segments)
    assert sorted(np.round(depths, 2).tolist()) == [0.1, 0.1, 0.3, 0.3]


def test_a_loop_that_is_turned_over():
    """A bow tie winds around one half in the wrong sense."""
    x, segments = boundary([(0, 0), (1, 1), (1, 0), (0, 1)], parts=5)
    half = 2.0 * 0.5 * np.tan(np.pi / 8.0)
    assert deepest(x, segments) == pytest.approx([half], rel=1e-2)
