"""``[section]``: the outline from its segments or from a drawing, what fills it, its materials."""

from collections import defaultdict
from dataclasses import asdict, dataclass, field, replace
from itertools import chain
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, model_validator

from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.seals.file.forms import (
    Distances,
    Percentages,
    Point,
    Points,
    Text,
    many,
    number,
    one_of,
    whole,
)
from seal_mdao.seals.file.schema import Table, key, known, rows, table
from seal_mdao.seals.file.segment_tables import PieceTable
from seal_mdao.seals.outline.arcs import Circle
from seal_mdao.seals.outline.cloud_file import read_cloud
from seal_mdao.seals.outline.contours import JOIN, Contour, Outline
from seal_mdao.seals.outline.dxf import Drawing, read_drawing
from seal_mdao.seals.outline.dxf_entities import MODEL_UNITS, layer_name
from seal_mdao.seals.outline.parting import check_uncrossed, trimmed
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.section_cloud import LAYERS, SLOPE, OutlineCloud
from seal_mdao.seals.outline.segments import pair
from seal_mdao.seals.outline.sizes import ACROSS, DEFAULT_LAYERS, start_spacing, unusual_size
from seal_mdao.seals.wall_grid import WALL_SCHEMES

LEAST_LAYERS = {name: own.basis_order + 1 for name, own in WALL_SCHEMES.items()}
"""Of particles across a wall, by the name of the accuracy."""
MOST_LAYERS = 50
"""That a spacing may have across a wall."""
MOST_PARTICLES = 200_000
"""That a section may need; more is a slip of the spacing."""
FILLINGS = ("spacing", "rays", "cloud")

Edge = Annotated[Text, AfterValidator(layer_name)]
"""Drawings of designs have edges as layers."""


Layers = many(Text, 'a list of layers, such as ["split"]')


@table(kw_only=True)
class OuterTable(PieceTable):
    """Segment of the outer contour; the segments follow one another counter-clockwise and close."""

    edge: Edge = key("name of the edge to which the segment belongs")
    body: whole(1, 1000) = key(
        "number of the body to which the segment belongs, if there are several", 1
    )


@table(kw_only=True)
class HoleTable(PieceTable):
    """Segment of the contour of a hole, in either direction."""

    edge: Edge = key("name of the edge to which the segment belongs")
    hole: whole(1, 1000) = key(
        "number of the hole to which the segment belongs, if there are several", 1
    )


@table
class RaysTable(Table):
    """Particles on radial rows from a centre, for an annular wall."""

    rays: whole(8, 100_000) = key("number of radial rows; the first one points straight down")
    layers: whole(2, 1000) = key("number of particles across the wall; 4 is a suitable value")
    centre: Point = key("origin of the radial rows", (0.0, 0.0))
    accuracy: one_of(*LEAST_LAYERS) = key(
        "setting of kernels, polynomial basis, interpolation of the pressure and contact points",
        Rays.accuracy,
    )

    @model_validator(mode="after")
    def _enough_layers(self):
        # a basis of order p across the wall needs p + 1 particles
        least = LEAST_LAYERS[self.accuracy]
        if self.layers < least:
            raise ValueError(
                f"layers = {self.layers} is too small: the accuracy {self.accuracy!r} needs at "
                f"least {least} layers of particles across the wall; 4 is a suitable value"
            )
        return self


@table
class RegionTable(Table):
    """Part of the section with another material."""

    material: Text = key("name of a material, neither that of [section] nor of another region")
    at: Point | None = key(
        "any point in the part; optional if a drawing has the material name as a text in the part",
        None,
    )
    line: Points | None = key(
        "line that divides the part from the remaining section, from one point of the boundary to "
        "another (parts of it in holes are left out), or a closed line around an insert, whose last "
        "point is its first one; optional for a complete body, and if a drawing has parting lines",
        None,
    )


