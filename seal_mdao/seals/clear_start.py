"""Start positions of profiles that do not overlap the body, for any boundary and placement."""

import numpy as np

from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.pose import Pose
from seal_mdao.seals.seal import Seal

PART = 0.005
"""A profile backs off in multiples of this fraction of the section's size, so that neighbouring
designs have the same start and their derivatives are those of one path."""
MOST = 400
"""Largest number of these multiples: twice the section's size."""
PRESSING = 0.1
"""Least normal fraction of a travel for a profile to back off along that travel."""


def with_clear_starts(seal: Seal, particles: np.ndarray) -> Seal:
    """Move the start of profiles that would overlap a body backwards along their motion.

    The first load step becomes longer and ends where it did (``Motion.clearance``), as do all others. A
    profile whose first stage does not press (it stands still, turns or slides) backs off along its
    normal and is brought to its place by the first step. One that is clear is left as it is, and so is
    one whose first stage leads away from the body.

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
    clearances = {}
    for definition in seal.terms():
        if isinstance(definition, RigidContact):
            clearance = _clearance(definition, particles)
            if clearance is not None:
                clearances[definition.label] = clearance
    return seal.with_clearances(clearances) if clearances else seal


def _clearance(contact: RigidContact, particles) -> np.ndarray | None:
    """Where the first load step of a contact has to begin, from its first waypoint, (2,) mm; None where
    it is clear as it is, or cannot be."""
    motion, x = contact.motion, np.ascontiguousarray(contact.where.moving.at(particles))
    curve, (px, py, angle) = contact.shape.profile().curve, motion.coordinates(0.0)

    def gaps(shift):
        found = np.empty(len(x))
        normal_gaps(curve, Pose.of((px + shift[0], py + shift[1]), angle, motion.pivot), x, found)
        return found

    if gaps((0.0, 0.0)).min() >= 0.0:
        return None
    part = PART * float(np.hypot(*np.ptp(particles, axis=0)))
    back = _way_back(motion.positions[1] - motion.positions[0], gaps, part)
    for count in range(1, MOST + 1):
        if gaps(count * part * back).min() > 0.0:
            return motion.clearance + count * part * back
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
