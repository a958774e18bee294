"""Robust optimisation: evaluate a seal in scenarios of its tolerances instead of the nominal
one."""

from concurrent.futures import Executor
from dataclasses import asdict, dataclass

import numpy as np
import openmdao.api as om
from scipy.special import ndtr, ndtri

from seal_mdao import values
from seal_mdao.components.aggregate_comp import quantile_name
from seal_mdao.components.scenario_group import ScenarioGroup
from seal_mdao.distributions import FACTOR, SHIFT
from seal_mdao.measures.measure import Measure
from seal_mdao.optimization import DESIGN, DRAWING, MEAN, SHARE, Limit, RunOptions, Task
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.variation import Scenarios
from seal_mdao.seals.seal import Seal
from seal_mdao.tolerances.tolerance_set import Tolerances

GOALS = MEAN_STD, WORST = "mean_std", "worst"


@dataclass(frozen=True)
class RobustGoal:
    """Requirements of a robust design.

    Attributes
    ----------
    minimize : {"mean_std", "worst"}
        Mean plus ``deviations`` standard deviations of the measure that is minimised, or its smooth
        largest value over the scenarios.
    deviations : float
    band : float
        Relative change of the vertical reaction of the nominal door seal that is allowed.
    share : float
        Required fraction of samples within a limit (``RobustLimit``).
    widen : float
        Scatter of the scenarios over that of the tolerances. A few widely scattered scenarios represent
        the worst of many samples.
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
        """Quantiles of a measure in the scenarios that satisfy its limits.

        They correspond to the required fraction of samples if measures are normally distributed; rounded
        to 0.1 %, because the names of outputs contain them.
        """
        # Phi(Phi^-1(q) / widen) for the quantiles q on both sides
        outside = 0.5 * (1.0 - self.share)
        return tuple(ndtr(ndtri([outside, 1.0 - outside]) / self.widen).round(3).tolist())

    def scenarios(self, tolerances: Tolerances, seal: Seal, count: int, seed: int) -> Scenarios:
        """Create the scenarios: the nominal one, and ``count`` around the middle of the tolerances.

        Parameters
        ----------
        tolerances : Tolerances
        seal : Seal
        count, seed : int
            As of ``Tolerances.samples``.

        Raises
        ------
        ValueError
            For scenarios that are so wide that a parameter has a value that it cannot have.
        """
        made, middle = tolerances.samples(seal, count, seed=seed), tolerances.means
        # m + widen (x - m) around the means m
        numbers = middle + self.widen * (made.numbers - middle)
        # the nominal seal is the first scenario
        drawing = nominal_numbers(tolerances.variations, seal)
        offsets = np.vstack([np.zeros(seal.n_offsets), self.widen * made.offsets])
        found = Scenarios(tolerances.variations, np.vstack([drawing, numbers]), offsets)
        self._require_admissible(found, seal)
        return found

    def _require_admissible(self, scenarios: Scenarios, seal: Seal) -> None:
        """Raise ValueError for a scenario with a value that a parameter cannot have."""
        nominal = {name: float(seal.scalars[name].value) for name in scenarios.parameters}
        for number in range(len(scenarios)):
            try:
                seal.with_parameters(scenarios.values(number, nominal))
            except ValueError as error:
                raise ValueError(
                    f"{scenarios.described(number)}: {error}; the scenarios are {self.widen:g} times "
                    "as far from the means as samples of the tolerances (widen): use a smaller "
                    "factor, at least 1, or smaller tolerances"
                ) from error


def nominal_numbers(variations: tuple, seal: Seal) -> np.ndarray:
    """Return the numbers of variations that change nothing, shape (len(variations),).

    Raises
    ------
    ValueError
        For one that gives several parameters of different values the same.
    """
    neutral = {SHIFT: 0.0, FACTOR: 1.0}
    found = []
    for variation in variations:
        nominal = {float(seal.scalars[name].value) for name in variation.parameters}
        if variation.kind not in neutral and len(nominal) > 1:
            raise ValueError(
                f"the manufacturing tolerance {variation.name} sets "
                f'{", ".join(variation.parameters)} to one common value (kind "value"), but '
                'their nominal values differ; use kind "factor" or "shift"'
            )
        found.append(neutral.get(variation.kind, min(nominal)))
    return np.array(found)


@dataclass(frozen=True, eq=False)
class Robust:
    """Formulation over scenarios, for ``optimization_problem``.

    Attributes
    ----------
    goal : RobustGoal
    scenarios : Scenarios
        Of ``goal.scenarios``.
    workers
        As of ``ScenarioGroup``.
    label : str
        Which scenarios these are, for recorder files.
    """

    goal: RobustGoal
    scenarios: Scenarios
    workers: int | Processes | Executor | None = None
    label: str = ""

    @property
    def settings(self) -> dict:
        """Settings stored in a recorder file."""
        return {
            "robust": asdict(self.goal), "scenarios": len(self.scenarios), "label": self.label
        }  # fmt: skip

    def model(self, task: Task, run: RunOptions) -> om.Group:
        """Build the group that computes objective and measures."""
        model = om.Group()
        group = ScenarioGroup(
            seal=task.seal, scenarios=self.scenarios, measures=task.measures,
            quantiles=self.goal.levels, workers=self.workers, callback=run.callback,
        )  # fmt: skip
        model.add_subsystem("seal", group, promotes=["*"])
        if self.goal.minimize == MEAN_STD:
            # cost = mean + k std
            name, own = task.minimize, {"units": _units(task)}
            total = om.ExecComp(
                f"robust_cost = mean + {self.goal.deviations!r} * std",
                robust_cost=own, mean=own, std=own,
            )  # fmt: skip
            parts = [("mean", f"{name}_mean"), ("std", f"{name}_std"), "robust_cost"]
            model.add_subsystem("cost", total, promotes=parts)
        return model

    def objective(self, task: Task) -> str:
        """Name of the output that is minimised."""
        return f"{task.minimize}_highest" if self.goal.minimize == WORST else "robust_cost"

    def outputs(self, limit: Limit) -> list[tuple[str, dict]]:
        """Outputs of the scenarios to constrain, and arguments of ``add_constraint``."""
        more = limit.scaling
        if limit.over == DRAWING:
            more["indices"] = [limit.entry or 0]
        if limit.over != SHARE:
            ending = {DESIGN: "", DRAWING: "_scenarios", MEAN: "_mean"}[limit.over]
            return [(limit.measure + ending, limit.sides | more)]
        # the low quantile satisfies the lower limit, the high one the upper
        names = dict(zip(("lower", "upper"), map(quantile_name, self.goal.levels), strict=True))
        return [
            (f"{limit.measure}_{names[side]}", {side: value} | more)
            for side, value in limit.sides.items()
        ]


def _units(task: Task) -> str | None:
    """Units of the measure that is minimised."""
    names = [m for m in task.measures if not isinstance(m, Measure)]
    own = [m for m in task.measures if isinstance(m, Measure)]
    known = (*own, *(task.seal.measures(names) if names else ()))
    units = next(measure.units for measure in known if measure.name == task.minimize)
    return task.seal.units.of(units)
