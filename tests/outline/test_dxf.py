"""Drawings in and out."""

import builtins

import numpy as np
import pytest
from drawings import Drawing
from sample_sections import bulb, circle, mixed
from scipy.interpolate import BSpline as Basis

from seal_mdao.seals.outline.contours import Contour, Line, Outline, Spline
from seal_mdao.seals.outline.dxf import add_segment, read_dxf, write_dxf

S = np.linspace(0.0, 1.0, 41)


def largest_distance(one, other):
    """Between points of equal arc length of equal segments of two sections, mm."""
    assert [len(c.segments) for c in one.contours] == [len(c.segments) for c in other.contours]
    pairs = [
        (a, b)
        for c, d in zip(one.contours, other.contours, strict=True)
        for a, b in zip(c.segments, d.segments, strict=True)
    ]
    assert all(type(a) is type(b) and a.edge == b.edge for a, b in pairs)
    return max(np.abs(a.points(S) - b.points(S)).max() for a, b in pairs)


@pytest.mark.parametrize("outline", [mixed(), bulb(), bulb(circle((0.3, 7.0), 1.0 / 3.0))])
def test_round_trip(tmp_path, outline):
    """Sections of 20 mm; rounding of the arc length's inversion is some 1e-12."""
    once = read_dxf(write_dxf(outline, tmp_path / "one.dxf"))
    twice = read_dxf(write_dxf(once, tmp_path / "two.dxf"))
    assert largest_distance(outline, once) < 1e-9
    assert largest_distance(outline, twice) < 1e-9
    assert twice.edge_names == outline.edge_names
    assert twice.area == pytest.approx(outline.area, rel=1e-12)


@pytest.mark.parametrize("method", ["add_lwpolyline", "add_polyline2d"])
@pytest.mark.parametrize("off", [0.0, 4e-4])
def test_a_closed_polyline_may_repeat_its_first_vertex(tmp_path, method, off):
    """As some programs write it; half a disc of an arc (bulge 1) and a line."""
    corners = [(0.0, 0.0, 0.0), (8.0, 0.0, 1.0), (0.0, off, 0.0)]
    drawing = Drawing(tmp_path)
    add, form = getattr(drawing.model, method), {"format": "xyb"}
    add(corners, **form, close=True, dxfattribs={"layer": "seal"})
    outer = read_dxf(drawing.saved()).outer
    assert len(outer.segments) == 2
    assert outer.area == pytest.approx(8.0 * np.pi, rel=1e-12)


def test_pieces_in_any_order_and_direction(tmp_path):
    outline, drawing = mixed(), Drawing(tmp_path)
    loose = [s for contour in outline.contours for s in contour.segments]
    for number in (4, 2, 5, 0, 3, 1):
        segment = loose[number] if number % 2 else loose[number].reversed()
        add_segment(drawing.model, segment)
    found = read_dxf(drawing.saved())
    assert set(found.edge_names) == set(outline.edge_names)
    assert found.outer.area == pytest.approx(outline.outer.area, rel=1e-12)
    assert found.area == pytest.approx(outline.area, rel=1e-12)
    for name in outline.edge_names:
        (there,), (here,) = outline.edge(name), found.edge(name)
        assert np.abs(here.start - there.start).max() < 1e-9  # walked the same way
        assert here.length == pytest.approx(there.length, rel=1e-12)


@pytest.mark.parametrize(("code", "name", "scale"), [
    (1, "inch", 25.4), (2, "foot", 304.8), (4, "mm", 1.0), (5, "cm", 10.0), (6, "m", 1000.0),
    (14, "dm", 100.0),
])  # fmt: skip
def test_units_become_millimetres(tmp_path, code, name, scale):
    assert read_dxf(Drawing(tmp_path, code).box().saved()).area == pytest.approx(100 * scale**2)
    without = Drawing(tmp_path, None).box().saved()
    assert read_dxf(without, units=name).area == pytest.approx(100 * scale**2)
    assert read_dxf(Drawing(tmp_path, code).box().saved(), units=name).area > 0.0


def test_polylines_with_bulges(tmp_path):
    """A stadium, its ends half circles, and a quarter circle walked clockwise."""
    drawing = Drawing(tmp_path)
    stadium = [(0, 0, 0.0), (10, 0, 1.0), (10, 4, 0.0), (0, 4, 1.0)]
    drawing.model.add_lwpolyline(stadium, format="xyb", close=True, dxfattribs={"layer": "seal"})
    quarter = [(2, 1, 0.0), (2, 2, 0.0), (3, 2, -np.tan(np.pi / 8)), (2, 1, 0.0)]
    drawing.model.add_lwpolyline(quarter, format="xyb", dxfattribs={"layer": "hole"})
    outline = read_dxf(drawing.saved())
    assert outline.outer.area == pytest.approx(40.0 + 4.0 * np.pi, rel=1e-14)
    (hole,) = outline.holes
    assert hole.area == pytest.approx(-np.pi / 4, rel=1e-13)


