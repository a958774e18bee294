"""Contact with a rigid profile that is lost before the end of a closing stage of its motion, or never
begins."""

from collections.abc import Iterator

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.geometry.motion import Motion


def contact_losses(path: PathResult) -> Iterator[str]:
    """Yield a sentence for every profile that touches the seal in a closing stage, but not at its end.

    A profile that stands still has the stages of the first one that moves, or of the first moved edges.
    """
    contacts = [term for term in path.problem.terms if isinstance(term, ContactTerm)]
    parts = [*contacts, *getattr(path.problem.imposed, "edges", ())]
    leading = next((own.motion for own in parts if own.motion.moves), None)
    fractions = np.array([step.fraction for step in path.steps])
    for term in contacts:
        motion = term.motion if leading is None or term.motion.moves else leading
        touching = np.array([own.branch.any() for own in path.responses(term.label)])
        begin = 0
        for stage, end in enumerate(np.cumsum(motion.steps)):
            # the state with which the stage begins is one of it
            during = np.flatnonzero((fractions >= begin) & (fractions <= end))
            if closes(motion, stage) and touching[during].any() and not touching[during[-1]]:
                last = during[touching[during]][-1]
                yield _sentence(term.label, motion, stage, fractions[last : last + 2])
            begin = end


def untouched_profiles(path: PathResult) -> Iterator[str]:
    """Yield a sentence for every moving profile that touches the seal at no load step, and for those
    that stand still if none touches it; a profile to which edges are bonded touches it always."""
    imposed = path.problem.imposed
    bonded = () if imposed is None else imposed.labels
    contacts = [
        term
        for term in path.problem.terms
        if isinstance(term, ContactTerm) and term.label not in bonded
    ]
    apart = [t for t in contacts if not any(own.branch.any() for own in path.responses(t.label))]
    for term in apart:
        if term.motion.moves or len(apart) == len(contacts):
            # least gap of a contact point over the load steps
            gaps = [own.gap.min() for own in path.responses(term.label)]
            nearest = float(min(gaps))
            moves = "approaches the seal" if gaps[-1] < gaps[0] else "moves away from the seal"
            how = f"its motion (stage) {moves}" if term.motion.moves else "it does not move"
            yield (
                f"the profile {term.label!r} touches the seal at no load step, and comes no nearer than "
                f"{nearest:.3g} mm: {how}; change translate or start of the profile, or its contact "
                "edges"
            )


def closes(motion: Motion, stage: int) -> bool:
    """Return whether a stage (from 0) brings the profile no nearer to the start of its motion."""
    travelled, turn = (
        np.hypot(*(motion.positions - motion.positions[0]).T),
        motion.angles - motion.angles[0],
    )
    if travelled[stage + 1] != travelled[stage]:
        return bool(travelled[stage + 1] > travelled[stage])
    return bool(abs(turn[stage + 1]) >= abs(turn[stage]))


def _sentence(label: str, motion: Motion, stage: int, fractions) -> str:
    """Name the load steps of last contact and after it, ``fractions`` (2,), by their travel."""
    begin = np.array([*motion.positions[stage], motion.angles[stage]])
    x, y, angle = np.transpose([motion.coordinates(at) - begin for at in fractions])
    travels, turns = np.hypot(x, y), np.abs(np.degrees(angle))
    where = "load steps {:.5g} and {:.5g}".format(*fractions)
    if travels[1] > 0.0:
        where = "travels of {:.4f} and {:.4f} mm".format(*travels)
    elif turns[1] > 0.0:
        where = "turns of {:.3g} and {:.3g} degrees".format(*turns)
    of_stage = f" in stage {stage + 1}" if len(motion.steps) > 1 else ""
    return (
        f"the seal loses contact with the profile {label!r} between {where}{of_stage} and is not "
        "in contact at the end of the stage; end the stage earlier, or change the motion of the "
        "profile"
    )
