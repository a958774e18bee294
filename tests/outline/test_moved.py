"""The section of a design, drawn anew where it has moved."""

from dataclasses import replace

import numpy as np
import pytest
from sample_sections import bulb, circle, lines, mixed

from seal_mdao.seals.outline.contours import Circle, Contour, Line, Outline, Spline, sampled
from seal_mdao.seals.outline.dxf import read_dxf, write_dxf
from seal_mdao.seals.outline.moved import shifted_outline


def grown(outline, spacing, edges, offset):
    """Points moved outwards along the normals of some edges, nothing where these end."""
    boundaries = sampled(outline, spacing)
    moved = []
    for boundary in boundaries:
        normal = np.column_stack([boundary.tangent[:, 1, 1], -boundary.tangent[:, 1, 0]])
        own = np.isin(boundary.edge, edges) & (np.roll(boundary.edge, 1) == boundary.edge)
        moved.append(boundary.points + offset * own[:, None] * normal)
    return boundaries, moved


def test_what_has_not_moved_stays_what_it_is():
    outline = mixed()
    boundaries = sampled(outline, 0.5)
    assert shifted_outline(outline, boundaries, [b.points for b in boundaries]) == outline
    _, points = grown(outline, 0.5, ["top"], 0.1)
    other = shifted_outline(outline, boundaries, points)
    kinds = [type(segment) for segment in other.outer.segments]
    assert kinds == [type(segment) for segment in outline.outer.segments]
    assert other.outer.segments[:2] == outline.outer.segments[:2]
    assert other.holes == outline.holes


def test_a_circle_that_grows_is_the_larger_circle():
    outline = bulb(circle((0.0, 7.0), 3.0))
    (hole,) = shifted_outline(outline, *grown(outline, 0.8, ["cavity"], -0.2)).holes
    (larger,) = hole.segments
    assert isinstance(larger, Circle)
    assert larger.clockwise
    np.testing.assert_allclose([*larger.centre, larger.radius], [0.0, 7.0, 3.2], atol=1e-13)


def test_arcs_and_lines_remain_only_where_all_points_allow_it():
    """One moved point of many makes a spline."""
    outline = bulb(circle((0.0, 7.0), 3.0))
    boundaries, points = grown(outline, 0.8, ["cavity"], -0.2)
    points[1][3] *= 1.0 + 1e-6
    points[0] = points[0] * (1.1, 1.1)
    found = shifted_outline(outline, boundaries, points)
    assert isinstance(found.holes[0].segments[0], Spline)
    assert [type(s) for s in found.outer.segments] == [type(s) for s in outline.outer.segments]
    assert found.outer.area == pytest.approx(1.21 * outline.outer.area, rel=1e-12)


def test_a_circle_that_becomes_an_ellipse_tends_to_it():
    """Fourth order of a periodic spline: sixteen times less with twice the points."""
    errors = []
    for spacing in (0.8, 0.4):
        outline = bulb(circle((0.0, 7.0), 3.0))
        boundaries, points = grown(outline, spacing, ["cavity"], 0.0)
        points[1] = (0.0, 7.0) + (points[1] - (0.0, 7.0)) * (1.1, 0.9)
        (hole,) = shifted_outline(outline, boundaries, points).holes
        (spline,) = hole.segments
        assert isinstance(spline, Spline)
        assert np.abs(spline.tangents([0.0]) - spline.tangents([1.0])).max() < 1e-13
        errors.append(abs(-hole.area - np.pi * 3.3 * 2.7))
    assert errors[0] / errors[1] > 12.0
    assert errors[1] < 1e-3


def test_the_new_boundary_passes_through_the_moved_points():
    outline = bulb()
    boundaries, points = grown(outline, 0.9, ["seal"], 0.3)
    found = shifted_outline(outline, boundaries, points)
    (seal,) = found.edge("seal")
    own = boundaries[0].edge == "seal"
    at = seal.curve(boundaries[0].arc_length[own])
    assert np.abs(at - points[0][own]).max() < 1e-13
    assert isinstance(found.edge("base")[0], Line)


@pytest.mark.parametrize("names", ["one", "two"])
def test_corners_stay_corners(names):
    """A square of one edge, all of it moved, and one of two edges."""
    square = lines([(0.0, 0.0), (10.0, 0.0), (10.0, 10.0), (0.0, 10.0)])
    if names == "two":
        square = Contour([
            replace(s, edge=name) for s, name in zip(square.segments, "aabb", strict=True)
        ])  # fmt: skip
    outline = Outline(square)
    boundaries = sampled(outline, 2.5)
    points = [1.1 * boundaries[0].points]
    found = shifted_outline(outline, boundaries, points)
    assert len(found.outer.segments) == 4
    assert found.area == pytest.approx(121.0, rel=1e-13)


def test_a_drop_keeps_its_corner():
    drop = [(0.0, 0.0), (4.0, 3.0), (3.0, 7.0), (0.0, 8.0), (-3.0, 7.0), (-4.0, 3.0), (0.0, 0.0)]
    outline = Outline(Contour([Spline(drop, "a", slopes=((1.0, 0.2), (1.0, -0.2)))]))
    boundaries = sampled(outline, 0.25)
    found = shifted_outline(outline, boundaries, [1.2 * boundaries[0].points])
    (seal,) = found.outer.segments
    for s in (0.0, 1.0):
        there = outline.outer.segments[0].tangents([s])
        # not-a-knot tangents err by the third power of the spacing
        assert np.abs(seal.tangents([s]) - there).max() < 0.02
    assert found.area == pytest.approx(1.44 * outline.area, rel=1e-4)


def test_a_moved_section_goes_into_a_drawing_and_back(tmp_path):
    outline = mixed()
    boundaries, points = grown(outline, 0.5, ["top", "oval", "cavity"], 0.1)
    found = shifted_outline(outline, boundaries, points)
    again = read_dxf(write_dxf(found, tmp_path / "moved.dxf"))
    s = np.linspace(0.0, 1.0, 101)
    for name in outline.edge_names:
        for one, other in zip(found.edge(name), again.edge(name), strict=True):
            assert type(one) is type(other)
            assert np.abs(one.points(s) - other.points(s)).max() < 1e-9
    assert [type(p) for p in again.edge("cavity")] == [Circle]


def test_a_circle_whose_first_point_moves_to_its_left_becomes_a_spline():
    outline = Outline(circle((0.0, 0.0), 5.0, "seal"), (circle((0.0, 0.0), 2.0),))
    boundaries = sampled(outline, 0.5)
    new = shifted_outline(outline, boundaries, [boundaries[0].points, -boundaries[1].points])
    (segment,) = new.holes[0].segments
    assert isinstance(segment, Spline)
    assert new.area == pytest.approx(outline.area, rel=1e-4)
