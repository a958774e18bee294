"""Read and write sections as DXF drawings, with the library ezdxf (extra ``dxf``)."""

from collections.abc import Mapping
from dataclasses import replace
from difflib import get_close_matches
from importlib import import_module
from math import degrees
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.errors import GeometryError
from seal_mdao.input_files import reason_of, require_ordinary
from seal_mdao.seals.outline.b_splines import b_spline_of
from seal_mdao.seals.outline.chain import check_count, loops
from seal_mdao.seals.outline.contours import JOIN, SAGITTA, Arc, Circle, Contour, Line, Outline
from seal_mdao.seals.outline.crossings import nearest_around
from seal_mdao.seals.outline.dxf_entities import MODEL_UNITS, layer_name, pieces_of
from seal_mdao.seals.outline.dxf_layers import layer_names, sorted_entities
from seal_mdao.seals.outline.edges_by_corner import named_by_corners
from seal_mdao.seals.outline.parting import parted

MILLIMETRES = 4
NONE = MappingProxyType({})
"""No parting lines."""
UNITS = {1: "inch", 2: "foot", 4: "mm", 5: "cm", 6: "m", 14: "dm"}
"""Supported values of the header variable $INSUNITS."""


class Drawing(NamedTuple):
    """Section read from a drawing, with parting lines, texts and omitted entities.

    Attributes
    ----------
    outline : Outline
        Its boundary, mm.
    parting : tuple of ndarray, shape (k, 2)
        Lines across it, between regions of different rubber, mm.
    texts : tuple of (str, (float, float))
        Texts and their insertion points, mm.
    left_out : dict of str to int
        Number of entities that were not read, by layer.
    """

    outline: Outline
    parting: tuple
    texts: tuple
    left_out: dict

    @property
    def notice(self) -> str:
        """One line that says which layers and how many entities were left out; empty for none."""
        if not self.left_out:
            return ""
        layers = ", ".join(f"{name!r} ({count})" for name, count in self.left_out.items())
        count, several = sum(self.left_out.values()), "s" * (len(self.left_out) > 1)
        return f"ignored in the drawing: {count} entities on layer{several} {layers}"


def read_dxf(path, units: str | None = None) -> Outline:
    """Read the boundary of the section in a drawing, in mm: the outline of ``read_drawing``."""
    return read_drawing(path, units).outline


def read_drawing(
    path, units: str | None = None, parting=(), ignore=(), by_corners: bool = False
) -> Drawing:
    """Read the section in the model space of a drawing, in mm.

    Lines, arcs, circles, ellipses, polylines and splines in any order and direction; ends closer than
    1e-3 mm are joined in one point. Layers are the names of edges; layers that are off or frozen are
    ignored, annotation is left out (``dxf_layers.sorted_entities``), blocks are resolved. The largest
    contour is the outer one; those inside it are holes, those outside of all and those in holes are
    further bodies. Splines of degree one to three are converted exactly, others and ellipses
    approximated within 1e-6 mm.

    Parameters
    ----------
    path : str or Path
    units : {"mm", "cm", "dm", "m", "inch", "foot"}, optional
        For drawings whose header has no $INSUNITS; must not contradict it.
    parting : sequence of str
        Layers of the lines between regions, which end on the boundary.
    ignore : sequence of str
        Layers that are not read.
    by_corners : bool
        Whether edges are the parts of the boundary between corners, with the names of
        ``named_by_corners``, independent of the layers.

    Raises
    ------
    ImportError
        Without ezdxf.
    GeometryError
        For a file that is no drawing, no units, a layer that does not exist, an entity of another kind
        (with handle and layer), contours that are open or cross, parting lines that do not lead from
        boundary to boundary.
    """
    document = _document(path)
    try:
        scale = MODEL_UNITS[_units(document, units)]
        _check_layers(document, parting=parting, ignore=ignore)
        found = sorted_entities(document, ignore)
        # layers distinguish edges from parting lines
        between = {name.casefold() for name in parting}
        divides = [own.layer.casefold() in between for own in found.geometry]
        boundary = [own for own, line in zip(found.geometry, divides, strict=True) if not line]
        lines = [own for own, line in zip(found.geometry, divides, strict=True) if line]
        drawn = pieces_of(boundary, scale)
        if by_corners:
            # a name for every piece, so that no two parts have the same
            drawn = [
                (replace(segment, edge=str(number)), name)
                for number, (segment, name) in enumerate(drawn)
            ]
        outline = _outline_of(drawn, list(dict.fromkeys(own.layer for own in boundary)))
        if by_corners:
            outline = named_by_corners(outline)
        pieces = pieces_of(lines, scale)
        outline, cuts = parted(outline, *zip(*pieces, strict=True)) if pieces else (outline, ())
        texts = tuple((text, (scale * x, scale * y)) for text, (x, y) in found.texts)
        return Drawing(outline, cuts, texts, dict(found.left_out))
    except GeometryError as error:
        raise GeometryError(f"{path}: {error}") from None


