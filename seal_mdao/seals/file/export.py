"""Write a design as a seal file of its own: drawing, cloud, and the tables of its nominal file."""

import os
import re
import textwrap
from copy import deepcopy
from importlib import import_module
from itertools import islice
from pathlib import Path

import numpy as np
import shapely

from seal_mdao.measures.retention import CompressionSet
from seal_mdao.measures.section_shape import Displacement
from seal_mdao.seals.file.build import outline_of
from seal_mdao.seals.file.chosen import write_chosen
from seal_mdao.seals.file.clearance import TYPED, nearest_at_start
from seal_mdao.seals.file.design_table import DesignTable
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.measure_table import places_of
from seal_mdao.seals.outline.cloud_file import write_cloud
from seal_mdao.seals.outline.design import possible_designs
from seal_mdao.seals.outline.dxf import write_dxf
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.sampling import located

HEAD = """# A design of {name} with the particles of its analysis; to generate new particles, replace
# cloud by spacing.
"""
LEFT_OUT = (
    "[[design]] {number} of {name} is left out, because this design does not permit it: {reason}"
)
DRAWN = (
    "outer", "hole", "dxf", "units", "ignore", "parting", "spacing", "accuracy", "layers",
    "edge_spacing", "rays", "cloud",
)  # fmt: skip
"""Keys of a section that the drawing and the cloud replace."""
SHORT_LIST = re.compile(r'\[\n((?: *(?:[\w.+-]+|"[^"\n\\]*"|\[[^\[\]\n]*\]),\n)+) *\]')
"""A list with an item on every line: numbers, names or lists that are on one line."""
LINE = 100
"""Most characters of a list on one line."""

ON_CUT = 1e-6
"""Largest distance of a particle from a line between two materials on which it lies, mm."""


WRITERS = {"ezdxf": "ezdxf", "meshio": "meshio", "tomli_w": "tomli-w"}
"""Packages with which designs are written, by their modules: all in the extra ``dxf``."""


def require_writers() -> None:
    """Import the libraries with which designs are written.

    Raises
    ------
    ImportError
        Without ezdxf, meshio or tomli-w; it names all that are missing.
    """
    missing = []
    for module, package in WRITERS.items():
        try:
            import_module(module)
        except ImportError:
            missing.append(package)
    if missing:
        raise ImportError(
            f"writing a design as a seal file needs {' and '.join(missing)}, not installed: pip "
            "install seal_mdao[dxf]"
        )


def write_design(
    file: SealFile, seal: OutlineSeal, offsets, measures, folder, name: str
) -> list[Path]:
    """Write a design with its particles and load steps: ``NAME.toml``, ``NAME.dxf``, ``NAME.vtu``.

    Parameters
    ----------
    file : SealFile
    seal : OutlineSeal
        That of the file.
    offsets : ndarray, shape (seal.n_offsets,)
        mm.
    measures : sequence of Measure
        All of the file, their places taken.
    folder : str or Path
    name : str

    Returns
    -------
    list of Path

    Raises
    ------
    GeometryError
        For a boundary that crosses itself.
    ImportError
        Without ezdxf, meshio or tomli-w.
    """
    # the section as a drawing, the particles as a mesh, everything else in the seal file
    require_writers()
    writer, folder = import_module("tomli_w"), Path(folder)
    paths = [folder / f"{name}.{kind}" for kind in ("toml", "dxf", "vtu")]
    given = deepcopy(file.given)
    # parting lines of a drawing stay lines of a drawing, on the first of their layers
    between = given["section"].get("parting", ())[:1]
    lines = _moved_lines(seal, offsets)
    drawn = len(file.section.parting)
    parting = dict.fromkeys(between, lines[:drawn])
    outline = outline_of(file, seal, offsets)
    write_dxf(outline, paths[1], parting)
    write_cloud(seal, offsets, paths[2])
    # drawing and cloud replace the keys of outline and filling
    section = {key: value for key, value in given["section"].items() if key not in DRAWN}
    given["section"] = section | {"dxf": paths[1].name, "cloud": paths[2].name}
    if between:
        given["section"]["parting"] = between
    counts = [len(own) for own in file.section.region_lines]
    _move_regions(section.get("region", []), counts, lines[drawn:], seal, offsets)
    # tests of materials and target curves stay where they are, relative to the new file
    for own in (*given["material"].values(), *given.get("measure", ())):
        if "data" in own:
            own["data"] = _from(folder, file.path.parent / own["data"])
    _move_designs(given.get("design", []), seal, offsets)
    refused = _without_impossible_designs(given, file, seal, outline, offsets)
    # what was chosen for the nominal seal holds for the design
    write_chosen(given, file, seal)
    rows = _with_places(given.get("measure", []), file, seal, offsets, measures)
    if rows:
        given["measure"] = rows
    # edges of the nominal section; a cloud has no scheme, from which contact points would follow
    for own, profile in zip(given.get("profile", ()), file.profiles, strict=True):
        own["contact"] = list(profile.contact)
        own["contact_points"] = profile.contact_points
    write_interferences(given, file, outline)
    head = HEAD.format(name=file.path.name) + "".join(refused)
    text = head + on_lines(writer.dumps(given))
    paths[0].write_text(text, encoding="utf-8")
    return paths


