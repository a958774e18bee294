"""Exact solutions of bodies of revolution: pressed cylinders and rings, inflated tubes and spheres.

They use the principal stretches of the Mooney-Rivlin energy alone, never the code of the materials:

    W = C10 (I1 J^(-2/3) - 3) + C01 (I2 J^(-4/3) - 3) + K/2 (J - 1)^2.

Lengths in mm, stresses in kPa, forces of the complete ring in N.
"""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_bvp
from scipy.optimize import brentq

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.geometry.motion import straight_motion
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.geometry.shape import GivenShape
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.averaged_points import averaged_points
from seal_mdao.terms.points import boundary_particles
from verification.bodies import Grid, fixed_components, grid_body, scattered
from verification.solving import grown, holding_forces, solve, tight

C10, C01, BULK = 80.0, 20.0, 2000.0
PENALTY, STEPS = 1e5, 5
WIDTH, HEIGHT = 2.0, 1.0
"""Of the section of a pressed ring, mm."""
MILLI = 1e-3
"""kPa mm^2 in N."""
SUPPORT = {1: 2.0, 2: 3.0}
"""Kernel radius over the longest edge at a particle, by the order of the basis."""


def principal_stress(first, second, third, bulk=BULK):
    """First Piola-Kirchhoff stresses (3, ...) of three principal stretches."""
    stretch = np.array(np.broadcast_arrays(first, second, third))
    squares, J = stretch**2, stretch.prod(axis=0)
    one = squares.sum(axis=0)
    two = (one**2 - (squares**2).sum(axis=0)) / 2.0
    # d(I1 J^(-2/3))/dl_i,  d(I2 J^(-4/3))/dl_i,  K (J - 1) J / l_i
    by_one = J ** (-2.0 / 3.0) * (2.0 * stretch - 2.0 / 3.0 * one / stretch)
    by_two = J ** (-4.0 / 3.0) * (2.0 * stretch * (one - squares) - 4.0 / 3.0 * two / stretch)
    return C10 * by_one + C01 * by_two + bulk * (J - 1.0) * J / stretch


def free_stretch(axial: float, bulk: float = BULK) -> float:
    """Radial stretch of a cylinder with a free side, the root of P_r = 0."""
    return brentq(
        lambda s: principal_stress(s, s, axial, bulk)[0], 0.5, 3.0 / axial, xtol=1e-15, rtol=1e-14
    )


def exact_force(inner: float, squeeze: float) -> float:
    """Force, N, of a smooth plate that has moved by ``squeeze`` on a ring with free sides."""

    def axial_stress(axial):
        s = free_stretch(axial)
        return principal_stress(s, s, axial)[2]

    # w_n (l H - y) + P_z = 0 at the plate, y = H - squeeze
    place = HEIGHT - squeeze
    axial = brentq(
        lambda s: PENALTY * (s * HEIGHT - place) + axial_stress(s), 0.5, 1.0, xtol=1e-15, rtol=1e-14
    )
    return -axial_stress(axial) * np.pi * ((inner + WIDTH) ** 2 - inner**2) * MILLI


class PressedRing(NamedTuple):
    """Errors of a ring below a smooth plate.

    Attributes
    ----------
    force : float
        Relative, of the force.
    pressure : float
        Largest difference of a pressure from the mean, over the mean.
    """

    force: float
    pressure: float


def pressed_ring(inner: float, share: float, kind: str, squeeze: float = 0.2) -> PressedRing:
    """A ring of ``inner`` radius, or a cylinder, on a smooth base below a smooth plate.

    Particles are scattered by the fraction ``share`` of their distance; ``kind`` of contact points.
    """
    grid = Grid(12, 6)
    X = scattered(grid, share, 5) * [WIDTH, HEIGHT] + [inner, 0.0]
    fixed = fixed_components(len(X), x=grid.left if inner == 0.0 else (), y=grid.bottom)
    body = grid_body(grid, X, fixed, SUPPORT[1], axisymmetric=True)
    # walked with the body on the left
    row = grid.top[::-1]
    neighbours = Edge(row, False).neighbours
    if kind == "averages":
        points = averaged_points(row, neighbours, X, axisymmetric=True)
    else:
        points = boundary_particles(row, neighbours).around_axis()
    motion = straight_motion((inner, HEIGHT), (inner, HEIGHT - squeeze), STEPS)
    law = ContactLaw(PENALTY, 1e5, 0.0, True)
    plate = RigidContact("plate", points, GivenShape(flat_profile()), motion, law)
    material = MooneyRivlin(C10, C01, BULK)
    options = NewtonOptions(tolerance=1e-12, branch="primary")
    path = solve(body, X, (elastic_body(material), plate), STEPS, None, options)
    pressure = np.maximum(-path.steps[-1].responses[1].gap, 0.0)
    force = abs(path.reaction("plate")[-1, 1])
    return PressedRing(
        float(abs(force / exact_force(inner, squeeze) - 1.0)),
        float(np.abs(pressure / pressure.mean() - 1.0).max()),
    )


