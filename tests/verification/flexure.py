"""Bending of a block to a ring: Rivlin's flexure of an incompressible block in plane strain."""

from typing import NamedTuple

import numpy as np

from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body
from verification.solving import holding_forces, solve, tight


class Flexure(NamedTuple):
    """Moment against bending angle.

    Attributes
    ----------
    angle : ndarray, shape (n_steps,)
        Angle between the two end faces, radians.
    moment, exact : ndarray, shape (n_steps,)
        Moment per unit depth over mu H^2, H the thickness; computed and closed form.
    misplacement : float
        Largest distance of a particle from its exact place at the end, over the thickness.
    """

    angle: np.ndarray
    moment: np.ndarray
    exact: np.ndarray
    misplacement: float

    @property
    def error(self) -> np.ndarray:
        """Relative error of the moment at every angle."""
        return self.moment / self.exact - 1.0


def bent_radii(angle: float, length: float, thickness: float = 1.0):
    """Inner and outer radius of the bent block whose curved faces are free of traction."""
    rate = angle / length
    root = np.hypot(rate * thickness, 1.0)
    # r2^2 - r1^2 = 2 H / rate (volume) and rate^2 r1 r2 = 1 (free faces)
    mean = root / rate**2
    half = thickness / rate
    return np.sqrt(mean - half), np.sqrt(mean + half)


def bent_places(X: np.ndarray, angle: float, length: float, thickness: float = 1.0) -> np.ndarray:
    """Exact places: r^2 = r1^2 + 2 (H - Y) / rate, theta = rate (X - L / 2), top face inside."""
    if angle == 0.0:
        return X.copy()
    rate = angle / length
    inner, _ = bent_radii(angle, length, thickness)
    r = np.sqrt(inner**2 + 2.0 * (thickness - X[:, 1]) / rate)
    theta = rate * (X[:, 0] - 0.5 * length)
    centre = np.array([0.5 * length, thickness + inner])
    return centre + r[:, None] * np.column_stack([np.sin(theta), -np.cos(theta)])


def exact_moment(angle: float, length: float, thickness: float = 1.0) -> float:
    """Moment per unit depth over mu H^2.

    R. S. Rivlin, Proc. R. Soc. A 195 (1949) 463: lambda_theta = rate r = 1 / lambda_r, and for the
    Mooney-Rivlin material in plane strain sigma_theta = d(r sigma_r)/dr with
    sigma_r = mu (rate^2 r^2 + rate^-2 r^-2 - rate^2 r1^2 - rate^-2 r1^-2) / 2. The moment is the
    integral of sigma_theta r over the thickness; sigma_r vanishes on both faces when
    rate^2 r1 r2 = 1, and the end faces then carry no resultant force.
    """
    rate = angle / length
    r1, r2 = bent_radii(angle, length, thickness)
    level = (rate * r1) ** 2 + (rate * r1) ** -2
    # -integral of r sigma_r dr, after one integration by parts
    power = rate**2 * (r2**4 - r1**4) / 4.0 + rate**-2 * np.log(r2 / r1)
    return float(-0.5 * (power - level * (r2**2 - r1**2) / 2.0) / thickness**2)


def bend_block(
    degrees: float = 360.0,
    cells: tuple[int, int] = (60, 6),
    length: float = 10.0,
    bulk_ratio: float = 1e4,
    n_steps: int = 36,
    support=2.0,
) -> Flexure:
    """A 10 x 1 block bent until its ends meet; the end faces follow Rivlin's solution.

    ``support`` as of ``grid_body``.
    """
    grid = Grid(*cells)
    X = grid.reference * [length, 1.0]
    ends = np.concatenate([grid.left, grid.right])
    material = MooneyRivlin(0.4, 0.1, bulk_ratio)
    body = grid_body(grid, X, fixed_components(len(X), x=ends, y=ends), support)
    angle = np.linspace(0.0, np.radians(degrees), n_steps + 1)
    imposed = ImposedDisplacements(np.array([bent_places(X, a, length) - X for a in angle]))
    path = solve(body, X, (elastic_body(material),), n_steps, imposed, tight(material))
    moment = []
    for a, f in zip(angle[1:], holding_forces(path)[:, grid.right], strict=True):
        x = bent_places(X[grid.right], a, length)
        x = x - x.mean(axis=0)
        moment.append(np.sum(x[:, 0] * f[:, 1] - x[:, 1] * f[:, 0]))
    exact = np.array([exact_moment(a, length) for a in angle[1:]])
    away = X + path.displacement() - bent_places(X, angle[-1], length)
    return Flexure(angle[1:], np.array(moment), exact, float(np.abs(away).max()))