def test_an_arc_seen_from_below_is_mirrored(tmp_path):
    """Extrusion (0, 0, -1): x to the left."""
    drawing = Drawing(tmp_path)
    drawing.model.add_arc((-5, 0), 5, 0, 180, dxfattribs={"extrusion": (0, 0, -1), "layer": "a"})
    drawing.model.add_line((0, 0), (10, 0), {"layer": "b"})
    assert read_dxf(drawing.saved()).area == pytest.approx(12.5 * np.pi, rel=1e-14)


def test_what_is_not_shown_is_passed_over(tmp_path):
    drawing = Drawing(tmp_path).box()
    drawing.document.layers.add("sizes").off()
    drawing.document.layers.add("frame").freeze()
    drawing.model.add_text("R 4", dxfattribs={"layer": "sizes"})
    drawing.model.add_line((0, 0), (3, 3), {"layer": "frame"})
    assert read_dxf(drawing.saved()).area == 100.0


def test_a_frozen_layer_hides_the_complete_block(tmp_path):
    """As in CAD programs; a layer that is off hides only what is on it."""
    drawing = Drawing(tmp_path).box()
    drawing.document.blocks.new("VARIANT").add_circle((5, 5), 1.0, {"layer": "second"})
    drawing.model.add_blockref("VARIANT", (0, 0), {"layer": "other"})
    layer = drawing.document.layers.add("other")
    layer.freeze()
    assert read_dxf(drawing.saved()).area == 100.0
    layer.thaw()
    layer.off()
    assert read_dxf(drawing.saved()).area == pytest.approx(100.0 - np.pi, rel=1e-12)


def test_hidden_entities_are_passed_over(tmp_path):
    drawing = Drawing(tmp_path).box()
    drawing.model.add_circle((5, 5), 1.0, {"layer": "second", "invisible": 1})
    assert read_dxf(drawing.saved()).area == 100.0


def spline_section(tmp_path, control, degree, knots, weights=()):
    """A spline from (0, 0) to (10, 0) above a line."""
    drawing = Drawing(tmp_path)
    entity = drawing.model.add_spline(degree=degree, dxfattribs={"layer": "top"})
    entity.control_points, entity.knots, entity.weights = control, knots, weights
    drawing.model.add_line((0, 0), (10, 0), {"layer": "base"})
    return read_dxf(drawing.saved())


def away(outline, points):
    """Largest distance of points (k, 2) from fine polygons along the edge "top"."""
    import shapely

    lines = shapely.MultiLineString(
        [s.points(np.linspace(0, 1, 4001)) for s in outline.edge("top")]
    )
    return shapely.distance(shapely.points(points), lines).max()


CONTROL = [(0, 0), (1, 4), (3, 1), (5, 5), (7, 6), (9, 3), (10, 0)]
CUBIC = [0, 0, 0, 0, 1, 2, 3.5, 5, 5, 5, 5]


def test_cubic_b_splines_are_taken_over_exactly(tmp_path):
    outline = spline_section(tmp_path, CONTROL, 3, CUBIC)
    (top,) = outline.edge("top")
    assert len(top.through) == 5
    curve = Basis(CUBIC, np.array(CONTROL, float), 3)
    u = np.linspace(0.0, 5.0, 50)
    backwards = np.abs(top.start - curve(0.0)).max() > 1.0
    assert np.abs(top.curve(5.0 - u if backwards else u) - curve(u)).max() < 1e-13


@pytest.mark.parametrize(("degree", "knots", "pieces"), [
    (3, [0, 0, 0, 0, 1, 1, 2, 3, 3, 3, 3], 2),
    (3, [0, 0, 0, 0, 2, 2, 2, 3, 3, 3, 3], 2),
    (2, [0, 0, 0, 1, 2, 3, 4, 5, 5, 5], 5),
    (1, [0, 0, 1, 2, 3, 4, 5, 6, 6], 6),
    (5, [0, 0, 0, 0, 0, 0, 1, 2, 2, 2, 2, 2, 2], 1),
])  # fmt: skip
def test_other_degrees_and_repeated_knots(tmp_path, degree, knots, pieces):
    """Exact up to degree three; points of the fine polygons are 1e-6 off by their sagitta."""
    outline = spline_section(tmp_path, CONTROL, degree, knots)
    assert len(outline.edge("top")) == pieces
    assert all(isinstance(s, Line if degree == 1 else Spline) for s in outline.edge("top"))
    curve = Basis(knots, np.array(CONTROL, float), degree)
    assert away(outline, curve(np.linspace(0.0, knots[-1], 101))) < 5e-6


