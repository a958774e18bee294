"""Points, tangents, lengths and areas of segments."""

import numpy as np
import pytest
from sample_sections import bulb, circle, lines, mixed
from scipy.special import ellipe

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.contours import Arc, Circle, Line, Spline, sampled

S = np.linspace(0.0, 1.0, 13)
WAVE = [(0.0, 0.0), (1.0, 2.0), (4.0, 1.0), (5.0, 3.0), (8.0, 2.5)]
SEGMENTS = [
    Line((1.0, 2.0), (4.0, -2.0), "a"),
    Arc.through((4.0, 0.0), (0.0, 14.0), (-4.0, 0.0), "a"),
    Arc.through((-4.0, 0.0), (0.0, 3.0), (4.0, 0.0), "a"),
    Circle((1.0, 2.0), 3.0, "a"),
    Circle((1.0, 2.0), 3.0, "a", clockwise=True),
    Spline(WAVE, "a"),
    Spline(WAVE, "a", slopes=((0.0, 1.0), (1.0, -2.0))),
    Spline([*WAVE, (4.0, -3.0), (0.0, 0.0)], "a"),
]


@pytest.mark.parametrize("segment", SEGMENTS)
def test_points_go_in_proportion_to_arc_length_and_tangents_belong_to_them(segment):
    """Central differences of step h err by h^2/6 of the third derivative, at most of order one here,
    and by rounding over h; the panels' Gauss sums by less."""
    h = 1e-5
    inside = S[1:-1]
    slope = (segment.points(inside + h) - segment.points(inside - h)) / (2.0 * h)
    assert np.abs(np.linalg.norm(slope, axis=1) - segment.length).max() < 1e-6 * segment.length
    assert np.abs(slope / segment.length - segment.tangents(inside)).max() < 1e-6
    turned = (segment.tangents(inside + h) - segment.tangents(inside - h)) / (2.0 * h)
    t = segment.tangents(inside)
    curvature = (t[:, 0] * turned[:, 1] - t[:, 1] * turned[:, 0]) / segment.length
    assert np.abs(curvature - segment.curvature(inside)).max() < 1e-4
    assert np.abs(np.einsum("ki,ki->k", t, segment.normals(inside))).max() < 1e-15


@pytest.mark.parametrize("segment", SEGMENTS)
def test_walked_back_it_is_the_same_curve(segment):
    back = segment.reversed()
    size = np.abs(segment.points(S)).max()
    assert np.abs(back.points(S) - segment.points(1.0 - S)).max() < 1e-13 * size
    assert np.abs(back.tangents(S) + segment.tangents(1.0 - S)).max() < 1e-13
    assert back.length == pytest.approx(segment.length, rel=1e-14)
    assert back.area == pytest.approx(-segment.area, rel=1e-13)
    assert back.edge == "a"


@pytest.mark.parametrize("segment", SEGMENTS)
def test_chords_stay_within_the_sagitta(segment):
    shares = segment.chords(1e-3)
    ends = segment.points(shares)
    middles = segment.points(0.5 * (shares[1:] + shares[:-1]))
    t = np.diff(ends, axis=0) / np.linalg.norm(np.diff(ends, axis=0), axis=1)[:, None]
    away = middles - ends[:-1]
    # curvature is looked for at sixteen places a side, so the sharpest one may be missed a little
    assert np.abs(t[:, 0] * away[:, 1] - t[:, 1] * away[:, 0]).max() < 1.1e-3


def test_an_arc_passes_its_three_points():
    points = [(4.0, 0.0), (0.0, 14.0), (-4.0, 0.0)]
    arc = Arc.through(*points)
    assert np.abs(arc.start - points[0]).max() < 1e-14
    assert np.abs(arc.end - points[2]).max() < 1e-14
    assert np.hypot(*np.subtract(points[1], arc.centre)) == pytest.approx(arc.radius, rel=1e-15)
    assert arc.sweep > np.pi  # counter-clockwise, the long way
    assert Arc.through(*points[::-1]).sweep == pytest.approx(-arc.sweep)


def test_a_bulge_is_the_tangent_of_a_quarter_of_the_sweep():
    for bulge in (-1.7, -1.0, -0.2, 0.3, 1.0, 2.5):
        arc = Arc.bulged((1.0, 2.0), (4.0, 3.0), bulge)
        assert np.abs(arc.start - (1.0, 2.0)).max() < 1e-14
        assert np.abs(arc.end - (4.0, 3.0)).max() < 1e-14
        assert np.tan(arc.sweep / 4.0) == pytest.approx(bulge, rel=1e-14)


def test_a_spline_passes_its_points_and_is_periodic_where_it_closes():
    spline = SEGMENTS[-1]
    knots = np.array(spline.parameter)
    assert np.abs(spline.curve(knots) - spline.through).max() < 1e-14
    assert np.abs(np.diff(spline.curve(knots[[0, -1]], 1), axis=0)).max() < 1e-14
    assert np.abs(np.diff(spline.curve(knots[[0, -1]], 2), axis=0)).max() < 1e-13


