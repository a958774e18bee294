"""Problem (71) as an OpenMDAO problem: close the gap, within stress, area and size limits."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver

from seal_mdao.components.seal_group import SealGroup
from seal_mdao.drivers.ipopt_driver import IpoptDriver
from seal_mdao.drivers.optimizer_driver import OptimizerDriver
from seal_mdao.drivers.slsqp_driver import SlsqpDriver
from seal_mdao.drivers.uno_driver import UnoDriver
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.recording.recorder import RestartRecorder, record_all
from seal_mdao.recording.settings import PROBLEM_OPTION
from seal_mdao.seals.door.door_seal import OFFSET_BOUND, STANDARD
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.seal import Seal

AREA_LIMIT = 110.0
"""mm^2."""
STRESS_SHARE, STRESS_FLOOR = 0.8, 100.0
"""Each stress has to fall to this share of its start, but not below the floor (kPa)."""
FORCE_BAND = 0.1
"""Relative change of the vertical reaction that ``keep_force`` and ``clamp_load`` allow."""
PRESSURE_SHARE = 0.5
"""Share of the drawn seal's contact pressure that ``pressure_floor`` asks of each patch."""

NEGLIGIBLE_GAP = 1e-3
"""Gaps of the drawn seal, mm, below which there is nothing to optimise: a penalty leaves as much."""
OBJECTIVE_REF = 2.0
"""Scaled objective 1 is this multiple of the start: it sets the length of SLSQP's first step."""
TOLERANCE = 1e-6
"""Accuracy of the constraints, scaled; for SLSQP also that of the objective."""
OPTIMALITY = 1e-3
"""Largest entry of the scaled Lagrangian's gradient at which Uno and IPOPT stop.

The cost is zero where the gap is closed, and its derivative jumps where a contact state changes: a
closed gap leaves about this much. What can still be gained then is at most the cost itself.
"""


def uno_driver(max_iterations: int = 100) -> Driver:
    """SQP of Uno, the default."""
    return UnoDriver(tol=OPTIMALITY, feas_tol=TOLERANCE, maxiter=max_iterations)


def ipopt_driver(max_iterations: int = 100) -> Driver:
    """IPOPT; needs the extra ``ipopt``."""
    return IpoptDriver(tol=OPTIMALITY, feas_tol=TOLERANCE, maxiter=max_iterations)


def slsqp_driver(max_iterations: int = 60) -> Driver:
    """SciPy's SLSQP, which stops when the objective no longer changes, be it optimal or not."""
    return SlsqpDriver(tol=TOLERANCE, maxiter=max_iterations)


