"""Drawings as CAD programs export them: annotation, parting lines, blocks, units, old versions."""

import numpy as np
import pytest
from drawings import Drawing

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.chain import SHORTEST
from seal_mdao.seals.outline.contours import JOIN, Circle
from seal_mdao.seals.outline.dxf import boundary_layers, read_drawing, read_dxf, write_dxf

AREA = 12.0 * 8.0 + 0.5 * np.pi * 36.0 - np.pi * 9.0
QUARTER = np.tan(np.pi / 8.0)


def bulb(model, old=False, unit=1.0, gap=0.0):
    """A foot with a bulb: 12 mm wide, a half circle on top, a round cavity, a parting line at y = 2.

    Lines are split and reversed; ``gap`` opens the joints, in mm."""

    def at(*points):
        return [tuple(np.array(point) / unit) for point in points]

    def on(layer):
        return {"layer": layer}

    model.add_line(*at((6, 0), (1, 0)), on("base"))
    model.add_line(*at((-6, gap), (1, gap)), on("base"))
    polyline = model.add_polyline2d if old else model.add_lwpolyline
    way = [
        (*p, b) for p, b in zip(at((6, gap), (6, 8), (-6, 8), (-6, 0)), (0, 1, 0, 0), strict=True)
    ]
    polyline(way, format="xyb", dxfattribs=on("seal"))
    model.add_arc(*at((0, 8)), 3 / unit, 0, 180, dxfattribs=on("cavity"))
    model.add_arc(*at((0, 8)), 3 / unit, 180, 360, dxfattribs=on("cavity"))
    model.add_line(*at((6, 2), (0, 2)), on("split"))
    model.add_line(*at((-6, 2 + gap), (0, 2)), on("split"))


def annotated(drawing):
    """Six entities of annotation on three layers, one of them that of an edge."""
    document, model = drawing.document, drawing.model
    document.layers.add("middle", linetype="CENTER")
    model.add_line((0, -2), (0, 16), {"layer": "middle"})
    model.add_line((-8, 8), (8, 8), {"layer": "seal", "linetype": "CENTER"})
    model.add_text("foot", dxfattribs={"layer": "sizes"}).set_placement((1.0, 1.0))
    model.add_linear_dim((0, -3), (-6, 0), (6, 0), dxfattribs={"layer": "sizes"}).render()
    model.add_point((0, 0), {"layer": "sizes"})
    model.add_text("R 6", dxfattribs={"layer": "seal"})
    return drawing


def check_bulb(found, tolerance=1e-12):
    assert found.outline.area == pytest.approx(AREA, rel=tolerance)
    assert set(found.outline.edge_names) == {"base", "seal", "cavity"}
    (line,) = found.parting
    assert np.sort(line[:, 0]) == pytest.approx([-6.0, 0.0, 6.0], abs=1e-9)
    assert line[:, 1] == pytest.approx([2.0] * 3, abs=2e-3)
    # a joint of the boundary at both ends, bit for bit
    joints = [tuple(s.start) for s in found.outline.outer.segments]
    assert tuple(line[0]) in joints
    assert tuple(line[-1]) in joints


@pytest.mark.parametrize("version", ["R12", "R2000", "R2010", "R2018"])
def test_annotation_is_left_out_in_every_version(tmp_path, version):
    drawing = Drawing(tmp_path, 4, version)
    bulb(drawing.model, old=version == "R12")
    drawing.document.linetypes.add("CENTER", [2.0, 1.25, -0.25, 0.25, -0.25])
    path = annotated(drawing).saved()
    if version == "R12":  # without units
        with pytest.raises(
            GeometryError, match=r"give units in \[section\] \(--units of the command\), one of mm"
        ):
            read_drawing(path, parting=["split"])
    found = read_drawing(path, "mm", ["split"])
    check_bulb(found)
    assert found.left_out == {"middle": 1, "seal": 2, "sizes": 3}
    assert found.notice == (
        "ignored in the drawing: 6 entities on layers 'middle' (1), 'seal' (2), 'sizes' (3)"
    )
    assert found.texts[0] == ("foot", (1.0, 1.0))
    assert boundary_layers(path) == ["base", "seal", "cavity", "split"]


