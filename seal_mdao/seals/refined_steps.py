"""Refine load steps until a further division changes results by less than a tolerance.

Called by ``steps_and_penalties``. Those steps are halved in which the last two paths drift apart. Where
the penalties differ as well, their estimated effect on measures is taken off.
"""

import numpy as np

from seal_mdao.seals.adjusted_penalties import (
    CORRECTIONS,
    adjusted_penalties,
    is_too_costly,
    with_own_parameters,
)
from seal_mdao.seals.penalty_error import penalty_errors, scale_of, standard_measures
from seal_mdao.seals.profiles import moving_parts
from seal_mdao.seals.result import UNUSABLE, SealResult

ROUNDS = 10
"""Largest number of times that the steps are divided."""
SETTLING = 0.5
"""Largest ratio of an error to that two divisions before; 1/4 where errors are of first order."""
DIVIDED = 0.5
"""Drift of the steps that are divided, over the mean one: with less many small drifts stay, and further
paths are needed; with more there are as many paths."""


def with_refined_steps(seal, ends, coarse: SealResult, tolerance, names, penalty_tolerance, run):
    """Refine load steps and adjust penalties until both errors are within their tolerances.

    Returns the ends of the steps, the path, and its estimated error by the steps. The error is
    estimated by the change in the last division, since it is at least of first order in the step size;
    for steps that were not divided again, by their fraction of the drift before. Steps within which
    measures are interpolated are divided until these do not change, either. It is above the
    tolerance where further divisions do not reduce it, such as after a loss of stability.
    """
    # e, drift of every step, remaining corrections of penalties
    errors, drift, corrections = [np.inf], np.ones(len(ends)), CORRECTIONS
    # error of interpolated measures, and the steps within which it is too large
    between, within = 0.0, np.empty(0, int)
    # for some measures drifts do not show which steps are too long
    all_alike = any(measure.needs_all_steps for measure in standard_measures(coarse))
    for _ in range(ROUNDS):
        error = errors[-1]
        changed = adjusted_penalties(coarse, names, penalty_tolerance) if corrections else {}
        enough = max(error, between) <= tolerance and not changed
        if enough or (between <= tolerance and _does_not_settle(errors)):
            break
        # next path: divided steps, other penalties
        parts = _parts(error, np.ones(len(ends)) if all_alike else drift, tolerance)
        parts[within] = 2
        finer = divided(ends, parts)
        other_seal = with_own_parameters(seal.with_parameters(changed)) if changed else seal
        fine = run(other_seal, finer, 0)
        # other penalties that converge worse are given up
        if changed and is_too_costly(fine, coarse):
            other_seal, corrections = seal, 1
            fine = run(seal, finer, 0)
        fine.require_converged()
        seal, corrections = other_seal, corrections - bool(changed)
        # index of the matching fine step; steps that were not divided
        at, whole = np.cumsum(parts) - 1, parts == 1
        # error of steps not divided: e (sum of their drift) / (sum of all)
        left = error * drift[whole].sum() / drift.sum() if whole.any() else 0.0
        # e = left + |m(fine) - m(coarse)| / scale
        errors.append(left + difference(coarse, fine, at, by_penalties=bool(changed)))
        # half of the drift in either half of a divided step
        drift = np.repeat(np.where(whole, drift, 0.5 * drifts(coarse, fine, at)), parts)
        between, within = interpolation(coarse, fine, tolerance)
        ends, coarse = finer, fine
    return ends, coarse, max(errors[-1], between)


def _does_not_settle(errors: list) -> bool:
    """Whether the last error makes results unusable and is above ``SETTLING`` times all but the one
    before it. Smaller errors may rise while the steps are still long."""
    # the first one is infinite
    settling = len(errors) <= 3 or errors[-1] <= SETTLING * min(errors[:-2])
    return errors[-1] > UNUSABLE and not settling


def _parts(error: float, drift: np.ndarray, tolerance: float) -> np.ndarray:
    """Return the number of parts of every load step: two where its drift is at least ``DIVIDED`` times
    the mean."""
    split = (drift >= DIVIDED * drift.mean()) & (error > tolerance)
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
    for part in moving_parts(coarse.seal):
        one, other = (result.path.reaction(part.label) for result in (coarse, fine))
        # max |F_coarse - F_fine| / max |F_fine| along the path; rounding errors count as zero
        scale = max(np.abs(other).max(), fine.path.least_force)
        found.append(float(np.abs(one - other[at]).max() / scale))
    return max(found)


def measure_difference(coarse: SealResult, fine: SealResult, by_penalties: bool = False) -> float:
    """Compute the largest relative difference of the measures, at the points of ``fine``, without those
    that are interpolated between steps."""
    worst, measures = 0.0, standard_measures(fine)
    # expected change c/w_coarse - c/w_fine
    known = _changes_by_penalties(coarse, fine, measures) if by_penalties else {}
    for measure in measures:
        if not measure.between_steps(fine).size:
            apart = _relative(coarse, fine, measure, known.get(measure.name, 0.0))
            worst = max(worst, float(apart.max(initial=0.0)))
    return worst


def interpolation(
    coarse: SealResult, fine: SealResult, tolerance: float
) -> tuple[float, np.ndarray]:
    """Compute the largest relative difference of the measures that are interpolated between steps, and
    the steps of ``fine``, indices (k,), with differences above the tolerance.

    Displacements say nothing of them: where a seal slides steadily they are the same at the ends of
    long and short steps, but the force turns round within a fraction of the first one.
    """
    worst, found = 0.0, [np.empty(0, int)]
    for measure in standard_measures(fine):
        fractions = measure.between_steps(fine)
        if fractions.size:
            apart = float(_relative(coarse, fine, measure).max())
            worst = max(worst, apart)
            if apart > tolerance:
                # the step of index k between the fractions k and k + 1
                found.append(np.floor(fractions).astype(int))
    return worst, np.unique(np.concatenate(found))


def _relative(coarse: SealResult, fine: SealResult, measure, known=0.0) -> np.ndarray:
    """Compute the relative differences of the values of a measure beyond the ``known`` ones, shape
    (m,); zero where the scale is."""
    # a seal without contacts has no penalty errors
    errors = fine.penalty_error
    scale = errors[measure.name].scale if errors else scale_of(measure, fine)
    # |m_coarse - m_fine - expected| / scale, of values that exist: the leak rate of a seal that is not
    # closed is infinite in both
    one, other = coarse.value(measure), fine.value(measure)
    both = np.isfinite(one) & np.isfinite(other)
    apart = np.abs(np.subtract(one - known, other, where=both, out=np.zeros(np.shape(one))))
    return apart / scale if scale > 0.0 else 0.0 * apart


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
