"""Position and rotation of a rigid profile: transformation between its own frame and the fixed one.

    x = z + c + Q (x' - c)        x' = c + Q^T (x - z - c)

with the translation z, the rotation Q by an angle about the pivot c, which is given in the profile's
frame and moves with z. Lengths, gaps and natural coordinates are the same in both frames; velocities,
normals and forces turn with Q.

Rates of the pose enter twice. With dQ = omega S Q, S = [[0, -1], [1, 0]],

    x'' = Q^T (v - z' - omega S (x - z - c))        v: velocity of the body point
    f'  = omega S f + (df/dx) (v - z' - omega S (x - z - c))

so a linearisation in the fixed frame takes the velocity relative to the rigid motion in place of v
(``rigid_velocity`` is what to subtract), and the force turns with the profile (``quarter_turn``).
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import inlined


class Pose(NamedTuple):
    """Translation and rotation of a profile.

    Attributes
    ----------
    position : ndarray, shape (2,)
        Translation z.
    cos, sin : float
        Of the angle.
    pivot : ndarray, shape (2,)
        c, in the profile's frame.
    """

    position: np.ndarray
    cos: float
    sin: float
    pivot: np.ndarray

    @classmethod
    def of(cls, position, angle: float = 0.0, pivot=(0.0, 0.0)) -> "Pose":
        """Build the pose of a translation (2,), an angle in radians and a pivot (2,)."""
        position, pivot = np.array(position, float), np.array(pivot, float)
        return cls(position, float(np.cos(angle)), float(np.sin(angle)), pivot)

    @property
    def matrix(self) -> np.ndarray:
        """Rotation matrix Q, shape (2, 2)."""
        return np.array([[self.cos, -self.sin], [self.sin, self.cos]])

    def places(self, points: np.ndarray) -> np.ndarray:
        """Transform points (n, 2) from the profile's frame to the fixed one."""
        # x = z + c + Q (x' - c)
        return self.position + self.pivot + (points - self.pivot) @ self.matrix.T


@inlined
def in_frame(pose, x, y):
    """Transform the point x, y of the fixed frame to the profile's frame."""
    dx, dy = x - pose.position[0], y - pose.position[1]
    rx, ry = dx - pose.pivot[0], dy - pose.pivot[1]
    # x' = c + Q^T (x - z - c) = (x - z) + (Q^T - I)(x - z - c): exactly x - z where Q = I
    less = pose.cos - 1.0
    return dx + less * rx + pose.sin * ry, dy + less * ry - pose.sin * rx


@inlined
def turned(pose, v):
    """Rotate a pair: Q v."""
    return pose.cos * v[0] - pose.sin * v[1], pose.sin * v[0] + pose.cos * v[1]


def quarter_turn(v: np.ndarray) -> np.ndarray:
    """Rotate vectors (..., 2) by 90 degrees: S v, the rate of a vector that turns with the profile,
    for a unit rate of the angle."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def rigid_velocity(pose: Pose, x: np.ndarray) -> np.ndarray:
    """Compute velocities of points x (n, 2) that move with the profile, for unit rates of z_x, z_y and
    the angle, shape (n, 2, 3)."""
    # dx/dz = I,  dx/dangle = S (x - z - c)
    out = np.zeros((*x.shape, 3))
    out[:, 0, 0] = out[:, 1, 1] = 1.0
    out[:, :, 2] = quarter_turn(x - pose.position - pose.pivot)
    return out