def large_ring_force(mean_radius: float | None) -> float:
    """Force of a rough plate on a bonded ring, N per mm of its mean circumference.

    The section, 4 mm wide below and 3 mm above, is bonded below and has no plane of symmetry along the
    axis, so that the curvature 1/R changes the force in first order. None: plane strain.
    """
    grid, middle = Grid(12, 6), mean_radius or 0.0
    across, up = scattered(grid, 0.2, 5).T
    # from x = -2 to 2 below, -1 to 2 above
    X = np.column_stack([2.0 - (1.0 - across) * (4.0 - up), 3.0 * up])
    fixed = fixed_components(len(X), x=grid.bottom, y=grid.bottom)
    place = X + np.array([middle, 0.0])
    body = grid_body(grid, X, fixed, SUPPORT[1], axisymmetric=mean_radius is not None)
    row = grid.top[::-1]
    points = averaged_points(row, Edge(row, False).neighbours, X, body.axisymmetric)
    motion = straight_motion((middle, 3.0), (middle, 2.4), STEPS)
    plate = RigidContact(
        "plate", points, GivenShape(flat_profile()), motion, ContactLaw(PENALTY, 1e5, 0.5, True)
    )
    material = MooneyRivlin(C10, C01, BULK)
    # places of 4e4 mm are rounded by 7e-12 mm: friction to 1e-9 of the forces
    options = NewtonOptions(tolerance=1e-8)
    path = solve(body, place, (elastic_body(material), plate), STEPS, None, options)
    force = abs(path.reaction("plate")[-1, 1])
    # N/m in N/mm, or N over 2 pi R
    return MILLI * force if mean_radius is None else force / (2.0 * np.pi * mean_radius)


# ---- inflated tubes and spheres ----

BORE, OUTSIDE, INFLATED = 1.0, 2.0, 1.5
"""Radii, mm, and the stretch of the bore."""
HOOPS = {"tube": 1, "sphere": 2}
"""Directions with the hoop stretch r / R."""


def radial_solution(kind: str, bulk: float = BULK):
    """Radii r(R) and the nominal stress P_r at the bore of an inflated tube or sphere.

    With n hoop directions, q = r' and t = r / R,

        P_r' = n (P_t - P_r) / R,    r(A) given,    P_r(B) = 0.

    Returns
    -------
    radius : callable
        ``radius(R)`` of any radii, mm.
    stress : float
        kPa.
    """
    n, step = HOOPS[kind], 1e-30

    def stress(q, t):
        return principal_stress(q, t, t if n == 2 else 1.0, bulk)

    def rates(R, state):
        r, q = state
        t = r / R
        at = stress(q, t)
        by_q, by_t = (stress(q + 1j * step, t)[0], stress(q, t + 1j * step)[0])
        # P_r' = dP_r/dq q' + dP_r/dt (q - t)/R
        away = n * (at[1] - at[0]) / R - by_t.imag / step * (q - t) / R
        return np.array([q, away / (by_q.imag / step)])

    def ends(first, last):
        return np.array([first[0] - INFLATED * BORE, stress(last[1], last[0] / OUTSIDE)[0] / C10])

    R = np.linspace(BORE, OUTSIDE, 101)
    # r^(n+1) - R^(n+1) is constant where the volume is
    grown_by = (INFLATED * BORE) ** (n + 1) - BORE ** (n + 1)
    r = (R ** (n + 1) + grown_by) ** (1.0 / (n + 1))
    found = solve_bvp(rates, ends, R, np.array([r, (R / r) ** n]), tol=1e-11, max_nodes=100_000)
    if not found.success:
        raise RuntimeError(found.message)
    q = found.sol(BORE)[1]
    return lambda radii: found.sol(radii)[0], float(stress(q, INFLATED)[0])


