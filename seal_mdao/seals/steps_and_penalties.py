"""Choose load steps and contact penalties by tolerance, once on the nominal seal; then they are fixed.

Which steps are divided is in ``refined_steps``, how penalties change in ``adjusted_penalties``, their
initial values in ``contact.default_penalties``, how one step is solved in ``analysis.load_path``, the
keys of seal files in ``seals.file.load_steps``.

A coarse path comes first. Where its estimated error of a measure by the penalties (``penalty_error``),
the penetration or the elastic slip in stick is above the tolerance, the next path has penalties that
are higher by the ratio of the two. Where the error is far below it and the iterations converge badly,
they are lower. That path has the steps that are given, or where they are chosen
each step halved; then those are halved in which the last two paths drift apart, until what the halving
changes is below the tolerance. What a change of the penalties does to measures is taken off by its
estimate, what else it does to the path counts as an error of the steps. The last path is the analysis
of the nominal seal with all that was chosen, and is not computed again (``chosen_path``). Steps and
penalties are attributes of the seal afterwards: functions of the design stay smooth.
"""

from collections.abc import Callable, Collection
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.seals.adjusted_penalties import (
    penalty_values,
    relative_error,
    with_adjusted_penalties,
)
from seal_mdao.seals.checks import findings
from seal_mdao.seals.chosen_path import store_path
from seal_mdao.seals.penalty_error import penalties_of
from seal_mdao.seals.profiles import motions
from seal_mdao.seals.refined_steps import divided, with_refined_steps
from seal_mdao.seals.result import FACTOR_MEMORY, Known, SealResult, analyze_particles
from seal_mdao.seals.seal import Seal

STEP_TOLERANCE = 5e-3
PENALTY_TOLERANCE = 1e-3
COARSE = 12
"""Least number of equal load steps of the first path."""
MOST = 8
"""Largest refinement of the first path while paths still fail, as a factor on its steps."""


class Choice(NamedTuple):
    """A seal with load steps and penalties within their tolerances.

    Attributes
    ----------
    seal : Seal
    ends : tuple of float
        Ends of its load steps, in nominal steps of the seal that they were chosen for.
    penalties : dict of str to float
        The penalties that were chosen, by their names in ``Seal.scalars``, kPa/mm.
    step_error : float or None
        Estimated error by the load steps, of a measure over its largest value at the end, and of a
        force anywhere on the path over its largest one; None where the steps were given. Above the
        tolerance, as ``step_error`` of the seal, where more steps do not reduce it.
    penalty_error : float or None
        Largest estimated error by the penalties that were chosen, relative, of a measure; None where
        they were given, and where a path in steps that were given cannot be completed.
    """

    seal: Seal
    ends: tuple
    penalties: dict
    step_error: float | None
    penalty_error: float | None


class _Analyses:
    """Analyses of a seal in other steps and with other penalties, in a row, with one discretisation.

    One that begins with the load steps of the last resumes after them. Their number is reported to a
    callback with a method ``begin_analysis``, what is impossible in their results to ``faults``.
    """

    def __init__(self, callback: Callable | None):
        self.callback, self.number, self.discretization = callback, 0, None
        self.report = getattr(callback, "begin_analysis", None)
        self.tell = getattr(callback, "faults", None)
        # seal, ends of load steps and states of the last path
        self.last = None, np.empty(0), {}

    def __call__(self, seal: Seal, ends: np.ndarray | None, more: int) -> SealResult:
        """Analyse a seal with the load steps ``ends``, or its own; at least ``more`` analyses follow."""
        states = {} if ends is None else self._common(seal, ends)
        if ends is not None:
            self.last = seal, ends, states
            # its own steps: the path is then that of the seal itself
            if not np.array_equal(ends, np.arange(1.0, seal.n_steps + 1.0)):
                seal = seal.with_ends(ends)
        self.number += 1
        if self.report is not None:
            self.report(self.number, self.number + more, seal.n_steps)
        result = analyze_particles(
            seal, seal.nominal_particles, np.zeros(seal.n_offsets), factor_memory=FACTOR_MEMORY,
            callback=self.callback,
            known=Known(self.discretization, states.get(max(states, default=0)), states),
        )  # fmt: skip
        # steps and penalties do not change the discretised body
        self.discretization = result.path.discretization
        if self.tell is not None and result.converged:
            # before further analyses, which may take long
            self.tell([own.text for own in findings(result.path) if own.impossible])
        return result

    def _common(self, seal: Seal, ends: np.ndarray) -> dict:
        """Return the states of the last path after load steps that it has in common with ``ends``."""
        before, old, states = self.last
        if seal is not before:
            return {}
        # leading ends that are the same bit for bit
        n = min(len(old), len(ends))
        same = int(np.cumprod(old[:n] == ends[:n]).sum())
        return {number: state for number, state in states.items() if number <= same}