@table
class WrittenSection(Table):
    """Outline of the section, and how it is filled with particles."""

    material: Text | None = key("name of a material; optional if the file has only one", None)
    spacing: number("mm", above=0.0) | None = key(
        "largest distance of neighbouring particles; it is smaller in thin walls; default "
        f"1/{ACROSS} of the smaller dimension of the section",
        None,
    )
    accuracy: Percentages | None = key(
        "largest admissible estimated error of all measures or of named ones; spacing, layers, "
        "edge_spacing, and load steps and penalties that the file does not give are chosen for it; "
        "given values of spacing, layers and edge_spacing are the start",
        None,
    )
    layers: whole(3, MOST_LAYERS) | None = key(
        f"with spacing: least number of particles across a wall, default {LAYERS}, or "
        f"{DEFAULT_LAYERS} if spacing is left out",
        None,
    )
    edge_spacing: Distances | None = key(
        "with spacing: largest distances of the particles along named edges, smaller than spacing",
        None,
    )
    rays: RaysTable | None = key("instead of spacing, for an annular wall", None)
    cloud: Text | None = key(
        "instead of spacing: mesh file; its path is relative to the seal file", None
    )
    outer: rows(OuterTable) | None = key("segments of the outer contour", None)
    hole: rows(HoleTable) | None = key("segments of the contours of holes", None)
    dxf: Text | None = key(
        "instead of outer and hole: drawing; its path is relative to the seal file", None
    )
    units: one_of(*MODEL_UNITS) | None = key(
        "unit of length of a drawing whose header has none", None
    )
    parting: Layers | None = key("layers of a drawing with the lines between regions", None)
    ignore: Layers | None = key(
        "layers of a drawing that are not read; layers with annotation only need not be listed",
        None,
    )
    region: rows(RegionTable) | None = key("parts of the section with another material", None)

    @model_validator(mode="after")
    def _one_outline(self):
        # segments in this file or a drawing, which has its own holes and units
        nominal = self.dxf is not None
        if nominal == (self.outer is not None):
            has = "both" if nominal else "neither"
            raise ValueError(
                "the outline of the section must be given either by [[section.outer]] or by a "
                f"drawing (dxf), but the seal file has {has}"
            )
        if nominal and self.hole is not None:
            raise ValueError(
                "[[section.hole]] cannot be combined with a drawing (dxf); draw the holes in the "
                "drawing"
            )
        if not nominal and self.units is not None:
            raise ValueError(
                "the key units applies only to a drawing (dxf); leave out units, because all "
                "lengths in a seal file are in mm"
            )
        for name in ("parting", "ignore"):
            if not nominal and getattr(self, name) is not None:
                raise ValueError(
                    f"the key {name} names layers of a drawing, but the seal file has no drawing "
                    f"(dxf); leave out {name}"
                )
        if self.parting is not None and self.region is None:
            raise ValueError(
                "the lines between two materials (layers in parting) have no effect without "
                "[[section.region]]; add a region with the material on one side of these lines"
            )
        return self

    @model_validator(mode="after")
    def _one_filling(self):
        # spacing, which may be left out, rays or cloud; layers are those of a spacing
        given = [name for name in FILLINGS if getattr(self, name) is not None]
        if len(given) > 1:
            raise ValueError(
                "the section needs only one of the keys spacing (largest distance of particles in "
                f"mm), rays (radial rows) and cloud (mesh file), but has {' and '.join(given)}; leave "
                "out all but one"
            )
        spaced = given in ([], ["spacing"])
        if self.accuracy is not None and not spaced:
            raise ValueError(
                f"the key accuracy can only be combined with spacing, but the section has {given[0]}; "
                f"leave out either accuracy or {given[0]}"
            )
        if self.rays is not None and self.region is not None:
            raise ValueError(
                "[[section.region]] cannot be combined with radial rows of particles (rays); use "
                "spacing instead"
            )
        if self.layers is not None and not spaced:
            raise ValueError(
                "the key layers can only be combined with spacing; rays and cloud define their own "
                "layers, so leave out layers"
            )
        if self.edge_spacing is not None and not spaced:
            raise ValueError(
                "the key edge_spacing can only be combined with spacing; rays and cloud define "
                "their own particles, so leave out edge_spacing"
            )
        return self

    def read(self, folder: Path, materials: tuple) -> "SectionTable":
        """Read the section of a file in ``folder``, which its drawing and its cloud are relative to.

        ``materials`` are the names of those in the file.

        Raises
        ------
        SealFileError
            For contours that are open or cross, a drawing or a cloud that cannot be read; without
            a material where the file has several.
        """
        if self.material is None and len(materials) > 1:
            raise SealFileError(
                "[section]: the key 'material' is missing; with several materials it must be one "
                f"of {', '.join(materials)}"
            )
        if self.dxf is None:
            drawing = Drawing(self._segments(), (), (), {})
        else:
            layers = self.parting or (), self.ignore or ()
            drawing = _other_file("dxf", read_drawing, folder / self.dxf, self.units, *layers)
        outline, regions, lines = drawing.outline, [], []
        for i, region in enumerate(self.region or (), 1):
            where = f"[[section.region]] {i}"
            regions.append(_placed(where, region, drawing))
            # a line divides the segments of the boundary that it meets
            outline, parts = _trimmed(where, region.line, outline)
            lines.append(tuple(parts))
        try:
            check_uncrossed([*drawing.parting, *chain.from_iterable(lines)])
        except GeometryError as error:
            raise SealFileError(f"[section]: {error}") from None
        # the largest distance of particles, the rays that they lie on, or they themselves
        filling = self.spacing
        if self.rays is not None:
            filling = Rays(**asdict(self.rays))
        elif self.cloud is not None:
            filling = _other_file("cloud", read_cloud, folder / self.cloud, outline)
        elif filling is None:
            filling = float(f"{start_spacing(np.ptp(outline.box, axis=0)):.3g}")
        # a choice for an accuracy, which starts with fewer layers, is no default
        default = all(getattr(self, name) is None for name in (*FILLINGS, "accuracy"))
        # files that designs and recorders refer to
        beside = (None if name is None else folder / name for name in (self.dxf, self.cloud))
        layers = self.layers or (DEFAULT_LAYERS if default else LAYERS)
        return SectionTable(
            outline, self.material or materials[0], filling, *beside, tuple(regions), layers,
            drawing.parting, drawing.notice, self.edge_spacing or {},
            tuple(lines), self.accuracy, default_spacing=default,
        )  # fmt: skip

    def _segments(self) -> Outline:
        """Make the outline of the segments of this file, body by body and hole by hole."""
        bodies, holes = defaultdict(list), defaultdict(list)
        for row in self.outer:
            bodies[row.body] += row.pieces(row.edge)
        for row in self.hole or ():
            holes[row.hole] += row.pieces(row.edge)
        # the first body is that of the number 1, and so on; contours close by themselves
        outer = [
            _contour("[[section.outer]]" + (f" of body {n}" if len(bodies) > 1 else ""), own)
            for n, own in sorted(bodies.items())
        ]
        inner = [_hole(n, own, 1 + max(holes)) for n, own in sorted(holes.items())]
        try:
            return Outline(outer[0], tuple(inner), tuple(outer[1:]))
        except GeometryError as error:
            raise SealFileError(f"[section]: {error}") from None


