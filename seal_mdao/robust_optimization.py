"""A door seal that closes on every car: problem (71) over scenarios instead of at its drawing."""

from concurrent.futures import Executor
from dataclasses import asdict, dataclass

import numpy as np
import openmdao.api as om
from openmdao.core.driver import Driver
from scipy.special import ndtr, ndtri

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
from seal_mdao.scenarios.variation import FACTOR, SHIFT, Scenarios
from seal_mdao.seals.door.door_seal import DoorSeal
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
        Mean plus ``deviations`` standard deviations of the integral of the squared gap, or its smooth
        largest value over the scenarios.
    deviations : float
    band : float
        Relative change of the drawn seal's vertical reaction that is allowed.
    share : float
        Share of all cars in which the reaction keeps to its band.
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
        """Quantiles of the reaction in the scenarios that keep to the band.

        As far out among the wide scenarios as those of all cars, were both normal; to a tenth of a per
        cent, for they name outputs.
        """
        outside = 0.5 * (1.0 - self.share)
        return tuple(ndtr(ndtri([outside, 1.0 - outside]) / self.widen).round(3).tolist())

    def scenarios(self, tolerances: Tolerances, seal: DoorSeal, count: int, seed: int) -> Scenarios:
        """The drawing, and ``count`` scenarios around the middle of the tolerances.

        Parameters
        ----------
        tolerances : Tolerances
        seal : DoorSeal
        count, seed : int
            As of ``Tolerances.samples``.
        """
        made, middle = tolerances.samples(seal, count, seed=seed), tolerances.means
        numbers = middle + self.widen * (made.numbers - middle)
        drawing = drawn_numbers(tolerances.variations, seal)
        offsets = np.vstack([np.zeros(seal.n_offsets), self.widen * made.offsets])
        return Scenarios(tolerances.variations, np.vstack([drawing, numbers]), offsets)


def drawn_numbers(variations: tuple, seal: DoorSeal) -> np.ndarray:
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

    Limits are those of problem (71) with its pressure floor, from the drawn seal: area and stress norm
    of the design in the first scenario, the drawing; the mean contact pressure of each patch; and the
    quantiles of the reaction of ``goal``.

    Parameters
    ----------
    seal : DoorSeal
    scenarios : Scenarios
        Of ``goal.scenarios``.
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
    low, high = (quantile_name(level) for level in goal.levels)
    model.add_constraint("area", upper=limits.area, ref=limits.area)
    model.add_constraint("stress_norm_scenarios", indices=[0], upper=stress, ref=stress)
    model.add_constraint("patch_pressure_mean", lower=floor, ref=floor)
    vertical = {"indices": [1], "ref": reaction}
    model.add_constraint(f"reaction_{low}", lower=(1.0 - goal.band) * reaction, **vertical)
    model.add_constraint(f"reaction_{high}", upper=(1.0 + goal.band) * reaction, **vertical)
