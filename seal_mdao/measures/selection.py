"""Where the measures are taken: chosen once on the drawn seal, then frozen."""

import numpy as np

from seal_mdao.contact.friction import OPEN


def local_maxima(values: np.ndarray, periodic: bool) -> np.ndarray:
    """Places of the strict local maxima along a row; the ends of an open row do not count."""
    left, right = np.roll(values, 1), np.roll(values, -1)
    peak = (values > left) & (values > right)
    if not periodic:
        peak[[0, -1]] = False
    return np.flatnonzero(peak)


def boundary_peaks(rows, stress: np.ndarray, count: int) -> np.ndarray:
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
    # by number within a boundary, so that ties do not depend on the way round
    peaks = np.concatenate(
        [np.sort(row[local_maxima(stress[row], closed)]) for row, closed in rows]
    )
    others = np.setdiff1d(np.concatenate([row for row, _ in rows]), peaks)
    ranked = [group[np.argsort(-stress[group], kind="stable")] for group in (peaks, others)]
    return np.concatenate(ranked)[:count]


def touching_stretch(in_contact: np.ndarray, closed: bool = False) -> np.ndarray:
    """Contact points from the first to the last one in contact, in order.

    On a closed boundary they are all points but those of its longest open part.
    """
    touching, size = np.flatnonzero(in_contact), in_contact.size
    if touching.size == 0:
        return touching
    if closed:
        following = np.append(touching[1:], touching[0] + size)
        last = int(np.argmax(following - touching))
        first = (last + 1) % touching.size
        return np.arange(touching[first], touching[last] + 1 + size * (first > last)) % size
    return np.arange(touching[0], touching[-1] + 1)


def opened_points(state: np.ndarray, closed: bool = False) -> np.ndarray:
    """Contact points that stand open between the first and the last one in contact."""
    between = touching_stretch(state != OPEN, closed)
    return between[state[between] == OPEN]


def contact_patches(state: np.ndarray) -> tuple:
    """All contact points: before and after the middle of the opened stretch, or in one piece."""
    everywhere, opened = np.arange(state.size), opened_points(state)
    if opened.size == 0:
        return (everywhere,)
    middle = opened[opened.size // 2]
    return everywhere[:middle], everywhere[middle:]
