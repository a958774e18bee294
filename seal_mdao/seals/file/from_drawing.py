"""Write the seal file of a drawing: edges, regions and plate from layers, texts and size."""

import json
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import shapely

from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.seals.outline.dxf import (
    Drawing,
    boundary_layers,
    read_drawing,
    write_dxf,
)
from seal_mdao.seals.outline.sizes import start_spacing

SQUEEZE = 0.2
"""Travel of the plate after first contact, as a fraction of the height of the drawing."""
SAGITTA = 1e-3
"""Largest distance of the polygon of a section from its arcs, mm."""
CLEARANCE = 0.02
"""Initial clearance of the plate, as a fraction of the height of the drawing."""
ANNOTATION = re.compile(
    r"cent(er|re)|(^|[^a-z])ax[ie]s|dim(ension)?s?($|[^a-z])|hidden|phantom|construct|border|frame|title"
    r"|notes?($|[^a-z])|defpoints|mittel|bema(ss|ß)|hilf|rahmen",
    re.IGNORECASE,
)
"""Names of layers of centre lines, dimensions, construction lines and frames, English and German."""
LAYERED = "_edges.dxf"
"""End of the name of a drawing that is written with a layer for every edge."""
PARTING = "parting"
"""Layer of the lines between rubbers there."""
MATERIAL = """\
[material.{name}]
shore_a = 60
"""
REGION = """\
[[section.region]]
material = "{name}"
at = [{x:.5g}, {y:.5g}]
"""
FILE = """\
# {name}: the section of {drawing}, pressed by a plate. Lengths in mm, stresses in kPa, forces in N/m.
# Layers of the drawing: edges {edges};
# {layers}.
# Look at section.png of `seal-mdao check {name}.toml`, then change what is fixed, which edges the
# plate touches, its start and its travel.

# Rubber by its hardness; or sponge = "2A3", a grade of ASTM D1056 (`seal-mdao materials` lists all); or
# a law with constants, law = "mooney_rivlin", or fitted to tests, law = "ogden", data = "tests.csv".
{materials}
[section]
material = "{rest}"
spacing = {spacing:.3g}
layers = 5  # of particles across walls, at least
dxf = {file}
{keys}{regions}
[fixed]
edges = [{lowest}]

# A rigid profile: its solid side lies on the left of the line.
[[profile]]
name = "plate"
friction = 0.3
contact = [{contact}]
line = [[{left:.5g}, 0.0], [{right:.5g}, 0.0]]
start = [0.0, {start:.5g}]  # {clearance:.3g} mm above the top, {percent:.2g} % of the height
[[profile.stage]]
translate = [0.0, {travel:.5g}]  # the clearance, then {squeeze:.2g} % of the height

[[measure]]
type = "contact_width"
[[measure]]
type = "von_mises"
away_from_singular = {spacing:.3g}  # mm from ends of edges and interfaces, and corners (infinite stress)

# To optimise the shape, take the "#" away and name the edges that may move.
# [[design]]
# edges = [{contact}]
# parameters = 6
# bound = 0.4  # mm
# [optimize]
# minimize = "section_area"
# constraint = [{{ measure = "reaction", lower = 100.0 }}]  # force on the plate, N/m
"""


