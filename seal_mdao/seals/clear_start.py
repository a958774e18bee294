"""Start positions of profiles that do not overlap the body, for any boundary and placement."""

import numpy as np

from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import BEFORE
from seal_mdao.geometry.pose import Pose
from seal_mdao.seals.seal import Seal

PART = 0.005
"""A profile backs off in multiples of the power of two that is nearest to this fraction of the nominal
section's size (mm), so that all designs have the same positions and their derivatives are those of
one path."""
MOST = 600
"""Largest number of these multiples, more than twice the section's size."""
PRESSING = 0.1
"""Least normal fraction of a travel for a profile to back off along that travel."""
STEP = 5e-6
"""Step of the difference quotients of gaps, over the section's size."""


def with_clear_starts(seal: Seal, particles: np.ndarray) -> Seal:
    """Move the start of profiles that would overlap a body backwards along their motion.

    Preliminary increments (``Motion.retraction``) bring them to where the first load step begins, so
    that all load steps are those of the motion. They end at fixed positions: a design whose profile has
    to start one position farther back has one more increment, which ends at first contact, and the same
    path from there on. Under friction, too, results are therefore continuous in the design.

    A profile whose first stage does not press (it stands still, turns, slides or leads away) backs off
    along its normal. One that is clear is left as it is, and so is one that would back off into the
    rubber.

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
            retraction = _retraction(definition, particles, nominal, seal)
            if retraction is not None:
                retractions[definition.label] = retraction
    return seal.with_retractions(retractions) if retractions else seal


def _gaps(contact: RigidContact, x: np.ndarray):
    """Return the gaps of points x (k, 2) where the first load step begins, as a function of a shift of
    the profile (2,), mm."""
    motion, x = contact.motion, np.ascontiguousarray(x)
    curve, (px, py, angle) = contact.shape.profile().curve, motion.coordinates(0.0)

    def gaps(shift):
        found = np.empty(len(x))
        normal_gaps(curve, Pose.of((px + shift[0], py + shift[1]), angle, motion.pivot), x, found)
        return found

    return gaps


def _retraction(contact: RigidContact, particles, nominal, seal: Seal) -> np.ndarray | None:
    """Find where the preliminary increments of a contact have to begin, from the start of its first load
    step, (n, 2) mm, the last one first; None where it is clear as it is, or cannot be.

    Direction and positions are those of the ``nominal`` contact and particles: they do not depend on
    the design.
    """
    motion, x = contact.motion, contact.where.moving.at(particles)
    gaps = _gaps(contact, x)
    if gaps(motion.coordinates(BEFORE)[:2] - motion.coordinates(0.0)[:2]).min() >= 0.0:
        return None
    part = 2.0 ** round(np.log2(PART * np.hypot(*np.ptp(seal.nominal_particles, axis=0))))
    way = _way_back(nominal, seal.nominal_particles)
    for count in range(1, MOST + 1):
        shift = count * part * way
        found = gaps(shift)
        if found.min() > 0.0:
            inside = _is_inside(contact, particles, seal.body.cells, x[found.argmin()], shift)
            return None if inside else np.arange(1, count + 1)[:, None] * part * way
    return None


def _is_inside(contact: RigidContact, particles, cells, x, shift) -> bool:
    """Return whether a profile that touches the boundary at a point x (2,) lies in the rubber there.

    One that overlaps the complete thickness of a wall would back off to the wrong side of its face.
    """
    at = int(np.hypot(*(particles - x).T).argmin())
    # centre of the cells beside the point: the gap increases from the point into the rubber
    centre = particles[cells[(cells == at).any(axis=1)]].mean(axis=(0, 1))
    at_point, within = _gaps(contact, np.array([x, centre]))(shift)
    return bool(within < at_point)


def _way_back(contact: RigidContact, particles) -> np.ndarray:
    """Compute the unit vector against the travel of the first stage where that presses, else along the
    normal at the nearest point."""
    gaps = _gaps(contact, contact.where.moving.at(particles))
    first, second = contact.motion.positions[:2]
    nearest = int(gaps((0.0, 0.0)).argmin())
    # n = grad g by central differences
    steps = STEP * float(np.hypot(*np.ptp(particles, axis=0))) * np.eye(2)
    slope = np.array([gaps(step)[nearest] - gaps(-step)[nearest] for step in steps])
    normal, travel = slope / (np.hypot(*slope) or 1.0), second - first
    length = float(np.hypot(*travel))
    presses = -normal @ travel >= PRESSING * length > 0.0
    return -travel / length if presses else normal
