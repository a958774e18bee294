"""A seal that works on every car: its optimisation over scenarios instead of at its drawing."""

from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver
from scipy.special import ndtr, ndtri

from seal_mdao import values
from seal_mdao.components.aggregate_comp import quantile_name
from seal_mdao.components.scenario_group import ScenarioGroup
from seal_mdao.file_optimization import design_bounds, optimized_measures, problem_settings
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.measures.measure import Measure
from seal_mdao.optimization import (
    OBJECTIVE_REF,
    PRESSURE_SHARE,
    STRESS_FLOOR,
    STRESS_SHARE,
    design_variables,
    new_problem,
    problem_limits,
    set_up,
)
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.variation import FACTOR, SHIFT, Scenarios
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.result import SealResult
from seal_mdao.seals.seal import Seal
from seal_mdao.tolerances.tolerances import Tolerances

COST = "gap_square_integral"
MEASURES = (COST, "reaction", "patch_pressure", "stress_norm")
GOALS = MEAN_STD, WORST = "mean_std", "worst"


@dataclass(frozen=True)
class RobustGoal:
    """What a robust design is asked for.

    Attributes
    ----------
    minimize : {"mean_std", "worst"}
        Mean plus ``deviations`` standard deviations of the measure that is minimised, or its smooth
        largest value over the scenarios.
    deviations : float
    band : float
        Relative change of the vertical reaction of the drawn door seal that is allowed.
    share : float
        Share of all cars in which a limit is kept (``RobustLimit``).
    widen : float
        How many times as far as the tolerances the scenarios scatter: few wide ones see what happens to
        the worst of many cars.
    """

    minimize: str = MEAN_STD
    deviations: float = 2.0
    band: float = 0.35
    share: float = 0.95
    widen: float = 1.5

    def __post_init__(self):
        values.one_of("minimize", self.minimize, GOALS)
        values.real("deviations", self.deviations, 0.0)
        values.real("band", self.band, above=0.0, below=1.0)
        values.real("share", self.share, above=0.5, below=1.0)
        values.real("widen", self.widen, 1.0)

    @property
    def levels(self) -> tuple[float, float]:
        """Quantiles of a measure in the scenarios that keep to its limits.

        As far out among the wide scenarios as those of all cars, were both normal; to a tenth of a per
        cent, for they name outputs.
        """
        outside = 0.5 * (1.0 - self.share)
        return tuple(ndtr(ndtri([outside, 1.0 - outside]) / self.widen).round(3).tolist())

    def scenarios(self, tolerances: Tolerances, seal: Seal, count: int, seed: int) -> Scenarios:
        """The drawing, and ``count`` scenarios around the middle of the tolerances.

        Parameters
        ----------
        tolerances : Tolerances
        seal : Seal
        count, seed : int
            As of ``Tolerances.samples``.
        """
        made, middle = tolerances.samples(seal, count, seed=seed), tolerances.means
        numbers = middle + self.widen * (made.numbers - middle)
        drawing = drawn_numbers(tolerances.variations, seal)
        offsets = np.vstack([np.zeros(seal.n_offsets), self.widen * made.offsets])
        return Scenarios(tolerances.variations, np.vstack([drawing, numbers]), offsets)


def drawn_numbers(variations: tuple, seal: Seal) -> np.ndarray:
    """Numbers of variations that change nothing, shape (len(variations),).

    Raises
    ------
    ValueError
        For one that gives several parameters of different values the same.
    """
    neutral = {SHIFT: 0.0, FACTOR: 1.0}
    found = []
    for variation in variations:
        drawn = {float(seal.scalars[name].value) for name in variation.parameters}
        if variation.kind not in neutral and len(drawn) > 1:
            raise ValueError(
                f"{variation.name} gives {', '.join(variation.parameters)} one value, and they are "
                "drawn with different ones; make it a factor or a shift"
            )
        found.append(neutral.get(variation.kind, min(drawn)))
    return np.array(found)


