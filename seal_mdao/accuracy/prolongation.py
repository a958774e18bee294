"""Prolongate a path to a finer cloud: the displacements and stresses from which iterations begin there.

u(X) of the coarse cloud is interpolated at the particles of the finer one, and coefficients d are found
with which that cloud has these displacements: Phi_f d = u. They are not exactly isochoric in the smaller
cells, and contact points do not have exactly the gaps of their pressures, which a large bulk modulus and
large penalties would make forces of. So the first tangent has the volume changes and the gaps of the
coarse cloud (``mixed_newton``).
"""

from itertools import pairwise

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.structure.structural_term import StructuralTerm


class Prolongation:
    """Steps of a solved path as the start of iterations at the same loads, possibly on a finer cloud.

    Parameters
    ----------
    path : PathResult
    steps : dict of int to ConvergedStep
        Of that path, by the nominal load step of the other path that ends at the same load.
    fine : Discretization
        Of the other path; that of ``path`` for the same cloud.
    parents : ndarray of int, shape (n_fine_cells,), optional
        Coarse cell of every cell of a finer cloud.
    """

    def __init__(self, path: PathResult, steps: dict, fine: Discretization, parents=None):
        self.path, self.steps, self.fine, self.parents = path, steps, fine, parents
        self._between, self._inverse = None, None
        if fine is not path.discretization:
            self._between = self._at_particles()
            self._inverse = splu(_matrix(fine.everywhere.table, len(fine.particles)).tocsc())
        self._weights = {}

    def __call__(self, increment: Increment):
        """Return displacements (n, 2) near those at the end of an increment, and the state of mixed
        iterations there; None where the path has no such step."""
        step = self.steps.get(float(increment.target))
        # self-contact begins from a converged step only (``ContactTerm.begin_mixed``)
        if step is None or increment.problem.touches_itself:
            return None
        # P d, and what was corrected in the step before: d_f - P d
        d = self._prolongated(step)
        before = self.steps.get(float(increment.last.fraction))
        if before is not None:
            d += increment.last.d - self._prolongated(before)
        fixed, imposed = self.fine.layout.equations < 0, increment.problem.imposed
        d[fixed] = 0.0 if imposed is None else imposed.at(increment.target)[fixed]
        terms = zip(increment.problem.terms, self.path.problem.terms, step.responses, strict=True)
        known = tuple(self._known(*term, step) for term in terms)
        return d, increment.problem.begin_near(d, increment.target, known)

    def _prolongated(self, step) -> np.ndarray:
        """Coefficients (n, 2) of the finer cloud with the displacements of a step."""
        if self._between is None:
            return step.d.copy()
        # Phi_f d_f = P d
        return self._inverse.solve(self._between @ step.d)

    def _at_particles(self) -> csr_array:
        """Matrix (n_fine, n_coarse) of the displacements at the fine particles."""
        coarse = self.path.discretization
        samples = coarse.body.samples
        # fine particles are coarse ones, midpoints of sides, centres of cells; some a little beside them
        places = samples.at(coarse.particles)
        nearest = cKDTree(places).query(self.fine.particles)[1]
        table, beside = coarse.table_at(nearest).table, self.fine.particles - places[nearest]
        # u(X) = u(X_s) + grad u . (X - X_s)
        rows = table.grad.size // table.neighbours.size
        sizes = np.diff(table.start)
        phi = table.phi.copy()
        for axis in (0, 1):
            phi += _component(table, rows, axis) * np.repeat(beside[:, axis], sizes)
        return _matrix(table._replace(phi=phi), len(coarse.particles))

    def _known(self, term, coarse_term, response, step) -> np.ndarray | None:
        """What the step says about a term: swelling of cells, gaps of contact points."""
        if isinstance(term, StructuralTerm):
            return self._swelling(term, coarse_term, step)
        if isinstance(term, ContactTerm):
            return self._gaps(term, coarse_term, response)
        return None

    def _swelling(self, term, coarse_term, step) -> np.ndarray | None:
        """Volume change of the parent of every cell; None where the pressure runs through columns."""
        swelling = coarse_term.swelling_at(step.d, step.fraction)
        if self.parents is None:
            return swelling
        return swelling[self.parents] if len(self.parents) == len(term.bulk) else None

    def _gaps(self, term, coarse_term, response) -> np.ndarray:
        """Interpolate gaps between the two nearest coarse contact points, shape (k,)."""
        if self._between is None:
            return response.gap.copy()
        if term.label not in self._weights:
            old, new = (
                own.where.points.at(disc.particles)
                for own, disc in ((coarse_term, self.path.discretization), (term, self.fine))
            )
            away, which = cKDTree(old).query(new, k=2)
            # linear between both: the nearer one has the larger weight
            self._weights[term.label] = which, away[:, ::-1] / away.sum(axis=1, keepdims=True)
        which, weights = self._weights[term.label]
        return np.ascontiguousarray((response.gap[which] * weights).sum(axis=1))


def _component(table, rows: int, axis: int) -> np.ndarray:
    """One component of the gradients of a table with one point a group, flat (group, neighbour)."""
    starts = table.start
    picked = [
        table.grad[rows * a + axis * (b - a) : rows * a + (axis + 1) * (b - a)]
        for a, b in pairwise(starts)
    ]
    return np.concatenate(picked)


def _matrix(table, n: int) -> csr_array:
    """Shape functions of points as a sparse matrix (n_points, n)."""
    return csr_array((table.phi, table.neighbours, table.start), shape=(table.n_groups, n))
