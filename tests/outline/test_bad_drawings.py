"""Drawings that are refused: one line that says what and where."""

import re

import numpy as np
import pytest
from drawings import Drawing

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.dxf import read_dxf

ON = {"layer": "seal"}
FILE = """[material.rubber]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 8e4
[section]
material = "rubber"
spacing = 0.5
dxf = "{}"
[[profile]]
name = "door"
friction = 0.2
contact = ["seal"]
line = [[-9.0, 0.0], [9.0, 0.0]]
start = [0.0, 90.0]
stage = [{{ translate = [0.0, -1.0], steps = 4 }}]
"""


def add(method, *arguments, units=4, box=True, **further):
    """A drawing of a square and one more entity."""

    def make(folder):
        drawing = Drawing(folder, units)
        if box:
            drawing.box()
        getattr(drawing.model, method)(*arguments, dxfattribs={"layer": "extra"}, **further)
        return drawing.saved()

    return make


def lines(*ends):
    """A drawing of single lines."""

    def make(folder):
        drawing = Drawing(folder)
        for a, b in ends:
            drawing.model.add_line(a, b, ON)
        return drawing.saved()

    return make


def text(content):
    def make(folder):
        path = folder / "drawing.dxf"
        path.write_text(content)
        return path

    return make


def polyline_of(count):
    """A drawing of a polygon with so many sides."""

    def make(folder):
        drawing, angle = Drawing(folder), np.arange(count) * 2.0 * np.pi / count
        corners = 1e4 * np.column_stack([np.cos(angle), np.sin(angle)])
        drawing.model.add_lwpolyline(corners.tolist(), close=True, dxfattribs=ON)
        return drawing.saved()

    return make


def wrong_layer(folder):
    path = Drawing(folder).box(layer="lip_top").saved()
    path.write_text(path.read_text().replace("lip_top", "lip/top"))
    return path


def block(folder):
    drawing = Drawing(folder)
    drawing.document.blocks.new("BULB").add_line((0, 0), (1, 0))
    drawing.model.add_blockref("BULB", (0, 0), dxfattribs=ON)
    return drawing.saved()


def block_in_itself(folder):
    drawing = Drawing(folder)
    drawing.document.blocks.new("BULB").add_blockref("BULB", (0, 0))
    drawing.model.add_blockref("BULB", (0, 0), dxfattribs=ON)
    return drawing.saved()


def _upright_ellipse(folder):
    drawing = Drawing(folder).box()
    drawing.model.add_ellipse(
        (5, 5, 0), (0, 0, 2), 0.5, dxfattribs={"layer": "hole", "extrusion": (1, 0, 0)}
    )
    return drawing.saved()


def cut(folder):
    path = Drawing(folder).box().saved()
    path.write_text(path.read_text()[:-400])
    return path


def old(folder):
    """R12 knows no units."""
    drawing = Drawing(folder, 4, "R12")
    drawing.model.add_circle((0, 0), 5.0, ON)
    return drawing.saved()


def garbled(folder):
    """A word of the file's that ezdxf meets with an error of its own kind."""
    path = Drawing(folder).box().saved()
    words = path.read_text().split("\n")
    at = words.index("LWPOLYLINE", words.index("ENTITIES"))
    number = words.index(" 90", at)
    words[number + 1] = "1e400"
    path.write_text("\n".join(words))
    return path


def empty_layer(folder):
    drawing = Drawing(folder).box()
    drawing.document.layers.add("seal").off()
    return drawing.saved()


def spline(control, knots, degree=3, weights=()):
    def make(folder):
        drawing = Drawing(folder)
        entity = drawing.model.add_spline(degree=degree, dxfattribs=ON)
        entity.control_points = control
        entity.knots, entity.weights = knots, weights
        return drawing.saved()

    return make


def boxes(*squares, layers=("seal", "hole", "other")):
    def make(folder):
        drawing = Drawing(folder)
        for (size, at), layer in zip(squares, layers, strict=False):
            drawing.box(size, layer, at)
        return drawing.saved()

    return make


ARCH = [(0, 0), (1, 4), (3, 4), (4, 0)]
CLAMPED = [0, 0, 0, 0, 1, 1, 1, 1]


