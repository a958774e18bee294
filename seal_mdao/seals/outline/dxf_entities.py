"""Conversion of entities of a drawing to segments of a section."""

from itertools import pairwise

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.seals.outline.arcs import Arc, Circle
from seal_mdao.seals.outline.b_splines import segments_of
from seal_mdao.seals.outline.contours import JOIN
from seal_mdao.seals.outline.segments import Line, pair

MODEL_UNITS = {"mm": 1.0, "cm": 10.0, "dm": 100.0, "m": 1000.0, "inch": 25.4, "foot": 304.8}
"""Length of each unit, mm."""

_LEVEL = 1e-9

FRAME = 16
"""Flag of a vertex of a POLYLINE that is a control point of a fitted spline."""

FORBIDDEN = '<>/\\":;?*=`'
"""Characters not allowed in names of layers, besides control characters."""


def layer_name(name: str) -> str:
    """Check that an edge can have the name of a layer, and return it; GeometryError if not."""
    forbidden = [sign for sign in name if sign in FORBIDDEN or ord(sign) < 32]
    if forbidden:
        raise GeometryError(
            f"the name {name!r} of an edge contains {forbidden[0]!r}, which is not allowed in the "
            f"name of a DXF layer; avoid {' '.join(FORBIDDEN)} and control characters"
        )
    return name


def pieces_of(placed, scale: float) -> list[tuple]:
    """Convert entities of a drawing (``dxf_layers.Placed``) to segments (mm) with their names.

    GeometryError names the entity that cannot be converted by its kind, handle and layer.
    """
    from ezdxf import DXFError

    pieces = []
    for own in placed:
        try:
            pieces += [(segment, own.name) for segment in _segments(own, scale)]
        except (GeometryError, DXFError) as error:
            raise GeometryError(f"{own.name}: {error}") from None
    return pieces


def _segments(placed, scale) -> list:
    entity, kind = placed.entity, placed.entity.dxftype()
    if kind not in _READERS:
        raise GeometryError(
            f"a drawing can contain only the entities {', '.join(_READERS)}; explode this entity, "
            "or name its layer in ignore of [section]"
        )
    # these have their own plane; lines, splines and ellipses are in the coordinates of the drawing
    if kind in ("ARC", "CIRCLE", "LWPOLYLINE") or (kind == "POLYLINE" and entity.is_2d_polyline):
        _make_upright(entity)
    return _READERS[kind](entity, scale, layer_name(placed.layer))


def _make_upright(entity) -> None:
    """Transform an entity with extrusion direction -z (mirrored) to the usual coordinates."""
    from ezdxf.upright import upright

    _check_normal(entity)
    upright(entity)


def _check_normal(entity) -> None:
    # n = (0, 0, 1) or (0, 0, -1) up to rounding
    normal = np.array(entity.dxf.extrusion)
    if np.abs(np.abs(normal) - [0.0, 0.0, 1.0]).max() > _LEVEL:
        raise GeometryError(
            f"the entity does not lie in the plane of the drawing (normal {tuple(normal)}); rotate "
            "the entity into the x-y plane"
        )


def _planar(points, scale) -> np.ndarray:
    """Convert points (n, 3) in a plane z = const to (n, 2), mm."""
    points = np.array([tuple(point) for point in points], float)
    if np.ptp(points[:, 2]) > _LEVEL * (1.0 + np.abs(points).max()):
        raise GeometryError(
            "the entity does not lie in the plane of the drawing, because its z coordinate varies; "
            "project the entity to z = 0"
        )
    return scale * points[:, :2]


def _line(entity, scale, edge):
    a, b = _planar([entity.dxf.start, entity.dxf.end], scale)
    return [Line(tuple(a), tuple(b), edge)]


def _circle(entity, scale, edge):
    centre = _planar([entity.dxf.center], scale)[0]
    return [Circle(tuple(centre), scale * entity.dxf.radius, edge)]


def _arc(entity, scale, edge):
    # DXF arcs run counter-clockwise from start to end angle, degrees; equal angles: a full circle
    first, last = entity.dxf.start_angle, entity.dxf.end_angle
    sweep = (last - first) % 360.0
    if sweep == 0.0:
        return _circle(entity, scale, edge)
    centre = _planar([entity.dxf.center], scale)[0]
    return [
        Arc(tuple(centre), scale * entity.dxf.radius, np.radians(first), np.radians(sweep), edge)
    ]


