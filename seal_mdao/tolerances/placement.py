"""Rigid profiles that are not where the drawing says."""

from dataclasses import replace

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.seals.assembled import AssembledSeal
from seal_mdao.seals.door.door_seal import DoorSeal
from seal_mdao.seals.seal import Seal

ROOM = 0.5
"""mm by which a door starts farther away, so that hardly any sample begins inside of a seal."""


def placeable(seal: Seal) -> Seal:
    """The seal with parameters that place every profile: ``<label>_x``, ``<label>_y`` (mm) and
    ``<label>_angle`` (degrees about its pivot), zero where they are drawn.

    They move a profile along its whole path; a sample whose profile would begin inside of the seal
    begins farther back (``seals.clear_start``). The door seal has ``door_shift``, ``door_angle`` and
    ``depth`` of its own and stays as it is.
    """
    if not isinstance(seal, AssembledSeal):
        return seal
    definitions = []
    for definition in seal.definitions:
        if isinstance(definition, RigidContact):
            label = definition.label
            motion = definition.motion.with_placement(f"{label}_x", f"{label}_y", f"{label}_angle")
            definition = replace(definition, motion=motion)
        definitions.append(definition)
    return replace(seal, definitions=tuple(definitions))


def with_room(seal: DoorSeal) -> DoorSeal:
    """The door seal with a door that begins 0.5 mm farther away: clearance for boundaries that are off
    and for a door that is turned, the same one for all designs of an optimisation."""
    return seal.with_(room=seal.room + ROOM)