@pytest.mark.parametrize(("code", "unit"), [(1, 25.4), (4, 1.0), (5, 10.0)])
def test_parting_lines_and_texts_have_the_units_of_the_drawing(tmp_path, code, unit):
    drawing = Drawing(tmp_path, code)
    bulb(drawing.model, unit=unit)
    drawing.model.add_mtext("foot", {"layer": "sizes", "insert": (1.0 / unit, 1.0 / unit)})
    found = read_drawing(drawing.saved(), parting=["SPLIT"])
    check_bulb(found, 1e-10)
    assert found.texts[0][1] == pytest.approx((1.0, 1.0))


def test_gaps_of_less_than_a_micrometre(tmp_path):
    drawing = Drawing(tmp_path)
    bulb(drawing.model, gap=0.7e-3)
    check_bulb(read_drawing(drawing.saved(), parting=["split"]), 1e-4)


def test_a_section_in_blocks(tmp_path):
    """Layers of their own in the block; scaled, turned and moved; in another block."""
    drawing = Drawing(tmp_path)
    bulb(drawing.document.blocks.new("BULB"), unit=2.0)
    outer = drawing.document.blocks.new("PART")
    outer.add_blockref("BULB", (0, 0), {"xscale": 2.0, "yscale": 2.0, "layer": "parts"})
    drawing.model.add_blockref("PART", (0, 0), {"layer": "parts"})
    check_bulb(read_drawing(drawing.saved(), parting=["split"]))
    turned = Drawing(tmp_path)
    bulb(turned.document.blocks.new("BULB"))
    turned.model.add_blockref("BULB", (30, 5), {"rotation": 90.0})
    found = read_drawing(turned.saved(), parting=["split"])
    assert found.outline.area == pytest.approx(AREA, rel=1e-12)
    assert found.outline.box == pytest.approx(np.array([[16.0, -1.0], [30.0, 11.0]]), abs=1e-9)


def test_layer_0_of_a_block_is_that_of_its_reference(tmp_path):
    drawing = Drawing(tmp_path)
    block = drawing.document.blocks.new("RING")
    block.add_circle((0, 0), 5.0)
    drawing.model.add_blockref("RING", (0, 0), dxfattribs={"layer": "seal"})
    assert read_dxf(drawing.saved()).edge_names == ("seal",)


def test_blocks_on_layers_of_annotation_are_symbols(tmp_path):
    drawing = Drawing(tmp_path).box()
    drawing.document.blocks.new("ROUGH").add_line((0, 0), (1, 2))
    drawing.model.add_blockref("ROUGH", (3, 10), {"layer": "sizes"})
    path = drawing.saved()
    with pytest.raises(
        GeometryError, match="layers read as boundary: seal, sizes; name layers of lines between"
    ):
        read_drawing(path)
    assert read_drawing(path, ignore=["Sizes"]).left_out == {"sizes": 1}
    drawing.model.add_text("Rz 6", dxfattribs={"layer": "sizes"})
    found = read_drawing(drawing.saved())
    assert found.outline.area == 100.0
    assert found.left_out == {"sizes": 2}


@pytest.mark.parametrize("hidden", ["ignored", "frozen", "invisible"])
def test_foreign_entities_that_are_not_read_need_no_reader(tmp_path, hidden):
    """Entities of other programs (vendor objects) on layers that are ignored or frozen."""
    drawing = Drawing(tmp_path).box()
    drawing.model.add_line((1, 1), (2, 2), {"layer": "vendor", "invisible": hidden == "invisible"})
    layer = drawing.document.layers.add("vendor")
    if hidden == "frozen":
        layer.freeze()
    path = drawing.saved()
    path.write_text(path.read_text().replace("\nLINE\n", "\nVENDOR_PART\n"))
    ignore = ["vendor"] if hidden == "ignored" else []
    found = read_drawing(path, ignore=ignore)
    assert found.outline.area == 100.0
    assert found.left_out == ({"vendor": 1} if hidden == "ignored" else {})


def test_foreign_entities_on_read_layers_are_named(tmp_path):
    drawing = Drawing(tmp_path).box()
    drawing.model.add_line((1, 1), (2, 2), {"layer": "vendor"})
    path = drawing.saved()
    path.write_text(path.read_text().replace("\nLINE\n", "\nVENDOR_PART\n"))
    with pytest.raises(GeometryError, match=r"VENDOR_PART #\w+ on layer 'vendor': a drawing can"):
        read_drawing(path)


