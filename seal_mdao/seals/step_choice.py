"""Load steps by tolerance: chosen once on the drawn seal, then frozen.

A path with the steps S is compared with one in which each of them is divided in four. Where the two
drift apart the steps are halved, until all measures and the forces along the path agree. The sequence
is an attribute of the seal afterwards: functions of the design stay smooth.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.measures.contact import Reaction
from seal_mdao.measures.measure import Derived
from seal_mdao.seals.result import SealResult, analyze, frozen_measures
from seal_mdao.seals.seal import Seal

TOLERANCE = 5e-3
FINER = 4
FIRST = 10
MOST = 4
"""Times the first steps that there may be while paths still fail."""
ROUNDS = 10
NOISE = 1e-6
"""Of its largest value along the path, below which a measure at the end is zero but for rounding."""


class StepChoice(NamedTuple):
    """Load steps and how far from a finer sequence they leave the path.

    Attributes
    ----------
    ends : tuple of float
        Ends of the steps, in nominal steps of the seal that they were chosen for: stages of its path.
    error : float
        Largest difference from ``FINER`` times as many steps, of a measure over its largest value at
        the end, and of a force anywhere on the path over its largest one.
    """

    ends: tuple
    error: float


def choose_steps(
    seal: Seal, tolerance: float, first: int = FIRST, callback: Callable | None = None
) -> StepChoice:
    """The load steps whose measures are within ``tolerance`` of ``FINER`` times as many.

    Parameters
    ----------
    seal : Seal
        As drawn, with one nominal step for every stage of its path.
    tolerance : float
        Relative, at most 1, as ``StepChoice.error``.
    first : int
        Equal steps to begin with, divided among the stages.
    callback : callable, optional
        Called with each ``ConvergedStep`` that completes a nominal step of one of the analyses.

    Raises
    ------
    LoadPathError
        When the path cannot be completed.
    ValueError
        When the tolerance is no such number, or is not reached after ``ROUNDS`` rounds of halving.
    """
    values.real("step_tolerance", tolerance, above=0.0, high=1.0)
    ends = begun = divided(np.arange(1.0, seal.n_steps + 1.0), -(-first // seal.n_steps))
    error = np.inf
    for _ in range(ROUNDS):
        fine = analyze(seal.with_ends(divided(ends, FINER)), callback=callback)
        coarse = analyze(seal.with_ends(ends), callback=callback) if fine.converged else fine
        if not coarse.converged:
            if len(ends) >= MOST * len(begun):
                coarse.require_converged()
            ends = divided(ends, 2)
            continue
        error = difference(coarse, fine)
        if error <= tolerance:
            return StepChoice(tuple(ends.tolist()), error)
        ends = halved(ends, drifts(coarse, fine))
    raise ValueError(
        f"load steps within {tolerance:g} were not found: {len(ends)} of them are still {error:.2g} "
        f"from {FINER} times as many; allow a larger tolerance or give the steps"
    )


def divided(ends: np.ndarray, parts: int) -> np.ndarray:
    """Every step divided in equal parts; the old ends are kept bit for bit."""
    starts = np.concatenate([[0.0], ends[:-1]])
    share = np.arange(1, parts + 1) / parts
    new = starts[:, None] + (ends - starts)[:, None] * share
    new[:, -1] = ends
    return new.ravel()


def halved(ends: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Steps with the mean drift or more are halved."""
    starts = np.concatenate([[0.0], ends[:-1]])
    split = drift >= drift.mean()
    return np.sort(np.concatenate([ends, 0.5 * (starts + ends)[split]]))


def difference(coarse: SealResult, fine: SealResult) -> float:
    """``StepChoice.error`` of two paths."""
    return max(measure_difference(coarse, fine), float(force_differences(coarse, fine).max()))


def drifts(coarse: SealResult, fine: SealResult) -> np.ndarray:
    """By how much every step of ``coarse`` moves the particles apart from ``fine``, shape (n_steps,)."""
    matching = fine.path.nominal_steps[FINER - 1 :: FINER]
    apart = np.array([a.d - b.d for a, b in zip(coarse.path.nominal_steps, matching, strict=True)])
    own = np.diff(apart, axis=0, prepend=0.0 * apart[:1])
    return np.abs(own).max(axis=(1, 2))


def force_differences(coarse: SealResult, fine: SealResult) -> np.ndarray:
    """Differences of the total forces of all rigid profiles along the path, over the largest one."""
    found = [0.0]
    for term in coarse.path.problem.terms:
        if hasattr(term, "motion"):
            pair = [result.path.reaction(term.label) for result in (coarse, fine)]
            scale = np.abs(pair[1]).max()
            if scale > 0.0:
                found.append(np.abs(pair[0] - pair[1][FINER - 1 :: FINER]).max() / scale)
    return np.array(found)


def measure_difference(coarse: SealResult, fine: SealResult) -> float:
    """Largest difference of a standard measure over its largest value, at the places of ``fine``."""
    worst = 0.0
    for measure in frozen_measures(fine.seal, analysis=lambda _: fine):
        values, exact = coarse.value(measure), fine.value(measure)
        scale = max(np.abs(exact).max(initial=0.0), least_scale(measure, fine))
        if scale > 0.0:
            worst = max(worst, float(np.abs(values - exact).max() / scale))
    return worst


def least_scale(measure, result: SealResult) -> float:
    """What a measure that may be zero but for rounding is compared with: its noise along the path, and
    for one component of a reaction the whole force."""
    if isinstance(measure, Reaction):
        return measure.scale * float(np.abs(result.path.reaction(measure.profile)).max())
    base = measure.base if isinstance(measure, Derived) else measure
    if not base.wants_end:
        return 0.0
    steps, path = result.path.steps, result.path
    until = [place for place, step in enumerate(steps, 1) if step.nominal % FINER == FINER - 1]
    parts = (replace(result, path=replace(path, steps=steps[:place])) for place in until)
    return NOISE * float(max(np.abs(part.value(measure)).max(initial=0.0) for part in parts))
