"""What the report draws of rigid profiles and contacts: faces, places, curves, points that touch."""

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.boundary_line import is_closed
from seal_mdao.measures.selection import opened_points
from seal_mdao.plotting.contact import arc_length
from seal_mdao.plotting.section import face_of, outlines, rigid_side, size_of
from seal_mdao.seals.profiles import contacts, profile_histories, self_contacts, true_pressure

BETWEEN = 3
"""Mark of a point that is open between others in contact; 0, 1 and 2 are its contact states."""


def profile_shapes(result) -> list[dict]:
    """Every profile in its own frame: points along its face, and outlines of its rigid side, mm."""
    size, found = size_of(result), []
    for contact in contacts(result.seal):
        face = face_of(contact.shape.profile(), size)
        rings = outlines(rigid_side(contact.shape.profile(), face, size))
        found.append(
            {"name": contact.label, "face": _rounded(face), "body": list(map(_rounded, rings))}
        )
    return found


def poses(result, fraction: float) -> list:
    """Place of every profile after ``fraction`` nominal steps: x, y (mm) of the origin of its frame,
    cosine and sine of its angle."""
    found = [contact.motion.pose(fraction) for contact in contacts(result.seal)]
    return [
        [*pose.places(np.zeros((1, 2)))[0].round(6).tolist(), pose.cos, pose.sin] for pose in found
    ]


def profile_curves(result, steps) -> list[dict]:
    """Curves of every profile at nominal steps: along its contact points, and over its travel."""
    return [_curves(result, *pair, steps) for pair in zip(
        contacts(result.seal), profile_histories(result), strict=True
    )]  # fmt: skip


def _curves(result, contact, history, steps) -> dict:
    answers = [result.path.at_nominal(contact.label)[step] for step in steps]
    words, along = _abscissa(history)
    return {
        "name": contact.label,
        "arc": np.round(arc_length(result, contact.label), 4).tolist(),
        "along": np.round(along[steps], 6).tolist(),
        "words": words,
        "reaction": np.round(history.force[steps], 4).tolist(),
        "state": ["".join(map(str, marks(result, contact.label, answer))) for answer in answers],
        "pressure": [np.round(true_pressure(result, contact, s), 2).tolist() for s in steps],
        "gap": [np.round(answer.gap, 5).tolist() for answer in answers],
    }


def _abscissa(history) -> tuple[str, np.ndarray]:
    """Travel of a profile with one course, else the number of the load step."""
    if len(history.courses) == 1:
        (course,) = history.courses
        return "turn (°)" if course.turns else "travel (mm)", course.along
    return "load step", np.arange(1.0, 1.0 + len(history.force))


def contact_points(result, step: int) -> tuple[np.ndarray, str]:
    """Places (k, 2), mm, of the points that touch a profile or another wall after a nominal step, or
    that a profile leaves open between contacts, and a mark of each."""
    places, found = [np.empty((0, 2))], [np.empty(0, int)]
    for term in (*contacts(result.seal), *self_contacts(result.seal)):
        answer = result.path.at_nominal(term.label)[step]
        own = marks(result, term.label, answer)
        places.append(answer.x[own != OPEN])
        found.append(own[own != OPEN])
    return np.concatenate(places), "".join(map(str, np.concatenate(found)))


def marks(result, label: str, answer) -> np.ndarray:
    """States of the points of a contact, ``BETWEEN`` where a profile leaves them between contacts."""
    state = np.array(answer.branch)
    where = getattr(result.term(label), "where", None)
    if where is not None:
        state[opened_points(answer.branch, is_closed(where))] = BETWEEN
    return state


def _rounded(points) -> list:
    return np.round(points, 4).tolist()
