"""The rows B = Phi of a term's points, and all that a design moves there."""

from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.tables import table_seeds
from seal_mdao.rkpm.transformed import TableRates


class PointDesign(NamedTuple):
    """Rates of what a design moves at k points, or seeds on it, in P columns.

    Attributes
    ----------
    phi : TableRates, or ndarray, shape (phi.size, P)
        Of the rows B: rates B', or seeds.
    x : ndarray, shape (k, 2, P)
        Of the undeformed places X.
    measure : ndarray, shape (k, 1, P)
        Of the weights w.
    parameters : ndarray, shape (n, P)
        Of the scalar parameters theta.
    """

    phi: TableRates
    x: np.ndarray
    measure: np.ndarray
    parameters: np.ndarray


class PointRows:
    """Rows B of material points, and their design derivatives.

    Parameters
    ----------
    where : MaterialPoints
    names : tuple of str
        Scalar parameters of the term.
    discretization : Discretization
    place : int
        Which of the discretisation's tables holds the rows.
    """

    def __init__(self, where, names, discretization, place: int):
        self.where, self.names, self.place = where, names, place
        self.discretization, self.table = discretization, discretization.tables[place]

    def rates(self, shape, rates) -> PointDesign:
        """Rates for the parameters of ``rates``; ``shape`` are the ``DiscretizationRates``."""
        particles, velocity = self.discretization.particles, rates.velocity
        measure = self.where.length_rates(particles, velocity)[:, None]
        x, parameters = self.where.velocity(velocity), rates.of(self.names)
        return PointDesign(shape.tables[self.place], x, measure, parameters)

    def no_seeds(self, count: int, wanted=()) -> PointDesign:
        """Zero seeds of ``count`` measures, to be added to."""
        k, n = len(self.where), len(self.names)
        shapes = (self.table.table.phi.size,), (k, 2), (k, 1), (n,)
        return PointDesign(*(np.zeros((*shape, count)) for shape in shapes))

    def pull_back(self, seeds: PointDesign, particles_bar):
        """Transpose of ``rates``: add to ``particles_bar`` (n, 2, M) what the seeds come to there.

        Returns
        -------
        ndarray, shape (c, u, M)
            Seeds on the essential transformation.
        """
        disc, none = self.discretization, np.empty((0, particles_bar.shape[2]))
        self.where.add_length_seeds(disc.particles, seeds.measure[:, 0], particles_bar)
        self.where.add_point_seeds(seeds.x, particles_bar)
        return table_seeds(
            disc.cloud, self.table, seeds.phi, none, particles_bar, disc.transformation
        )