def from_drawing(
    name: str, path: Path, folder: Path, units=None, parting=(), ignore=(), report: Callable = print
) -> str:
    """Write the seal file of a drawing, with the lowest edge fixed and a plate that presses from
    above.

    Parameters
    ----------
    name : str
        Of the seal file, without its ending.
    path : Path
        The drawing, which is copied into ``folder`` unless it is there.
    folder : Path
        That of the seal file.
    units, parting, ignore
        As of ``read_drawing``; without ``parting`` a layer of lines between rubbers is looked for.
        Layers that are annotation by their names are left out where the others are a section then.
    report : callable
        Called with one line where the drawing is written again, with a layer for every edge.

    Raises
    ------
    ImportError, GeometryError
        As ``read_drawing``.
    SealFileError
        For a drawing with one edge only.
    """
    path, drawing, parting, ignore = _read(
        path, units, list(parting), list(ignore), folder / f"{name}{LAYERED}", report
    )
    if path.name.endswith(LAYERED):  # written with units of its own
        units = None
    # bounding box, mm
    low, high = np.array(drawing.outline.box)
    width, height = high - low
    lowest, touched = _fixed_and_touched(drawing, low[1] + 0.5 * height)
    if not touched:
        raise SealFileError(
            f"{path} has only one edge, {lowest!r} (all lines are on one layer); draw the fixed "
            "part and the part in contact on separate layers"
        )
    rest, *others = _parts(drawing)
    if not (folder / path.name).exists():  # a seal file names files beside it
        shutil.copy(path, folder / path.name)
    # at least twelve particles across; a plate seven times as wide
    return FILE.format(
        name=name, drawing=path.name, edges=", ".join(drawing.outline.edge_names),
        layers=_described(drawing, parting), rest=rest[0],
        materials="".join(MATERIAL.format(name=own) for own, _ in (rest, *others)),
        keys=_keys(units, parting, ignore), file=_quoted(path.name),
        regions="".join(REGION.format(name=own, x=at[0], y=at[1]) for own, at in others),
        spacing=start_spacing((width, height)), lowest=_quoted(lowest),
        contact=", ".join(map(_quoted, touched)),
        left=low[0] - 3.0 * width, right=high[0] + 3.0 * width,
        clearance=CLEARANCE * height, percent=100.0 * CLEARANCE, squeeze=100.0 * SQUEEZE,
        start=high[1] + CLEARANCE * height, travel=-(SQUEEZE + CLEARANCE) * height,
    )  # fmt: skip


def _read(path, units, parting, ignore, layered: Path, report) -> tuple[Path, Drawing, list, list]:
    """Read a drawing with its parting layers and the layers that are left out, given or found.

    A drawing whose layers are not edges is written again to ``layered``, which is returned as its path.
    """
    refused = None
    try:
        found = [(read_drawing(path, units, parting, ignore), parting, ignore)]
    except GeometryError as error:
        refused, found = error, _other_readings(path, units, parting, ignore)
    # layers that are no edges, or one around all of the outside: no edge of it could be fixed and
    # another one pressed
    if not found or all(len(own.outline.outer.edge_names) == 1 for own, _, _ in found):
        written = _write_layers(path, units, parting, ignore, layered, report)
        if written is not None:
            return layered, written, [PARTING] if written.parting else [], []
    if len(found) != 1:
        # several layers, or none, with which the others are a section: the first error says more
        raise refused
    drawing, parting, ignore = found[0]
    return path, drawing, parting, ignore


def _write_layers(path, units, parting, ignore, layered: Path, report) -> Drawing | None:
    """Write the section of a drawing, whatever its layers are, with a layer for every edge between
    corners and one for the lines between rubbers, and read it; None where the drawing is no section,
    where several layers may be lines between rubbers, or where its outside has no corners."""
    try:
        found = [(read_drawing(path, units, parting, ignore, by_corners=True), parting, ignore)]
    except GeometryError:
        found = _other_readings(path, units, parting, ignore, by_corners=True)
    if len(found) != 1 or len(found[0][0].outline.outer.edge_names) == 1:
        return None
    drawing, parting, _ = found[0]
    if layered.exists():
        raise SealFileError(
            f"{layered} already exists, but the drawing with one layer per edge of {path.name} "
            "would be written there; choose another NAME or another folder (--out)"
        )
    lines = {PARTING: drawing.parting} if drawing.parting else {}
    write_dxf(drawing.outline, layered, lines)
    between = (
        f"; lines between rubbers, from {', '.join(parting)}, are on {PARTING}" if lines else ""
    )
    report(
        f"the layers of {path.name} do not divide the boundary into edges, so the drawing "
        f"{layered} was written with one layer for every edge between two corners: "
        f"{', '.join(drawing.outline.edge_names)}{between}"
    )
    # texts, and what was left out, are those of the drawing as it was given
    written = read_drawing(layered, parting=list(lines))
    return written._replace(texts=drawing.texts, left_out=drawing.left_out)


