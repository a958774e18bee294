"""Coulomb friction where the exact force is known: a block on a plane, a belt on a cylinder."""

from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.loading import LoadProgram
from seal_mdao.analysis.loads import internal_forces
from seal_mdao.contact.friction import SLIP, ContactLaw
from seal_mdao.geometry.profile import circle_profile, flat_profile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.verification.bodies import Grid, fixed_components, grid_body, row_contact
from seal_mdao.verification.solving import completed

MATERIAL = MooneyRivlin(80.0, 20.0, 2000.0)


class DraggedBlock(NamedTuple):
    """A plane pressed on a block and dragged along it, to and fro.

    Attributes
    ----------
    travel : ndarray, shape (n_steps,)
        Sideways position of the plane while the normal approach is held.
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
    disc = discretize(grid_body(grid, X, fixed, **row_contact(grid.top)), X)
    down = np.column_stack([np.zeros(6), np.linspace(1e-3, -0.05, 6)])
    travel = np.concatenate([np.linspace(0.0, 0.3, 16), np.linspace(0.3, -0.3, 31)[1:]])
    along = np.column_stack([travel[1:], np.full(len(travel) - 1, -0.05)])
    law = ContactLaw(1e5, 1e4, friction, True)
    program = LoadProgram(np.vstack([down, along]))
    path = completed(solve_path(disc, MATERIAL, flat_profile(), law, program))
    steps = path.nominal_steps[5:]
    force = np.array([s.reaction for s in steps])
    base = np.array([internal_forces(disc, MATERIAL, s.d)[grid.bottom].sum(axis=0) for s in steps])
    touching = [s.after.state[s.gap < 0.0] for s in steps]
    return DraggedBlock(
        travel[1:], force[:, 0] / force[:, 1], np.array([np.all(t == SLIP) for t in touching]),
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
    disc = discretize(grid_body(grid, X, fixed, **row_contact(grid.bottom)), X)
    up, pull = np.linspace(-1e-6, 0.2, 6), np.linspace(0.0, 1.0, 11)
    positions = np.column_stack([np.zeros(16), np.concatenate([up, np.full(10, 0.2)])])
    imposed = np.zeros((16, len(X), 2))
    imposed[6:, grid.right, 1] = -pull[1:, None]
    law = ContactLaw(1e2, 1e2, friction, True)
    program = LoadProgram(positions, imposed)
    profile = circle_profile((0.0, 0.0), RADIUS)
    step = completed(solve_path(disc, BELT, profile, law, program)).steps[-1]
    force = internal_forces(disc, BELT, step.d)
    ends_force = [force[row].sum(axis=0) for row in (grid.left, grid.right)]
    slack, tight = (float(np.hypot(*end)) for end in ends_force)
    wrap, touching = turning(*ends_force), step.gap < 0.0
    return Belt(
        thickness / RADIUS, wrap, (slack, tight), float(np.log(tight / slack)),
        friction * wrap, bool(np.all(step.after.state[touching] == SLIP)),
    )  # fmt: skip


def turning(first: np.ndarray, last: np.ndarray) -> float:
    """Angle between the directions of a belt at its ends, pulled by the forces (2,), clockwise.

    The belt runs against the first force and along the last one.
    """
    (ax, ay), (bx, by) = -first, last
    return float(np.mod(np.arctan2(ay * bx - ax * by, ax * bx + ay * by), 2.0 * np.pi))
