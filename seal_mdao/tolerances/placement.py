"""Clearance for boundaries and rigid profiles that are not where the drawing says."""

import numpy as np

from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.seal import Seal

ROOM = 0.5
"""mm by which a profile starts farther away, so that hardly any sample begins inside of a seal."""


def with_room(seal: Seal) -> Seal:
    """The seal with profiles that begin 0.5 mm farther back along their travel: clearance for boundaries
    that are off and for profiles that are turned, the same one for all designs of an optimisation."""
    rooms = {}
    for contact in contacts(seal):
        way = contact.motion.positions[0] - contact.motion.positions[1]
        length = np.hypot(*way)
        if length:  # one that stands still or turns has no way back
            rooms[contact.label] = contact.motion.room + ROOM * way / length
    return seal.with_rooms(rooms) if rooms else seal
