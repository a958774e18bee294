"""A design as a seal file of its own: drawing, cloud, and the tables of the file that it came from."""

import os
import tomllib
from importlib import import_module
from pathlib import Path

import numpy as np

from seal_mdao.seals.file.build import outline_of
from seal_mdao.seals.file.chosen import write_chosen
from seal_mdao.seals.file.measure_table import places_of
from seal_mdao.seals.file.seal_file import SealFile
from seal_mdao.seals.outline.cloud_file import write_cloud
from seal_mdao.seals.outline.dxf import write_dxf
from seal_mdao.seals.outline.outline_seal import OutlineSeal

HEAD = """# A design of {name} with the particles that it was computed with; for new ones put spacing
# in place of cloud.
"""
DRAWN = ("outer", "hole", "dxf", "units", "spacing", "layers", "rays", "cloud")
"""Keys of a section that the drawing and the cloud replace."""

ON_CUT = 1e-6
"""Largest distance of a particle from a line between two materials on which it lies, mm."""


def write_design(
    file: SealFile, seal: OutlineSeal, offsets, measures, folder, name: str
) -> list[Path]:
    """Write a design as ``NAME.toml`` with ``NAME.dxf`` and ``NAME.vtu``, to be analysed as it is, in
    the load steps that it has.

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
    writer, folder = _writer(), Path(folder)
    paths = [folder / f"{name}.{kind}" for kind in ("toml", "dxf", "vtu")]
    write_dxf(outline_of(file, seal, offsets), paths[1])
    write_cloud(seal, offsets, paths[2])
    given = tomllib.loads(file.path.read_text(encoding="utf-8"))
    section = {key: value for key, value in given["section"].items() if key not in DRAWN}
    given["section"] = section | {"dxf": paths[1].name, "cloud": paths[2].name}
    _move_regions(section.get("region", []), seal, offsets)
    for material in given["material"].values():
        if "data" in material:
            material["data"] = _from(folder, file.path.parent / material["data"])
    write_chosen(given, file, seal)
    given["measure"] = _with_places(given.get("measure", []), file, seal, offsets, measures)
    for own, profile in zip(given["profile"], file.profiles, strict=True):
        own["contact_points"] = profile.contact_points
    text = HEAD.format(name=file.path.name) + writer.dumps(given)
    paths[0].write_text(text, encoding="utf-8")
    return paths


def _writer():
    try:
        return import_module("tomli_w")
    except ImportError as error:
        raise ImportError(
            "seal files are written by tomli-w, which is not installed: pip install seal_mdao[dxf]"
        ) from error


def _from(folder, path) -> str:
    """A path relative to a folder, where there is a way."""
    path = path.resolve()
    try:
        return Path(os.path.relpath(path, folder.resolve())).as_posix()
    except ValueError:  # another drive
        return path.as_posix()


def _move_regions(regions, seal, offsets) -> None:
    """Points in regions, and the lines between them, where they are in the design."""
    particles, drawn = seal.particles(offsets), seal.drawn_particles
    cuts = iter(seal.cuts)
    for number, region in enumerate(regions, 1):
        if "line" in region:
            along, away = _along(drawn, next(cuts))
            on = np.flatnonzero(away <= ON_CUT)
            region["line"] = particles[on[np.argsort(along[on])]].tolist()
        cell = seal.body.cells[np.flatnonzero(seal.parts == number)[0]]
        region["at"] = particles[cell].mean(axis=0).tolist()


def _along(points, line):
    """Length along a polyline to the nearest place of every point, and the distance from it."""
    first, side = line[:-1], np.diff(line, axis=0)
    length = np.hypot(*side.T)
    to = points[:, None] - first
    share = np.clip((to * side).sum(axis=-1) / length**2, 0.0, 1.0)
    away = np.hypot(*np.moveaxis(to - share[..., None] * side, -1, 0))
    nearest, every = away.argmin(axis=1), np.arange(len(points))
    starts = np.concatenate([[0.0], np.cumsum(length)])
    return starts[nearest] + (share * length)[every, nearest], away[every, nearest]


def _with_places(rows, file, seal, offsets, measures) -> list:
    """Tables of the measures, with the places that the drawn seal gave them."""
    rows = {row.get("name", row["type"]): dict(row) for row in rows}
    types = {entry.name: entry for entry in file.measures}
    for measure in measures:
        name, places = measure.name, places_of(measure)
        entry = types[name]
        if entry.type == "displacement":
            rows[name]["at"] = seal.particles(offsets)[measure.point].tolist()
        if places:
            own = rows.setdefault(name, {"type": entry.type})
            own["places"] = [list(p) if isinstance(p, tuple) else p for p in places]
    return list(rows.values())