def test_length_and_area_of_a_spline_tend_to_those_of_the_ellipse():
    """Fourth order: sixteen times less with twice the points."""
    errors = []
    for n in (48, 96):
        phi = 2.0 * np.pi * np.arange(n) / n
        points = np.column_stack([3.0 * np.cos(phi), 2.0 * np.sin(phi)])
        spline = Spline([*points, points[0]], "a")
        errors.append((spline.length - 12.0 * ellipe(1.0 - 4.0 / 9.0), spline.area - 6.0 * np.pi))
    ratio = np.abs(np.array(errors[0]) / np.array(errors[1]))
    assert (ratio > 12.0).all()
    assert np.abs(errors[1]).max() < 1e-6


def test_area_of_a_section_is_exact():
    arc = bulb().outer.segments[1]
    half = np.arcsin(4.0 / arc.radius)
    segment = arc.radius**2 * (np.pi - half + 0.5 * np.sin(2.0 * half))
    assert bulb().area == pytest.approx(segment, rel=1e-14)
    assert bulb(circle((0.0, 7.0), 4.5)).area == pytest.approx(segment - np.pi * 4.5**2, rel=1e-14)
    assert lines([(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)]).area == 6.0


def test_holes_are_turned_round_and_contours_begin_with_an_edge():
    outline = bulb(circle((0.0, 7.0), 4.5), circle((0.0, 12.8), 0.4, "second", clockwise=True))
    assert [hole.area < 0.0 for hole in outline.holes] == [True, True]
    assert outline.edge_names == ("base", "seal", "cavity", "second")
    turned = bulb().outer.segments
    half = [Line((0.0, 0.0), (4.0, 0.0), "base"), turned[1], Line((-4.0, 0.0), (0.0, 0.0), "base")]
    walked = type(outline)(type(outline.outer)(half)).outer
    assert [s.edge for s in walked.segments] == ["base", "base", "seal"]


@pytest.mark.parametrize("spacing", [0.9, lambda x: 0.3 + 0.05 * np.abs(x[:, 0])])
def test_sampled_points_are_on_the_boundary_at_the_spacing(spacing):
    outline = mixed()
    boundaries = sampled(outline, spacing)
    assert len(boundaries) == 3
    for contour, boundary in zip(outline.contours, boundaries, strict=True):
        ends = np.array([segment.start for segment in contour.segments])
        assert np.array_equal(boundary.points[boundary.corner], ends)
        assert boundary.length == pytest.approx(contour.length, rel=1e-14)
        following = np.append(boundary.arc_length[1:], boundary.length)
        steps = following - boundary.arc_length
        wanted = spacing(boundary.points) if callable(spacing) else spacing
        assert (steps <= wanted * (1.1 if callable(spacing) else 1.0 + 1e-12)).all()
        for number, segment in enumerate(contour.segments):
            own = boundary.segment == number
            assert set(boundary.edge[own]) == {segment.edge}
            first = boundary.arc_length[own][0]
            s = (boundary.arc_length[own] - first) / segment.length
            assert np.abs(segment.points(s) - boundary.points[own]).max() < 1e-10
            assert np.abs(segment.tangents(s) - boundary.tangent[own, 1]).max() < 1e-10
    corner = boundaries[0].tangent[0]
    assert np.abs(corner - [(0.0, -1.0), (1.0, 0.0)]).max() < 1e-15  # from the side to the base


@pytest.mark.parametrize("spacing", [0.9, lambda x: np.full(len(x), 0.9)])
def test_named_edges_are_sampled_more_finely(spacing):
    """The sides of a circle of radius 4.5 mm are at most 0.2 mm long, the others as without it."""
    outline = bulb(circle((0.0, 7.0), 4.5))
    plain, fine = sampled(outline, spacing), sampled(outline, spacing, {"cavity": 0.2})
    assert len(fine[1].points) == np.ceil(2.0 * np.pi * 4.5 / 0.2)
    np.testing.assert_array_equal(fine[0].points, plain[0].points)
    # no coarser than the spacing
    _, same = sampled(outline, spacing, {"cavity": 2.0})
    np.testing.assert_array_equal(same.points, plain[1].points)


def test_a_coarse_spacing_still_follows_the_curve():
    assert len(sampled(bulb(circle((0.0, 7.0), 0.5)), 5.0)[1].points) == 8


@pytest.mark.parametrize("spacing", [0.0, -1.0, np.nan, lambda x: np.zeros(len(x))])
def test_a_spacing_that_is_not_positive_is_refused(spacing):
    with pytest.raises(ValueError, match="spacing must be a positive number"):
        sampled(bulb(), spacing)


def test_an_unknown_edge_is_named_with_those_there_are():
    with pytest.raises(GeometryError, match=r"no edge 'top'; its edges are base, seal$"):
        bulb().edge("top")
