"""The door of the paper as a cubic spline through points of its line-arc-line form."""

from dataclasses import dataclass, replace

import numpy as np

import seal_mdao as sm
from seal_mdao.geometry.spline_profile import spline_profile
from seal_mdao.measures.reaction import Reaction


@dataclass(frozen=True)
class SplineDoor:
    """``count`` points along the corner, others as far apart beside it; |t| is that distance."""

    side: float
    door_radius: float
    count: int
    drawn_radius: float
    names = ("door_radius",)

    def profile(self):
        turn = np.linspace(-0.5 * np.pi, 0.0, self.count)
        unit = np.column_stack([np.cos(turn), np.sin(turn)])
        # the distance is that of the drawn corner: it does not change with the radius
        apart = 0.5 * np.pi * self.drawn_radius / (self.count - 1) * np.arange(1.0, self.count)
        still = np.zeros_like(apart)
        points = np.concatenate([
            np.column_stack([self.side - self.door_radius - apart[::-1], still]),
            [self.side - self.door_radius, self.door_radius] + self.door_radius * unit,
            np.column_stack([still + self.side, self.door_radius + apart]),
        ])  # fmt: skip
        flat, side = np.tile([-1.0, 0.0], (len(apart), 1)), np.tile([0.0, 1.0], (len(apart), 1))
        rates = np.concatenate([flat, unit + np.array([-1.0, 1.0]), side])
        return spline_profile(points, [rates])


def under_spline(count):
    """The nominal seal under the spline door, 40 steps."""
    door_seal = sm.door_seal(n_steps=40)
    rubber, door = door_seal.terms()
    radius = door.shape.door_radius
    spline = replace(door, shape=SplineDoor(door.shape.side, radius, count, radius))
    return assembled(door_seal, (rubber, spline))


def under_corner():
    """The same under the line-arc-line door."""
    door_seal = sm.door_seal(n_steps=40)
    return assembled(door_seal, door_seal.terms())


def assembled(door_seal, terms):
    return sm.Seal(
        door_seal.nominal_particles, door_seal.design_velocity, door_seal.body, terms,
        door_seal.n_steps, (Reaction(terms[1].label),), newton=sm.NewtonOptions(tolerance=1e-11),
    )  # fmt: skip