def choose(
    seal: Seal,
    step_tolerance: float | None = None,
    penalty_tolerance: float | None = None,
    names: Collection[str] = (),
    coarse: int = COARSE,
    callback: Callable | None = None,
) -> Choice:
    """Choose load steps and penalties within tolerances; the next analysis reuses the last path.

    Parameters
    ----------
    seal : Seal
        Nominal. With one nominal step for every stage of its path where steps are to be chosen.
    step_tolerance : float, optional
        Relative, at most 1, as ``Choice.step_error``; without it the steps are not changed.
    penalty_tolerance : float, optional
        Relative, at most 1, as ``Choice.penalty_error``; without it the penalties are not changed.
    names : collection of str, optional
        Penalties to choose, by their names in ``Seal.scalars``.
    coarse : int
        Equal steps of the first path, divided among the stages.
    callback : callable, optional
        Called with each ``ConvergedStep`` that completes a nominal step. Its method
        ``begin_analysis``, where it has one, is called before every analysis with its number, the
        number that there will be at the least, and its load steps; its method ``faults`` after it with
        a list of messages.

    Raises
    ------
    LoadPathError
        When the path cannot be completed and steps are to be chosen.
    ValueError
        When a tolerance is no such number.
    """
    # relative tolerances in (0, 1]
    for name, tolerance in (
        ("step_tolerance", step_tolerance), ("penalty_tolerance", penalty_tolerance),
    ):  # fmt: skip
        if tolerance is not None:
            values.real(name, tolerance, above=0.0, high=1.0)
    # penalties of these names that the seal has
    run, wanted = _Analyses(callback), names if penalty_tolerance is not None else ()
    names = frozenset(p.name for p in penalties_of(seal) if p.name in wanted)
    # first path: coarse steps, or some of the given ones
    begun = _divided_stages(seal, coarse) if step_tolerance is not None else _thinned(seal, coarse)
    ends, result = _first_path(seal, begun, run, 1, given=step_tolerance is None)
    if not result.converged:
        if step_tolerance is not None:
            result.require_converged()
        # its analysis will say how far it comes
        return Choice(
            seal, tuple(np.arange(1.0, seal.n_steps + 1.0)), penalty_values(seal, names), None, None
        )
    # given steps: adjust the penalties alone
    if step_tolerance is None:
        chosen, ends, error = seal, np.arange(1.0, seal.n_steps + 1.0), None
        if names:
            chosen, result = with_adjusted_penalties(seal, result, names, penalty_tolerance, run)
    else:
        # refine steps and adjust penalties together
        ends, result, error = with_refined_steps(
            seal, ends, result, step_tolerance, names, penalty_tolerance, run
        )
        chosen = result.seal
        if error > step_tolerance:
            # the analysis says so
            chosen = replace(chosen, step_error=error)
            result = replace(result, seal=chosen)
    # the last path is the analysis of the chosen seal: solve it once only
    if result.seal.key == chosen.key:
        store_path(chosen, result.path)
    # error that remains by the chosen penalties
    left = relative_error(result, names) if names else None
    return Choice(chosen, tuple(ends.tolist()), penalty_values(chosen, names), error, left)


def _divided_stages(seal: Seal, coarse: int) -> np.ndarray:
    """Return the ends of at least ``coarse`` equal load steps over stages of one nominal step each."""
    return divided(np.arange(1.0, seal.n_steps + 1.0), -(-coarse // seal.n_steps))


def _thinned(seal: Seal, coarse: int) -> np.ndarray:
    """Select about ``coarse`` of the given ends of load steps, including the ends of all stages."""
    # every k-th end, and the ends of the stages
    every = -(-seal.n_steps // coarse)
    stages = [np.cumsum(motion.steps) for motion in motions(seal)]
    return np.unique(np.concatenate([*stages, np.arange(every, seal.n_steps, every)])).astype(float)


def _first_path(seal: Seal, ends: np.ndarray, run, more: int, given: bool):
    """Find load steps with which the path is completed: all that are ``given``, or the halves of those
    before, up to ``MOST`` times as many. Return their ends and the path."""
    every, most = np.arange(1.0, seal.n_steps + 1.0), MOST * len(ends)
    while True:
        result = run(seal, ends, more)
        if result.converged or len(ends) >= (len(every) if given else most):
            return ends, result
        # a failed path gives no error to compare: no other division than that of all steps
        ends = every if given else divided(ends, 2)
