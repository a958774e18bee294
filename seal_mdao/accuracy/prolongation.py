"""Prolongate a path to a finer cloud: the displacements and stresses from which iterations begin there.

u(X) of the coarse cloud is interpolated at the particles of the finer one, and coefficients d are found
with which that cloud has these displacements: Phi_f d = u. They are not exactly isochoric in the smaller
cells, and contact points do not have exactly the gaps of their pressures, which a large bulk modulus and
large penalties would make forces of. So the first tangent has the volume changes and the gaps of the
coarse cloud (``mixed_newton``).
"""

import numpy as np
from scipy.sparse import csc_array, csr_array
from scipy.sparse.linalg import splu
from scipy.spatial import cKDTree

from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.rkpm.shape_functions import ShapeTable
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.structure.structural_term import StructuralTerm
from seal_mdao.terms.point_assembly import interpolate


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
        self._same_cloud = fine is path.discretization
        if not self._same_cloud:
            self._samples, self._beside = self._nearest_samples()
            table, n = fine.everywhere.table, len(fine.particles)
            # Phi_f as a sparse matrix
            phi = csc_array(csr_array((table.phi, table.neighbours, table.start), shape=(n, n)))
            self._inverse = splu(phi)
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
        if self._same_cloud:
            return step.d.copy()
        u = np.empty_like(self._beside)
        interpolate(self._samples, step.d, u)
        # u(X) = u(X_s) + grad u . (X - X_s)
        gradient = deformation_gradients(self._samples, step.d)[:, :4].reshape(-1, 2, 2) - np.eye(2)
        u += np.einsum("sij,sj->si", gradient, self._beside)
        # Phi_f d_f = u
        return self._inverse.solve(u)

    def _nearest_samples(self) -> tuple[ShapeTable, np.ndarray]:
        """Find the shape functions at the coarse sample point nearest to every fine particle, and the
        particle's distance from it (n_fine, 2)."""
        coarse = self.path.discretization
        # fine particles are coarse ones, midpoints of sides, centres of cells; some a little beside them
        places = coarse.body.samples.at(coarse.particles)
        nearest = cKDTree(places).query(self.fine.particles)[1]
        return coarse.table_at(nearest).table, self.fine.particles - places[nearest]

    def _known(self, term, coarse_term, response, step) -> np.ndarray | None:
        """What the step says about a term: volumetric strain of cells, gaps of contact points."""
        if isinstance(term, StructuralTerm):
            return self._volume_strain(term, coarse_term, step)
        if isinstance(term, ContactTerm):
            return self._gaps(term, coarse_term, response)
        return None

    def _volume_strain(self, term, coarse_term, step) -> np.ndarray | None:
        """Volume change of the parent of every cell; None where the pressure runs through columns."""
        volume_strain = coarse_term.volume_strain_at(step.d, step.fraction)
        if self.parents is None:
            return volume_strain
        return volume_strain[self.parents] if len(self.parents) == len(term.bulk) else None

    def _gaps(self, term, coarse_term, response) -> np.ndarray:
        """Interpolate gaps between the two nearest coarse contact points, shape (k,)."""
        if self._same_cloud:
            return response.gap.copy()
        if term.label not in self._weights:
            old, new = (
                own.where.points.at(disc.particles)
                for own, disc in ((coarse_term, self.path.discretization), (term, self.fine))
            )
            # of two points at a sharp corner the first one
            first = np.flatnonzero(np.append(True, (old[1:] != old[:-1]).any(axis=1)))
            away, which = cKDTree(old[first]).query(new, k=2)
            # linear between both: the nearer one has the larger weight
            weights = away[:, ::-1] / away.sum(axis=1, keepdims=True)
            self._weights[term.label] = first[which], weights
        which, weights = self._weights[term.label]
        return np.ascontiguousarray((response.gap[which] * weights).sum(axis=1))
