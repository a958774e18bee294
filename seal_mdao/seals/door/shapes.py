"""Shapes of the door."""

from dataclasses import dataclass

from seal_mdao.geometry.profile import (
    RigidProfile,
    corner_profile,
    flat_profile,
    segmented_corner_profile,
)


@dataclass(frozen=True)
class FlatDoor:
    """Door with a flat lower face at y = 0."""

    names = ()

    def profile(self) -> RigidProfile:
        return flat_profile()


@dataclass(frozen=True)
class CornerDoor:
    """Door with a flat lower face at y = 0, a rounded corner and a vertical side.

    Attributes
    ----------
    corner_x : float
        Where the flat ends for the nominal radius, mm.
    side : float
        x of the vertical side, which stays where it is when the radius changes, mm.
    door_radius : float
        Of the corner, mm.
    segments : int or None
        None: exact line-arc-line form; else the number of straight segments.
    """

    corner_x: float
    side: float
    door_radius: float
    segments: int | None = None
    names = ("door_radius",)

    def profile(self) -> RigidProfile:
        # line, quarter circle, line exactly, or chords of the circle in its place
        if self.segments is None:
            return corner_profile(self.corner_x, self.door_radius, self.side)
        return segmented_corner_profile(self.corner_x, self.door_radius, self.side, self.segments)
