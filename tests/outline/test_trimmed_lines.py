"""Lines between two materials that meet holes: in their vertices, and along their sides."""

import numpy as np
import pytest

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.arcs import Circle
from seal_mdao.seals.outline.contours import Contour, Line, Outline
from seal_mdao.seals.outline.parting import check_uncrossed, trimmed


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


@pytest.mark.parametrize("line", [
    # beside the hole, with a vertex at its corner and on its side, and at the outside
    [(-6.0, 6.0), (-3.0, 5.0), (6.0, 6.0)], [(-6.0, 6.0), (0.0, 5.0), (6.0, 6.0)],
    [(-6.0, 6.0), (0.0, 5.0004), (6.0, 6.0)], [(-6.0, 6.0), (0.0, 8.0), (6.0, 6.0)],
    # the same beside a part of another line that crosses the hole
    [(-6.0, 4.0), (3.0, 4.0), (4.5, 8.0), (6.0, 4.0)],
])  # fmt: skip
def test_a_line_that_touches_the_boundary_is_refused(line):
    """The mesher cannot fill the wedges there."""
    with pytest.raises(
        GeometryError, match=r"^touches the boundary at .* without crossing it; let it"
    ):
        trimmed(Outline(OUTSIDE, (HOLE,)), line)


def test_a_line_along_a_tangent_of_a_hole_is_refused():
    hole = Contour((Circle((0.0, 3.0), 2.0, "cavity"),))
    for height in (5.0, 5.0008):
        with pytest.raises(GeometryError, match=r"touches the boundary at \(\S+, 5\)"):
            trimmed(Outline(OUTSIDE, (hole,)), [(-6.0, height), (6.0, height)])
    assert len(trimmed(Outline(OUTSIDE, (hole,)), [(-6.0, 5.01), (6.0, 5.01)])[1]) == 1


@pytest.mark.parametrize("other", [
    [(-6.0, 1.0), (0.0, 2.0), (6.0, 3.0)], [(6.0, 3.0), (-6.0, 1.0)],
    [(-6.0, 2.0), (-4.0, 1.0 + 1.0 / 3.0 + 5e-4), (0.0, 2.0), (6.0, 4.0)],
])  # fmt: skip
def test_two_lines_that_coincide_are_refused(other):
    """Such as those of two regions beside each other; the mesher cannot fill the space between them."""
    line = [(-6.0, 1.0), (6.0, 3.0)]
    with pytest.raises(
        GeometryError, match=r"the lines 1 and 2 .* coincide near .*; give a line betw"
    ):
        check_uncrossed([line, other])
    # a common end is no coincidence
    check_uncrossed([line, [(-6.0, 1.0), (6.0, 3.4)]])


def test_a_line_that_crosses_itself_is_refused():
    line = [(-6.0, 1.0), (4.0, 1.0), (4.0, 6.0), (0.0, 6.0), (0.0, 0.0)]
    with pytest.raises(GeometryError, match="between two materials crosses itself"):
        trimmed(Outline(OUTSIDE), line)
