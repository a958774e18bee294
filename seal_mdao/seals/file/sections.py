"""``[section]``: the outline, from its segments or from a drawing."""

from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import numpy as np

from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.seals.file.checks import (
    LIST,
    POINT,
    POINTS,
    TEXT,
    Check,
    Key,
    number,
    one_of,
    table,
    tables,
    whole,
)
from seal_mdao.seals.file.shapes import KEYS, segments_of
from seal_mdao.seals.file.tables import RegionTable, SectionTable
from seal_mdao.seals.outline.chain import ROUNDING
from seal_mdao.seals.outline.cloud import LAYERS
from seal_mdao.seals.outline.cloud_file import GivenCloud, read_cloud
from seal_mdao.seals.outline.dxf import read_dxf
from seal_mdao.seals.outline.dxf_entities import MODEL_UNITS, layer_name
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.section import JOIN, Contour, Outline
from seal_mdao.seals.wall_grid import SCHEMES

LEAST_LAYERS = {name: own.basis_order + 1 for name, own in SCHEMES.items()}
"""Of particles across a wall, by the name of the accuracy."""
MOST_LAYERS = 50
"""That a spacing may have across a wall."""
RAY_KEYS = {
    "rays": Key(whole(8, 100_000)),
    "layers": Key(whole(2, 1000)),
    "centre": Key(POINT, (0.0, 0.0)),
    "accuracy": Key(one_of(*LEAST_LAYERS), Rays.accuracy),
}
SECTION_KEYS = {
    "material": Key(TEXT),
    "spacing": Key(number(above=0.0), None),
    "layers": Key(whole(3, MOST_LAYERS), None),
    "rays": Key(
        Check("a table { rays, layers, centre, accuracy }", lambda v: table("rays", v, RAY_KEYS)),
        None,
    ),
    "cloud": Key(TEXT, None),
    "outer": Key(LIST, None),
    "hole": Key(LIST, None),
    "dxf": Key(TEXT, None),
    "units": Key(one_of(*MODEL_UNITS), None),
    "region": Key(LIST, None),
}
REGION_KEYS = {"material": Key(TEXT), "at": Key(POINT), "line": Key(POINTS, None)}
EDGE = Check(TEXT.allowed, lambda value: layer_name(TEXT.convert(value)))
"""Drawings of designs have edges as layers."""
OUTER_KEYS = {"edge": Key(EDGE), "body": Key(whole(1, 1000), 1), **KEYS}
FILLINGS = ("spacing", "rays", "cloud")
HOLE_KEYS = {"edge": Key(EDGE), "hole": Key(whole(1, 1000), 1), **KEYS}


def read_section(given, folder: Path) -> SectionTable:
    """The section of a file in ``folder``, which its drawing is relative to.

    Raises
    ------
    SealFileError
    """
    where = "[section]"
    values = table(where, given, SECTION_KEYS)
    drawn = values["dxf"] is not None
    if drawn == (values["outer"] is not None):
        raise SealFileError(
            f"{where}: needs either [[section.outer]] or dxf; it has {'both' if drawn else 'neither'}"
        )
    if drawn and values["hole"] is not None:
        raise SealFileError(f"{where}: [[section.hole]] beside dxf; the drawing has the holes")
    if not drawn and values["units"] is not None:
        raise SealFileError(f"{where}: units belongs to dxf; all numbers of this file are in mm")
    outline = _drawing(where, values, folder) if drawn else _segments(where, values)
    rows = [] if values["region"] is None else tables("section.region", values["region"])
    regions = tuple(
        _to_joints(RegionTable(**table(f"[[section.region]] {i}", one, REGION_KEYS)), outline)
        for i, one in enumerate(rows, 1)
    )
    filling = _filling(where, values, folder, outline)
    if isinstance(filling, Rays) and regions:
        raise SealFileError(f"{where}: [[section.region]] beside rays; use spacing")
    beside = (None if values[key] is None else folder / values[key] for key in ("dxf", "cloud"))
    if values["layers"] is not None and not isinstance(filling, float):
        raise SealFileError(f"{where}: layers belongs to spacing; rays and a cloud have their own")
    layers = LAYERS if values["layers"] is None else values["layers"]
    return SectionTable(outline, values["material"], filling, *beside, regions, layers)


def _to_joints(region: RegionTable, outline: Outline) -> RegionTable:
    """The region with the ends of its line at the joints of the boundary that they are drawn at."""
    if region.line is None:
        return region
    joints = np.array([segment.start for c in outline.contours for segment in c.segments])

    def moved(point):
        away = np.hypot(*(joints - point).T)
        near = ROUNDING < away.min() <= JOIN
        return tuple(joints[away.argmin()].tolist()) if near else point

    first, *inner, last = region.line
    return replace(region, line=(moved(first), *inner, moved(last)))


def _filling(where, values, folder, outline) -> float | Rays | GivenCloud:
    given = [name for name in FILLINGS if values[name] is not None]
    if len(given) != 1:
        raise SealFileError(
            f"{where}: needs one of spacing (the largest distance of particles in mm), rays and cloud; "
            f"it has {' and '.join(given) or 'none of them'}"
        )
    if given == ["rays"]:
        return _rays(where, Rays(**values["rays"]))
    if given == ["spacing"]:
        return values["spacing"]
    try:
        return read_cloud(folder / values["cloud"], outline)
    except (GeometryError, ImportError) as error:
        raise SealFileError(f"{where}: cloud: {error}") from None


def _rays(where, rays: Rays) -> Rays:
    least = LEAST_LAYERS[rays.accuracy]
    if rays.layers < least:
        raise SealFileError(
            f"{where}: rays: layers = {rays.layers} with the accuracy {rays.accuracy!r}, which needs at "
            f"least {least}; 4 are a good start"
        )
    return rays


def _drawing(where, values, folder) -> Outline:
    try:
        return read_dxf(folder / values["dxf"], values["units"])
    except (GeometryError, ImportError) as error:
        raise SealFileError(f"{where}: dxf: {error}") from None


def _segments(where, values) -> Outline:
    bodies, holes = defaultdict(list), defaultdict(list)
    for number_, given in enumerate(tables("section.outer", values["outer"]), 1):
        place, row = _row("section.outer", number_, given, OUTER_KEYS)
        bodies[row["body"]] += segments_of(place, row, row["edge"])
    rows = [] if values["hole"] is None else tables("section.hole", values["hole"])
    for number_, given in enumerate(rows, 1):
        place, row = _row("section.hole", number_, given, HOLE_KEYS)
        holes[row["hole"]] += segments_of(place, row, row["edge"])
    outer = [
        _contour("[[section.outer]]" + (f" of body {n}" if len(bodies) > 1 else ""), bodies[n])
        for n in sorted(bodies)
    ]
    inner = [_contour(f"[[section.hole]] of hole {n}", holes[n]) for n in sorted(holes)]
    try:
        return Outline(outer[0], tuple(inner), tuple(outer[1:]))
    except GeometryError as error:
        raise SealFileError(f"{where}: {error}") from None


def _row(name, number_, given, keys):
    edge = given.get("edge")
    place = f"[[{name}]] {number_}" + (f" (edge {edge!r})" if isinstance(edge, str) else "")
    return place, table(place, given, keys)


def _contour(where, segments) -> Contour:
    try:
        return Contour(tuple(segments))
    except GeometryError as error:
        raise SealFileError(f"{where}: {error}") from None
