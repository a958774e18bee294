"""Start position of the profile in the seal file of a design that has grown into it."""

import numpy as np

from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.seals.clear_start import with_clear_starts
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal

ALONG = 1e-9
"""Largest sine of the angle between a travel and the way back from it."""


def write_clear_start(given: dict, file: SealFile, seal: OutlineSeal, offsets) -> None:
    """Move the start of the only moving profile in the tables of a file until it does not overlap
    the design.

    Its first stage becomes longer by as much and ends where it did, as do its load steps. Nothing is
    changed for a design that is clear, with travels of measures, times, temperatures or swelling, which
    count from the start, and where more than one profile moves.

    Parameters
    ----------
    given : dict
        Tables of the file, with load steps, which are changed.
    offsets : ndarray, shape (seal.n_offsets,)
        mm.
    """
    moving = [own for own in file.moving if own.stages]
    counted = any("travel" in row or "data" in row for row in given.get("measure", ()))
    timed = file.environment is not None or any(cavity.vented for cavity in file.cavities)
    if len(moving) != 1 or counted or timed:
        return
    name = moving[0].name
    back = np.sum([
        own.motion.clearance
        for own in with_clear_starts(seal, seal.particles(offsets)).terms()
        if isinstance(own, RigidContact) and own.label == name
    ], axis=0)  # fmt: skip
    row = next((own for own in given.get("profile", ()) if own["name"] == name), None)
    if row is None or not np.any(back):
        return
    stage = row["stage"][0]
    travel = np.array(stage.get("translate", (0.0, 0.0)), float)
    more, length = np.hypot(*back), np.hypot(*travel)
    across = travel[0] * back[1] - travel[1] * back[0]
    # back along the travel, without a turn, which would begin earlier
    if abs(across) > ALONG * more * length or travel @ back >= 0.0 or stage.get("rotate"):
        return
    row["start"] = (np.array(row.get("start", (0.0, 0.0)), float) + back).tolist()
    stage["translate"] = (travel - back).tolist()
    ends = stage["steps"]
    ends = np.arange(1, ends + 1) / ends if isinstance(ends, int) else np.array(ends)
    # f' = (c + f L) / (c + L)
    ends = (more + ends * length) / (more + length)
    ends[-1] = 1.0
    stage["steps"] = ends.tolist()
