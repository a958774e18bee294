"""A profile: an ellipse whose two semi-axes are parameters."""

from dataclasses import dataclass

import numpy as np

import seal_mdao as sm
from seal_mdao.geometry.spline_profile import spline_profile


@sm.register("profiles", "ellipse")
@dataclass(frozen=True)
class Ellipse:
    """A spline through ``points`` points; its natural coordinate is their number, so |t| != 1."""

    a: float
    b: float
    points: int = 48
    names = ("a", "b")

    def __post_init__(self):
        if not (self.a > 0.0 and self.b > 0.0):
            raise ValueError(f"semi-axes must be positive, got {self.a} and {self.b}")

    def profile(self):
        # counter-clockwise: the rigid body lies on the left
        angle = 2.0 * np.pi * np.arange(self.points) / self.points
        unit = np.column_stack([np.cos(angle), np.sin(angle)])
        rates = [unit * [1.0, 0.0], unit * [0.0, 1.0]]
        return spline_profile(unit * [self.a, self.b], rates, closed=True)
