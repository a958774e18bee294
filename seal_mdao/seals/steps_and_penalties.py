"""Choose load steps and contact penalties by tolerance, once on the nominal seal; then they are fixed.

A coarse path comes first. Where its estimated error of a measure by the penalties (``penalty_error``),
the penetration or the elastic slip in stick is above the tolerance, the next path has penalties that
are higher by the ratio of the two. That path has the steps that are given, or where they are chosen
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
from seal_mdao.seals.chosen_path import store_path
from seal_mdao.seals.penalty_error import (
    compliance,
    penalties_of,
    penalty_errors,
    scale_of,
    standard_measures,
)
from seal_mdao.seals.profiles import contacts, motions, moved_edges
from seal_mdao.seals.result import FACTOR_MEMORY, SealResult, analyze_particles
from seal_mdao.seals.seal import Seal

STEP_TOLERANCE = 5e-3
PENALTY_TOLERANCE = 1e-3
COARSE = 12
"""Least number of equal load steps of the first path."""
MOST = 8
"""Largest refinement of the first path while paths still fail, as a factor on its steps."""
ROUNDS = 10
CORRECTIONS = 4
"""Largest number of times that the penalties are raised."""
COSTLY = 2.0
"""Largest ratio of iterations per load step of a path with higher penalties to that before."""
SURPLUS = 1.5
"""Factor on the ratio of error to tolerance by which a penalty is raised."""
RELATIVE_ROUNDING = 1e-10
"""Largest rounding error of the contact pressure over the shear modulus; it bounds the penalties."""


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
        force anywhere on the path over its largest one; None where the steps were given.
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
    callback with a method ``begin_analysis``.
    """

    def __init__(self, callback: Callable | None):
        self.callback, self.number, self.discretization = callback, 0, None
        self.report = getattr(callback, "begin_analysis", None)
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
            callback=self.callback, discretization=self.discretization,
            resume=states.get(max(states, default=0)), states=states,
        )  # fmt: skip
        # steps and penalties do not change the discretised body
        self.discretization = result.path.discretization
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
        number that there will be at the least, and its load steps.

    Raises
    ------
    LoadPathError
        When the path cannot be completed and steps are to be chosen.
    ValueError
        When a tolerance is no such number, or load steps within it are not found in ``ROUNDS`` rounds.
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
    ends, result = _first_path(seal, begun, run, more=1)
    if not result.converged:
        if step_tolerance is not None:
            result.require_converged()
        # its analysis will say how far it comes
        return Choice(
            seal, tuple(np.arange(1.0, seal.n_steps + 1.0)), _values(seal, names), None, None
        )
    # given steps: raise the penalties alone
    if step_tolerance is None:
        chosen, ends, error = seal, np.arange(1.0, seal.n_steps + 1.0), None
        if names:
            chosen, result = _with_penalties(seal, result, names, penalty_tolerance, run)
    else:
        # refine steps and raise penalties together
        ends, result, error = _with_steps(
            seal, ends, result, step_tolerance, names, penalty_tolerance, run
        )
        chosen = result.seal
    # the last path is the analysis of the chosen seal: solve it once only
    if result.seal.key == chosen.key:
        store_path(chosen, result.path)
    # error that remains by the chosen penalties
    left = relative_error(result, names) if names else None
    return Choice(chosen, tuple(ends.tolist()), _values(chosen, names), error, left)


