"""Where a section is nearest to a profile at the start."""

from typing import NamedTuple

import numpy as np
from scipy.optimize import minimize_scalar

from seal_mdao.contact.kinematics import closest_point
from seal_mdao.errors import SealFileError
from seal_mdao.geometry.pose import in_frame
from seal_mdao.seals.file.profiles import motion_of, rigid_profile_of
from seal_mdao.seals.outline.segments import pair

ROUNDING = 1e-9
"""Penetration at the start that is none, over the size of the section."""
LOOK = 1e-4
"""Sagitta of the chords whose ends are looked at, over the size of the section."""


def gap_at_start(profile):
    """Gap of a place to a profile at the start, as a function of x and y."""
    curve, pose = rigid_profile_of(profile).curve, motion_of(profile, 1).pose(0.0)
    return lambda x, y: closest_point(curve, *in_frame(pose, x, y))[2]


class Nearest(NamedTuple):
    """Where a section is nearest to a profile at the start: gap (mm), place, edge."""

    gap: float
    place: np.ndarray
    edge: str


def nearest_at_start(profile, outline) -> Nearest:
    """The place of the edges that may touch a profile where their gap at the start is least."""
    gap = gap_at_start(profile)
    segments = [segment for name in profile.contact for segment in outline.edge(name)]
    return min(
        (_nearest_of(segment, gap, LOOK * outline.size) for segment in segments),
        key=lambda found: found.gap,
    )


def check_start(where: str, profile, outline) -> float:
    """The least gap of a profile at the start, mm, which must not be negative.

    Parameters
    ----------
    where : str
        The profile's place in the file.

    Raises
    ------
    SealFileError
        When the profile begins within the section.
    """
    least, place, edge = nearest_at_start(profile, outline)
    if least < -ROUNDING * outline.size:
        gap = gap_at_start(profile)
        edges = [segment for name in profile.contact for segment in outline.edge(name)]
        every = np.concatenate([s.points(s.chords(LOOK * outline.size)) for s in edges])
        turned = "; is it walked the wrong way?" if all(gap(*x) < 0.0 for x in every) else ""
        raise SealFileError(
            f"{where}: start = {pair(profile.start)} puts the edge {edge!r} {-least:.3g} mm "
            f"inside the rigid body at {pair(np.round(place, 6) + 0.0)}; start it farther away (the "
            f"rigid body lies on the left when walked{turned})"
        )
    return least


def _nearest_of(segment, gap, sagitta) -> Nearest:
    """By points close enough to see every part of a segment, then between those beside the nearest."""

    def at(share):
        return gap(*segment.points([share])[0])

    shares = segment.chords(sagitta)
    gaps = [at(share) for share in shares]
    k = int(np.argmin(gaps))
    beside = shares[max(k - 1, 0)], shares[min(k + 1, len(shares) - 1)]
    between = minimize_scalar(at, bounds=beside, method="bounded", options={"xatol": 1e-10}).x
    share = min(shares[k], between, key=at)
    return Nearest(at(share), segment.points([share])[0], segment.edge)