DESIGN, DRAWING, MEAN, SHARE = "design", "drawing", "mean", "share"
"""Where a limit holds: for the section itself, in the first scenario, on average, in most cars."""


@dataclass(frozen=True, eq=False)
class RobustLimit:
    """Limits of a measure in a robust optimisation.

    Attributes
    ----------
    measure : str
    over : {"design", "drawing", "mean", "share"}
        For the section itself (``area``), in the drawing (the first scenario), for the mean over the
        scenarios, or in the ``share`` of all cars that is asked for.
    lower, upper : float or ndarray, optional
    entry : int, optional
        Of a measure with several values; all when left out, of the drawing the first.
    """

    measure: str
    over: str
    lower: float | np.ndarray | None = None
    upper: float | np.ndarray | None = None
    entry: int | None = None

    def outputs(self, goal: RobustGoal) -> list[tuple[str, dict]]:
        """Outputs of a ``ScenarioGroup`` to constrain, and arguments of ``add_constraint``."""
        sides = {
            side: value for side, value in (("lower", self.lower), ("upper", self.upper))
            if value is not None
        }  # fmt: skip
        more = {"ref": float(max(np.abs(value).max() for value in sides.values())) or 1.0}
        if self.entry is not None or self.over == DRAWING:
            more["indices"] = [self.entry or 0]
        if self.over != SHARE:
            ending = {DESIGN: "", DRAWING: "_scenarios", MEAN: "_mean"}[self.over]
            return [(self.measure + ending, sides | more)]
        names = dict(zip(("lower", "upper"), map(quantile_name, goal.levels), strict=True))
        return [(f"{self.measure}_{names[s]}", {s: value} | more) for s, value in sides.items()]

    def kept(self, values: np.ndarray) -> np.ndarray:
        """In which samples of values (n, m) the limits are kept, shape (n,)."""
        own = values if self.entry is None else values[:, [self.entry]]
        low = -np.inf if self.lower is None else self.lower
        high = np.inf if self.upper is None else self.upper
        return ((own >= low) & (own <= high)).all(axis=1)


@dataclass(frozen=True, eq=False)
class RobustTask:
    """What a robust optimisation is about, whatever the scenarios.

    Attributes
    ----------
    minimize : str
        The measure whose mean and standard deviation, or largest value, are made small.
    start : float
        Its value in the drawing.
    measures : tuple of Measure or str
        All that the scenarios give.
    variables : dict of str to dict
        Arguments of ``add_design_var`` by the name of the input.
    limits : tuple of RobustLimit
    settings : dict
        What else a recorder file keeps.
    """

    minimize: str
    start: float
    measures: tuple
    variables: dict
    limits: tuple
    settings: dict = field(default_factory=dict)

    @property
    def sampled(self) -> tuple[RobustLimit, ...]:
        """Limits that fresh samples keep to or not."""
        return tuple(limit for limit in self.limits if limit.over in (MEAN, SHARE))


def door_task(drawn: SealResult, goal: RobustGoal) -> RobustTask:
    """Problem (71) with its pressure floor: limits of area and stress norm of the drawing, of the mean
    contact pressure of each patch, and a band of the reaction.

    Raises
    ------
    ValueError
        When no gap opens under the nominal seal.
    """
    limits, force = problem_limits(drawn, (*MEASURES[2:], COST)), float(drawn.reaction[-1, 1])
    stress = max(STRESS_SHARE * float(limits.further["stress_norm"][0]), STRESS_FLOOR)
    band = (1.0 - goal.band) * force, (1.0 + goal.band) * force
    return RobustTask(
        COST, float(limits.further[COST][0]), MEASURES, design_variables(limits), (
            RobustLimit("area", DESIGN, upper=limits.area),
            RobustLimit("stress_norm", DRAWING, upper=stress),
            RobustLimit("patch_pressure", MEAN, PRESSURE_SHARE * limits.further["patch_pressure"]),
            RobustLimit("reaction", SHARE, *band, entry=1),
        ),
    )  # fmt: skip