def test_ellipses_are_followed(tmp_path):
    """Half an ellipse over a line, and a complete one as a hole."""
    drawing = Drawing(tmp_path)
    drawing.model.add_line((-5, 0), (5, 0), {"layer": "base"})
    drawing.model.add_ellipse((0, 0), (5, 0), 0.8, 0.0, np.pi, {"layer": "seal"})
    drawing.model.add_ellipse((0, 1.5), (2, 0), 0.5, dxfattribs={"layer": "hole"})
    outline = read_dxf(drawing.saved())
    assert outline.area == pytest.approx(0.5 * np.pi * 20.0 - np.pi * 2.0, rel=1e-6)
    found = np.concatenate([s.points(np.linspace(0, 1, 50)) for s in outline.edge("seal")])
    assert np.abs(np.hypot(found[:, 0] / 5.0, found[:, 1] / 4.0) - 1.0).max() < 1e-6


def divided(tmp_path, add, ends):
    """A drawing with one more parting line of two points."""
    drawing = Drawing(tmp_path)
    add(drawing.model)
    before = read_dxf(drawing.saved())
    drawing.model.add_line(*ends, {"layer": "split"})
    found = read_drawing(drawing.saved(), parting=["split"])
    return before, found.outline


@pytest.mark.parametrize("kind", ["line", "arc", "circle", "spline"])
def test_a_parting_line_divides_the_segment_that_it_ends_at(tmp_path, kind):
    """The curve stays what it was, and has a joint there."""
    on = {"layer": "seal"}
    add, ends, more = {
        "line": (lambda m: m.add_lwpolyline([(0, 0), (9, 0), (9, 5), (0, 5)], close=True,
                                            dxfattribs=on), ((3, 0), (2, 5)), 2),
        "arc": (lambda m: (m.add_arc((0, 0), 5, 0, 180, dxfattribs=on),
                           m.add_line((-5, 0), (5, 0), on)), ((3, 4), (1, 0)), 2),
        "circle": (lambda m: m.add_circle((0, 0), 5, on), ((3, 4), (3, -4)), 2),
        "spline": (lambda m: (m.add_spline([(-5, 0), (-2, 4), (3, 5), (5, 0)], dxfattribs=on),
                              m.add_line((-5, 0), (5, 0), on)), ((3, 5), (1, 0)), 2),
    }[kind]  # fmt: skip
    before, after = divided(tmp_path, add, ends)
    assert after.area == pytest.approx(before.area, rel=1e-12)
    assert len(after.outer.segments) == len(before.outer.segments) + more
    joints = np.array([s.start for s in after.outer.segments])
    assert all(np.hypot(*(joints - end).T).min() < 1e-6 for end in ends)
    # points of the new segments are on the old ones
    points = np.concatenate([s.points(np.linspace(0, 1, 9)) for s in after.outer.segments])
    away = [min(s.nearest(p)[1] for s in before.outer.segments) for p in points]
    assert max(away) < 1e-7
    assert not any(isinstance(s, Circle) for s in after.outer.segments)


def test_curved_parting_lines_are_followed_by_straight_sides(tmp_path):
    drawing = Drawing(tmp_path).box()
    drawing.model.add_arc((5, 0), 5, 0, 180, dxfattribs={"layer": "split"})
    drawing.model.add_line((0, 8), (10, 8), {"layer": "split"})
    arc, line = read_drawing(drawing.saved(), parting=["split"]).parting
    middles = 0.5 * (arc[1:] + arc[:-1])
    assert np.hypot(arc[:, 0] - 5.0, arc[:, 1]) == pytest.approx(np.full(len(arc), 5.0))
    assert 0.005 < 5.0 - np.hypot(middles[:, 0] - 5.0, middles[:, 1]).min() <= 0.01
    assert len(line) == 2


def test_closed_parting_lines_surround_inserts(tmp_path):
    """A circle, and three lines in any order and direction, beside a line across the section."""
    drawing = Drawing(tmp_path).box()
    on = {"layer": "split"}
    drawing.model.add_circle((5, 5), 1, on)
    for a, b in (((2, 2), (3, 2)), ((3, 3), (3, 2)), ((2, 2), (3, 3)), ((0, 8), (10, 8))):
        drawing.model.add_line(a, b, on)
    across, circle, triangle = read_drawing(drawing.saved(), parting=["split"]).parting
    assert len(across) == 2
    for closed in (circle, triangle):
        np.testing.assert_array_equal(closed[0], closed[-1])
    assert np.hypot(*(circle - 5.0).T) == pytest.approx(np.ones(len(circle)))
    assert sorted(map(tuple, triangle[:-1].tolist())) == [(2, 2), (3, 2), (3, 3)]


