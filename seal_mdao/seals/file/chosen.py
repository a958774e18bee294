"""What was chosen for the seal of a file: particles, load steps and penalties, for recorders and
designs."""

import numpy as np

from seal_mdao.geometry.motion import Motion
from seal_mdao.seals.file.edge_tables import SELF_CONTACT
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.penalty_error import NORMAL, TANGENT, penalties_of
from seal_mdao.seals.profiles import motions
from seal_mdao.seals.seal import Seal


def chosen_for(file: SealFile, seal: Seal) -> dict:
    """Return what was chosen for the seal of a file: keyword arguments of ``build_seal``.

    Returns
    -------
    dict
        ``filling``, lengths in mm, ``step_ends``, in stages, and ``penalties``, kPa/mm by parameter;
        each where it was open.
    """
    # only what the file leaves open
    found = {}
    if file.section.chosen:
        found["filling"] = file.section.filling
    if file.step_tolerance is not None:
        found["step_ends"] = chosen_ends(seal)
    if file.open_penalties:
        values = {penalty.name: penalty.value for penalty in penalties_of(seal)}
        found["penalties"] = {name: values[name] for name in file.open_penalties}
    return found


def chosen_ends(seal: Seal) -> list[float]:
    """Return the ends of the chosen load steps in stages, ``step_ends`` of ``build_seal``."""
    return _staged(seal).ends.tolist()


def _staged(seal: Seal) -> Motion:
    """Find the motion with stages; one without has a single stage, in which it rests."""
    return max(motions(seal), key=lambda motion: motion.steps.size)


def write_chosen(given: dict, file: SealFile, seal: Seal) -> None:
    """Write what was chosen for a seal into the tables ``given`` of its file."""
    if file.step_tolerance is not None:
        _write_steps(given, seal)
    # penalties of the file stay, the others are those of the seal
    values = {penalty.name: penalty.value for penalty in penalties_of(seal)}
    owners = {profile["name"]: profile for profile in given.get("profile", ())}
    owners |= {SELF_CONTACT: given[SELF_CONTACT]} if SELF_CONTACT in given else {}
    for name, table in owners.items():
        for kind in (NORMAL, TANGENT):
            table.setdefault(kind, values[f"{name}_{kind}"])
    # a tolerance would ask for another choice
    given.pop("penalties", None)


def _write_steps(given: dict, seal: Seal) -> None:
    """Write the fractions of every stage at the ends of its steps."""
    motion = _staged(seal)
    by_stage = np.split(motion.fractions, np.cumsum(motion.steps)[:-1])
    given.pop("steps", None)
    for profile in (*given.get("profile", ()), *given.get("moved", ())):
        # profiles without stages stand still in any steps
        for stage, fractions in zip(profile.get("stage", ()), by_stage, strict=False):
            stage["steps"] = fractions.tolist()
