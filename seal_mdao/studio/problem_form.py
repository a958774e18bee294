"""Form of the page for the problem: fixed edges, contact edges, design, objective and constraints;
and seal files of drawings that are dropped on it."""

import tomllib
from copy import deepcopy
from importlib import import_module
from pathlib import Path

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.export import on_lines, write_interferences
from seal_mdao.seals.file.from_drawing import LAYERED, from_drawing
from seal_mdao.seals.file.measure_types import KINDS
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.studio.project import Project, ProjectError
from seal_mdao.studio.workbench import Workbench

MEASURES = (
    "section_area", "reaction", "peak_pressure", "contact_width", "von_mises",
    "gap_square_sum", "wall_thickness", "strain_energy",
)  # fmt: skip
"""Measures that the page offers; all are types that need no further key."""


def offered(bench: Workbench) -> dict:
    """Return the content of the form: edges with their lines (mm), measures, the present
    problem."""
    outline, tables = bench.file.section.outline, bench.tables
    designs = tables.get("design", [])
    moving = [own for own in designs if "edges" in own]
    optimize = tables.get("optimize", {})
    names = [*MEASURES, *(own.name for own in bench.measures)]
    return {
        "edges": {
            name: [segment.points(segment.chords(0.1)).tolist() for segment in outline.edge(name)]
            for name in outline.edge_names
        },
        "fixed": list(tables.get("fixed", {}).get("edges", ())),
        "pressed": list(bench.file.profiles[0].contact) if bench.file.profiles else [],
        "moving": sorted({name for own in moving for name in own["edges"]}),
        "parameters": moving[0].get("parameters", 4) if moving else 4,
        "bound": moving[0]["bound"] if moving else 0.4,
        "measures": sorted({name for name in names if name in KINDS or name not in MEASURES}),
        "minimize": optimize.get("minimize"),
        "limits": [
            {key: own.get(key) for key in ("measure", "lower", "upper")}
            for own in optimize.get("constraint", ())
            if not _is_listed(own)
        ],
        "unseen": [own["measure"] for own in optimize.get("constraint", ()) if _is_listed(own)],
    }  # fmt: skip


def _is_listed(limit: dict) -> bool:
    """Whether a limit has a value for every value of its measure, which the form does not show."""
    return any(isinstance(limit.get(side), list) for side in ("lower", "upper"))


def write_problem(bench: Workbench, design: list, problem: dict, path: Path) -> None:
    """Write the seal file with another problem, and with the numbers of the page except its
    offsets.

    Parameters
    ----------
    bench : Workbench
    design : list of float
    problem : dict
        ``fixed``, ``pressed``, ``moving``: names of edges; ``parameters`` and ``bound`` (mm) of those
        that move; ``minimize``: a measure or None; ``limits``: list of ``measure``, ``lower``,
        ``upper``.
    path : Path
        Of the new file, in the folder of the first one.

    Raises
    ------
    SealFileError
        For a problem that the seal cannot have; no file is written then.
    """
    tables = deepcopy(bench.tables)
    bench.write_numbers(tables, design)
    write_interferences(tables, bench.placed(design), bench.file.section.outline)
    if problem["fixed"]:
        tables["fixed"] = tables.get("fixed", {}) | {"edges": problem["fixed"]}
    else:
        tables.pop("fixed", None)
    if problem["pressed"] and tables.get("profile"):
        tables["profile"][0]["contact"] = problem["pressed"]
    shown = offered(bench)
    # edges that move as before keep their symmetry, their own bounds and so on
    now = [sorted(problem["moving"]), problem["parameters"], problem["bound"]]
    if now != [shown["moving"], shown["parameters"], shown["bound"]]:
        # designs of vertices and arcs stay
        designs = [own for own in tables.pop("design", []) if "edges" not in own]
        if problem["moving"]:
            designs.append({
                "edges": problem["moving"], "parameters": problem["parameters"],
                "bound": problem["bound"],
            })  # fmt: skip
        if designs:
            tables["design"] = designs
    # limits that the form does not show stay
    before = tables.pop("optimize", {}).get("constraint", ())
    unseen = [own for own in before if _is_listed(own)]
    if problem["minimize"]:
        limits = [
            {key: value for key, value in own.items() if value is not None}
            for own in problem["limits"]
        ]
        tables["optimize"] = {"minimize": problem["minimize"]}
        if limits or unseen:
            tables["optimize"]["constraint"] = [*limits, *unseen]
    text = on_lines(import_module("tomli_w").dumps(tables))
    path.write_text(f"# {bench.path.name} with another problem.\n{text}", encoding="utf-8")
    try:
        # what cannot be read or filled is said now, not when it is opened
        unchosen_seal(read_seal_file(path))
    except ValueError as error:
        path.unlink()
        raise SealFileError(str(error).replace(f"{path}: ", "")) from error


def write_drawing(project: Project, name: str, content: bytes) -> tuple[str, str]:
    """Write a drawing that was dropped, and its seal file; return the name of that and a remark.

    Raises
    ------
    ProjectError
        For a name that is no drawing of the folder.
    GeometryError, SealFileError, ImportError
        For a drawing that is no section.
    """
    path = project.path(name)
    if path.suffix.lower() != ".dxf":
        raise ProjectError("only drawings with the ending .dxf can be dropped here")
    stem = project.new(path.stem, (".toml", LAYERED))
    if path.exists() and path.read_bytes() != content:
        # the drawing of that name stays as it is
        path = project.path(f"{project.new(path.stem, ('.dxf',))}.dxf")
    known, remarks = path.exists(), []
    path.write_bytes(content)
    try:
        text = from_drawing(stem, path, project.folder, report=remarks.append)
        tomllib.loads(text)
    except (ValueError, ImportError):
        if not known:
            path.unlink()
        raise
    project.path(f"{stem}.toml").write_text(text, encoding="utf-8")
    return f"{stem}.toml", " ".join(remarks).replace(f"{project.folder}/", "")