def boundary_layers(path) -> list[str]:
    """List the layers of a drawing that hold geometry, annotation left out.

    Raises
    ------
    ImportError, GeometryError
        As ``read_drawing`` for a file that is no drawing.
    """
    geometry = sorted_entities(_document(path)).geometry
    return list(dict.fromkeys(own.layer for own in geometry))


def _check_layers(document, **wanted) -> None:
    """Refuse layers that the drawing does not have; ``wanted`` are by the key that names them."""
    every = {layer.dxf.name.casefold(): layer.dxf.name for layer in document.layers}
    every |= {name.casefold(): name for name in layer_names(document)}
    for key, names in wanted.items():
        for name in names:
            if name.casefold() not in every:
                # layers with entities alone: drawings have many empty ones
                filled = layer_names(document)
                near = get_close_matches(name.casefold(), [own.casefold() for own in filled], 1)
                hint = f" (did you mean {every[near[0]]!r}?)" if near else ""
                raise GeometryError(
                    f"{key} = {name!r}, but the drawing has no such layer{hint}; its layers are "
                    + ", ".join(filled)
                )


def _outline_of(pieces, layers) -> Outline:
    """Chain pieces of the boundary on some layers, segments with names, to the section."""
    check_count(len(pieces))
    if not pieces:
        raise GeometryError(
            "the drawing has no section: its model space has nothing on visible layers, except "
            "annotation; move the section to the model space and make its layers visible"
        )
    segments, names = zip(*pieces, strict=True)
    try:
        contours = [Contour(chain) for chain in loops(segments, names, JOIN)]
    except GeometryError as error:
        if len(layers) == 1:
            raise
        raise GeometryError(
            f"{error} (layers read as boundary: {', '.join(layers)}; name layers of lines between "
            "rubbers in parting of [section], other layers in ignore; as options of the command new: "
            "--parting, --ignore)"
        ) from None
    # largest first: a contour comes behind those around it
    contours.sort(key=lambda contour: -abs(contour.area))
    return _nested(contours)


def _nested(contours) -> Outline:
    """Build the section of contours, the largest first, by their nesting depth."""
    around = nearest_around([c.polyline(SAGITTA * c.length)[0] for c in contours])
    # even depth: outer contour of a body, odd depth: hole
    depth = []
    for outer in around:
        depth.append(0)
        while outer is not None:
            depth[-1] += 1
            outer = around[outer]
    bodies = [
        c.reversed() if c.area < 0.0 else c
        for c, d in zip(contours, depth, strict=True)
        if d % 2 == 0
    ]
    holes = tuple(c for c, d in zip(contours, depth, strict=True) if d % 2)
    return Outline(bodies[0], holes, tuple(bodies[1:]))


