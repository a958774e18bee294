"""Where the measures are taken: chosen once on the drawn seal, then frozen."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.contact.friction import OPEN

STRESS_COUNT = 7


@dataclass(frozen=True, eq=False)
class MeasurePoints:
    """Frozen places of the measures.

    Attributes
    ----------
    stress : ndarray of int
        Particles at which the von Mises stress is a measure.
    gap : ndarray of int
        Contact points (places in ``body.contact``) whose normal gap is a measure.
    stretch : ndarray of int
        Contact points from the first to the last one in contact.
    patches : tuple of ndarray of int
        All contact points, divided in the middle of the opened stretch.
    curve : ndarray of int
        Nominal steps, from 0, whose reaction is a measure.
    """

    stress: np.ndarray
    gap: np.ndarray
    stretch: np.ndarray
    patches: tuple
    curve: np.ndarray

    def size_of(self, measure: str) -> int:
        """Entries of an optional measure."""
        return {"patch_pressure": len(self.patches), "reaction_curve": self.curve.size}.get(
            measure, 1
        )


def local_maxima(values: np.ndarray, periodic: bool) -> np.ndarray:
    """Places of the strict local maxima along a row; the ends of an open row do not count."""
    left, right = np.roll(values, 1), np.roll(values, -1)
    peak = (values > left) & (values > right)
    if not periodic:
        peak[[0, -1]] = False
    return np.flatnonzero(peak)


def stress_points(rows, stress: np.ndarray, count: int = STRESS_COUNT) -> np.ndarray:
    """The particles of the ``count`` largest local maxima along boundary rows, largest first.

    Parameters
    ----------
    rows : sequence of (ndarray of int, bool)
        Particles of each boundary row in order, and whether the row is closed.
    stress : ndarray, shape (n,)
        Von Mises stress at all particles. Where there are fewer maxima than ``count``, the
        largest other boundary values follow.
    """
    # mirror images that differ by rounding only keep their order
    stress = np.round(stress / max(np.abs(stress).max(), np.finfo(float).tiny), 9)
    peaks = np.concatenate([row[local_maxima(stress[row], closed)] for row, closed in rows])
    others = np.setdiff1d(np.concatenate([row for row, _ in rows]), peaks)
    ranked = [group[np.argsort(-stress[group], kind="stable")] for group in (peaks, others)]
    return np.concatenate(ranked)[:count]


def touching_stretch(state: np.ndarray) -> np.ndarray:
    """Contact points from the first to the last one in contact."""
    touching = np.flatnonzero(state != OPEN)
    if touching.size == 0:
        return touching
    return np.arange(touching[0], touching[-1] + 1)


def opened_points(state: np.ndarray) -> np.ndarray:
    """Contact points that stand open between the first and the last one in contact."""
    between = touching_stretch(state)
    return between[state[between] == OPEN]


def contact_patches(state: np.ndarray) -> tuple:
    """All contact points: before and after the middle of the opened stretch, or in one piece."""
    everywhere, opened = np.arange(state.size), opened_points(state)
    if opened.size == 0:
        return (everywhere,)
    middle = opened[opened.size // 2]
    return everywhere[:middle], everywhere[middle:]


def curve_steps(travel: np.ndarray, depths) -> np.ndarray:
    """Steps, from 0, whose ``travel`` is nearest to those of the ``depths`` that are reached."""
    reached = [depth for depth in depths if depth <= travel[-1] + 1e-9]
    return np.array([np.argmin(np.abs(travel - depth)) for depth in reached], int)
