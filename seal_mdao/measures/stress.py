"""Von Mises stress at particles, its p-norm over a region, and its maximum over the section."""

from dataclasses import dataclass, replace
from math import ceil, log, log1p

import numpy as np

from seal_mdao.measures.measure import Measure
from seal_mdao.measures.selection import boundary_peaks
from seal_mdao.measures.singular_points import away_from_singular
from seal_mdao.measures.smooth_peaks import NORM_ORDER, p_norm
from seal_mdao.structure.particle_stress import particle_stress
from seal_mdao.values import real

STRESS_COUNT = 7
EXCESS = 0.05
"""Bound of the relative excess of the smooth maximum over the largest stress."""


@dataclass(frozen=True)
class VonMises(Measure):
    """Von Mises stress at particles at the end of the path.

    Attributes
    ----------
    points : tuple of int, or None
        Particles; None for the ``count`` largest local maxima along the boundaries of the nominal seal.
    count : int
    """

    points: tuple | None = None
    count: int = STRESS_COUNT
    name: str = "von_mises"
    units = "kPa"
    text = "Von Mises stress at particles, at the end of the path."

    @property
    def selects_points(self):
        return self.points is None

    def frozen(self, nominal):
        rows = [
            (edge.particles[~nominal.seal.body.fixed[edge.particles].all(axis=1)], edge.closed)
            for edge in nominal.seal.body.edges.values()
        ]
        # rows without fully fixed particles
        rows = [(row, closed) for row, closed in rows if row.size]
        peaks = boundary_peaks(rows, nominal.stress_field(), self.count)
        return replace(self, points=tuple(int(p) for p in peaks))

    def on_refined(self, fine, particles):
        # the same places
        return replace(self, points=tuple(particles[list(self.points)].tolist()))

    def size(self, seal):
        return self.count if self.points is None else len(self.points)

    def evaluate(self, result, partials):
        points = np.array(self.points, int)
        stress, rows = particle_stress(result.path, points), np.arange(len(points))
        # d sigma_vm/dF and d sigma_vm/d(constants) of ``particle_stress``
        for step, by_gradient in stress.by_gradient:
            partials.gradient(step)[rows, points] += by_gradient
        for name, row in stress.by_constants.items():
            partials.parameter(name)[:] += row
        return stress.value


def _stress_norm(result, points, order, partials, gradient_at) -> float:
    """Compute the p-norm of the von Mises stress at points, and add its derivatives in F at every step
    to ``gradient_at(step)`` (1, N, 4 or 5)."""
    stress = particle_stress(result.path, points)
    # N = (sum sigma_i^p)^(1/p),  dN/dF_i = (dN/d sigma_i) d sigma_i/dF_i
    value, weight = p_norm(stress.value, order)
    for step, by_gradient in stress.by_gradient:
        gradient_at(step)[0][points] += weight[:, None] * by_gradient
    for name, row in stress.by_constants.items():
        partials.parameter(name)[0] += weight @ row
    return value


@dataclass(frozen=True)
class StressNorm(Measure):
    """p-norm of the von Mises stress over particles: a smooth upper bound of the largest.

    Attributes
    ----------
    points : tuple of int, or None
        None for all particles.
    order : int
    """

    points: tuple | None = None
    order: int = NORM_ORDER
    name: str = "stress_norm"
    units = "kPa"
    text = "p-norm of the von Mises stress of the particles, an upper bound."

    def on_refined(self, fine, particles):
        # the same places: more of them would make the sum larger
        own = particles if self.points is None else particles[list(self.points)]
        return replace(self, points=tuple(own.tolist()))

    def evaluate(self, result, partials):
        n = len(result.particles)
        points = np.arange(n) if self.points is None else np.array(self.points, int)
        return _stress_norm(result, points, self.order, partials, partials.gradient)


@dataclass(frozen=True)
class LargestVonMises(Measure):
    """Smooth maximum of the von Mises stress over the complete section: at all particles, at the
    midpoints of the sides of all cells and at their centres.

    It is the p-norm of the stresses s_i at these n points, for which

        max_i s_i <= (sum_i s_i^p)^(1/p) <= n^(1/p) max_i s_i,

    with p = ln n / ln(1 + excess), so the value is never below the largest of them, and at most
    ``excess`` above it. Its sensitivities cost one adjoint solution.

    Attributes
    ----------
    excess : float
        Bound on the relative excess: with a smaller one the derivatives change faster with the design.
    away_from_singular : float
        Distance from the singular points of the nominal section (``measures.singular_points``) within
        which points are left out, mm; 0 for the complete section.

    Raises
    ------
    ValueError
        For an excess that is not between 0 and 1, or a negative distance.
    """

    excess: float = EXCESS
    away_from_singular: float = 0.0
    name: str = "largest_von_mises"
    units = "kPa"
    text = "Largest von Mises stress of the section, a smooth upper bound."

    def __post_init__(self):
        real(f"excess of {self.name!r}", self.excess, above=0.0, high=1.0)
        real(f"away_from_singular of {self.name!r}", self.away_from_singular, low=0.0)

    def order(self, n_points: int) -> int:
        """Compute the order p of the norm over a number of points."""
        # n^(1/p) <= 1 + excess  =>  p >= ln n / ln(1 + excess)
        return max(2, ceil(log(n_points) / log1p(self.excess)))

    def check(self, seal):
        # refuses a distance from singular points beyond which nothing is left
        self.points(seal)

    def points(self, seal) -> np.ndarray:
        """Return the points of ``Body.samples`` that are evaluated; ValueError if none is left."""
        # particles, midpoints of sides, centres of cells
        if self.away_from_singular == 0.0:
            return np.arange(len(seal.body.samples.anchors))
        return away_from_singular(seal, self.away_from_singular)

    def evaluate(self, result, partials):
        points = self.points(result.seal)
        order = self.order(points.size)
        return _stress_norm(result, points, order, partials, partials.section_gradient)