class InflationErrors(NamedTuple):
    """Errors of an inflated body.

    Attributes
    ----------
    displacement : float
        Root of the mean square of all particles, over that of the exact one.
    force : float
        Relative, of the force on the bore.
    """

    displacement: float
    force: float


class Inflated(NamedTuple):
    """An inflated body.

    Attributes
    ----------
    grid : Grid
    displacement, exact : ndarray, shape (n, 2)
        Of the particles, computed and exact, mm.
    force : float
        Relative error of the force on the bore.
    """

    grid: Grid
    displacement: np.ndarray
    exact: np.ndarray
    force: float


def inflate(kind: str, cells: int, basis_order: int = 1, **options) -> Inflated:
    """Inflate a hemisphere or a slice of a tube, two cells high, with ``cells`` through the wall."""
    if kind == "tube":
        grid, height = Grid(cells, 2), 2.0 * (OUTSIDE - BORE) / cells
        X = grid.reference * [OUTSIDE - BORE, height] + [BORE, 0.0]
        fixed = fixed_components(len(X), x=grid.left, y=[*grid.bottom, *grid.top])
        normals, area = np.tile([1.0, 0.0], (len(X), 1)), 2.0 * np.pi * BORE * height
    else:
        grid = Grid(cells, 2 * cells)
        angle = 0.5 * np.pi * grid.reference[:, 1]
        normals = np.column_stack([np.cos(angle), np.sin(angle)])
        normals[grid.top, 0] = normals[grid.bottom, 1] = 0.0
        X = (BORE + (OUTSIDE - BORE) * grid.reference[:, :1]) * normals
        # the axis, the bore, the equator
        fixed = fixed_components(len(X), x=[*grid.left, *grid.top], y=[*grid.left, *grid.bottom])
        area = 2.0 * np.pi * BORE**2
    body = grid_body(
        grid, X, fixed, SUPPORT[basis_order], basis_order=basis_order, axisymmetric=True, **options
    )
    radius, stress = radial_solution(kind)
    u = np.where(fixed, (INFLATED - 1.0) * BORE * normals, 0.0)
    inside = np.ones(len(X), bool)
    inside[grid.left] = False
    u[inside] = 0.0
    material = MooneyRivlin(C10, C01, BULK)
    path = solve(body, X, (elastic_body(material),), 5, grown(u, 5), tight(material))
    R = np.einsum("ni,ni->n", X, normals)
    exact = (radius(R) - R)[:, None] * normals
    force = np.einsum("ni,ni->", holding_forces(path)[-1, grid.left], normals[grid.left])
    error = float(abs(force / (-stress * area * MILLI) - 1.0))
    return Inflated(grid, path.displacement(), exact, error)


def relative_difference(found: np.ndarray, exact: np.ndarray) -> float:
    """Root of the mean square of a difference over that of the exact values."""
    return float(np.sqrt(((found - exact) ** 2).sum() / (exact**2).sum()))


def inflation_errors(kind: str, cells: int, basis_order: int = 1, **options) -> InflationErrors:
    """Errors of an inflated tube or hemisphere with so many ``cells`` through the wall."""
    own = inflate(kind, cells, basis_order, **options)
    return InflationErrors(relative_difference(own.displacement, own.exact), own.force)


def extrapolated_error(cells: int) -> float:
    """Error of a hemisphere's displacement extrapolated in h^2 from ``cells`` and twice as many."""
    coarse, fine = (inflate("sphere", n) for n in (cells, 2 * cells))
    # particles of the coarse grid in the fine one
    i, j = np.divmod(np.arange(coarse.grid.n_particles), coarse.grid.ny + 1)
    same = fine.grid.particle(2 * i, 2 * j)
    # u = u_h + (u_h - u_2h) / 3
    found = fine.displacement[same] + (fine.displacement[same] - coarse.displacement) / 3.0
    return relative_difference(found, coarse.exact)
