"""Common base of terms at material points: rows of shape functions, history and outputs."""

from functools import cached_property

import numpy as np

from seal_mdao.terms.linearized_points import PointRows, PointSeeds
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.term import Term


class TermAtPoints(Term):
    """Base class of ``PointTerm`` and ``CoupledTerm``.

    Parameters
    ----------
    label : str
    names : tuple of str
        Scalar parameters, in the order of their columns in ``linearize``.
    where : MaterialPoints
    discretization : Discretization
    index : int
        Which of the discretisation's tables holds the shape functions at the points.

    Attributes
    ----------
    history_size : int
        Variables that a point passes to the next step.
    output_names : tuple of str
        What measures may take besides the force, the columns of the response's ``outputs``.
    """

    history_size = 0
    output_names: tuple = ()

    def __init__(self, label, names, where: MaterialPoints, discretization, index: int):
        self.label, self.names, self.where, self.index = label, tuple(names), where, index
        self.discretization, self.table = discretization, discretization.tables[index]
        self.reference = self.table.coordinates
        # w, the length that a point stands for
        self.length = where.measures(discretization.particles)
        self._x = np.empty((len(where), 2))

    @property
    def history_dependent(self) -> bool:
        """Whether a step depends on the previous one."""
        return self.history_size > 0

    @cached_property
    def basis(self) -> PointRows:
        return PointRows(self)

    @property
    def output_count(self) -> int:
        """Rows of the response's ``outputs``."""
        return len(self.where)

    def no_rates(self, count: int) -> np.ndarray:
        return np.zeros((len(self.where), self.history_size, count))

    def no_seeds(self, n_measures: int) -> PointSeeds:
        outputs = n_measures, self.output_count, len(self.output_names)
        return PointSeeds(np.zeros((n_measures, len(self.where), 2)), np.zeros(outputs))
