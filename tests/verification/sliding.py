"""Coulomb friction where the exact force is known: a block on a plane, a belt on a cylinder."""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.friction import SLIP, ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import Motion
from seal_mdao.geometry.profile import circle_profile, flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body, row_points
from verification.solving import holding_forces, solve

MATERIAL = MooneyRivlin(80.0, 20.0, 2000.0)


class DraggedBlock(NamedTuple):
    """A plane pressed on a block and dragged along it, to and fro.

    Attributes
    ----------
    travel : ndarray, shape (n_steps,)
        Sideways position of the plane while the normal approach is constant.
    ratio : ndarray, shape (n_steps,)
        Tangential over normal force on the plane; mu in full slip, against the motion.
    slipping : ndarray of bool, shape (n_steps,)
        Whether every contact point slips.
    base_ratio : ndarray, shape (n_steps,)
        The same ratio from the forces that hold the block's base.
    """

    travel: np.ndarray
    ratio: np.ndarray
    slipping: np.ndarray
    base_ratio: np.ndarray


def drag_block(friction: float = 0.3) -> DraggedBlock:
    """A 2 x 1 block held at its base; a plane is pressed 5 % into it, dragged right, then left.

    Exact (Coulomb): T = mu N once the whole face slips, towards the motion of the plane's drag on
    the body, whatever the pressures; global equilibrium gives the same ratio at the base.
    """
    grid = Grid(12, 6)
    X = grid.reference * [2.0, 1.0] - [1.0, 1.0]
    fixed = fixed_components(len(X), x=grid.bottom, y=grid.bottom)
    # down in 5 steps, right in 15, left in 30
    places = [(0.0, 1e-3), (0.0, -0.05), (0.3, -0.05), (-0.3, -0.05)]
    motion = Motion(places, np.zeros(4), [5, 15, 30])
    plane = RigidContact(
        "plane", row_points(grid.top), GivenShape(flat_profile()), motion,
        ContactLaw(1e5, 1e4, friction, True),
    )  # fmt: skip
    path = solve(grid_body(grid, X, fixed), X, (elastic_body(MATERIAL), plane), motion.n_steps)
    travel = np.array([motion.coordinates(s.fraction)[0] for s in path.nominal_steps[5:]])
    force = path.reaction("plane")[5:]
    base = holding_forces(path)[5:, grid.bottom].sum(axis=1)
    touching = [c.state[c.gap < 0.0] for c in path.at_nominal("plane")[5:]]
    return DraggedBlock(
        travel, force[:, 0] / force[:, 1], np.array([np.all(t == SLIP) for t in touching]),
        base[:, 0] / base[:, 1],
    )  # fmt: skip


class Belt(NamedTuple):
    """A thin belt pulled over a rigid cylinder.

    Attributes
    ----------
    thickness : float
        Over the radius of the cylinder.
    wrap : float
        Angle by which the belt turns: that between the forces on its two ends, radians. About pi.
    tension : tuple of float
        Force on the slack and on the tight side.
    exponent, exact : float
        ln(T2 / T1) and mu times the wrap angle.
    slipping : bool
        Whether every contact point slips.
    """

    thickness: float
    wrap: float
    tension: tuple[float, float]
    exponent: float
    exact: float
    slipping: bool


# shear modulus 1, Poisson's ratio 0.3: the belt is a material that stretches, not rubber
BELT = MooneyRivlin(0.5, 0.0, 13.0 / 6.0)
RADIUS, TAIL = 10.0, 2.0


def hanging_belt(grid: Grid, thickness: float) -> np.ndarray:
    """Particles of a belt over the upper half of a cylinder, both ends hanging, left to right."""
    length = np.pi * RADIUS + 2.0 * TAIL
    s = grid.reference[:, 0] * length - TAIL
    r = RADIUS + thickness * grid.reference[:, 1]
    angle = np.pi - np.clip(s / RADIUS, 0.0, np.pi)
    hang = np.minimum(s, 0.0) + np.minimum(np.pi * RADIUS - s, 0.0)
    return r[:, None] * np.column_stack([np.cos(angle), np.sin(angle)]) + hang[:, None] * [0.0, 1.0]


def pull_belt(friction: float = 0.3, thickness: float = 0.2, cells: int = 144) -> Belt:
    """The cylinder is pushed up into the belt, then the right end is pulled down until all slips.

    Exact (L. Euler, 1769; J. A. Eytelwein, 1808): T2 / T1 = exp(mu * wrap) for a belt without
    thickness. Friction acts on the inner face and the tension half a thickness farther out, so the
    exponent of a belt of thickness t is smaller by the factor R / (R + t/2) to first order.
    """
    grid = Grid(cells, 2)
    X = hanging_belt(grid, thickness)
    ends = np.concatenate([grid.left, grid.right])
    fixed = fixed_components(len(X), x=ends, y=ends)
    motion = Motion([(0.0, -1e-6), (0.0, 0.2), (0.0, 0.2)], np.zeros(3), [5, 10])
    pull = np.zeros((motion.n_steps + 1, len(X), 2))
    pull[5:, grid.right, 1] = -np.linspace(0.0, 1.0, 11)[:, None]
    cylinder = RigidContact(
        "cylinder", row_points(grid.bottom), GivenShape(circle_profile((0.0, 0.0), RADIUS)), motion,
        ContactLaw(1e2, 1e2, friction, True),
    )  # fmt: skip
    path = solve(
        grid_body(grid, X, fixed), X, (elastic_body(BELT), cylinder), motion.n_steps,
        ImposedDisplacements(pull),
    )  # fmt: skip
    force = holding_forces(path)[-1]
    ends_force = [force[row].sum(axis=0) for row in (grid.left, grid.right)]
    slack, tight = (float(np.hypot(*end)) for end in ends_force)
    wrap, end = turning(*ends_force), path.at_nominal("cylinder")[-1]
    return Belt(
        thickness / RADIUS, wrap, (slack, tight), float(np.log(tight / slack)),
        friction * wrap, bool(np.all(end.state[end.gap < 0.0] == SLIP)),
    )  # fmt: skip


def turning(first: np.ndarray, last: np.ndarray) -> float:
    """Angle between the directions of a belt at its ends, pulled by the forces (2,), clockwise.

    The belt runs against the first force and along the last one.
    """
    (ax, ay), (bx, by) = -first, last
    return float(np.mod(np.arctan2(ay * bx - ax * by, ax * bx + ay * by), 2.0 * np.pi))