def _circle_twice(folder):
    """With other first points, so that no ends of the two circles meet."""
    drawing = Drawing(folder).box()
    drawing.model.add_circle((5, 5), 2, {"layer": "hole"})
    halves = [(5, 3, 1.0), (5, 7, 1.0)]
    drawing.model.add_lwpolyline(halves, "xyb", close=True, dxfattribs={"layer": "other"})
    return drawing.saved()


BAD = {
    "no file": (lambda folder: folder / "drawing.dxf", "there is no such drawing"),
    "a folder": (lambda folder: folder, "there is no such drawing"),
    "empty": (text(""), "the drawing cannot be read"),
    "no drawing": (text("name,stress\n1,2\n"), "is not a DXF file"),
    "cut off": (cut, "the drawing cannot be read"),
    "garbled": (garbled, "the drawing cannot be read (OverflowError"),
    "no units": (lambda folder: Drawing(folder, None).box().saved(), "drawing has no unit of length"),
    "units 0": (lambda folder: Drawing(folder, 0).box().saved(), "($INSUNITS in its header is"),
    "old": (old, "drawing has no unit of length"),
    "miles": (lambda folder: Drawing(folder, 3).box().saved(), "($INSUNITS = 3) are not supported"),
    "nothing": (lambda folder: Drawing(folder).saved(), "the drawing has no section"),
    "all off": (empty_layer, "the drawing has no section"),
    "too many lines": (
        polyline_of(20_001),
        "20001 segments (lines, arcs, splines) are more than the limit of 20000",
    ),
    "a layer of no such name": (wrong_layer, "the name 'lip/top' of an edge contains '/'"),
    "block": (block, "the contour is open: LINE of the block 'BULB' (INSERT #"),
    "face": (
        add("add_3dface", [(0, 0), (1, 0), (1, 1), (0, 1)]),
        "on layer 'extra': a drawing can contain only the entities ",
    ),
    "ellipse": (add("add_ellipse", (0, 0), (3, 0), 0.5), "crosses the outer contour"),
    "half an ellipse": (add("add_ellipse", (0, 0), (3, 0), 0.5, 0.0, 3.0), "ELLIPSE #"),
    "upright ellipse": (_upright_ellipse, "the entity does not lie in the plane of the drawing (normal"),
    "old polyline": (add("add_polyline2d", [(1, 1), (2, 2)]), "POLYLINE #"),
    "mesh": (add("add_polyface"), "the polyline entity is a mesh; draw the boundary"),
    "block in itself": (block_in_itself, "contains itself"),
    "an open line on another layer": (
        add("add_line", (2, 2), (8, 2)),
        "(layers read as boundary: seal, extra; name layers of lines between rubbers in parting of",
    ),
    "line of no length": (add("add_line", (3, 3), (3, 3)), "a line of the boundary has zero "
    "length, because"),
    "NaN": (add("add_line", (3, 3), (3, np.nan)), "is not finite"),
    "no radius": (add("add_circle", (5, 5), 0.0), "radius of a circle must be positive, got 0"),
    "negative radius": (add("add_arc", (5, 5), -2.0, 0, 90), "radius of an arc must be positive"),
    "twice a vertex": (
        add("add_lwpolyline", [(1, 1), (2, 1), (2, 1), (1, 2)], close=True),
        "LWPOLYLINE #30 on layer 'extra': the vertices 2 and 3 of a polyline coincide at (2, 1)",
    ),
    "first vertex again": (
        add("add_lwpolyline", [(1, 1), (2, 1), (1, 2), (1, 1), (1, 1)], close=True),
        "vertices 4 and 1 of a polyline coincide at (1, 1)",
    ),
    "one vertex": (add("add_lwpolyline", [(1, 1)]), "a polyline needs at least two vertices"),
    "slanting": (add("add_line", (0, 0, 0), (3, 0, 1)), "its z coordinate varies"),
    "upright circle": (
        lambda folder: _upright(folder), "the entity does not lie in the plane of the drawing (normal"
    ),
    "knots decrease": (spline(ARCH, [0, 0, 0, 0, 1, 1, 0.5, 1]), "knots of a spline must not decrease"),
    "broken": (
        spline([*ARCH, *ARCH], [0, 0, 0, 0, 1, 1, 1, 1, 2, 2, 2, 2]),
        "the spline is not a continuous curve: The spline has internal repeated knots",
    ),
    "knots of no length": (spline(ARCH, [1.0] * 8), "the spline has zero length, because its knots"),
    "negative weight": (spline(ARCH, CLAMPED, weights=[1, -1, 1, 1]), "weights of a spline must be"),
    "fit points": (add("add_spline", [(1, 1), (2, 2), (2, 2)]), "remove one of the two points"),
    "no points": (add("add_spline"), "a spline needs control points or at least two fit points"),
    "NaN in a spline": (spline([(0, 0), (1, np.nan), (3, 4), (4, 0)], CLAMPED), "is not finite"),
    "open": (
        lines(((0, 0), (4, 0)), ((4, 0), (4, 3))),
        "the contour is open: LINE #2F on layer 'seal' ends at (0, 0) and no segment begins there; "
        "the nearest open end is that of LINE #30 on layer 'seal' at (4, 3), 5 mm away",
    ),
    "open spline": (spline(ARCH, CLAMPED), "the contour is open: SPLINE #2F on layer 'seal'"),
    "a gap": (
        lines(((0, 0), (4, 0)), ((4, 0), (4, 3)), ((4, 3), (0, 0.01))),
        "no segment begins there; the nearest open end is that of LINE #31 on layer 'seal' at "
        "(0, 0.01), 0.01 mm away",
    ),
    "a branch": (
        lines(((0, 0), (4, 0)), ((4, 0), (4, 3)), ((4, 3), (0, 0)), ((0, 0), (4, 1))),
        "3 ends meet at (0, 0): LINE #2F on layer 'seal' and LINE #31 on layer 'seal' and LINE #32",
    ),
    "drawn twice": (
        lines(((0, 0), (4, 0)), ((4, 0), (4, 3)), ((4, 3), (0, 0)), ((0, 0), (4, 0))),
        "is a segment drawn twice?",
    ),
    "speck": (
        lines(((0, 0), (4, 0)), ((4, 0), (4, 0.005)), ((4, 0.005), (0, 3)), ((0, 3), (0, 0))),
        "is only 0.005 mm long",
    ),
    "crossing": (
        lines(((0, 0), (4, 0)), ((4, 0), (0, 3)), ((0, 3), (4, 3)), ((4, 3), (0, 0))),
        "crosses itself (edge 'seal') at (2, 1.5)",
    ),
    "hole touches": (boxes((10, (0, 0)), (2, (0, 4))), "touches hole 1, edge 'hole', at (0, "),
    "hole crosses": (
        boxes((10, (0, 0)), (2, (9, 4))),
        "crosses the outer contour of body 2, edge 'hole', at (10, ",
    ),
    "holes overlap": (boxes((10, (0, 0)), (3, (2, 2)), (3, (4, 4))), "crosses hole 2, edge 'other'"),
    "a circle twice": (_circle_twice, "hole 1, edge 'other', crosses the outer contour of"),
    "one layer": (
        boxes((10, (0, 0)), (5, (2, 2)), layers=("seal", "seal")),
        "the edge 'seal' is on the outer contour and on hole 1; an edge must be one connected",
    ),
}  # fmt: skip


def _upright(folder):
    drawing = Drawing(folder).box()
    drawing.model.add_circle((5, 5), 2, {"layer": "hole", "extrusion": (1, 0, 0)})
    return drawing.saved()


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_read_is_refused_in_one_line(tmp_path, name, refusing_script, capsys):
    make, words = BAD[name]
    path = make(tmp_path)
    with pytest.raises(GeometryError, match=re.escape(words)) as caught:
        read_dxf(path)
    assert str(caught.value).startswith(f"{path}: ")
    assert "\n" not in str(caught.value)
    file = tmp_path / "seal.toml"
    file.write_text(FILE.format(path.name), encoding="utf-8")
    line = refusing_script(file, capsys)
    assert str(file) in line
    assert words in line


@pytest.mark.parametrize(("units", "words"), [
    ("inch", "units = 'inch' contradicts the header of the drawing .*: mm"),
    ("miles", "units = 'miles', but it must be one of mm, cm, dm, m, inch, foot"),
])  # fmt: skip
def test_units_that_contradict_are_refused(tmp_path, units, words):
    with pytest.raises(GeometryError, match=words):
        read_dxf(Drawing(tmp_path).box().saved(), units)
