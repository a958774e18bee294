"""A door seal that closes on every car: problem (71) over scenarios instead of at its drawing."""

from concurrent.futures import Executor
from dataclasses import asdict, dataclass

import openmdao.api as om
from openmdao.core.driver import Driver

from seal_mdao import values
from seal_mdao.components.aggregate_comp import quantile_name
from seal_mdao.components.scenario_group import ScenarioGroup
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.optimization import (
    OBJECTIVE_REF,
    PRESSURE_SHARE,
    STRESS_FLOOR,
    STRESS_SHARE,
    Limits,
    add_variables,
    new_problem,
    problem_limits,
    set_up,
)
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.variation import Scenarios
from seal_mdao.seals.door.door_seal import DoorSeal

COST = "gap_square_integral"
MEASURES = (COST, "reaction", "patch_pressure", "stress_norm")
GOALS = MEAN_STD, WORST = "mean_std", "worst"


@dataclass(frozen=True)
class RobustGoal:
    """What a robust design is asked for.

    Attributes
    ----------
    minimize : {"mean_std", "worst"}
        Mean plus ``deviations`` standard deviations of the integral of the squared gap, or its smooth
        largest value over the scenarios.
    deviations : float
    band : float
        Relative change of the drawn seal's vertical reaction that is allowed.
    share : float
        Share of all cars in which reaction and contact pressure keep to their limits.
    """

    minimize: str = MEAN_STD
    deviations: float = 2.0
    band: float = 0.35
    share: float = 0.95

    def __post_init__(self):
        values.one_of("minimize", self.minimize, GOALS)
        values.real("deviations", self.deviations, 0.0)
        values.real("band", self.band, above=0.0, below=1.0)
        values.real("share", self.share, above=0.5, below=1.0)

    @property
    def levels(self) -> tuple[float, float, float]:
        """Quantiles that keep to limits: of the pressure, both of the reaction."""
        outside = 1.0 - self.share
        return outside, 0.5 * outside, 1.0 - 0.5 * outside


def robust_problem(
    seal: DoorSeal,
    scenarios: Scenarios,
    goal: RobustGoal,
    *,
    workers: int | Processes | Executor | None = None,
    driver: Driver | None = None,
    recorder=None,
    kept: KeptAnalyses | None = None,
    work_dir=None,
    reports=None,
    label: str = "",
) -> om.Problem:
    """The robust optimisation over boundary offsets and door radius, set up to run.

    Limits are those of problem (71) with its pressure floor, from the drawn seal: the mean of the
    stress norm, the area of the design, the quantiles of ``goal`` of reaction and contact pressure.

    Parameters
    ----------
    seal : DoorSeal
    scenarios : Scenarios
    goal : RobustGoal
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
        When no gap opens under the drawn seal, or the scenarios do not fit the seal.
    LoadPathError
        When the drawn seal cannot be analysed.
    """
    kept = KeptAnalyses() if kept is None else kept
    drawn = kept.analyze(seal)
    drawn.require_converged()
    limits = problem_limits(drawn, (*MEASURES[2:], COST))
    group = ScenarioGroup(
        seal=seal, scenarios=scenarios, measures=MEASURES, quantiles=goal.levels, workers=workers
    )
    model = om.Group()
    model.add_subsystem("seal", group, promotes=["*"])
    problem = new_problem(model, driver, work_dir, reports)
    add_variables(model, limits)
    _add_objective(model, goal, limits)
    _add_constraints(model, goal, limits, float(drawn.reaction[-1, 1]))
    set_up(problem, {"robust": asdict(goal), "scenarios": len(scenarios), "label": label}, recorder)
    return problem


def _add_objective(model: om.Group, goal: RobustGoal, limits: Limits) -> None:
    size = OBJECTIVE_REF * float(limits.further[COST][0])
    if goal.minimize == WORST:
        model.add_objective(f"{COST}_highest", ref=size)
        return
    total = om.ExecComp(
        f"robust_cost = mean + {goal.deviations!r} * std",
        robust_cost={"units": "mm**3"}, mean={"units": "mm**3"}, std={"units": "mm**3"},
    )  # fmt: skip
    parts = [("mean", f"{COST}_mean"), ("std", f"{COST}_std"), "robust_cost"]
    model.add_subsystem("cost", total, promotes=parts)
    model.add_objective("robust_cost", ref=size)


def _add_constraints(model: om.Group, goal: RobustGoal, limits: Limits, reaction: float) -> None:
    stress = max(STRESS_SHARE * float(limits.further["stress_norm"][0]), STRESS_FLOOR)
    floor = PRESSURE_SHARE * limits.further["patch_pressure"]
    pressure, low, high = (quantile_name(level) for level in goal.levels)
    model.add_constraint("area", upper=limits.area, ref=limits.area)
    model.add_constraint("stress_norm_mean", upper=stress, ref=stress)
    model.add_constraint(f"patch_pressure_{pressure}", lower=floor, ref=floor)
    vertical = {"indices": [1], "ref": reaction}
    model.add_constraint(f"reaction_{low}", lower=(1.0 - goal.band) * reaction, **vertical)
    model.add_constraint(f"reaction_{high}", upper=(1.0 + goal.band) * reaction, **vertical)