def write_interferences(given: dict, file: SealFile, outline) -> None:
    """Write the depths by which profiles lie inside an outline at the start, where it has grown into
    them or they have been moved into it, into the tables ``given`` of the file."""
    for own, profile in zip(given.get("profile", ()), file.profiles, strict=True):
        # a hundredth more, for a drawing is rounded
        inside = -1.01 * nearest_at_start(profile, outline).gap
        if inside > TYPED * outline.size:
            own["interference"] = max(profile.interference, float(f"{inside:.3g}"))


def on_lines(text: str) -> str:
    """Write lists of TOML that have their items on lines of their own on one line where they fit."""

    def joined(found):
        items = " ".join(map(str.strip, found[1].splitlines()))
        line = f"[{items.rstrip(',')}]"
        return line if len(line) <= LINE else found[0]

    # lists of lists after the lists in them
    return SHORT_LIST.sub(joined, SHORT_LIST.sub(joined, text))


def _from(folder, path) -> str:
    """Return a path relative to a folder where it can be."""
    path = path.resolve()
    try:
        return Path(os.path.relpath(path, folder.resolve())).as_posix()
    except ValueError:  # another drive
        return path.as_posix()


def _moved_lines(seal, offsets) -> list:
    """Follow the lines that divide the section by the particles of the design on them."""
    particles, nominal = seal.particles(offsets), shapely.points(seal.nominal_particles)
    found = []
    for cut in seal.cuts:
        # the particles on the line, in order along it
        line = shapely.linestrings(cut)
        on = np.flatnonzero(shapely.distance(line, nominal) <= ON_CUT)
        on = on[np.argsort(shapely.line_locate_point(line, nominal[on]))]
        # a closed line ends at its first point
        found.append(particles[np.append(on, on[:1]) if line.is_closed else on])
    return found


def _move_regions(regions, counts, lines, seal, offsets) -> None:
    """Move points in regions, and the lines between them, with the particles of the design.

    ``counts`` are the numbers of parts of the line of every region, in the order of ``lines``.
    """
    particles, lines = seal.particles(offsets), iter(lines)
    for number, (region, count) in enumerate(zip(regions, counts, strict=True), 1):
        if count:
            # one line across the holes between its parts, which are left out again when it is read
            region["line"] = np.concatenate([*islice(lines, count)]).tolist()
        # the centre of a cell is inside its part
        cell = seal.body.cells[np.flatnonzero(seal.parts == number)[0]]
        region["at"] = particles[cell].mean(axis=0).tolist()


def _move_designs(designs, seal, offsets) -> None:
    """Move the points that designs name with the nearest boundary particles."""
    boundary = np.concatenate(seal.loops)
    nominal, moved = seal.nominal_particles[boundary], seal.particles(offsets)[boundary]
    for design in designs:
        given = [own for own in (design.get("vertex"), design.get("arc")) if own is not None]
        for point in [*given, *design.get("between", ())]:
            nearest = np.hypot(*(nominal - point).T).argmin()
            # a vertex, or a point of an arc, is at a particle afterwards
            on_particle = point in given
            place = moved[nearest] if on_particle else point + moved[nearest] - nominal[nearest]
            point[:] = place.tolist()


def _without_impossible_designs(given, file, seal, outline, offsets) -> list[str]:
    """Remove the designs that the section of a design does not have any more, such as the radius of an
    arc that another design has deformed; return a comment about each of them."""
    particles, rows = seal.particles(offsets), given.get("design", [])
    moved = [DesignTable(**row).made() for row in rows]
    boundaries = [
        located(contour, particles[loop])[0]
        for contour, loop in zip(outline.contours, seal.loops, strict=True)
    ]
    left, refused = possible_designs(boundaries, moved, file.supports)
    if not refused:
        return []
    given["design"] = [rows[index] for index in left]
    if not left:
        # errors of the boundary are those of the edges of designs
        del given["design"]
        tolerance = given.get("tolerance", {})
        tolerance.pop("boundary", None)
        if not tolerance.get("vary"):
            given.pop("tolerance", None)
    return [
        textwrap.fill(
            LEFT_OUT.format(number=index + 1, name=file.path.name, reason=reason), LINE,
            initial_indent="# ", subsequent_indent="# ",
        ) + "\n"
        for index, reason in sorted(refused.items())
    ]  # fmt: skip


def _with_places(rows, file, seal, offsets, measures) -> list:
    """Write the places that measures took from the nominal seal into their tables."""
    # measures that [optimize] names by their type get a table of their own for their places
    rows = {row.get("name", row["type"]): dict(row) for row in rows}
    types = {entry.name: entry for entry in file.measures}
    for measure in measures:
        name, places = measure.name, places_of(measure)
        # the nearest particle has moved with the design
        entry = types[name]
        if isinstance(measure, CompressionSet | Displacement):
            rows[name]["at"] = seal.particles(offsets)[measure.point].tolist()
        if places:
            own = rows.setdefault(name, {"type": entry.type})
            own["places"] = [list(p) if isinstance(p, tuple) else p for p in places]
    return list(rows.values())
