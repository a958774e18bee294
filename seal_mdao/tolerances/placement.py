"""Clearance for boundaries and rigid profiles that deviate from the drawing."""

import numpy as np

from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.seal import Seal

CLEARANCE = 0.5
"""Clearance, mm, with which hardly any sample begins inside a seal."""


def with_clearance(seal: Seal) -> Seal:
    """Return the seal with profiles that start 0.5 mm farther back along their travel: a clearance for
    boundary errors and turned profiles, the same for all designs of an optimisation."""
    clearances = {}
    for contact in contacts(seal):
        # backwards along the first increment of the motion
        back = contact.motion.positions[0] - contact.motion.positions[1]
        length = np.hypot(*back)
        # a fixed or turning profile has no direction of travel
        if length:
            clearances[contact.label] = contact.motion.clearance + CLEARANCE * back / length
    return seal.with_clearances(clearances) if clearances else seal
