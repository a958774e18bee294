"""Optimisation problem of ``seal-mdao robust``: the door seal, or table ``[optimize]`` of a seal
file."""

from dataclasses import dataclass

import numpy as np

import seal_mdao as sm
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import checked_arguments
from seal_mdao.cli.seal_files import file_errors
from seal_mdao.cli.varied_seals import door_with_tolerances, file_with_tolerances
from seal_mdao.door_optimization import DoorProblem, door_task, robust_door_task
from seal_mdao.file_optimization import design_warnings, file_task, require_problem
from seal_mdao.measures.measure import Measure
from seal_mdao.optimization import Limit, RunOptions, Task
from seal_mdao.progress import LoadStepProgress
from seal_mdao.recording.recorded_optimization import label, shown_unit
from seal_mdao.robust_optimization import RobustGoal
from seal_mdao.seals.result import frozen_measures
from seal_mdao.tolerances.design_comparison import SampledLimit
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.tolerance_set import Tolerances


@dataclass(frozen=True, eq=False)
class Subject:
    """Optimisation problem: seal, tolerances, goal and limits.

    Attributes
    ----------
    seal : Seal
    tolerances : Tolerances
    goal : RobustGoal
    task : Task
    limits : tuple of SampledLimit
    said : dict
        The limits in summary.json.
    file : SealFile or None
        None for the door seal.
    """

    seal: sm.Seal
    tolerances: Tolerances
    goal: RobustGoal
    task: Task
    limits: tuple
    said: dict
    file: sm.SealFile | None = None

    @property
    def source(self) -> str:
        """Text of the seal file, which identifies it in files of samples; empty for the door seal."""
        return "" if self.file is None else self.file.path.read_text(encoding="utf-8")

    def measure(self, name: str) -> Measure:
        """Return a measure of the optimisation with its evaluation points."""
        measures = frozen_measures(self.seal, self.task.measures)
        return next(measure for measure in measures if measure.name == name)

    def described(self, name: str) -> str:
        """Describe a measure with its unit."""
        unit = shown_unit(self.seal.units.of(self.measure(name).units))
        return f"{label(name)} ({unit})" if unit else label(name)

    def nominal_task(self, run: RunOptions) -> Task:
        """Return the problem without tolerances."""
        if self.file is not None:
            return self.task
        # the door seal's problem without tolerances, same measures
        flags = DoorProblem(True, pressure_floor=True, stress_norm=True, gap_integral=True)
        return door_task(run.analyze(self.seal), flags)


def subject_of(arguments, cache: AnalysisCache) -> Subject:
    """Set up the problem of the door seal or of a seal file, with its nominal analysis."""
    with checked_arguments():
        # mean + K std, or smooth maximum over the scenarios
        goal = RobustGoal(
            arguments.minimize, arguments.deviations, arguments.band, arguments.fraction,
            arguments.widen,
        )  # fmt: skip
    of = _door if arguments.file is None else _of_file
    return of(arguments, goal, cache)


def _door(arguments, goal: RobustGoal, cache: AnalysisCache) -> Subject:
    """Set up problem (71) of the door seal."""
    seal, tolerances = door_with_tolerances(arguments)
    with checked_arguments():
        # limits relative to the nominal seal's pressure and reaction
        task = robust_door_task(_nominal_result(seal, cache), goal)
    pressure, reaction = task.sampled
    # the reaction stays in a band, the pressure above a floor
    low, high = band = reaction.lower, reaction.upper
    least = " and ".join(f"{value:.3g}" for value in pressure.lower)
    limits = (
        SampledLimit(
            "share_above_pressure_floor", f"contact pressure of at least {least} kPa",
            "patch_pressure", pressure.satisfied,
        ),
        SampledLimit(
            "share_in_reaction_band", f"reaction within {low:.3g} to {high:.3g} N/m",
            "reaction", reaction.satisfied, reaction.entry, goal.share, high - low,
        ),
    )  # fmt: skip
    said = {"reaction_band_N_per_m": band, "pressure_floor_kPa": pressure.lower}
    return Subject(seal, tolerances, goal, task, limits, said)


def _of_file(arguments, goal: RobustGoal, cache: AnalysisCache) -> Subject:
    """Set up the problem of table ``[optimize]`` of a seal file."""
    file, seal, tolerances = file_with_tolerances(arguments, ("band", "nominal"))
    # profiles start farther back: scattered seals begin free of contact
    seal = with_clearance(seal)
    with file_errors(arguments.file):
        require_problem(file, seal)
        for text in design_warnings(file, seal):
            print(f"WARNING: {text}")
        task = file_task(file, _nominal_result(seal, cache))
    said = {"limits": [[own.measure, own.lower, own.upper] for own in task.sampled]}
    subject = Subject(seal, tolerances, goal, task, (), said, file)
    # fraction of samples that satisfies each limit
    limits = tuple(
        SampledLimit(
            f"share_{own.measure}_{number}",
            _in_words(own, seal.units.of(subject.measure(own.measure).units)),
            own.measure, own.satisfied, required=goal.share, band=_band(own),
        )
        for number, own in enumerate(task.sampled, 1)
    )  # fmt: skip
    return Subject(seal, tolerances, goal, task, limits, said, file)


def _band(limit: Limit) -> float | None:
    """Return the distance of the bounds of a limit; None for one alone."""
    return None if limit.lower is None or limit.upper is None else limit.upper - limit.lower


def _in_words(limit: Limit, unit: str | None) -> str:
    """Write a limit in words: ``reaction at least 60 N/m``."""
    sides = (("at least", limit.lower), ("at most", limit.upper))
    words = [
        f"{word} {', '.join(f'{own:.4g}' for own in np.ravel(value))}"
        for word, value in sides
        if value is not None
    ]
    return (
        f"{label(limit.measure)} {' and '.join(words)} {shown_unit(unit) if unit else ''}".rstrip()
    )


def _nominal_result(seal, cache) -> sm.SealResult:
    """Analyse the nominal seal with a progress bar."""
    with LoadStepProgress(seal) as progress:
        nominal = cache.analyze(seal, callback=progress)
    nominal.require_converged()
    return nominal
