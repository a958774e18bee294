"""Optimisation problem of the table ``[optimize]`` of a seal file, over the parameters of
``[[design]]``."""

import hashlib
import tomllib
from dataclasses import replace

import numpy as np

from seal_mdao.components.rkpm_contact_comp import BESIDE
from seal_mdao.errors import SealFileError
from seal_mdao.file_seal import build_seal
from seal_mdao.measures.gap import BetweenContacts
from seal_mdao.measures.load_deflection import ForceTarget, LoadDeflectionError
from seal_mdao.measures.reaction import Reaction
from seal_mdao.optimization import Limit, Task
from seal_mdao.rkpm.cells import in_both_directions
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.described import FILE, FILE_NAME, named_in
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.design_parameters import dependent_parameters, inverting_limits
from seal_mdao.seals.outline.layers import ENOUGH, thin_wall
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.section_cloud import LONGEST, Kernels, OutlineCloud, longest_side
from seal_mdao.seals.result import SealResult, analyze, frozen_measures, is_empty
from seal_mdao.seals.seal import Seal

CHECKSUMS = "checksums"
"""What a recorder file calls the checksums of the files that a seal file names."""
CHOSEN = "chosen"
"""What a recorder file calls particles, load steps and penalties that were chosen, as ``build_seal``
takes them."""

FILLING = ("spacing", "layers", "edge_spacing")
"""Attributes of a section that give its cloud."""


def file_task(file: SealFile, nominal: SealResult) -> Task:
    """Set up the optimisation that a seal file defines.

    Parameters
    ----------
    file : SealFile
    nominal : SealResult
        Its nominal seal, analysed (``RunOptions.analyze``).

    Raises
    ------
    SealFileError
        For a file without ``[optimize]`` or ``[[design]]``, or whose measures are empty.
    LoadPathError
        When the path of the nominal seal was not completed.
    """
    seal = nominal.seal
    require_problem(file, seal)
    measures, start = optimized_measures(file, seal, nominal)
    aim, bounds = file.optimize.minimize, design_bounds(file, seal)
    # -b <= offset <= b, scaled to [-1/2, 1/2]
    variables = {"boundary_offsets": {"lower": -bounds, "upper": bounds, "ref": 2.0 * bounds}}
    limits = tuple(
        _limit(f"{file.path}: [[optimize.constraint]] {i}", constraint, start)
        for i, constraint in enumerate(file.optimize.constraints, 1)
    )
    chosen = {CHOSEN: chosen_for(file, seal)} if file.leaves_open else {}
    settings = problem_settings(file) | chosen
    return Task(seal, aim, float(start[aim][0]), measures, variables, limits, settings)


def _limit(where: str, constraint, start: dict) -> Limit:
    """The limits of a measure, scaled by the largest bound, or by the start where that is zero.

    Lists of bounds have a scale for every value.
    """
    name = constraint.measure
    constraint.check_size(where, start[name].size)
    given = {"lower": constraint.lower, "upper": constraint.upper}
    bounds = {
        side: np.array(own) if isinstance(own, tuple) else own
        for side, own in given.items()
        if own is not None
    }
    largest = np.max(np.broadcast_arrays(*map(np.abs, bounds.values())), axis=0)
    size = np.where(largest > 0.0, largest, float(np.abs(start[name]).max()) or 1.0)
    return Limit(name, **bounds, ref=size if size.ndim else float(size))


def on_new_cloud(design: SealFile, nominal: SealFile) -> tuple[SealFile, SealResult]:
    """Analyse a design with new particles, to estimate the influence of those that it was optimised
    with.

    Parameters
    ----------
    design : SealFile
        As ``write_design`` writes it.
    nominal : SealFile
        Whose section gives spacing or rays and layers of the new cloud; where it names a
        mesh file, its cells give them.

    Returns
    -------
    SealFile
        The design with the new particles.
    SealResult

    Raises
    ------
    SealFileError
        For a section that cannot be filled so, and a mesh file with other shape functions than those
        of a ``spacing``.
    """
    # given places are particles of the old cloud
    measures = tuple(m for m in design.measures if m.arguments.get("places") is None)
    filling = {name: getattr(nominal.section, name) for name in FILLING}
    if isinstance(nominal.section.spacing, OutlineCloud):
        filling |= _filling_like(nominal.section.spacing)
    section = replace(design.section, **filling)
    file = replace(design, section=section, measures=measures, optimize=None)
    return file, analyze(build_seal(file))


