"""A rubber block of two materials under a turning ellipse, a dead load and a moving base."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.geometry.spline_profile import spline_profile
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.ogden import Ogden
from seal_mdao.seals.seal import Seal
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.region import Region
from seal_mdao.terms.points import edge_points

COLUMNS, ROWS, STEPS = 7, 4, 14


@dataclass(frozen=True)
class Ellipse:
    """A closed spline with its half axes as parameters."""

    a: float
    b: float
    names = ("a", "b")

    def profile(self):
        t = np.linspace(0.0, 2 * np.pi, 49)
        c, s = np.column_stack([np.cos(t), 0 * t]), np.column_stack([0 * t, np.sin(t)])
        return spline_profile(self.a * c + self.b * s, np.stack([c, s]), closed=True)


def particles():
    x, y = np.meshgrid(np.linspace(-3.0, 3.0, COLUMNS), np.linspace(0.0, 2.0, ROWS))
    return np.column_stack([x.ravel(), y.ravel()])


def body(numbers):
    corners = numbers[:-1, :-1], numbers[:-1, 1:], numbers[1:, 1:], numbers[1:, :-1]
    fixed = np.zeros((numbers.size, 2), bool)
    fixed[numbers[0]] = True
    edges = {"top": Edge(numbers[-1][::-1], False), "right": Edge(numbers[:, -1], False)}
    cells = np.column_stack([corner.ravel() for corner in corners])
    return Body(cells, np.full(numbers.size, 1.3), fixed, edges)


def terms(nominal, block):
    right = nominal[block.cells].mean(axis=1)[:, 0] > 0.0
    rubber = Region(MooneyRivlin(), np.flatnonzero(~right), "hard_")
    softer = Region(Ogden((60.0, -10.0), (2.5, -2.0)), np.flatnonzero(right), "soft_")
    stages = [
        Stage(STEPS // 2, (0.0, -0.75), rates={"depth": (0.0, -1.0, 0.0)}),
        Stage(STEPS // 2, (0.25, 0.1), 20.0, rates={"turn": (0.0, 0.0, 1.0)}),
    ]
    motion = staged_motion(stages, start=(0.2, 3.05), pivot=(0.3, 0.1))
    law = ContactLaw(1e4, 1e2, 0.3, True)
    roll = RigidContact("roll", block.edge_points("top"), Ellipse(1.4, 1.0), motion, law, "roll_")
    ramp = np.linspace(0.0, 1.0, STEPS + 1)
    pull = DeadLoad("pull", edge_points(block.edge("right").sides), np.array([8.0, 3.0]), ramp)
    return ElasticBody((rubber, softer)), roll, pull


def moving_base(nominal, base):
    """The base sheared and tilted along the path; both are parameters."""
    ramp, rates = np.linspace(0.0, 1.0, STEPS + 1), np.zeros((2, STEPS + 1, len(nominal), 2))
    rates[0][:, base, 0] = 0.03 * ramp[:, None]
    rates[1][:, base, 1] = 0.02 * ramp[:, None] * nominal[base, 0]
    return ImposedDisplacements(0.5 * rates[0] + rates[1], ("shear", "tilt"), rates)


def block_seal():
    """The block with three design parameters."""
    nominal, numbers = particles(), np.arange(COLUMNS * ROWS).reshape(ROWS, COLUMNS)
    block, (x, y) = body(numbers), nominal.T
    velocity = np.zeros((3, len(nominal), 2))
    velocity[0, :, 1], velocity[2, :, 1] = y / 2 * np.exp(-(x**2)), y / 2 * np.sin(x)
    velocity[1, :, 0] = x * y / 6
    return Seal(
        nominal, velocity, block, terms(nominal, block), STEPS,
        imposed_displacements=moving_base(nominal, numbers[0]),
    )  # fmt: skip