@dataclass(frozen=True)
class SectionTable:
    """``[section]``: the outline, and how it is filled with particles.

    Attributes
    ----------
    outline : Outline
    material : str
        Of what is in no region.
    spacing : float, Rays or OutlineCloud
        Largest distance of particles, mm; or the rays that they lie on; or they themselves.
    drawing, cloud : Path or None
        What the outline and the particles were read from.
    regions : tuple of RegionTable
    layers : int
        Of particles across a wall at least, where a spacing fills the section.
    parting : tuple of ndarray, shape (k, 2)
        Lines between regions that a drawing has, mm.
    notice : str
        Line that says what of the drawing was left out; empty for nothing.
    edge_spacing : dict
        Largest distance of particles along edges by their names, mm, beside ``spacing``.
    region_lines : tuple of tuple of ndarray, shape (k, 2)
        Parts of the line of every region that lie in the section, mm.
    accuracy : float, dict of str to float, or None
        Largest relative errors of all measures, or of measures by their names, for which the particles
        are chosen; None where they are given.
    chosen : bool
        Whether they have been chosen (``seals.file.accuracy.with_filling``); until then spacing,
        layers and edge spacing are those to start with.
    default_spacing : bool
        Whether the file gives neither particles nor an accuracy.
    """

    outline: Outline
    material: str
    spacing: float | Rays | OutlineCloud
    drawing: Path | None = None
    cloud: Path | None = None
    regions: tuple[RegionTable, ...] = ()
    layers: int = LAYERS
    parting: tuple = ()
    notice: str = ""
    edge_spacing: dict[str, float] = field(default_factory=dict)
    region_lines: tuple = ()
    accuracy: float | dict[str, float] | None = None
    chosen: bool = False
    default_spacing: bool = False

    @property
    def filling(self) -> dict:
        """Spacing, layers and edge spacing, as ``seals.file.accuracy.with_filling`` takes them."""
        return {
            "spacing": self.spacing, "layers": self.layers, "edge_spacing": dict(self.edge_spacing)
        }  # fmt: skip

    @property
    def cuts(self) -> list:
        """Lines (k, 2) that divide the section: those of the drawing, then those of the regions."""
        return [*self.parting, *chain.from_iterable(self.region_lines)]


def _other_file(key_, read, *arguments):
    """Read another file that a key of the section names."""
    try:
        return read(*arguments)
    except (GeometryError, ImportError) as error:
        raise SealFileError(f"[section]: {key_}: {error}") from None


def _contour(where, segments) -> Contour:
    """Make a contour; what is wrong with it is said of its table."""
    try:
        return Contour(tuple(segments))
    except GeometryError as error:
        raise SealFileError(f"{where}: {error}") from None


