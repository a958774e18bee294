"""Optimisation of any seal as an OpenMDAO problem: task, options of a run, and the function that
builds it.

``door_optimization`` and ``file_optimization`` make the task of the door seal and of a seal file,
``robust_optimization`` the one over scenarios of tolerances."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver

from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.components.seal_group import SealGroup
from seal_mdao.drivers.ipopt_driver import IpoptDriver
from seal_mdao.drivers.slsqp_driver import SlsqpDriver
from seal_mdao.drivers.uno_driver import UnoDriver
from seal_mdao.openmdao_access import counted_iterations
from seal_mdao.recording.recorded_seals import PROBLEM_OPTION, recorded_settings
from seal_mdao.recording.recorder import RestartRecorder, record_all
from seal_mdao.recording.recorder_file import open_model
from seal_mdao.recording.restart import restart
from seal_mdao.seals.file.described import FILE_NAME
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.seal import Seal

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
    """Create the driver with the SQP method of Uno, the default."""
    return UnoDriver(tol=OPTIMALITY, feas_tol=TOLERANCE, maxiter=max_iterations)


def ipopt_driver(max_iterations: int = 100) -> Driver:
    """Create the driver with IPOPT; needs the extra ``ipopt``."""
    return IpoptDriver(tol=OPTIMALITY, feas_tol=TOLERANCE, maxiter=max_iterations)


def slsqp_driver(max_iterations: int = 60) -> Driver:
    """Create the driver with SciPy's SLSQP, which stops when the objective no longer changes,
    optimal or not."""
    return SlsqpDriver(tol=TOLERANCE, maxiter=max_iterations)


OPTIMIZERS = {"UNO": uno_driver, "IPOPT": ipopt_driver, "SLSQP": slsqp_driver}
"""Drivers by name; all settings of the optimisers are here and in the constants above."""

DESIGN, DRAWING, MEAN, SHARE = "design", "drawing", "mean", "share"
"""Where a limit of a robust optimisation holds: for the section itself, in the first scenario, on
average, in a fraction of all samples."""


@dataclass(frozen=True, eq=False)
class Limit:
    """Limits of a measure.

    Attributes
    ----------
    measure : str
    lower, upper : float or ndarray, optional
    entry : int, optional
        Of a measure with several values; all when left out, of the drawing the first.
    over : {"design", "drawing", "mean", "share"}
        In a robust optimisation: for the section itself (``area``), in the drawing (the first
        scenario), for the mean over the scenarios, or in the ``share`` of all samples asked for.
    ref : float or ndarray, optional
        Value that is scaled to 1; the largest bound when left out.
    """

    measure: str
    lower: float | np.ndarray | None = None
    upper: float | np.ndarray | None = None
    entry: int | None = None
    over: str = SHARE
    ref: float | np.ndarray | None = None

    @property
    def sides(self) -> dict:
        """Bounds that are given, by the argument names of ``add_constraint``."""
        both = {"lower": self.lower, "upper": self.upper}
        return {side: value for side, value in both.items() if value is not None}

    @property
    def scaling(self) -> dict:
        """Further arguments of ``add_constraint``."""
        largest = max(np.abs(value).max() for value in self.sides.values())
        more = {"ref": float(largest) or 1.0 if self.ref is None else self.ref}
        return more if self.entry is None else more | {"indices": [self.entry]}

    def satisfied(self, values: np.ndarray) -> np.ndarray:
        """Return which samples of values (n, m) satisfy the limits, shape (n,)."""
        own = values if self.entry is None else values[:, [self.entry]]
        # l <= m <= u, without a bound always
        low = -np.inf if self.lower is None else self.lower
        high = np.inf if self.upper is None else self.upper
        return ((own >= low) & (own <= high)).all(axis=1)


@dataclass(frozen=True, eq=False)
class Task:
    """Optimisation task: objective, design variables and limits, nominal or robust.

    Attributes
    ----------
    seal : Seal
    minimize : str
        The measure that is minimised.
    start : float
        Its value in the nominal seal.
    measures : tuple of Measure or str
        All that are evaluated.
    variables : dict of str to dict
        Arguments of ``add_design_var`` by the name of the input.
    limits : tuple of Limit
    settings : dict
        What a recorder file keeps, to recognise the problem or to set it up again.
    """

    seal: Seal
    minimize: str
    start: float
    measures: tuple
    variables: dict
    limits: tuple
    settings: dict = field(default_factory=dict)

    @property
    def scale(self) -> float:
        """Value of the objective that is scaled to 1."""
        return OBJECTIVE_REF * abs(self.start) or 1.0

    @property
    def sampled(self) -> tuple[Limit, ...]:
        """Limits that are verified on fresh samples."""
        return tuple(limit for limit in self.limits if limit.over in (MEAN, SHARE))


@dataclass(frozen=True, eq=False)
class RunOptions:
    """Options of an optimisation run.

    Attributes
    ----------
    driver : Driver, optional
        Uno when left out.
    recorder : str, Path or CaseRecorder, optional
        Where every model evaluation is recorded, with all that figures and restarts need.
    callback : callable, optional
        Called with every converged load step; over scenarios with the number of each that has
        finished, and its outcome.
    cache : AnalysisCache
        Keeps the analyses for whoever looks at the designs afterwards.
    work_dir : str or Path, optional
        Folder of OpenMDAO's own output; the current one when left out.
    reports : optional
        OpenMDAO reports to write, as for ``Problem``; none when left out.
    """

    driver: Driver | None = None
    recorder: object = None
    callback: Callable | None = None
    cache: AnalysisCache = field(default_factory=AnalysisCache)
    work_dir: str | Path | None = None
    reports: object = None

    def analyze(self, seal: Seal) -> SealResult:
        """Analyse the nominal seal, from which tasks derive their limits.

        Raises
        ------
        LoadPathError
            When its path cannot be completed.
        """
        nominal = self.cache.analyze(seal, keep_factors=True, callback=self.callback)
        nominal.require_converged()
        return nominal


class Nominal:
    """Formulation with the measures of the nominal seal."""

    @property
    def settings(self) -> dict:
        """Settings stored in a recorder file."""
        return {}

    def model(self, task: Task, run: RunOptions) -> om.Group:
        """Build the group that computes objective and measures."""
        return SealGroup(
            seal=task.seal, callback=run.callback, measures=task.measures, cache=run.cache
        )

    def objective(self, task: Task) -> str:
        """Name of the output that is minimised."""
        return task.minimize

    def outputs(self, limit: Limit) -> list[tuple[str, dict]]:
        """Outputs to constrain, and arguments of ``add_constraint``."""
        return [(limit.measure, limit.sides | limit.scaling)]


def optimization_problem(task: Task, run: RunOptions | None = None, robust=None) -> om.Problem:
    """Build the optimisation of any seal, set up to run.

    Parameters
    ----------
    task : Task
        ``door_optimization.door_task`` of the door seal, ``file_optimization.file_task`` of a seal
        file, or one of your own.
    run : RunOptions, optional
    robust : robust_optimization.Robust, optional
        Over scenarios; the nominal seal alone when left out.

    Returns
    -------
    Problem
        After ``setup``, at the nominal seal.
    """
    run = RunOptions() if run is None else run
    formulation = Nominal() if robust is None else robust
    group = formulation.model(task, run)
    options = {} if run.work_dir is None else {"work_dir": str(run.work_dir)}
    problem = om.Problem(group, driver=run.driver or uno_driver(), reports=run.reports, **options)
    for name, settings in task.variables.items():
        group.add_design_var(name, **settings)
    objective = formulation.objective(task)
    group.add_objective(objective, ref=task.scale)
    outputs = [own for limit in task.limits for own in formulation.outputs(limit)]
    # OpenMDAO takes an output once: the second time it needs an alias
    used = {objective}
    for number, (name, settings) in enumerate(outputs, 1):
        alias = f"{name}_{number}" if name in used else None
        group.add_constraint(name, alias=alias, **settings)
        used.add(name)
    # a restart compares them (``continue_run``)
    settings = json.dumps(formulation.settings | task.settings)
    group.options.declare(PROBLEM_OPTION, default=settings, types=str)
    if run.recorder is not None:
        record_run(problem, run.recorder)
    problem.setup()
    return problem


def record_run(problem: om.Problem, recorder) -> None:
    """Record every evaluation; derivatives mark those that begin a major iteration."""
    if isinstance(recorder, str | Path):
        recorder = RestartRecorder(Path(recorder).absolute())
    record_all(problem.driver, recorder)


def continue_run(problem: om.Problem, cases: Path) -> None:
    """Let the next run continue the one recorded in ``cases``, for any seal and folder.

    Raises
    ------
    ValueError
        When another problem is recorded there (``RestartError`` by ``restart``).
    """
    mine = json.loads(problem.model.options[PROBLEM_OPTION])
    recorded = recorded_settings(open_model(cases))
    # a seal file may have another name
    if recorded | {FILE_NAME: ""} != mine | {FILE_NAME: ""}:
        raise ValueError(
            f"{cases} was recorded in the optimisation of another problem (seal file, options, "
            "scenarios or goal); restart with the settings of the recorded optimisation, or begin "
            "a new one in another folder"
        )
    restart(problem, cases)


def major_iterations(problem: om.Problem) -> int | None:
    """Return the number of major iterations counted by the optimiser; None if it does not report
    it."""
    return counted_iterations(problem.driver)