def file_task(file: SealFile, seal: Seal, drawn: SealResult) -> RobustTask:
    """The ``[optimize]`` of a seal file, whose constraints hold in most of the cars.

    Raises
    ------
    SealFileError
        As of ``file_problem``.
    """
    measures, start = optimized_measures(file, seal, drawn)
    bounds = design_bounds(file)
    variables = {"boundary_offsets": {"lower": -bounds, "upper": bounds, "ref": 2.0 * bounds}}
    limits = tuple(
        RobustLimit(c.measure, SHARE, c.lower, c.upper) for c in file.optimize.constraints
    )
    aim = file.optimize.minimize
    return RobustTask(
        aim, float(start[aim][0]), measures, variables, limits, problem_settings(file)
    )


def robust_problem(
    seal: Seal,
    scenarios: Scenarios,
    goal: RobustGoal,
    task: RobustTask | None = None,
    *,
    workers: int | Processes | Executor | None = None,
    driver: Driver | None = None,
    recorder=None,
    kept: KeptAnalyses | None = None,
    work_dir=None,
    reports=None,
    label: str = "",
) -> om.Problem:
    """The robust optimisation of a seal, set up to run.

    Parameters
    ----------
    seal : Seal
    scenarios : Scenarios
        Of ``goal.scenarios``.
    goal : RobustGoal
    task : RobustTask, optional
        ``door_task`` of the nominal seal when left out; ``file_task`` is that of a seal file.
    workers
        As of ``ScenarioGroup``.
    driver, recorder, kept, work_dir, reports
        As of ``optimization.seal_problem``.
    label : str
        Which scenarios these are, for recorder files.

    Returns
    -------
    Problem
        After ``setup``, at the drawn seal.

    Raises
    ------
    ValueError
        When no gap opens under the nominal seal, or the scenarios do not fit the seal.
    LoadPathError
        When the drawn seal cannot be analysed.
    """
    if task is None:
        drawn = (KeptAnalyses() if kept is None else kept).analyze(seal)
        drawn.require_converged()
        task = door_task(drawn, goal)
    group = ScenarioGroup(
        seal=seal, scenarios=scenarios, measures=task.measures, quantiles=goal.levels,
        workers=workers,
    )  # fmt: skip
    model = om.Group()
    model.add_subsystem("seal", group, promotes=["*"])
    problem = new_problem(model, driver, work_dir, reports)
    for name, settings in task.variables.items():
        model.add_design_var(name, **settings)
    _add_objective(model, goal, task, seal)
    _add_constraints(model, [own for limit in task.limits for own in limit.outputs(goal)])
    settings = {"robust": asdict(goal), "scenarios": len(scenarios), "label": label}
    set_up(problem, settings | task.settings, recorder)
    return problem


def _add_constraints(model: om.Group, outputs: list) -> None:
    """An output that is constrained before has another name the next time."""
    used = set()
    for number, (name, settings) in enumerate(outputs, 1):
        model.add_constraint(name, alias=f"{name}_{number}" if name in used else None, **settings)
        used.add(name)


def _add_objective(model: om.Group, goal: RobustGoal, task: RobustTask, seal: Seal) -> None:
    name, size = task.minimize, OBJECTIVE_REF * abs(task.start) or 1.0
    if goal.minimize == WORST:
        model.add_objective(f"{name}_highest", ref=size)
        return
    measures = [m if isinstance(m, Measure) else seal.measures((m,))[0] for m in task.measures]
    units = {"units": next(measure.units for measure in measures if measure.name == name)}
    total = om.ExecComp(
        f"robust_cost = mean + {goal.deviations!r} * std", robust_cost=units, mean=units, std=units
    )
    parts = [("mean", f"{name}_mean"), ("std", f"{name}_std"), "robust_cost"]
    model.add_subsystem("cost", total, promotes=parts)
    model.add_objective("robust_cost", ref=size)
