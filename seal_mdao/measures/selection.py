"""Selection of the points of measures on the nominal seal, after which they are fixed."""

import numpy as np

from seal_mdao.contact.friction import OPEN


def local_maxima(values: np.ndarray, periodic: bool) -> np.ndarray:
    """Find the indices of strict local maxima along a row; the ends of an open row do not count."""
    left, right = np.roll(values, 1), np.roll(values, -1)
    # v_i > v_(i-1) and v_i > v_(i+1)
    peak = (values > left) & (values > right)
    if not periodic:
        peak[[0, -1]] = False
    return np.flatnonzero(peak)


def boundary_peaks(rows, stress: np.ndarray, count: int) -> np.ndarray:
    """Find the particles of the ``count`` largest local maxima along boundary rows, largest first.

    Parameters
    ----------
    rows : sequence of (ndarray of int, bool)
        Particles of each boundary row in order, and whether the row is closed.
    stress : ndarray, shape (n,)
        Von Mises stress at all particles. Where there are fewer maxima than ``count``, the
        largest other boundary values follow.
    """
    # symmetric values that differ by rounding only keep their order
    stress = np.round(stress / max(np.abs(stress).max(), np.finfo(float).tiny), 9)
    # by number within a boundary, so that ties do not depend on the orientation
    peaks = np.concatenate(
        [np.sort(row[local_maxima(stress[row], closed)]) for row, closed in rows]
    )
    others = np.setdiff1d(np.concatenate([row for row, _ in rows]), peaks)
    # local maxima first, each group sorted by decreasing stress
    ranked = [group[np.argsort(-stress[group], kind="stable")] for group in (peaks, others)]
    return np.concatenate(ranked)[:count]


def contact_range(in_contact: np.ndarray, closed: bool = False) -> np.ndarray:
    """List the contact points from the first to the last one in contact, in order.

    On a closed boundary they are all points except those of its longest open part.
    """
    touching, size = np.flatnonzero(in_contact), in_contact.size
    if touching.size == 0:
        return touching
    if closed:
        # the longest open part lies between the contacts `last` and `first`
        following = np.append(touching[1:], touching[0] + size)
        last = int(np.argmax(following - touching))
        first = (last + 1) % touching.size
        return np.arange(touching[first], touching[last] + 1 + size * (first > last)) % size
    return np.arange(touching[0], touching[-1] + 1)


def open_points(state: np.ndarray, closed: bool = False) -> np.ndarray:
    """Find the contact points that are open between the first and the last one in contact."""
    between = contact_range(state != OPEN, closed)
    return between[state[between] == OPEN]


def contact_patches(state: np.ndarray) -> tuple:
    """Divide the contact points at the middle of the open region; one patch without an open region."""
    everywhere, opened = np.arange(state.size), open_points(state)
    if opened.size == 0:
        return (everywhere,)
    # the open point in the middle divides the boundary into two patches
    middle = opened[opened.size // 2]
    return everywhere[:middle], everywhere[middle:]
