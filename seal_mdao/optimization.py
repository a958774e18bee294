"""Problem (71) as an OpenMDAO problem: close the gap, within stress, area and size limits."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver

from seal_mdao.components.seal_group import SealGroup
from seal_mdao.drivers.ipopt_driver import IpoptDriver
from seal_mdao.drivers.run_support import RunSupport
from seal_mdao.drivers.slsqp_driver import ResilientSLSQPDriver
from seal_mdao.model import OFFSET_BOUND, SealModel
from seal_mdao.recording.recorder import RestartRecorder, record_all
from seal_mdao.seal import SealResult, analyze

AREA_LIMIT = 110.0
"""mm^2."""
STRESS_SHARE, STRESS_FLOOR = 0.8, 100.0
"""Each stress has to fall to this share of its start, but not below the floor (kPa)."""
FORCE_BAND = 0.1
"""Relative change of the vertical reaction that ``keep_force`` allows."""

OBJECTIVE_REF = 2.0
"""Scaled objective 1 is this multiple of the start: it sets the length of SLSQP's first step."""
TOLERANCE = 1e-6
"""The optimisers' accuracy, in units of the scaled objective."""
PROBLEM_OPTION = "problem_settings"
"""Option of the recorded model with the other arguments of ``seal_problem`` that define the problem,
as JSON: what a restart needs to set up the same problem again."""


def slsqp_driver(max_iterations: int = 50) -> Driver:
    """SLSQP that backs off when an analysis fails."""
    return ResilientSLSQPDriver(tol=TOLERANCE, maxiter=max_iterations, disp=False)


def ipopt_driver(max_iterations: int = 200) -> Driver:
    """IPOPT; needs the extra ``ipopt``."""
    return IpoptDriver(tol=TOLERANCE, maxiter=max_iterations, disp=False)


OPTIMIZERS = {"SLSQP": slsqp_driver, "IPOPT": ipopt_driver}
"""Drivers by name; all settings of the optimisers are here and in the constants above."""


@dataclass(frozen=True, eq=False)
class Limits:
    """Limits of problem (71), fixed by the drawn seal.

    Attributes
    ----------
    gap_square_sum : float
        Start value of the cost, mm^2.
    area : float
        Upper limit, mm^2.
    von_mises : ndarray, shape (7,)
        Upper limits, kPa.
    force : tuple of float
        Lower and upper limit of the vertical reaction when it is kept, N/m.
    door_radius : tuple of float
        Bounds, mm.
    """

    gap_square_sum: float
    area: float
    von_mises: np.ndarray
    force: tuple
    door_radius: tuple


def problem_limits(drawn: SealResult) -> Limits:
    """Limits that follow from the analysis of the drawn seal.

    Raises
    ------
    ValueError
        When no gap opens under the drawn seal: there is nothing to minimise.
    """
    model, cost = drawn.model, drawn.gap_square_sum
    if not cost > 0.0:
        raise ValueError(
            "no contact point of the drawn seal stands open between others in contact, so the gap "
            "to minimise is zero; choose a larger depth"
        )
    force, radius = drawn.reaction[-1, 1], model.drawn_door_radius
    return Limits(
        gap_square_sum=cost,
        area=AREA_LIMIT,
        von_mises=np.maximum(STRESS_SHARE * drawn.von_mises, STRESS_FLOOR),
        force=((1 - FORCE_BAND) * force, (1 + FORCE_BAND) * force),
        door_radius=(radius - OFFSET_BOUND, radius + OFFSET_BOUND),
    )


def seal_problem(
    model: SealModel,
    *,
    keep_force: bool = False,
    driver: Driver | None = None,
    recorder=None,
    callback=None,
    work_dir=None,
    reports=None,
) -> om.Problem:
    """Problem (71): min gap_square_sum over boundary offsets and door radius, set up to run.

    Parameters
    ----------
    model : SealModel
    keep_force : bool
        Keep the vertical reaction at the end of the path within 10 % of its start.
    driver : Driver, optional
        SLSQP when left out.
    recorder : str, Path or CaseRecorder, optional
        Where every model evaluation is recorded, with all that figures and restarts need.
    callback : callable, optional
        Called with every converged load step.
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
    ValueError
        When no gap opens under the drawn seal.
    LoadPathError
        When the drawn seal cannot be analysed.
    """
    drawn = analyze(model)
    drawn.require_converged()
    limits = problem_limits(drawn)
    options = {} if work_dir is None else {"work_dir": str(work_dir)}
    problem = om.Problem(
        SealGroup(model=model, callback=callback), driver=driver or slsqp_driver(), reports=reports,
        **options,
    )  # fmt: skip
    _add_variables(problem.model, limits)
    _add_responses(problem.model, limits, keep_force)
    settings = {"keep_force": keep_force}
    problem.model.options.declare(PROBLEM_OPTION, default=json.dumps(settings), types=str)
    if recorder is not None:
        _record(problem, recorder)
    problem.setup()
    return problem


def _add_variables(group: om.Group, limits: Limits) -> None:
    low, high = limits.door_radius
    middle = 0.5 * (low + high)
    group.add_design_var("boundary_offsets", lower=-OFFSET_BOUND, upper=OFFSET_BOUND)
    group.add_design_var("door_radius", lower=low, upper=high, ref0=middle, ref=middle + 1.0)


def _add_responses(group: om.Group, limits: Limits, keep_force: bool) -> None:
    group.add_objective("gap_square_sum", ref=OBJECTIVE_REF * limits.gap_square_sum)
    group.add_constraint("area", upper=limits.area, ref=limits.area)
    group.add_constraint("von_mises", upper=limits.von_mises, ref=limits.von_mises)
    if keep_force:
        low, high = limits.force
        group.add_constraint("reaction", indices=[1], lower=low, upper=high, ref=0.5 * (low + high))


def _record(problem: om.Problem, recorder) -> None:
    """Record every evaluation; derivatives mark those that begin a major iteration."""
    if isinstance(recorder, str | Path):
        recorder = RestartRecorder(Path(recorder).absolute())
    record_all(problem.driver, recorder)


def major_iterations(problem: om.Problem) -> int | None:
    """Major iterations that the optimiser itself counted, None when it does not tell."""
    driver = problem.driver
    return driver.result.iter_count if isinstance(driver, RunSupport) else None
