"""Hertz line contact: a rigid cylinder pressed on a large elastic block, frictionless, small strain."""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.friction import OPEN, ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body
from seal_mdao.geometry.motion import straight_motion
from seal_mdao.geometry.profile import circle_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import MaterialPoints
from verification.bodies import Grid, fixed_components, grid_body, row_points
from verification.solving import solve

RADIUS = 100.0
# shear modulus 1, Poisson's ratio 0.3: E = 2.6, plane-strain modulus E / (1 - nu^2)
MATERIAL = MooneyRivlin(0.5, 0.0, 13.0 / 6.0)
MODULUS = 2.6 / (1.0 - 0.3**2)


class HertzContact(NamedTuple):
    """Contact pressures under the cylinder, one side of it.

    Attributes
    ----------
    load : float
        Force per unit depth on the whole cylinder.
    x, pressure : ndarray, shape (k,)
        Deformed places and pressures of the contact points.
    half_width, exact_half_width : float
        The exact ones are Hertz's for the computed load.
    peak, exact_peak : float
    """

    load: float
    x: np.ndarray
    pressure: np.ndarray
    half_width: float
    exact_half_width: float
    peak: float
    exact_peak: float


class FannedBlock(NamedTuple):
    """A block [-side, side] x [-side, 0]: a fine patch at the origin and rings of cells around it.

    Attributes
    ----------
    n : int
        Cells along the depth of the patch, twice as many along its width; the rings, each larger
        by one n-th, keep the cells square.
    patch, side : float
        Depths of the patch and of the block.
    """

    n: int
    patch: float
    side: float

    @property
    def grid(self) -> Grid:
        return Grid(2 * self.n, self.n)

    @property
    def n_rings(self) -> int:
        return int(np.ceil(np.log(self.side / self.patch) / np.log1p(1.0 / self.n)))

    @property
    def particles(self) -> np.ndarray:
        """Patch column by column, then ring by ring from the top left round to the top right."""
        square = self.grid.reference * [2.0, 1.0] - 1.0
        border = square[self._border]
        sizes = np.geomspace(self.patch, self.side, self.n_rings + 1)[1:]
        rings = (sizes[:, None, None] * border).reshape(-1, 2)
        return np.vstack([self.patch * square, rings])

    @property
    def _border(self) -> np.ndarray:
        grid = self.grid
        return np.concatenate([grid.left[:0:-1], grid.bottom, grid.right[1:]])

    @property
    def rings(self) -> np.ndarray:
        """Particle numbers (n_rings + 1, 4 n + 1); the first row is the border of the patch."""
        width = 4 * self.n + 1
        rest = self.grid.n_particles + np.arange(self.n_rings * width).reshape(-1, width)
        return np.vstack([self._border, rest])

    @property
    def cells(self) -> np.ndarray:
        r = self.rings
        corners = [r[:-1, :-1], r[1:, :-1], r[1:, 1:], r[:-1, 1:]]
        around = np.stack([c.ravel() for c in corners], axis=1)
        return np.vstack([self.grid.cells, around])

    def body(self) -> Body:
        """Held at the bottom."""
        bottom = self.rings[-1, self.n : -self.n]
        fixed = fixed_components(len(self.particles), x=bottom, y=bottom)
        return grid_body(self, self.particles, fixed)

    def surface(self) -> MaterialPoints:
        """The upper surface of the patch, which may touch."""
        row = np.concatenate([self.rings[1:2, 0], self.grid.top, self.rings[1:2, -1]])
        return row_points(row, 1)


def hertz_line(load: float) -> tuple[float, float]:
    """Half-width and peak pressure for a load per unit depth.

    a^2 = 4 P R / (pi E*), p0 = 2 P / (pi a) (H. Hertz 1882; K. L. Johnson, Contact Mechanics,
    1985, Eqs. (4.43), (4.45)), the cylinder being rigid.
    """
    a = np.sqrt(4.0 * load * RADIUS / (np.pi * MODULUS))
    return float(a), float(2.0 * load / (np.pi * a))


def press_cylinder(n: int = 8, depth: float = 0.03, side: float = 20.0) -> HertzContact:
    """A cylinder of radius 100 pressed into a block 40 x 20; the half-width a is about 1.32.

    Parameters
    ----------
    n : int
        Cells along 1.6, the depth of the fine patch; a half-width holds 0.83 n of them.
    depth : float
        How far the cylinder is pressed down; strains are of the order a / (2 R) < 1 %.

    Notes
    -----
    The half-width is that of the second moment of the pressure, a^2 / 4 = int p x^2 / int p for
    Hertz's ellipse, which uses every point and nothing to choose; the peak is the largest pressure
    of a contact point. Both are compared with Hertz's for the computed load, so that the
    compliance of the finite block does not enter.
    """
    block = FannedBlock(n, 1.6, side)
    contact = RigidContact(
        "cylinder", block.surface(), GivenShape(circle_profile((0.0, RADIUS), RADIUS)),
        straight_motion((0.0, 1e-6), (0.0, -depth), 3), ContactLaw(3e3, 1.0, 0.0, True),
    )  # fmt: skip
    path = solve(block.body(), block.particles, (elastic_body(MATERIAL), contact), 3)
    end, length = path.at_nominal("cylinder")[-1], path.problem.term("cylinder").length
    touching = end.state != OPEN
    x = end.x[touching, 0]
    force = np.hypot(*end.force[touching].T)
    pressure = force / length[touching]
    half_width = float(2.0 * np.sqrt(force @ x**2 / force.sum()))
    load = float(end.total[1])
    exact = hertz_line(load)
    return HertzContact(load, x, pressure, half_width, exact[0], float(pressure.max()), exact[1])
