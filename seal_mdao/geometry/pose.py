"""Where a rigid profile is: its own frame and the fixed one.

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
    """Place of a profile.

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
        """The pose with this translation (2,), angle in radians and pivot (2,)."""
        position, pivot = np.array(position, float), np.array(pivot, float)
        return cls(position, float(np.cos(angle)), float(np.sin(angle)), pivot)

    @property
    def matrix(self) -> np.ndarray:
        """Q, shape (2, 2)."""
        return np.array([[self.cos, -self.sin], [self.sin, self.cos]])

    def places(self, points: np.ndarray) -> np.ndarray:
        """Points (n, 2) of the profile's frame in the fixed one."""
        return self.position + self.pivot + (points - self.pivot) @ self.matrix.T


@inlined
def in_frame(pose, x, y):
    """The point x, y of the fixed frame in the profile's; x - z to the last bit where Q = I."""
    dx, dy = x - pose.position[0], y - pose.position[1]
    rx, ry = dx - pose.pivot[0], dy - pose.pivot[1]
    less = pose.cos - 1.0
    return dx + less * rx + pose.sin * ry, dy + less * ry - pose.sin * rx


@inlined
def turned(pose, v):
    """Q v of a pair."""
    return pose.cos * v[0] - pose.sin * v[1], pose.sin * v[0] + pose.cos * v[1]


def quarter_turn(v: np.ndarray) -> np.ndarray:
    """S v of vectors (..., 2): the rate of a vector that turns with the profile, for a unit rate of
    the angle."""
    return np.stack([-v[..., 1], v[..., 0]], axis=-1)


def rigid_velocity(pose: Pose, x: np.ndarray) -> np.ndarray:
    """Velocities of points x (n, 2) that move with the profile, for unit rates of z_x, z_y and the
    angle, shape (n, 2, 3)."""
    out = np.zeros((*x.shape, 3))
    out[:, 0, 0] = out[:, 1, 1] = 1.0
    out[:, :, 2] = quarter_turn(x - pose.position - pose.pivot)
    return out