OPTIMIZERS = {"UNO": uno_driver, "IPOPT": ipopt_driver, "SLSQP": slsqp_driver}
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
    further : dict of str to ndarray
        Values of the drawn seal of the optional measures asked for.
    door_radius : tuple of float
        Bounds, mm.
    """

    gap_square_sum: float
    area: float
    von_mises: np.ndarray
    door_radius: tuple
    further: dict


def problem_limits(drawn: SealResult, measures=()) -> Limits:
    """Limits that follow from the analysis of the drawn seal.

    Parameters
    ----------
    drawn : SealResult
    measures : sequence of str
        Optional measures that the problem uses.

    Raises
    ------
    ValueError
        When no gap opens under the drawn seal: there is nothing to minimise.
    """
    cost = drawn.gap_square_sum
    largest = float(np.abs(drawn.gap).max(initial=0.0))
    if not largest > NEGLIGIBLE_GAP:
        raise ValueError(
            "no contact point of the drawn seal stands open between others in contact by more than "
            f"{NEGLIGIBLE_GAP} mm (largest gap {largest:.1g} mm), so no gap to minimise; choose a "
            "larger depth or another door"
        )
    radius = drawn.seal.scalars["door_radius"].value
    return Limits(
        gap_square_sum=cost,
        area=AREA_LIMIT,
        von_mises=np.maximum(STRESS_SHARE * drawn.von_mises, STRESS_FLOOR),
        door_radius=(radius - OFFSET_BOUND, radius + OFFSET_BOUND),
        further={measure.name: drawn.value(measure) for measure in drawn.measures(measures)},
    )


def seal_problem(
    seal: Seal,
    *,
    keep_force: bool = False,
    clamp_load: bool = False,
    pressure_floor: bool = False,
    stress_norm: bool = False,
    gap_integral: bool = False,
    driver: Driver | None = None,
    recorder=None,
    callback=None,
    kept: KeptAnalyses | None = None,
    work_dir=None,
    reports=None,
) -> om.Problem:
    """Problem (71): min gap_square_sum over boundary offsets and door radius, set up to run.

    Parameters
    ----------
    seal : Seal
        The door seal.
    keep_force : bool
        Keep the vertical reaction at the end of the path within 10 % of its start.
    clamp_load : bool
        Keep the whole load curve: the same at 2, 4, 6, 8 and 10 mm, as far as the door goes.
    pressure_floor : bool
        Keep half of the drawn seal's contact pressure in each patch.
    stress_norm : bool
        Limit the p-norm of the stress of all particles instead of seven stresses.
    gap_integral : bool
        Minimise the integral of g^2 over the opened stretch instead of the sum over points.
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
    ValueError
        When no gap opens under the drawn seal.
    LoadPathError
        When the drawn seal cannot be analysed.
    """
    kept = KeptAnalyses() if kept is None else kept
    drawn = kept.analyze(seal, keep_factors=True, callback=callback)
    drawn.require_converged()
    chosen = {
        "reaction_curve": clamp_load, "patch_pressure": pressure_floor,
        "stress_norm": stress_norm, "gap_square_integral": gap_integral,
    }  # fmt: skip
    measures = tuple(name for name, wanted in chosen.items() if wanted)
    limits = problem_limits(drawn, measures)
    group = SealGroup(seal=seal, callback=callback, measures=(*STANDARD, *measures), kept=kept)
    problem = new_problem(group, driver, work_dir, reports)
    for name, settings in design_variables(limits).items():
        problem.model.add_design_var(name, **settings)
    _add_responses(problem.model, limits)
    if keep_force:
        _add_band(problem.model, "reaction", drawn.reaction[-1, 1:], indices=[1])
    settings = {
        "keep_force": keep_force, "clamp_load": clamp_load, "pressure_floor": pressure_floor,
        "stress_norm": stress_norm, "gap_integral": gap_integral,
    }  # fmt: skip
    set_up(problem, settings, recorder)
    return problem


def new_problem(group: om.Group, driver: Driver | None, work_dir, reports) -> om.Problem:
    """The problem of a group; arguments as of ``seal_problem``."""
    options = {} if work_dir is None else {"work_dir": str(work_dir)}
    return om.Problem(group, driver=driver or uno_driver(), reports=reports, **options)


def set_up(problem: om.Problem, settings: dict, recorder) -> None:
    """Keep what was asked for beside the model, record the run where that is wanted, and ``setup``."""
    problem.model.options.declare(PROBLEM_OPTION, default=json.dumps(settings), types=str)
    if recorder is not None:
        record_run(problem, recorder)
    problem.setup()


def design_variables(limits: Limits) -> dict[str, dict]:
    """Boundary offsets and door radius: arguments of ``add_design_var`` by the name of the input."""
    low, high = limits.door_radius
    middle = 0.5 * (low + high)
    return {
        "boundary_offsets": {"lower": -OFFSET_BOUND, "upper": OFFSET_BOUND},
        "door_radius": {"lower": low, "upper": high, "ref0": middle, "ref": middle + 1.0},
    }


def _add_responses(group: om.Group, limits: Limits) -> None:
    """Objective and constraints; the optional measures take the place of their simple forms."""
    further = limits.further
    if "gap_square_integral" in further:
        start = float(further["gap_square_integral"][0])
        group.add_objective("gap_square_integral", ref=OBJECTIVE_REF * start)
    else:
        group.add_objective("gap_square_sum", ref=OBJECTIVE_REF * limits.gap_square_sum)
    group.add_constraint("area", upper=limits.area, ref=limits.area)
    if "stress_norm" in further:
        upper = max(STRESS_SHARE * float(further["stress_norm"][0]), STRESS_FLOOR)
        group.add_constraint("stress_norm", upper=upper, ref=upper)
    else:
        group.add_constraint("von_mises", upper=limits.von_mises, ref=limits.von_mises)
    if "reaction_curve" in further:
        _add_band(group, "reaction_curve", further["reaction_curve"])
    if "patch_pressure" in further:
        floor = PRESSURE_SHARE * further["patch_pressure"]
        group.add_constraint("patch_pressure", lower=floor, ref=floor)


def _add_band(group: om.Group, name: str, start: np.ndarray, indices=None) -> None:
    """Keep forces within ``FORCE_BAND`` of their start."""
    group.add_constraint(
        name, indices=indices, lower=(1 - FORCE_BAND) * start, upper=(1 + FORCE_BAND) * start,
        ref=start,
    )  # fmt: skip


def record_run(problem: om.Problem, recorder) -> None:
    """Record every evaluation; derivatives mark those that begin a major iteration."""
    if isinstance(recorder, str | Path):
        recorder = RestartRecorder(Path(recorder).absolute())
    record_all(problem.driver, recorder)


def major_iterations(problem: om.Problem) -> int | None:
    """Major iterations that the optimiser itself counted, None when it does not tell."""
    driver = problem.driver
    return driver.result.iter_count if isinstance(driver, OptimizerDriver) else None