@pytest.mark.parametrize(("lines", "words"), [
    ([((0, 2), (9.99, 2))], "ends at (9.99, 2) inside the section, 0.01 mm away from its bou"),
    ([((0, 2), (10.5, 2))], "away from its boundary; shorten it to the boundary"),
    ([((0, 2), (5, 2)), ((5, 2), (10, 2)), ((5, 2), (5, 10))], "3 ends of parting lines meet at (5, 2)"),
    ([((1, 5), (7, 5)), ((7, 5), (7, 7)), ((7, 7), (1, 5))], "is closed, but touches or leaves the sec"),
    ([((0, 0), (0, 10))], "the parting line from (0, 0) to (0, 10) between two materials does not run"),
    ([((0, 7), (10, 7)), ((0, 5), (10, 9))], "the lines 1 and 3 between materials (parting lines) "
    "cross at (5, 7)"),
    ([((0, 1), (10, 1)), ((10, 1), (4, 4)), ((4, 4), (4, 0))], "between two materials crosses itself"),
    ([((0, 6.005), (10, 6.005))],
     "crosses at (6, 6.005) on hole 1, 0.005 mm away from (6, 6), where segments of the boundary meet"),
])  # fmt: skip
def test_parting_lines_that_divide_nothing_are_refused(tmp_path, lines, words):
    drawing = Drawing(tmp_path).box().box(2.0, "hole", (6.0, 6.0))
    for a, b in lines:
        drawing.model.add_line(a, b, {"layer": "split"})
    with pytest.raises(GeometryError) as caught:
        read_drawing(drawing.saved(), parting=["split"])
    assert words in str(caught.value)
    assert "cross at" in words or "LINE #" in str(caught.value)


@pytest.mark.parametrize("key", ["parting", "ignore"])
def test_layers_that_the_drawing_does_not_have_are_refused(tmp_path, key):
    path = Drawing(tmp_path).box().saved()
    with pytest.raises(
        GeometryError, match=f"{key} = 'sael', but the drawing has no such layer.*; its layers are"
    ):
        read_drawing(path, **{key: ["sael"]})


def test_a_misspelt_layer_is_suggested_among_those_with_entities(tmp_path):
    drawing = Drawing(tmp_path).box()
    drawing.document.layers.add("unused")
    drawing.model.add_line((0, 5), (10, 5), {"layer": "PARTING"})
    with pytest.raises(GeometryError) as caught:
        read_drawing(drawing.saved(), parting=["PARTNG"])
    assert "(did you mean 'PARTING'?)" in str(caught.value)
    assert str(caught.value).endswith("; its layers are seal, PARTING")


def test_an_ignored_frame_is_no_outline(tmp_path):
    drawing = Drawing(tmp_path).box().box(100.0, "Frame", (-20.0, -20.0))
    path = drawing.saved()
    assert read_dxf(path).outer.edge_names == ("Frame",)
    found = read_drawing(path, ignore=["FRAME"])
    assert found.outline.edge_names == ("seal",)
    assert found.left_out == {"Frame": 1}


def test_parting_lines_are_written_and_read_again(tmp_path):
    drawing = Drawing(tmp_path)
    bulb(drawing.model)
    found = read_drawing(drawing.saved(), parting=["split"])
    path = write_dxf(found.outline, tmp_path / "again.dxf", {"between": found.parting})
    again = read_drawing(path, parting=["between"])
    assert again.outline.area == pytest.approx(found.outline.area, rel=1e-12)
    assert np.array_equal(again.parting[0], found.parting[0])
    # no segment was divided twice
    assert [len(c.segments) for c in again.outline.contours] == [
        len(c.segments) for c in found.outline.contours
    ]
    assert min(s.length for s in again.outline.outer.segments) > SHORTEST * JOIN


def test_control_points_of_a_fitted_polyline_are_no_points_of_it(tmp_path):
    """R12 keeps the frame of a spline among the vertices of its curve."""
    drawing = Drawing(tmp_path, 4, "R12")
    polyline = drawing.model.add_polyline2d(
        [(0, 0), (10, 0), (10, 5), (0, 5)], close=True, dxfattribs={"layer": "seal"}
    )
    polyline.append_vertices([(30, 30), (-20, 40)], {"flags": 16})
    assert read_dxf(drawing.saved(), "mm").area == pytest.approx(50.0, rel=1e-12)
