"""Start positions of profiles that do not overlap the body, for any boundary and placement."""

import numpy as np

from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import BEFORE, Motion
from seal_mdao.geometry.pose import Pose
from seal_mdao.seals.seal import Seal

PART = 0.005
"""A profile backs off in multiples of the power of two that is nearest to this fraction of the section's
size (mm), so that neighbouring designs have the same positions and their derivatives are those of
one path."""
MOST = 600
"""Largest number of these multiples, more than twice the section's size."""
PRESSING = 0.1
"""Least normal fraction of a travel for a profile to back off along that travel."""


def with_clear_starts(seal: Seal, particles: np.ndarray) -> Seal:
    """Move the start of profiles that would overlap a body backwards along their motion.

    Preliminary increments (``Motion.retraction``) bring them to where the first load step begins, so
    that all load steps are those of the motion. They end at fixed positions: a design whose profile has
    to start one position farther back has one more increment, which ends at first contact, and the same
    path from there on. Under friction, too, results are therefore continuous in the design.

    A profile whose first stage does not press (it stands still, turns or slides) backs off along its
    normal. One that is clear is left as it is, and so is one whose first stage leads away from the body.

    Parameters
    ----------
    seal : Seal
    particles : ndarray, shape (n, 2)
        Of the design, mm.

    Returns
    -------
    Seal
        The same object where all profiles are clear.
    """
    retractions = {}
    for nominal, definition in zip(seal.definitions, seal.terms(), strict=True):
        if isinstance(definition, RigidContact):
            retraction = _retraction(definition, nominal.motion, particles)
            if retraction is not None:
                retractions[definition.label] = retraction
    return seal.with_retractions(retractions) if retractions else seal


def _retraction(contact: RigidContact, nominal: Motion, particles) -> np.ndarray | None:
    """Find where the preliminary increments of a contact have to begin, from the start of its first load
    step, (n, 2) mm, the last one first; None where it is clear as it is, or cannot be.

    The direction is that of the ``nominal`` motion, so that it does not depend on parameters.
    """
    motion, x = contact.motion, np.ascontiguousarray(contact.where.moving.at(particles))
    curve, (px, py, angle) = contact.shape.profile().curve, motion.coordinates(0.0)

    def gaps(shift):
        found = np.empty(len(x))
        normal_gaps(curve, Pose.of((px + shift[0], py + shift[1]), angle, motion.pivot), x, found)
        return found

    if gaps(motion.coordinates(BEFORE)[:2] - (px, py)).min() >= 0.0:
        return None
    # the same for neighbouring designs, whose sizes differ
    part = 2.0 ** round(np.log2(PART * np.hypot(*np.ptp(particles, axis=0))))
    back = _way_back(nominal.positions[1] - nominal.positions[0], gaps, part)
    for count in range(1, MOST + 1):
        if gaps(count * part * back).min() > 0.0:
            return np.arange(1, count + 1)[:, None] * part * back
    return None


def _way_back(travel: np.ndarray, gaps, part: float) -> np.ndarray:
    """Unit vector against the travel of the first stage where that presses, else along the normal at
    the deepest point; zero where the first stage leads away from the body."""
    deepest = int(gaps((0.0, 0.0)).argmin())
    # n = grad g by central differences
    steps = 1e-3 * part * np.eye(2)
    slope = np.array([gaps(step)[deepest] - gaps(-step)[deepest] for step in steps])
    normal, length = slope / (np.hypot(*slope) or 1.0), float(np.hypot(*travel))
    pressing = -normal @ travel
    if pressing >= PRESSING * length > 0.0:
        return -travel / length
    return normal if pressing >= 0.0 else np.zeros(2)