def write_dxf(outline: Outline, path, parting: Mapping = NONE) -> Path:
    """Write a section as a drawing in mm, every edge on a layer of its name.

    Lines, arcs, circles and splines keep their type.

    Parameters
    ----------
    outline : Outline
    path : str or Path
    parting : mapping of str to sequence of ndarray, shape (k, 2)
        Lines between regions by the layer to write them on, mm.

    Returns
    -------
    Path

    Raises
    ------
    ImportError
        Without ezdxf.
    GeometryError
        For an edge whose name no layer can have.
    TypeError
        For anything else than an outline.
    """
    values.instance("outline", outline, Outline)
    for name in outline.edge_names:
        layer_name(name)
    ezdxf = drawing_library()
    document = ezdxf.new("R2010", units=MILLIMETRES)
    for number, name in enumerate(outline.edge_names):
        if name not in document.layers:
            document.layers.add(name, color=1 + number % 6)
    model = document.modelspace()
    for contour in outline.contours:
        for segment in contour.segments:
            add_segment(model, segment)
    for name, lines in parting.items():
        if name not in document.layers:
            document.layers.add(name)
        for line in lines:
            model.add_lwpolyline(np.asarray(line).tolist(), dxfattribs={"layer": name})
    path = Path(path)
    document.saveas(path)
    return path


def add_segment(model, segment) -> None:
    """Add a segment to the model space of an ezdxf drawing, on the layer of its edge."""
    # every kind of segment has an entity of its own
    on = {"layer": segment.edge}
    if isinstance(segment, Line):
        model.add_line(segment.first, segment.last, on)
    elif isinstance(segment, Circle):
        model.add_circle(segment.centre, segment.radius, on)
    elif isinstance(segment, Arc):
        from_to = _degrees(segment.angle), _degrees(segment.angle + segment.sweep)
        model.add_arc(
            segment.centre, segment.radius, *from_to, is_counter_clockwise=segment.sweep > 0.0,
            dxfattribs=on,
        )  # fmt: skip
    else:
        # DXF has control points and knots, not the interpolated points
        knots, control = b_spline_of(segment)
        entity = model.add_spline(degree=3, dxfattribs=on)
        entity.control_points, entity.knots = control.tolist(), knots.tolist()


def _degrees(angle: float) -> float:
    return degrees(angle) % 360.0


def drawing_library():
    """Import ezdxf.

    Raises
    ------
    ImportError
        Where ezdxf is not installed.
    """
    try:
        return import_module("ezdxf")
    except ImportError as error:
        raise ImportError(
            "reading DXF drawings needs the Python package ezdxf, which is not installed: pip "
            "install seal_mdao[dxf]"
        ) from error


def _document(path):
    ezdxf = drawing_library()
    # ezdxf parses tags and header; foreign files are bounded before
    path = Path(path)
    if not path.is_file():
        raise GeometryError(f"{path}: there is no such drawing")
    try:
        require_ordinary(path)
        document = ezdxf.readfile(path)
        document.modelspace()
        return document
    except Exception as error:  # ezdxf raises errors of many kinds at damaged files
        foreign = isinstance(error, OSError) and not error.strerror
        reason = "it is not a DXF file" if foreign else reason_of(error)
    raise GeometryError(f"{path}: the drawing cannot be read ({reason}); save it as DXF again")


def _units(document, wanted) -> str:
    if wanted is not None and wanted not in MODEL_UNITS:
        raise GeometryError(f"units = {wanted!r}, but it must be one of {', '.join(MODEL_UNITS)}")
    # the header, which units of the caller must not contradict
    code = document.header.get("$INSUNITS", 0)
    # $INSUNITS = 0 means unitless: the caller has to state the unit
    if code == 0 and wanted is None:
        raise GeometryError(
            "the drawing has no unit of length ($INSUNITS in its header is missing or 0); set the "
            "unit in the drawing, or give units in [section] (--units of the command), one of "
            f"{', '.join(MODEL_UNITS)}"
        )
    if code == 0:
        return wanted
    if code not in UNITS:
        raise GeometryError(
            f"the units of the drawing ($INSUNITS = {code}) are not supported; use one of "
            + ", ".join(f"{number} ({name})" for number, name in UNITS.items())
        )
    if wanted not in (None, UNITS[code]):
        raise GeometryError(
            f"units = {wanted!r} contradicts the header of the drawing ($INSUNITS: {UNITS[code]}); "
            "leave out units, or correct the drawing"
        )
    return UNITS[code]
