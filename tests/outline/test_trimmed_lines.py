"""Lines between two materials that meet holes: in their vertices, and along their sides."""

import numpy as np
import pytest

from seal_mdao.seals.outline.contours import Contour, Line, Outline
from seal_mdao.seals.outline.parting import trimmed


def loop(points, edge):
    """A contour through points (k, 2)."""
    return Contour(
        tuple(Line(a, b, edge) for a, b in zip(points, [*points[1:], points[0]], strict=True))
    )


OUTSIDE = loop([(-6.0, 0.0), (6.0, 0.0), (6.0, 8.0), (-6.0, 8.0)], "skin")
HOLE = loop([(-3.0, 2.0), (-3.0, 5.0), (3.0, 5.0), (3.0, 2.0)], "cavity")
PARTS = [[(-6.0, 2.0), (-3.0, 2.0)], [(3.0, 2.0), (6.0, 2.0)]]


@pytest.mark.parametrize(
    "between",
    [
        # along the floor of the hole
        [],
        [(-3.0, 2.0), (3.0, 2.0)],
        # through the hole, with vertices on its corners, and nearly on them
        [(-3.0, 2.0), (0.0, 3.0), (3.0, 2.0)],
        [(-3.0 + 4e-4, 2.0), (0.0, 3.0), (3.0 - 4e-4, 2.0)],
        [(-3.0 - 4e-4, 2.0), (0.0, 3.0), (3.0 + 4e-4, 2.0)],
    ],
)
def test_parts_of_a_line_beside_a_hole(between):
    outline, parts = trimmed(Outline(OUTSIDE, (HOLE,)), [(-6.0, 2.0), *between, (6.0, 2.0)])
    assert len(parts) == 2
    for part, expected in zip(parts, PARTS, strict=True):
        # no two points at one place
        assert np.hypot(*np.diff(part, axis=0).T).min() > 1e-3
        np.testing.assert_allclose(part, expected, rtol=0.0, atol=1e-3)
        np.testing.assert_array_equal(part[[0, -1]], expected)
    assert [len(own.segments) for own in (outline.outer, *outline.holes)] == [6, 4]