def test_a_rational_spline_is_followed_to_the_stated_tolerance(tmp_path):
    """A half circle as two rational parabolas."""
    r = np.sqrt(0.5)
    control = [(0, 0), (0, 5), (5, 5), (10, 5), (10, 0)]
    outline = spline_section(tmp_path, control, 2, [0, 0, 0, 1, 1, 2, 2, 2], [1, r, 1, r, 1])
    top = outline.edge("top")
    assert len(top) == 2
    points = np.concatenate([segment.points(S) for segment in top])
    assert np.abs(np.hypot(points[:, 0] - 5.0, points[:, 1]) - 5.0).max() < 1e-6
    assert sum(s.length for s in top) == pytest.approx(5.0 * np.pi, abs=1e-5)


def test_a_closed_spline_is_a_contour(tmp_path):
    drawing = Drawing(tmp_path)
    control = [(0, 0), (6, -2), (9, 5), (4, 8), (-2, 5)]
    entity = drawing.model.add_spline(dxfattribs={"layer": "seal"})
    entity.control_points, entity.knots = control + control[:3], range(12)
    entity.closed = True
    outline = read_dxf(drawing.saved())
    (seal,) = outline.edge("seal")
    assert np.abs(seal.tangents([0.0]) - seal.tangents([1.0])).max() < 1e-14
    again = read_dxf(write_dxf(outline, tmp_path / "again.dxf"))
    assert largest_distance(outline, again) < 1e-9


def test_a_spline_of_fit_points_passes_them(tmp_path):
    drawing = Drawing(tmp_path)
    points = np.array([(0, 0), (2, 3), (6, 4), (10, 0)], float)
    drawing.model.add_spline(points, dxfattribs={"layer": "top"})
    drawing.model.add_line((0, 0), (10, 0), {"layer": "base"})
    assert away(read_dxf(drawing.saved()), points) < 5e-6


def test_small_gaps_are_closed(tmp_path):
    drawing = Drawing(tmp_path)
    corners = [(0, 0), (10, 0), (10, 10), (0, 10)]
    for a, b in zip(corners, [*corners[1:], corners[0]], strict=True):
        drawing.model.add_line(a, np.add(b, (0.0, 4e-4)), {"layer": "seal"})
    assert read_dxf(drawing.saved()).area == pytest.approx(100.0, abs=0.01)


def test_without_ezdxf_one_line_names_the_extra(tmp_path, monkeypatch):
    real = builtins.__import__

    def without(name, *rest):
        if name.split(".")[0] == "ezdxf":
            raise ImportError(name)
        return real(name, *rest)

    monkeypatch.setattr("seal_mdao.seals.outline.dxf.import_module", without)
    for action in (lambda: read_dxf(tmp_path / "a.dxf"), lambda: write_dxf(bulb(), "a.dxf")):
        with pytest.raises(ImportError, match=r"not installed: pip install seal_mdao\[dxf\]$"):
            action()


def test_reading_a_hole_first_finds_the_outer_contour(tmp_path):
    outline = read_dxf(Drawing(tmp_path).box(2.0, "hole", (4.0, 4.0)).box().saved())
    assert isinstance(outline, Outline)
    assert isinstance(outline.holes[0], Contour)
    assert outline.edge_names == ("seal", "hole")


def test_contours_outside_and_in_holes_are_further_bodies(tmp_path):
    drawing = Drawing(tmp_path).box().box(6.0, "hole", (2.0, 2.0)).box(2.0, "core", (3.0, 3.0))
    outline = read_dxf(drawing.box(4.0, "other", (12.0, 0.0)).box(1.0, "slot", (13.0, 1.0)).saved())
    assert [h.edge_names for h in outline.holes] == [("hole",), ("slot",)]
    assert [o.edge_names for o in outline.others] == [("other",), ("core",)]
    names = [[c.edge_names[0] for c in body] for body in outline.bodies]
    assert names == [["seal", "hole"], ["other", "slot"], ["core"]]
    assert outline.area == pytest.approx(100 - 36 + 16 - 1 + 4, rel=1e-12)
    again = read_dxf(write_dxf(outline, tmp_path / "again.dxf"))
    assert (again.edge_names, again.area) == (outline.edge_names, pytest.approx(outline.area))