def _light_polyline(entity, scale, edge):
    return _sides(np.array(entity.get_points("xyb"), float), entity.closed, scale, edge)


def _old_polyline(entity, scale, edge):
    """Convert a POLYLINE, the only kind of polyline of R12, with the vertices of its curve."""
    if not (entity.is_2d_polyline or entity.is_3d_polyline):
        raise GeometryError(
            "the polyline entity is a mesh; draw the boundary with lines, arcs, polylines or "
            "splines"
        )
    # control points of a curve that was fitted are no points of it
    own = [vertex for vertex in entity.vertices if not vertex.dxf.flags & FRAME]
    if own:
        _planar([vertex.dxf.location for vertex in own], scale)
    vertices = np.array(
        [(*tuple(v.dxf.location)[:2], v.dxf.get("bulge", 0.0)) for v in own], float
    )  # fmt: skip
    return _sides(vertices, entity.is_closed, scale, edge)


def _sides(vertices, closed: bool, scale, edge) -> list:
    """Convert vertices (n, 3) with x, y and bulge to lines and arcs.

    The last vertex of a closed polyline may repeat the first one, as some programs write it.
    """
    if closed and len(vertices) > 2:
        gap = scale * np.hypot(*(vertices[-1] - vertices[0])[:2])
        vertices = vertices[: -1 if gap <= JOIN else None]
    if len(vertices) < 2:
        raise GeometryError("a polyline needs at least two vertices")
    if closed:
        # the last side returns to the first vertex
        vertices = np.vstack([vertices, vertices[:1]])
    found = []
    # the bulge of a vertex belongs to the side that begins there; 0 is a straight side
    for i, (one, other) in enumerate(pairwise(vertices), 1):
        a, b = scale * one[:2], scale * other[:2]
        if (a == b).all():
            following = 1 if closed and i == len(vertices) - 1 else i + 1
            raise GeometryError(
                f"the vertices {i} and {following} of a polyline coincide at {pair(a)}; remove one "
                "of the two vertices"
            )
        bulge = float(one[2])
        if bulge == 0.0:
            found.append(Line(tuple(a), tuple(b), edge))
        else:
            found.append(Arc.bulged(tuple(a), tuple(b), bulge, edge))
    return found


def _ellipse(entity, scale, edge):
    """Convert an ellipse, or a part of one, by way of its rational B-spline."""
    from ezdxf.math import BSpline

    _check_normal(entity)
    # quadratic, with weights: exact
    tool = BSpline.from_ellipse(entity.construction_tool())
    control = _planar(tool.control_points, scale)
    return segments_of(tool.degree, tool.knots(), control, tool.weights(), edge)


def _spline(entity, scale, edge):
    if not len(entity.control_points):
        return _through_fit_points(entity, scale, edge)
    control = _planar(entity.control_points, scale)
    return segments_of(entity.dxf.degree, entity.knots, control, entity.weights, edge)


def _through_fit_points(entity, scale, edge):
    """Convert a spline given by fit points alone, interpolated as ezdxf does."""
    if len(entity.fit_points) < 2:
        raise GeometryError("a spline needs control points or at least two fit points")
    fit = _planar(entity.fit_points, scale)
    same = np.flatnonzero(~np.diff(fit, axis=0).any(axis=1))
    if same.size:
        raise GeometryError(
            f"the fit points {same[0] + 1} and {same[0] + 2} of a spline coincide at "
            f"{pair(fit[same[0]])}; remove one of the two points"
        )
    tool = entity.construction_tool()
    control = _planar(tool.control_points, scale)
    return segments_of(tool.degree, tool.knots(), control, tool.weights(), edge)


_READERS = {
    "LINE": _line, "ARC": _arc, "CIRCLE": _circle, "ELLIPSE": _ellipse, "SPLINE": _spline,
    "LWPOLYLINE": _light_polyline, "POLYLINE": _old_polyline,
}  # fmt: skip
