"""Load steps by tolerance: chosen once on the drawn seal, then frozen.

A path with the steps S is compared with one in which each of them is divided in four. Where the two
drift apart the steps are halved, until all measures and the forces along the path agree. The sequence
is an attribute of the seal afterwards: functions of the design stay smooth.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.seals.result import SealResult, analyze, frozen_measures

FINER = 4
FIRST = 10
ROUNDS = 8


class StepChoice(NamedTuple):
    """Load steps and how far from a finer sequence they leave the path.

    Attributes
    ----------
    ends : tuple of float
        Ends of the steps as shares of the path, the last one 1.
    error : float
        Largest difference from ``FINER`` times as many steps, of a measure over its largest value and
        of a force along the path over its largest value.
    """

    ends: tuple
    error: float


def choose_steps(seal_with: Callable, tolerance: float, first: int = FIRST) -> StepChoice:
    """The load steps whose measures are within ``tolerance`` of ``FINER`` times as many.

    Parameters
    ----------
    seal_with : callable
        ``seal_with(ends)`` gives the drawn seal with load steps that end at these shares of the path.
    tolerance : float
        Relative, at most 1, as ``StepChoice.error``.
    first : int
        Equal steps to begin with.

    Raises
    ------
    LoadPathError
        When a path cannot be completed.
    ValueError
        When the tolerance is no such number, or is not reached after ``ROUNDS`` rounds of halving.
    """
    values.real("step_tolerance", tolerance, above=0.0, high=1.0)
    ends = np.arange(1, first + 1) / first
    for _ in range(ROUNDS):
        coarse, fine = (analyze(seal_with(tuple(e.tolist()))) for e in (ends, divided(ends, FINER)))
        coarse.require_converged()
        fine.require_converged()
        forces = force_differences(coarse, fine)
        error = max(measure_difference(coarse, fine), float(forces.max()))
        if error <= tolerance:
            return StepChoice(tuple(ends.tolist()), error)
        ends = halved(ends, drifts(coarse, fine))
    raise ValueError(
        f"load steps within {tolerance:g} were not found: {len(ends)} of them are still {error:.2g} "
        f"from {FINER} times as many; allow a larger tolerance or give n_steps"
    )


def divided(ends: np.ndarray, parts: int) -> np.ndarray:
    """Every step divided in equal parts; the old ends are kept bit for bit."""
    starts = np.concatenate([[0.0], ends[:-1]])
    share = np.arange(1, parts + 1) / parts
    new = starts[:, None] + (ends - starts)[:, None] * share
    new[:, -1] = ends
    return new.ravel()


def halved(ends: np.ndarray, drift: np.ndarray) -> np.ndarray:
    """Steps with more than the mean drift are halved."""
    starts = np.concatenate([[0.0], ends[:-1]])
    split = drift > drift.mean()
    return np.sort(np.concatenate([ends, 0.5 * (starts + ends)[split]]))


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
        scale = np.abs(exact).max(initial=0.0)
        if scale > 0.0:
            worst = max(worst, float(np.abs(values - exact).max() / scale))
    return worst
