"""A shallow sinusoidal arch on two hinges under a sinusoidal load: snap-through and sway.

Y. C. Fung and A. Kaplan, Buckling of low arches or curved beams of small curvature, NACA TN 2840, 1952.
With the radius of gyration rho of the section, w = 2 rho (u sin(pi x/L) + v sin(2 pi x/L)) deflected and
2 rho c sin(pi x/L) drawn, equilibrium under the load q sin(pi x/L) is

    R = (c - u) + (c^2 - u^2 - 4 v^2) u,  (4 - c^2 + u^2 + 4 v^2) v = 0,  R = q L^4 / (2 pi^4 EI rho).
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.path_result import PathResult
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.structure.elastic_body import elastic_body
from verification.bodies import Grid, fixed_components, grid_body, row_points
from verification.solving import ramp, solve

MATERIAL = MooneyRivlin()


class ShallowArch(NamedTuple):
    """The path of an arch, and the closed form.

    Attributes
    ----------
    path : PathResult
    load : float
        First critical load over that of the closed form.
    released : float
        Energy that the first jump released, over the closed form's; NaN for an arch that sways.
    """

    path: PathResult
    load: float
    released: float


def critical_load(rise: float) -> float:
    """R at which the arch of the rise c = ``rise`` leaves its first branch."""
    snap = rise + np.sqrt(4.0 * (rise**2 - 1.0) ** 3 / 27.0)
    return float(snap if rise**2 <= 5.5 else rise + 3.0 * np.sqrt(rise**2 - 4.0))


def released_energy(rise: float) -> float:
    """Fall of the potential at the snap of an arch with c^2 <= 5.5, over 2 pi^4 EI rho^2 / L^3."""
    load, peak = critical_load(rise), np.sqrt((rise**2 - 1.0) / 3.0)

    def potential(u):
        return 0.5 * (u - rise) ** 2 + 0.25 * (u**2 - rise**2) ** 2 + load * u

    # the peak is a double root of the cubic, whose roots add up to zero
    return float(potential(peak) - potential(-2.0 * peak))


def press_arch(
    rise: float,
    cells: tuple[int, int] = (100, 4),
    length: float = 100.0,
    n_steps: int = 24,
    overload: float = 1.2,
    options: NewtonOptions | None = None,
) -> ShallowArch:
    """Press a rubber arch of thickness 1 in plane strain to ``overload`` times its critical load.

    Parameters
    ----------
    rise : float
        c: half the rise over the radius of gyration.
    """
    grid, gyration = Grid(*cells), 1.0 / np.sqrt(12.0)
    particles = grid.reference * (length, 1.0) - (0.0, 0.5)
    wave = np.sin(np.pi * particles[:, 0] / length)
    particles[:, 1] += 2.0 * gyration * rise * wave
    hinges = grid.particle(np.array([0, grid.nx]), grid.ny // 2)
    fixed = fixed_components(grid.n_particles, hinges, hinges)
    body = grid_body(grid, particles, fixed, (1.8, 2.5))
    # plane strain, incompressible: E / (1 - nu^2) is four times the shear modulus
    stiffness = 4.0 * MATERIAL.shear_modulus / 12.0
    scale = 2.0 * np.pi**4 * stiffness * gyration / length**4
    middle = grid.particle(np.arange(grid.nx + 1), grid.ny // 2)
    where = row_points(middle)
    density = np.zeros((len(where), 2))
    density[:, 1] = -overload * scale * critical_load(rise) * wave[middle]
    load = DeadLoad("load", where, density, ramp(n_steps))
    terms = elastic_body(MATERIAL), load
    path = solve(body, particles, terms, n_steps, options=options)
    first = path.critical_points[0]
    unit = scale * length * gyration
    energy = first.released / (unit * released_energy(rise)) if first.kind == "limit" else np.nan
    return ShallowArch(path, overload * first.fraction / n_steps, float(energy))
