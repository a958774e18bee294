"""The rows B = Phi of a term's points, and all that a design moves there."""

from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.transformed import TableRates
from seal_mdao.terms.linearization import Inputs


class PointDesign(NamedTuple):
    """Rates of what a design moves at k points, in P columns.

    Attributes
    ----------
    phi : TableRates
        B'.
    x : ndarray, shape (k, 2, P)
        X' of the undeformed places.
    measure : ndarray, shape (k, 1, P)
        w' of the weights.
    parameters : ndarray, shape (n, P)
        theta' of the scalar parameters.
    """

    phi: TableRates
    x: np.ndarray
    measure: np.ndarray
    parameters: np.ndarray


class PointDesignSeeds(NamedTuple):
    """Seeds of M measures on what a design moves at k points; summed over the steps.

    Attributes
    ----------
    phi : ndarray, shape (phi.size, M)
        On B.
    law : Inputs
        On what the law takes.
    """

    phi: np.ndarray
    law: Inputs

    @property
    def parameters(self) -> np.ndarray:
        """On the scalar parameters, shape (n, M)."""
        return self.law.parameters.sum(axis=0)


class PointRows:
    """Rows B of the points of a term, and their design derivatives.

    Parameters
    ----------
    term : TermAtPoints
    """

    def __init__(self, term):
        self.term, self.where, self.table = term, term.where, term.table
        self.discretization = term.discretization

    def rates(self, shape, rates) -> PointDesign:
        """Rates for the parameters of ``rates``; ``shape`` are the ``DiscretizationRates``."""
        particles, velocity = self.discretization.particles, rates.velocity
        measure = self.where.length_rates(particles, velocity)[:, None]
        x, parameters = self.where.velocity(velocity), rates.of(self.term.names)
        return PointDesign(shape.tables[self.term.place], x, measure, parameters)

    def no_seeds(self, count: int, wanted=()) -> PointDesignSeeds:
        """Zero seeds of ``count`` measures, to be added to."""
        phi = np.zeros((self.table.table.phi.size, count))
        return PointDesignSeeds(phi, self.term.spaces[1].zeros(len(self.where), count))

    def pull_back(self, seeds: PointDesignSeeds, particles_bar):
        """Transpose of ``rates``: add to ``particles_bar`` (n, 2, M) what the seeds come to there.

        Returns
        -------
        ndarray, shape (c, u, M)
            Seeds on the essential transformation.
        """
        disc, none, law = self.discretization, np.empty((0, particles_bar.shape[2])), seeds.law
        # x = X + B d, and X itself
        x_bar = law.x + law.reference if law.reference.shape[1] else law.x
        self.where.add_length_seeds(disc.particles, law.measure[:, 0], particles_bar)
        self.where.add_point_seeds(x_bar, particles_bar)
        return self.table.pull_back(seeds.phi, none, particles_bar)
