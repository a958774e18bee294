"""Contact patch tests: a block that a flat profile deforms homogeneously must feel uniform traction."""

from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.friction import OPEN, ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.geometry.motion import straight_motion
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.averaged_points import averaged_points
from seal_mdao.terms.points import MaterialPoints, boundary_particles
from verification.bodies import Grid, fixed_components, grid_body, scattered
from verification.patch import homogeneous_stress
from verification.solving import grown, solve

MATERIAL = MooneyRivlin(80.0, 20.0, 2000.0)
PENALTY = 1e5
WIDTH = 2.0
STEPS = 5
# pressures are known to the residual over the force on a point, a tenth of the whole
OPTIONS = NewtonOptions(tolerance=1e-12, branch="primary")


class ContactPatch(NamedTuple):
    """A pressed block.

    Attributes
    ----------
    path : PathResult
    place : ndarray, shape (k,)
        Undeformed places of the contact points along the plate, mm.
    pressure : ndarray, shape (k,)
        Nominal pressures of the contact points, kPa.
    state : ndarray of int, shape (k,)
    """

    path: PathResult
    place: np.ndarray
    pressure: np.ndarray
    state: np.ndarray

    @property
    def deviation(self) -> float:
        """Largest difference of a pressure from the mean, over the mean, of the points in contact."""
        pressure = self.pressure[self.state != OPEN]
        return float(np.abs(pressure / pressure.mean() - 1.0).max())


def block(share: float, basis_order: int):
    """Grid, particles scattered by a fraction of the spacing, and support of a block 2 x 1 mm."""
    grid = Grid(12, 6)
    return grid, scattered(grid, share, 5) * [WIDTH, 1.0], 2.0 if basis_order == 1 else 3.0


def contact_points(kind: str, row: np.ndarray, particles: np.ndarray) -> MaterialPoints:
    """Contact points of a row of particles."""
    neighbours = Edge(row, False).neighbours
    if kind == "averages":
        return averaged_points(row, neighbours, particles)
    return boundary_particles(row, neighbours)


def pressed(
    kind: str, share: float, basis_order: int = 1, squeeze: float = 0.1, sides: bool = False
) -> ContactPatch:
    """A block on a smooth base beside a plane of symmetry, its other side free, below a smooth plate.

    With ``sides`` the plate may touch both sides, too, around sharp corners.
    """
    grid, X, support = block(share, basis_order)
    fixed = fixed_components(len(X), x=grid.left, y=grid.bottom)
    body = grid_body(grid, X, fixed, support, basis_order=basis_order)
    motion = straight_motion((0.0, 1.0), (0.0, 1.0 - squeeze), STEPS)
    row = grid.top[::-1]
    if sides:
        row = np.concatenate([grid.right, row[1:-1], grid.left[::-1]])
    plate = _plate(kind, row, X, motion, friction=0.0)
    path = solve(body, X, (elastic_body(MATERIAL), plate), STEPS, None, OPTIONS)
    return _found(path)


def slid(kind: str, share: float, basis_order: int = 1) -> tuple[ContactPatch, float]:
    """A block sheared on three sides while a rough plate slides on the fourth.

    Returns
    -------
    patch : ContactPatch
    error : float
        Largest error of a displacement, over the side of the block.
    """
    grid, X, support = block(share, basis_order)
    # x = F X, compressed and sheared
    F = np.array([[1.0, 0.06], [0.0, 0.9]])
    shear, normal = homogeneous_stress(F, MATERIAL)[:, 1]
    held = np.unique(np.concatenate([grid.left, grid.right, grid.bottom]))
    fixed = fixed_components(len(X), x=held, y=held)
    body = grid_body(grid, X, fixed, support, basis_order=basis_order)
    # g = y - x_2 = P_22 / w_n,  mu = P_12 / |P_22|
    motion = straight_motion((0.0, 1.0), (1.0, F[1, 1] + normal / PENALTY), STEPS)
    # the free side on its left: walked from the right end
    row = grid.top[::-1]
    plate = _plate(kind, row, X, motion, friction=abs(shear / normal))
    u = X @ (F - np.eye(2)).T
    path = solve(body, X, (elastic_body(MATERIAL), plate), STEPS, grown(u, STEPS), OPTIONS)
    return _found(path), float(np.abs(path.displacement() - u).max())


def _plate(kind, row, particles, motion, friction: float) -> RigidContact:
    law = ContactLaw(PENALTY, 1e5, friction, True)
    return RigidContact(
        "plate",
        contact_points(kind, row, particles),
        GivenShape(flat_profile()),
        motion,
        law,
    )


def _found(path) -> ContactPatch:
    response, place = path.steps[-1].responses[1], path.problem.term("plate").reference[:, 0]
    return ContactPatch(path, place, -PENALTY * response.gap, response.state)
