"""Bodies of a seal file that nothing prevents from sliding along a line."""

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
    lines parallel to it, without friction. Its position along this line would be arbitrary.

    Contact with another body does not count: bodies are apart at the start (``check_apart``), where the
    equations would be singular.
    """
    outline = file.section.outline
    # a force of an extension may hold it
    if file.terms:
        return
    for number, contours in enumerate(outline.bodies, 1):
        names = {name for contour in contours for name in contour.edge_names}
        along, touching = _free_direction(file, names), _touching(file, names)
        if along is None or not all(_slides(own, along) for own in touching):
            continue
        axis = next((name for name, own in zip("xy", along, strict=True) if abs(own) == 1.0), None)
        line = axis or f"the direction ({along[0]:.4g}, {along[1]:.4g})"
        profiles = ", ".join(repr(own.name) for own in touching)
        contact = (
            f", and the profiles that may touch it ({profiles}) are straight, parallel to this "
            "direction and without friction"
        )
        between = (
            "; contact with another body ([self_contact]) does not hold it at the start, where they "
            "are apart"
        )
        friction = ", or give a profile a friction coefficient above 0"
        raise SealFileError(
            f"{outline.body_title(number)} can slide along {line} without resistance, because no edge "
            f"has a prescribed displacement in this direction{contact if touching else ''}"
            f"{between if outline.others and file.self_contact is not None else ''}; fix an edge in "
            f"this direction ([fixed] with directions){friction if touching else ''}"
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
