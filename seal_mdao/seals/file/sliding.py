"""Bodies of a seal file that nothing prevents from sliding along a line."""

from itertools import product

import numpy as np

from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.errors import SealFileError
from seal_mdao.geometry.pose import Pose
from seal_mdao.seals.file.model_table import RADIAL
from seal_mdao.seals.outline.contours import Line

PARALLEL = 1e-9
"""Sine of the angle up to which two lines are parallel."""


def check_sliding(file) -> None:
    """Raise SealFileError for a body of a ``SealFile`` that can slide along a line without resistance:
    no edge has a prescribed displacement along it, and all profiles that may touch the body are straight
    lines parallel to it, without friction. Its position along this line would be arbitrary. Bodies whose
    contact with each other resists sliding are one body here."""
    outline = file.section.outline
    # a force of an extension may hold it
    if file.terms:
        return
    bodies = [
        {name for contour in contours for name in contour.edge_names} for contours in outline.bodies
    ]
    for number, names in enumerate(bodies):
        along = _free_direction(file, names)
        if along is None:
            continue
        joined = _joined(file, bodies, number, along)
        if not all(_free(file, bodies[other], along) for other in joined):
            continue
        touching = [own.name for own in _touching(file, set.union(*(bodies[k] for k in joined)))]
        first = outline.bodies[number][0].edge_names[0]
        what = f"body {number + 1} (edge {first!r})" if outline.others else "the section"
        if len(joined) > 1:
            what += f", together with body {', '.join(str(k + 1) for k in joined if k != number)},"
        axis = next((name for name, own in zip("xy", along, strict=True) if abs(own) == 1.0), None)
        line = axis or f"the direction ({along[0]:.4g}, {along[1]:.4g})"
        contact = (
            f", and the profiles that may touch it ({', '.join(map(repr, touching))}) are straight, "
            "parallel to this direction and without friction"
        )
        between = (
            "; nor does the contact with another body ([self_contact]) resist this motion"
            if file.self_contact is not None and len(joined) < len(bodies)
            else ""
        )
        friction = ", or give a profile a friction coefficient above 0"
        raise SealFileError(
            f"{what} can slide along {line} without resistance, because no edge has a prescribed "
            f"displacement in this direction{contact if touching else ''}{between}; fix an edge in this "
            f"direction ([fixed] with directions){friction if touching else ''}"
        )


def _touching(file, names: set) -> list:
    """List the profiles that may touch edges of a body."""
    return [own for own in file.profiles if names & set(own.contact)]


def _prescribed(file, names: set) -> set:
    """Return the axes along which an edge of a body is prescribed, 0 for x and 1 for y."""
    held = {axis for name, axes in file.supports.items() if name in names for axis in axes}
    # a ring holds its radius itself
    return held | {RADIAL} if file.axisymmetric else held


def _free_direction(file, names: set) -> np.ndarray | None:
    """Find the line (2,) along which no edge of a body is prescribed; None if there is none."""
    held, profiles = _prescribed(file, names), _touching(file, names)
    if len(held) == 2:
        return None
    if held:
        return np.eye(2)[1 - held.pop()]
    # nothing is prescribed: the line of the first profile
    return _direction(profiles[0]) if profiles else None


def _free(file, names: set, along: np.ndarray) -> bool:
    """Whether neither edges nor profiles resist a motion of a body along a line."""
    return all(along[axis] == 0.0 for axis in _prescribed(file, names)) and all(
        _slides(own, along) for own in _touching(file, names)
    )


def _joined(file, bodies: list, first: int, along: np.ndarray) -> list[int]:
    """List the bodies that slide together with a body along a line, this one too: contact between them
    resists sliding past each other."""
    found = [first]
    for number in found:
        found += [
            other
            for other in range(len(bodies))
            if other not in found and _resists(file, bodies[number], bodies[other], along)
        ]
    return found


def _resists(file, one: set, other: set, along: np.ndarray) -> bool:
    """Whether contact between two bodies resists sliding past each other along a line: it has friction,
    or one of its edges is not straight and parallel to the line."""
    contact, outline = file.self_contact, file.section.outline
    if contact is None:
        return False
    laws = {frozenset(pair.edges): pair.friction for pair in contact.pairs}
    edges = [[name for name in contact.edges if name in names] for names in (one, other)]
    for pair in product(*edges):
        law = laws.get(frozenset(pair), contact.friction)
        # only the listed pairs touch where there is no friction of all others
        if law is None:
            continue
        straight = (_parallel(own, along) for name in pair for own in outline.edge(name))
        if law != 0.0 or not all(straight):
            return True
    return False


def _parallel(segment, along: np.ndarray) -> bool:
    """Whether a segment is a line parallel to a direction (2,)."""
    if not isinstance(segment, Line):
        return False
    chord = np.subtract(segment.last, segment.first)
    return bool(abs(along[0] * chord[1] - along[1] * chord[0]) <= PARALLEL * np.hypot(*chord))


def _direction(profile) -> np.ndarray | None:
    """Compute the unit vector (2,) along a straight profile at its start; None for another curve."""
    if profile.shape is not None or not all(isinstance(own, Line) for own in profile.segments):
        return None
    chords = np.array([np.subtract(own.last, own.first) for own in profile.segments])
    units = chords / np.hypot(*chords.T)[:, None]
    # t_1 x t_i = 0
    if np.abs(units[0, 0] * units[:, 1] - units[0, 1] * units[:, 0]).max() > PARALLEL:
        return None
    return Pose.of((0.0, 0.0), np.deg2rad(profile.angle)).matrix @ units[0]


def _slides(profile, along: np.ndarray) -> bool:
    """Whether a profile resists no motion along a line: it is parallel to it and has no friction."""
    own = profile.friction
    laws = own.laws if isinstance(own, FrictionByGroup) else (own,)
    direction = _direction(profile)
    if direction is None or profile.turns or any(law != 0.0 for law in laws):
        return False
    return bool(abs(along[0] * direction[1] - along[1] * direction[0]) <= PARALLEL)