def _divided_stages(seal: Seal, coarse: int) -> np.ndarray:
    """Return the ends of at least ``coarse`` equal load steps over stages of one nominal step each."""
    return divided(np.arange(1.0, seal.n_steps + 1.0), -(-coarse // seal.n_steps))


def _thinned(seal: Seal, coarse: int) -> np.ndarray:
    """Select about ``coarse`` of the given ends of load steps, including the ends of all stages."""
    # every k-th end, and the ends of the stages
    every = -(-seal.n_steps // coarse)
    stages = [np.cumsum(motion.steps) for motion in motions(seal)]
    return np.unique(np.concatenate([*stages, np.arange(every, seal.n_steps, every)])).astype(float)


def _first_path(seal: Seal, ends: np.ndarray, run, more: int):
    """Find load steps with which the path is completed: halve them while it fails, up to ``MOST`` times
    as many. Return their ends and the path."""
    most = MOST * len(ends)
    while True:
        result = run(seal, ends, more)
        if result.converged or len(ends) >= most:
            return ends, result
        # halve all steps, since a failed path gives no error to compare
        ends = divided(ends, 2)


def _values(seal: Seal, names) -> dict[str, float]:
    """Return the values of some penalties."""
    return {p.name: p.value for p in penalties_of(seal) if p.name in names}


# ---- penalties ----


def _groups(seal: Seal, names) -> list[frozenset]:
    """Group penalties that are raised by a common factor: those of rigid contacts, then those of
    self-contact, whose ratios to the stiffness of the body differ."""
    rigid = {contact.label for contact in contacts(seal)}
    first = frozenset(p.name for p in penalties_of(seal) if p.name in names and p.contact in rigid)
    return [group for group in (first, frozenset(names) - first) if group]


def relative_error(result: SealResult, names) -> float:
    """Compute the largest relative error by the penalties ``names``: in a measure, or as penetration or
    elastic slip in stick over the largest displacement.

    Measures whose error is not estimable, because contact is about to open, are left out where there
    are others.
    """
    errors = result.penalty_error.values()
    # all of them where none is estimable
    errors = [error for error in errors if error.estimable] or errors
    return max(compliance(result, names), *(error.part(names) for error in errors))


def _with_penalties(seal: Seal, result: SealResult, names, tolerance: float | None, run):
    """Raise ``names`` until their error is within the tolerance; return the seal, in its own steps, and
    its path. ``result`` is a coarse path.

    Ends early where higher penalties cost too much (``_too_costly``) or are bounded by rounding. Groups
    that were raised together are then raised one after the other.
    """
    for _ in range(CORRECTIONS):
        raised = _raised(result, names, tolerance)
        if not raised:
            break
        stiffer = _own(seal.with_parameters(raised))
        again = run(stiffer, None, 0)
        if _too_costly(again, result):
            # the penalties before remain, of one group alone where that is enough
            groups = [group for group in _groups(seal, names) if group & raised.keys()]
            for group in groups if len(groups) > 1 else ():
                seal, result = _with_penalties(seal, result, group, tolerance, run)
            break
        seal, result = stiffer, again
    return seal, result


def _too_costly(result: SealResult, before: SealResult) -> bool:
    """Whether a path with higher penalties fails, or takes ``COSTLY`` times the iterations for each
    load step."""
    iterations, others = (path.newton_iterations.mean() for path in (result, before))
    return not result.converged or iterations > COSTLY * others


def _raised(result: SealResult, names, tolerance: float) -> dict[str, float]:
    """Compute higher values of the penalties whose error exceeds the tolerance.

    All of a group by one factor: the ratio of tangential to normal penalty decides over the first
    increment of a point that comes into contact, which is an error of the load steps.
    """
    found, highest = {}, most_penalty(result.seal)
    for group in _groups(result.seal, names):
        excess, before = relative_error(result, group) / tolerance, _values(result.seal, group)
        # error ~ 1/w: w_new = w (1.5 error / tolerance), bounded by rounding
        factor = min(SURPLUS * excess, highest / max(before.values()))
        # two significant digits, for whoever reads them
        raised = {name: float(f"{value * factor:.2g}") for name, value in before.items()}
        if excess > 1.0 and all(raised[name] > before[name] for name in before):
            found |= raised
    return found


def most_penalty(seal: Seal) -> float:
    """Compute the highest penalty, kPa/mm, with pressures exact to ``RELATIVE_ROUNDING`` times G.

    A gap is a difference of coordinates, known to eps L, so the pressure is to w eps L.
    """
    # w eps L <= RELATIVE_ROUNDING G
    shear = max(region.material.shear_modulus for region in seal.terms()[0].regions)
    size = float(np.abs(seal.nominal_particles).max())
    return RELATIVE_ROUNDING * shear / (np.finfo(float).eps * size)


def _own(seal: Seal) -> Seal:
    """Return the seal with changed parameters moved into its terms and measures."""
    standard, further = (
        tuple(measure.with_parameters(seal.changed) for measure in own)
        for own in (seal.standard, seal.further)
    )
    return replace(seal, definitions=seal.terms(), standard=standard, further=further, changed={})


# ---- load steps ----


def _with_steps(seal, ends, coarse: SealResult, tolerance, names, penalty_tolerance, run):
    """Refine load steps and raise penalties until both errors are within their tolerances.

    Returns the ends of the steps, the path, and its estimated error by the steps. The error is
    estimated by the change in the last division, since it is at least of first order in the step size;
    for steps that were not divided again, by their fraction of the drift before.
    """
    # e, drift of every step, remaining corrections of penalties
    error, drift, corrections = np.inf, np.ones(len(ends)), CORRECTIONS
    for _ in range(ROUNDS):
        raised = _raised(coarse, names, penalty_tolerance) if corrections else {}
        if error <= tolerance and not raised:
            return ends, coarse, error
        # next path: divided steps, raised penalties
        parts = _parts(error, drift, tolerance)
        finer = divided(ends, parts)
        stiffer = _own(seal.with_parameters(raised)) if raised else seal
        fine = run(stiffer, finer, 0)
        # higher penalties that converge badly are given up
        if raised and _too_costly(fine, coarse):
            stiffer, corrections = seal, 1
            fine = run(seal, finer, 0)
        fine.require_converged()
        seal, corrections = stiffer, corrections - bool(raised)
        # index of the matching fine step; steps that were not divided
        at, whole = np.cumsum(parts) - 1, parts == 1
        # error of steps not divided: e (sum of their drift) / (sum of all)
        left = error * drift[whole].sum() / drift.sum() if whole.any() else 0.0
        # e = left + |m(fine) - m(coarse)| / scale
        error = left + difference(coarse, fine, at, by_penalties=bool(raised))
        # half of the drift in either half of a divided step
        drift = np.repeat(np.where(whole, drift, 0.5 * drifts(coarse, fine, at)), parts)
        ends, coarse = finer, fine
    raise ValueError(
        f"load steps within {tolerance:g} were not found: {len(ends)} of them still err by {error:.2g}; "
        "allow a larger tolerance or give the steps"
    )


def _parts(error: float, drift: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the number of parts of every load step: two where its drift is at least the mean."""
    split = (drift >= drift.mean()) & (error > tolerance)
    return np.where(split, 2, 1)


def divided(ends: np.ndarray, parts) -> np.ndarray:
    """Divide load steps into equal parts, one number for all or each; old ends stay the same bitwise."""
    parts = np.broadcast_to(parts, len(ends))
    # start + (end - start) i / n,  i = 1 ... n - 1, and the end itself
    starts = np.concatenate([[0.0], ends[:-1]])
    found = [
        np.append(start + (end - start) * np.arange(1, n) / n, end)
        for start, end, n in zip(starts, ends, parts, strict=True)
    ]
    return np.concatenate(found)


def difference(
    coarse: SealResult, fine: SealResult, at: np.ndarray, by_penalties: bool = False
) -> float:
    """Compute the largest relative difference of two paths: measures at the end, forces on the path.

    Parameters
    ----------
    at : ndarray of int, shape (n_steps of coarse,)
        Nominal steps of ``fine`` that end where those of ``coarse`` do.
    by_penalties : bool
        Whether the penalties differ too; their estimated effect on measures is subtracted.
    """
    return max(measure_difference(coarse, fine, by_penalties), force_difference(coarse, fine, at))


def drifts(coarse: SealResult, fine: SealResult, at: np.ndarray) -> np.ndarray:
    """Compute the displacement error that each step of ``coarse`` adds, shape (n_steps,), mm."""
    # steps of both paths that end at the same load
    matching = [fine.path.nominal_steps[index] for index in at]
    apart = np.array([a.d - b.d for a, b in zip(coarse.path.nominal_steps, matching, strict=True)])
    # growth of d_coarse - d_fine in each step
    own = np.diff(apart, axis=0, prepend=0.0 * apart[:1])
    return np.abs(own).max(axis=(1, 2))


def force_difference(coarse: SealResult, fine: SealResult, at: np.ndarray) -> float:
    """Compute the largest relative difference of the total force on a rigid profile, or on moved edges,
    along the path."""
    found = [0.0]
    moving = (*contacts(coarse.seal), *moved_edges(coarse.seal))
    for label in dict.fromkeys(own.label for own in moving):
        one, other = (result.path.reaction(label) for result in (coarse, fine))
        # max |F_coarse - F_fine| / max |F_fine| along the path
        scale = np.abs(other).max()
        if scale > 0.0:
            found.append(float(np.abs(one - other[at]).max() / scale))
    return max(found)


def measure_difference(coarse: SealResult, fine: SealResult, by_penalties: bool = False) -> float:
    """Compute the largest relative difference of the measures, at the points of ``fine``."""
    worst, measures = 0.0, standard_measures(fine)
    # expected change c/w_coarse - c/w_fine
    known = _changes_by_penalties(coarse, fine, measures) if by_penalties else {}
    # a seal without contacts has no penalty errors
    errors = fine.penalty_error
    for measure in measures:
        scale = errors[measure.name].scale if errors else scale_of(measure, fine)
        if scale > 0.0:
            # (m_coarse - m_fine - expected) / scale
            apart = coarse.value(measure) - fine.value(measure) - known.get(measure.name, 0.0)
            worst = max(worst, float(np.abs(apart).max(initial=0.0) / scale))
    return worst


def _changes_by_penalties(coarse: SealResult, fine: SealResult, measures) -> dict:
    """Estimate the effect of penalties on measures: c/w of ``coarse`` minus c/w of ``fine``."""
    other = fine.penalty_error
    # over the same reference values
    scales = {name: found.scale for name, found in other.items()}
    one = penalty_errors(coarse, measures, scales)
    return {
        name: one[name].error - other[name].error
        for name in one
        if one[name].estimable and other[name].estimable
    }