def _other_readings(path, units, parting, ignore, by_corners=False) -> list[tuple]:
    """List the readings of a drawing, each with its parting layers and the layers left out: with a
    single layer of parting lines, without the layers that are annotation by their names, or both."""
    annotation = _annotation(path)
    without = [*ignore, *(own for own in annotation if own not in (*parting, *ignore))]
    found = [] if parting else _readable(path, units, ignore, by_corners)
    if not found and annotation:
        try:
            drawing = read_drawing(path, units, parting, without, by_corners)
            found = [(drawing, parting, without)]
        except GeometryError:
            found = [] if parting else _readable(path, units, without, by_corners)
    return found


def _annotation(path) -> list[str]:
    """List the layers with geometry whose names say that they are annotation."""
    return [own for own in boundary_layers(path) if ANNOTATION.search(own)]


def _readable(path, units, ignore, by_corners) -> list[tuple]:
    """List the readings of a drawing in which a single layer holds parting lines."""
    found = []
    for layer in boundary_layers(path):
        if layer in ignore:
            continue
        try:
            drawing = read_drawing(path, units, [layer], ignore, by_corners)
            found.append((drawing, [layer], ignore))
        except GeometryError:
            continue
    return found


def _fixed_and_touched(drawing: Drawing, middle: float) -> tuple[str, list[str]]:
    """Find the edge that lies lowest, and those that reach above the middle of the section."""
    reach: dict[str, list] = {}  # lowest and highest ordinate of every edge
    for contour in (drawing.outline.outer, *drawing.outline.others):
        for segment in contour.segments:
            # nine points find the extent of a line or arc well enough
            ordinates = segment.points(np.linspace(0.0, 1.0, 9))[:, 1]
            own = reach.setdefault(segment.edge, [np.inf, -np.inf])
            own[:] = min(own[0], ordinates.min()), max(own[1], ordinates.max())
    # the edge whose highest point is lowest is the foot
    lowest = min(reach, key=lambda edge: reach[edge][1])
    return lowest, [e for e, (_, top) in reach.items() if e != lowest and top > middle]


def _parts(drawing: Drawing) -> list[tuple]:
    """List names of materials and points of the parts between parting lines, the largest part first."""
    if not drawing.parting:
        return [("rubber", None)]
    boundaries = [np.vstack([p, p[:1]]) for p in drawing.outline.polyline()]
    lines = shapely.union_all([shapely.LineString(own) for own in (*boundaries, *drawing.parting)])
    body = drawing.outline.shape(SAGITTA)
    # faces between all lines, holes left out
    faces = [f for f in shapely.polygonize([lines]).geoms if body.covers(f.representative_point())]
    faces.sort(key=lambda face: -face.area)
    names: list[str] = []
    for number, face in enumerate(faces, 1):
        # a single word in the part is the name of its material
        words = [text for text, at in drawing.texts if face.covers(shapely.Point(at))]
        words = [own for own in words if re.fullmatch(r"[A-Za-z_]\w*", own) and own not in names]
        names.append(words[0] if len(words) == 1 else f"rubber_{number}")
    points = [face.representative_point().coords[0] for face in faces]
    return list(zip(names, points, strict=True))


def _described(drawing: Drawing, parting) -> str:
    """Say which layers are parting lines, and which were left out."""
    said = [f"lines between rubbers on the layers {', '.join(parting)}"] if parting else []
    left = ", ".join(f"{name} ({count} entities)" for name, count in drawing.left_out.items())
    return "; ".join(said + ([f"left out {left}"] if left else [])) or "no layer was ignored"


def _keys(units, parting, ignore) -> str:
    """Write the keys of [section] that the reading of the drawing needs."""
    lines = [f"units = {_quoted(units)}\n"] if units else []
    for key, layers in (("parting", parting), ("ignore", ignore)):
        if layers:
            lines.append(f"{key} = [{', '.join(map(_quoted, layers))}]\n")
    return "".join(lines)


def _quoted(text: str) -> str:
    """Write a text as TOML does."""
    return json.dumps(text, ensure_ascii=False)
