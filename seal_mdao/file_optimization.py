"""``[optimize]`` of a seal file as an OpenMDAO problem over the parameters of its ``[[design]]``."""

import hashlib
from dataclasses import replace

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver

from seal_mdao.components.rkpm_contact_comp import BESIDE
from seal_mdao.components.seal_group import SealGroup
from seal_mdao.errors import SealFileError
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.measures.contact import BetweenContacts
from seal_mdao.optimization import OBJECTIVE_REF, new_problem, set_up
from seal_mdao.seals.file.build import build_seal
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.section_cloud import LAYERS
from seal_mdao.seals.result import SealResult, analyze, frozen_measures, is_empty
from seal_mdao.seals.seal import Seal

CHOSEN = "chosen"
"""What a recorder file calls load steps and penalties that were chosen, as ``build_seal`` takes them."""


def file_problem(
    file: SealFile,
    seal: OutlineSeal,
    *,
    driver: Driver | None = None,
    recorder=None,
    callback=None,
    kept: KeptAnalyses | None = None,
    work_dir=None,
    reports=None,
) -> om.Problem:
    """The optimisation that a seal file asks for, set up to run.

    Parameters
    ----------
    file : SealFile
    seal : OutlineSeal
        That of the file.
    driver : Driver, optional
        Uno when left out.
    recorder : str, Path or CaseRecorder, optional
        Where every model evaluation is recorded, with all that figures and restarts need.
    callback : callable, optional
        Called with every converged load step.
    kept : KeptAnalyses, optional
        Keeps the analyses for whoever looks at the designs afterwards; a new one when left out.
    work_dir : str or Path, optional
        Folder of OpenMDAO's own output; the current one when left out.
    reports : optional
        OpenMDAO reports to write, as for ``Problem``; none when left out.

    Returns
    -------
    Problem
        After ``setup``, at the drawn seal.

    Raises
    ------
    SealFileError
        For a file without ``[optimize]`` or ``[[design]]``, or whose measures are empty.
    LoadPathError
        When the drawn seal cannot be analysed.
    """
    require_problem(file, seal)
    kept = KeptAnalyses() if kept is None else kept
    drawn = kept.analyze(seal, keep_factors=True, callback=callback)
    measures, start = optimized_measures(file, seal, drawn)
    group = SealGroup(seal=seal, callback=callback, measures=measures, kept=kept)
    problem = new_problem(group, driver, work_dir, reports)
    bounds = design_bounds(file)
    group.add_design_var("boundary_offsets", lower=-bounds, upper=bounds, ref=2.0 * bounds)
    size = OBJECTIVE_REF * abs(float(start[file.optimize.minimize][0]))
    group.add_objective(file.optimize.minimize, ref=size or 1.0)
    _add_constraints(group, file, start)
    chosen = {CHOSEN: chosen_for(file, seal)} if file.leaves_open else {}
    set_up(problem, problem_settings(file) | chosen, recorder)
    return problem


def on_new_cloud(design: SealFile, filling, layers: int = LAYERS) -> SealResult:
    """A design analysed with new particles: what its numbers owe to those that it was optimised with.

    Parameters
    ----------
    design : SealFile
        As ``write_design`` writes it.
    filling : float or Rays
        Spacing of the new cloud, mm, or its rays.
    layers : int
        Of particles across a wall at least, with a spacing.

    Raises
    ------
    SealFileError
        For a section that cannot be filled so.
    """
    measures = tuple(m for m in design.measures if m.arguments.get("places") is None)
    section = replace(design.section, spacing=filling, layers=layers)
    return analyze(build_seal(replace(design, section=section, measures=measures, optimize=None)))


def optimized_measures(file: SealFile, seal: Seal, drawn: SealResult) -> tuple[tuple, dict]:
    """Measures of ``[optimize]`` with their places, and their values in the nominal seal by name.

    Raises
    ------
    SealFileError
        For measures that are empty, or zero already.
    LoadPathError
        When the path of the nominal seal was not completed.
    """
    drawn.require_converged()
    measures = frozen_measures(seal, measure_names(file), lambda seal: drawn)
    empty = [measure.name for measure in measures if is_empty(measure, seal)]
    if empty:
        raise SealFileError(
            f"{file.path}: [optimize]: the measure {empty[0]!r} has no value: at the end of the drawn "
            "seal's path nothing stands open between points in contact"
        )
    start = {measure.name: drawn.value(measure) for measure in measures}
    _require_gap(file, measures, start)
    return measures, start


def require_problem(file: SealFile, seal: Seal) -> None:
    """Raise SealFileError for a file without ``[optimize]`` or ``[[design]]``."""
    if file.optimize is None:
        raise SealFileError(f"{file.path}: [optimize] is missing: say what to minimize")
    if not seal.n_offsets:
        raise SealFileError(f"{file.path}: [[design]] is missing: say which edges may move")
    for name in measure_names(file):
        if name in BESIDE:
            raise SealFileError(
                f"{file.path}: [[measure]]: name = {name!r} is taken in an optimisation; give "
                "the measure another name"
            )


def _require_gap(file, measures, start) -> None:
    """Refuse to minimise a gap that is closed in the nominal seal."""
    aim = next(m for m in measures if m.name == file.optimize.minimize)
    if isinstance(aim, BetweenContacts) and not start[aim.name].any():
        raise SealFileError(
            f"{file.path}: [optimize]: the measure {aim.name!r} is zero at the start: at the end of the "
            "nominal seal's path nothing stands open between points in contact; minimise something else"
        )


def measure_names(file: SealFile) -> tuple:
    """Measures that the optimisation looks at, each once."""
    constraints = (constraint.measure for constraint in file.optimize.constraints)
    return tuple(dict.fromkeys([file.optimize.minimize, *constraints]))


def design_bounds(file: SealFile) -> np.ndarray:
    """Largest offset of every design parameter, mm."""
    return np.concatenate(
        [np.full(design.parameters * len(design.edges), design.bound) for design in file.designs]
    )


def problem_settings(file: SealFile) -> dict:
    """What a recorder file keeps of the seal file: its text, checksums of its drawing and cloud."""
    text = file.path.read_text(encoding="utf-8")
    beside = {"drawing": file.section.drawing, "cloud": file.section.cloud}
    sums = {
        name: hashlib.sha256(path.read_bytes()).hexdigest()
        for name, path in beside.items()
        if path is not None
    }
    return {"seal_file": text} | sums


def _add_constraints(group: om.Group, file: SealFile, start: dict) -> None:
    """A measure may be constrained twice, or be the objective as well: then under another name."""
    used = {file.optimize.minimize}
    for number, constraint in enumerate(file.optimize.constraints, start=1):
        name = constraint.measure
        limits = [abs(v) for v in (constraint.lower, constraint.upper) if v is not None]
        size = max(limits) or float(np.abs(start[name]).max()) or 1.0
        alias = f"{name}_{number}" if name in used else None
        group.add_constraint(
            name, lower=constraint.lower, upper=constraint.upper, ref=size, alias=alias
        )
        used.add(name)
