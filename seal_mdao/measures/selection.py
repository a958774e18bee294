"""Selection of the points of measures on the nominal seal, after which they are fixed."""

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.contact.kinematics import linearized_positions
from seal_mdao.measures.singular_points import STRAIGHT, in_plane
from seal_mdao.rkpm.cells import sides_of


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


def mirrored_ends(term) -> tuple[bool, bool]:
    """Find which ends of the contact points of a profile continue with their mirror image.

    The boundary ends in a plane of symmetry or on the axis of revolution, and the profile is its own
    mirror image there: its normal lies in the plane. A gap at such an end is closed by the mirror image
    of the contact.

    Parameters
    ----------
    term : ContactTerm
    """
    where, discretization = term.where, term.discretization
    body, particles = discretization.body, discretization.particles
    pairs = np.sort(where.edges.reshape(-1, 2), axis=1)
    # sides of the boundary to which contact points belong, and all others
    own = {tuple(pair) for pair in pairs[pairs[:, 0] < pairs[:, 1]].tolist()}
    others = {tuple(side) for side in np.sort(sides_of(body.cells)[0], axis=1).tolist()} - own
    found = []
    for nearest in (where.edges[0], where.edges[-1]):
        # particles of the first or last point to which only one side belongs
        ends = [p for p in np.unique(nearest).tolist() if sum(p in side for side in own) == 1]
        found.append(
            any(
                in_plane(body, particles, *side)
                and _normal_in_plane(term, particles[end], body.fixed[list(side)].all(axis=0))
                for end in ends
                for side in others
                if end in side
            )
        )
    return tuple(found)


def _normal_in_plane(term, place, across) -> bool:
    """Return whether the normal of the profile beside a point is perpendicular to the direction
    ``across`` (2,)."""
    x, normal, gap = place[None].copy(), np.zeros((1, 2)), np.zeros(1)
    linearized_positions(term.curve, term.pose(0.0), x, x.copy(), normal, gap)
    return bool(abs(normal[0, across].item()) < STRAIGHT)


def contact_range(
    in_contact: np.ndarray, closed: bool = False, mirrored: tuple = (False, False)
) -> np.ndarray:
    """List the contact points from the first to the last one in contact, in order.

    On a closed boundary they are all points except those of its longest open part. Beyond the ends that
    are ``mirrored`` the boundary continues with its mirror image (``mirrored_ends``).
    """
    if any(mirrored):
        own = np.arange(in_contact.size)
        # mirror image, boundary, mirror image; a closed one where both ends are mirrored
        parts = [own[::-1]] * mirrored[0] + [own] + [own[::-1]] * (mirrored == (False, True))
        doubled = np.concatenate(parts)
        return np.unique(doubled[contact_range(in_contact[doubled], all(mirrored))])
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


def open_points(
    state: np.ndarray, closed: bool = False, mirrored: tuple = (False, False)
) -> np.ndarray:
    """Find the contact points that are open between the first and the last one in contact; arguments as
    of ``contact_range``."""
    between = contact_range(state != OPEN, closed, mirrored)
    return between[state[between] == OPEN]


def contact_patches(state: np.ndarray, closed: bool = False) -> tuple:
    """Divide the contact points into a patch for every contact region, at the middle of the open parts
    between them; one patch of all points with fewer than two regions."""
    touching, every = state != OPEN, np.arange(state.size)
    between = contact_range(touching, closed)
    # open runs between two regions, from their first point to the point after their last one
    change = np.flatnonzero(np.diff(touching[between])) + 1
    if change.size == 0:
        return (every,)
    first, after = change[::2], change[1::2]
    cuts = between[(first + after) // 2]
    if closed:
        # the points begin at the middle of the longest open part, which is not between the regions
        every = np.roll(every, -(between[-1] + 1 + (state.size - between.size) // 2))
    return tuple(np.split(every, np.flatnonzero(np.isin(every, cuts))))