def _filling_like(given: OutlineCloud) -> dict:
    """Return the ``FILLING`` with which a section gets cells like those of a mesh file.

    Raises
    ------
    SealFileError
        For other shape functions or pressures than those of a ``spacing``.
    """
    kernels = given.kernels or Kernels()
    own, default = (
        (kind.basis_order, kind.column, in_both_directions(kind.n_gauss))
        for kind in (kernels, Kernels)
    )
    if own != default or given.support_axes is not None:
        raise SealFileError(
            "the mesh file named by cloud has other shape functions than new particles would have"
        )
    # cells are up to a quarter longer than the spacing
    spacing = longest_side(given.cells, given.particles) / LONGEST
    thinnest = thin_wall(given.loops, given.particles, given.cells)
    layers = ENOUGH if thinnest is None else max(thinnest.layers, 2)
    # the longest side of every edge
    sides = {}
    for boundary in given.boundaries:
        side = np.hypot(*(np.roll(boundary.points, -1, axis=0) - boundary.points).T)
        for edge, length in zip(boundary.edge.tolist(), side.tolist(), strict=True):
            sides[edge] = max(sides.get(edge, 0.0), length)
    fine = {edge: length for edge, length in sides.items() if length < spacing}
    return {"spacing": spacing, "layers": layers, "edge_spacing": fine}


def optimized_measures(file: SealFile, seal: Seal, nominal: SealResult) -> tuple[tuple, dict]:
    """Return the measures of ``[optimize]`` with their evaluation points, and their values in the
    nominal seal by name.

    Raises
    ------
    SealFileError
        For measures that are empty, or zero already.
    LoadPathError
        When the path of the nominal seal was not completed.
    """
    nominal.require_converged()
    measures = frozen_measures(seal, measure_names(file), lambda seal: nominal)
    empty = [measure.name for measure in measures if is_empty(measure, seal)]
    if empty:
        raise SealFileError(
            f"{file.path}: [optimize]: the measure {empty[0]!r} has no value, because the nominal "
            "seal has no gap between points in contact at the end of the analysis; choose another "
            "measure"
        )
    start = {measure.name: nominal.value(measure) for measure in measures}
    _require_gap(file, measures, start)
    return measures, start


def require_problem(file: SealFile, seal: Seal) -> None:
    """Raise SealFileError for a file without ``[optimize]`` or ``[[design]]``."""
    if file.optimize is None:
        raise SealFileError(
            f"{file.path}: [optimize] is missing; name the measure to minimise, such as minimize = "
            '"section_area"'
        )
    if not seal.n_offsets:
        raise SealFileError(
            f"{file.path}: [[design]] is missing; name the edges of the section that may change, "
            'such as edges = ["top"]'
        )
    for where, own in file.located_measures:
        if own.name in BESIDE and own.name in measure_names(file):
            raise SealFileError(
                f"{file.path}: {where}: name = {own.name!r} is reserved in an optimisation; give "
                "this measure another name"
            )


def _require_gap(file, measures, start) -> None:
    """Refuse to minimise a gap that is closed in the nominal seal."""
    aim = next(m for m in measures if m.name == file.optimize.minimize)
    if isinstance(aim, BetweenContacts) and not start[aim.name].any():
        raise SealFileError(
            f"{file.path}: [optimize]: the measure {aim.name!r} is already zero, because the "
            "nominal seal has no gap between points in contact at the end of the analysis; "
            "minimise another measure"
        )


def force_targets(file: SealFile, seal: Seal) -> list[ForceTarget]:
    """List target curves and bounds of forces at travels that the optimisation uses."""
    known, found = {measure.name: measure for measure in seal.standard}, []
    aim = known[file.optimize.minimize]
    if isinstance(aim, LoadDeflectionError):
        found.append(ForceTarget(aim.name, aim.base, np.array(aim.targets)))
    for constraint in file.optimize.constraints:
        own = known[constraint.measure]
        if (
            isinstance(own, Reaction)
            and own.travels is not None
            and own.size(seal) == len(own.travels)
        ):
            bounds = (constraint.lower, constraint.upper)
            every = (None if b is None else np.broadcast_to(b, len(own.travels)) for b in bounds)
            found.append(ForceTarget(own.name, own, None, *every))
    return found


def measure_names(file: SealFile) -> tuple:
    """Return the names of the measures that the optimisation uses, each once."""
    constraints = (constraint.measure for constraint in file.optimize.constraints)
    return tuple(dict.fromkeys([file.optimize.minimize, *constraints]))


def design_bounds(file: SealFile, seal: OutlineSeal) -> np.ndarray:
    """Return the largest value of every design parameter of the seal of a file, mm."""
    # every design has as many parameters as its seal says
    pairs = zip(file.designs, seal.design_sizes, strict=True)
    return np.concatenate([np.full(size, design.bound) for design, size in pairs])


def design_warnings(file: SealFile, seal: OutlineSeal) -> tuple[str, ...]:
    """Warn of design parameters of a file that move the boundary in the same way, and of limits that
    permit a wall to be inverted."""
    if not seal.n_offsets:
        return ()
    return (*dependent_parameters(seal), *inverting_limits(seal, design_bounds(file, seal)))


def problem_settings(file: SealFile) -> dict:
    """Return what a recorder file stores of the seal file: its name, its tables, and checksums of the
    files that it names."""
    tables, folder = tomllib.loads(file.path.read_text(encoding="utf-8")), file.path.parent
    # drawing, cloud, tests of materials, target curves
    sums = {
        name: hashlib.sha256((folder / name).read_bytes()).hexdigest() for name in named_in(tables)
    }
    return {FILE_NAME: file.path.name, FILE: tables, CHECKSUMS: sums}
