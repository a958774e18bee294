"""Measures of the deformed and the undeformed section."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.measures.measure import Measure


@dataclass(frozen=True)
class Displacement(Measure):
    """Displacement of a particle at the end of the path.

    Attributes
    ----------
    point : int
        Particle.
    """

    point: int
    name: str = "displacement"
    units = "mm"
    text = "Displacement of a particle: horizontal, vertical."

    def on_refined(self, fine, particles):
        return replace(self, point=int(particles[self.point]))

    def size(self, seal):
        return 2

    def evaluate(self, result, partials):
        # dm_i/du_j = delta_ij
        partials.displacement()[np.arange(2), self.point, np.arange(2)] += 1.0
        return result.displacement()[self.point]


@dataclass(frozen=True)
class CavityArea(Measure):
    """Area inside a closed edge of the deformed section.

    Attributes
    ----------
    edge : str
        Name of the edge around the cavity.
    """

    edge: str
    name: str = "cavity_area"
    units = "mm**2"
    text = "Area of a cavity of the deformed section."

    def evaluate(self, result, partials):
        ring = result.seal.body.edge(self.edge).particles
        x = result.particles[ring] + result.displacement()[ring]
        value, by_x = polygon_area(x)
        # edges have the body on the left: a cavity is traversed clockwise, its area negative;
        # x = X + u, hence the same derivatives in X and u
        sense = 1.0 if value > 0.0 else -1.0
        partials.displacement()[0, ring] += sense * by_x
        partials.particles[0, ring] += sense * by_x
        return sense * value


@dataclass(frozen=True)
class SectionArea(Measure):
    """Area of the undeformed section, summed over its cells."""

    name: str = "section_area"
    units = "mm**2"
    text = "Area of the undeformed section."

    def evaluate(self, result, partials):
        value, by_particles = cells_area(result.seal.body.cells, result.particles)
        partials.particles[0] += by_particles
        return value


@dataclass(frozen=True)
class Volume(Measure):
    """Volume of the undeformed body of revolution, summed over its cells."""

    name: str = "volume"
    units = "mm**3"
    text = "Volume of the undeformed body of revolution."

    def check(self, seal):
        if not seal.body.axisymmetric:
            raise ValueError(
                'the measure volume needs a body of revolution (kinematics = "axisymmetric" in '
                "[model]); for a long seal use section_area"
            )

    def evaluate(self, result, partials):
        value, by_particles = cells_volume(result.seal.body.cells, result.particles)
        partials.particles[0] += by_particles
        return value


@dataclass(frozen=True)
class Mass(Measure):
    """Mass of the undeformed seal per length, of a ring that of the complete ring.

    Every material of the section needs a density.
    """

    name: str = "mass"
    units = "g/m"
    text = "Mass of the seal."

    def check(self, seal):
        for region in seal.definitions[0].regions:
            if region.density is None:
                where = f"[material.{region.name}]" if region.name else "its table [material.NAME]"
                raise ValueError(
                    f"{region.title} has no density; add density = 1200 (kg/m3), or its own value, "
                    f"to {where}"
                )

    def evaluate(self, result, partials):
        body, total = result.seal.body, 0.0
        size = cells_volume if body.axisymmetric else cells_area
        for region in result.term("structure").definition.regions:
            value, by_particles = size(body.cells[region.at], result.particles)
            # kg/m^3 mm^2 = 1e-3 g/m,  kg/m^3 mm^3 = 1e-6 g
            weight = region.density * (1e-6 if body.axisymmetric else 1e-3)
            total += weight * value
            partials.particles[0] += weight * by_particles
        return total


def cells_volume(cells: np.ndarray, particles: np.ndarray) -> tuple[float, np.ndarray]:
    """Compute the volume of cells (m, 4) turned about x = 0, and its gradient (n, 2), as
    ``cells_area``."""
    value, gradient = 0.0, np.zeros_like(particles)
    for corners, area, pulls in _triangles(cells, particles):
        # V = 2 pi R A of each triangle, R = (x_a + x_b + x_c) / 3 (Pappus)
        around = 2.0 * np.pi * particles[corners, 0].sum(axis=1) / 3.0
        value += (around * area).sum().item()
        on_radius = np.column_stack([2.0 * np.pi / 3.0 * area, np.zeros(len(area))])
        for corner, pull in enumerate(pulls):
            np.add.at(gradient, corners[:, corner], around[:, None] * pull + on_radius)
    return value, gradient


def cells_area(cells: np.ndarray, particles: np.ndarray) -> tuple[float, np.ndarray]:
    """Compute the area of cells (m, 4), triangles repeating a corner, and its gradient (n, 2).

    Both are complex for complex particles.
    """
    value, gradient = 0.0, np.zeros_like(particles)
    for corners, area, pulls in _triangles(cells, particles):
        value += area.sum().item()
        for corner, pull in enumerate(pulls):
            np.add.at(gradient, corners[:, corner], pull)
    return value, gradient


def _triangles(cells: np.ndarray, particles: np.ndarray):
    """Divide cells in two triangles: their corners (m, 3), areas (m,), and derivatives of the areas in
    the corners, three (m, 2)."""
    # of a triangular cell one of both is degenerate
    for corners in (cells[:, [0, 1, 2]], cells[:, [0, 2, 3]]):
        a, b, c = (particles[corners[:, i]] for i in range(3))
        u, v = b - a, c - a
        # A = 1/2 u x v with u = b - a, v = c - a
        area = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
        # dA/db = 1/2 (v_y, -v_x),  dA/dc = 1/2 (-u_y, u_x),  dA/da = -dA/db - dA/dc
        by_b = 0.5 * np.column_stack([v[:, 1], -v[:, 0]])
        by_c = 0.5 * np.column_stack([-u[:, 1], u[:, 0]])
        yield corners, area, (-by_b - by_c, by_b, by_c)
