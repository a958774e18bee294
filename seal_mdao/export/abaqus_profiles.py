"""Rigid profiles in the form of Abaqus: analytical surfaces of lines and arcs."""

import numpy as np

from seal_mdao.geometry.curve import ARC, CUBIC, LINE
from seal_mdao.geometry.pose import Pose
from seal_mdao.geometry.profile import PROFILE_EXTENT, RigidProfile

MOST_TURN = 0.5 * np.pi
"""Largest angle of an arc; Abaqus wants less than 180 degrees."""
CHORDS = 16
"""Straight segments in place of a cubic piece."""


def surface_lines(profile: RigidProfile, pose: Pose) -> list[str]:
    """Write the data lines of ``*SURFACE, TYPE=SEGMENTS``, in mm.

    Abaqus has its outward normal on the left of the segments; here the rigid body is on the left. So the
    pieces are written from the last to the first. Lines at the ends of an open profile are extended.
    """
    ends, lines = None, []
    for piece in reversed(range(len(profile.kind))):
        points, centre = _points(profile, piece)
        # a cubic piece has many points, an arc one for every part of at most 90 degrees
        placed = pose.places(points[::-1])
        if ends is None:
            lines.append(_line("START", placed[0]))
        for point in placed[1:]:
            arc = () if centre is None else (pose.places(centre[None])[0],)
            lines.append(_line("LINE" if centre is None else "CIRCL", point, *arc))
        ends = placed[-1]
    return lines


def has_cubic(profile: RigidProfile) -> bool:
    """Return whether cubic pieces are replaced by straight segments."""
    return bool((profile.kind == CUBIC).any())


def _points(profile: RigidProfile, piece: int) -> tuple[np.ndarray, np.ndarray | None]:
    """Compute points along a piece in the profile's frame, and the centre of an arc."""
    origin, angle = profile.origin[piece], profile.angle[piece]
    length, radius = profile.length[piece], profile.radius[piece]
    if profile.kind[piece] == LINE:
        # x(s) = x_0 + s (cos a, sin a), longer at the ends of an open profile
        beyond = 0.0 if profile.period else PROFILE_EXTENT
        first = -beyond if piece == 0 else 0.0
        last = length + (beyond if piece == len(profile.kind) - 1 else 0.0)
        return origin + np.outer([first, last], [np.cos(angle), np.sin(angle)]), None
    if profile.kind[piece] == ARC:
        # x(s) = c + |r| (cos a, sin a), a = a_0 + s / r with the sign of r
        turn = length / radius
        parts = int(np.ceil(abs(turn) / MOST_TURN - 1e-9))
        at = angle + np.linspace(0.0, turn, parts + 1)
        return origin + abs(radius) * np.column_stack([np.cos(at), np.sin(at)]), origin
    # x(s) = sum_k c_k s^k
    powers = np.linspace(0.0, length, CHORDS + 1)[:, None] ** np.arange(4)
    return powers @ profile.coefficient[piece], None


def _line(word: str, *points) -> str:
    numbers = (f"{value:.12g}" for point in points for value in point)
    return ", ".join([word, *numbers])