def _hole(number: int, segments, unused: int) -> Contour:
    """Make the contour of a hole. A circle beside other segments may be another hole, of a number that
    is ``unused``."""
    where = f"[[section.hole]] of hole {number}"
    try:
        return _contour(where, segments)
    except SealFileError as error:
        if len(segments) == 1 or not any(isinstance(own, Circle) for own in segments):
            raise
        raise SealFileError(f"{error}; segments of another hole need hole = {unused}") from None


def _placed(where: str, region: RegionTable, drawing: Drawing) -> RegionTable:
    """Give a region without ``at`` the place of the text in the drawing that names its material."""
    if region.at is not None:
        return region
    named = [at for text, at in drawing.texts if text.casefold() == region.material.casefold()]
    if len(named) != 1:
        found = f"{len(named)} texts" if named else "no text"
        raise SealFileError(
            f"{where}: the key 'at' is missing, and the drawing has {found} {region.material!r}; "
            "give a point inside the region, or write the name of its material into the region "
            "exactly once"
        )
    return replace(region, at=named[0])


def _trimmed(where: str, line, outline: Outline) -> tuple[Outline, list]:
    """Trim the line of a region at the boundary, which it divides; no parts without a line."""
    if line is None:
        return outline, []
    if len(line) == 2 and np.hypot(*np.subtract(*line)) <= JOIN:
        raise SealFileError(
            f"{where}: the line between two materials begins and ends at {pair(line[0])}; it must "
            "connect two different points of the boundary"
        )
    try:
        return trimmed(outline, line)
    except GeometryError as error:
        raise SealFileError(f"{where}: line {error}") from None


def check_section(file) -> None:
    """Raise SealFileError for unknown materials, and a spacing with no or too many particles."""
    # material of the rest, spacing, then region by region
    section, outline = file.section, file.section.outline
    known("[section]", "material", section.material, tuple(file.materials), "material")
    if isinstance(section.spacing, float):
        _check_spacing(section.spacing, outline)
        _check_edge_spacing(section)
    # constants of a material have its name, so every part has another one
    seen = {section.material: "[section]"}
    for number_, region in enumerate(section.regions, 1):
        where = f"[[section.region]] {number_}"
        known(where, "material", region.material, tuple(file.materials), "material")
        if region.material in seen:
            raise SealFileError(
                f"{where}: material = {region.material!r}, but {seen[region.material]} already has "
                "this material; give every region a different material (two materials may have "
                "equal constants)"
            )
        seen[region.material] = where
        _check_region(where, region, section)


def _check_spacing(spacing, outline) -> None:
    """Refuse a spacing of half the section's width, or of more particles than can be analysed."""
    extent = np.ptp(outline.box, axis=0)
    small, size = float(extent.min()), unusual_size(extent)
    hint = f" ({size})" if size else ""
    if spacing >= 0.5 * small:
        raise SealFileError(
            f"[section]: spacing = {spacing:g} mm is not less than half of the smaller dimension of "
            f"the section, {small:.4g} mm; choose a smaller spacing" + hint
        )
    # about area / spacing^2 particles
    least = np.sqrt(outline.area / MOST_PARTICLES)
    if spacing < least:
        raise SealFileError(
            f"[section]: spacing = {spacing:g}, which needs more than {MOST_PARTICLES} particles; it "
            f"must be at least {least:.3g}" + hint
        )


def _check_edge_spacing(section) -> None:
    """Refuse unknown edges, and distances that refine nothing or need too many particles."""
    segments = [s for contour in section.outline.contours for s in contour.segments]
    for edge, h in section.edge_spacing.items():
        known("[section]", "edge_spacing", edge, sorted({s.edge for s in segments}), "edge")
        if h >= section.spacing:
            raise SealFileError(
                f"[section]: edge_spacing: {edge} = {h:g}, which must be less than spacing = "
                f"{section.spacing:g}"
            )
        # int dA / (h + SLOPE d)^2 over the distance d from an edge of length L:  L / (SLOPE h)
        least = sum(s.length for s in segments if s.edge == edge) / SLOPE / MOST_PARTICLES
        if h < least:
            raise SealFileError(
                f"[section]: edge_spacing: {edge} = {h:g}, which needs more than {MOST_PARTICLES} "
                f"particles; it must be at least {least:.3g}"
            )


def _check_region(where, region, section) -> None:
    """Refuse a region without a line in a single body."""
    if region.line is None and not (section.parting or section.outline.others):
        raise SealFileError(
            f"{where}: the key 'line' is missing; give the line that divides the region from the "
            "rest of the body, or name its layer in parting of [section]"
        )
