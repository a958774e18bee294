"""Averages of shape functions over the boundary edges beside a particle.

With weight functions psi_A that sum to one, each on the edges e beside particle A alone
(``terms.averaged_points`` says which), and the Gauss points q of these edges,

    m_q = w_q l_e psi_A(X_q),    L_A = sum_q m_q,    Phi_A = sum_q (m_q / L_A) Phi(X_q).

Phi_A gives the mean of the deformed boundary beside A, x_A = sum_q (m_q / L_A) x(X_q) = X_A + Phi_A d.
The Gauss points of straight edges are those with which ``consistent_gradients`` integrates them: forces
L_A t at the means are the uniform traction t to rounding. Contact at means passes the patch test,
contact at particles does not. In a body of revolution m_q has the circumference c_q = 2 pi R_q
(``axisymmetry``),

    m_q = c_q w_q l_e psi_A(X_q).
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.axisymmetry import CIRCUMFERENCE, add_radius_seeds
from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import Cloud, PointSet, ShapeTable
from seal_mdao.rkpm.tables import PointTable, raw_tables
from seal_mdao.rkpm.transformed import TableRates, TableTransform, entry_starts, of_group


class EdgeAverages(NamedTuple):
    """Means over the boundary edges beside particles.

    Attributes
    ----------
    gauss : PointSet
        Gauss points of the edges beside a particle, a group each.
    edges : ndarray of int, shape (k, e, 2)
        From A to the other ends of these edges; to A itself where there is none.
    fractions : ndarray, shape (k, e, q)
        m_q / (c_q l_e), w_q psi_A; zero for an edge that is missing.
    around : ndarray of bool, shape (k,)
        Whose edges are turned about the axis; c_q = 1 in plane strain, and for points whose edges all
        lie on the axis.
    """

    gauss: PointSet
    edges: np.ndarray
    fractions: np.ndarray
    around: np.ndarray

    def weights(self, particles: np.ndarray) -> np.ndarray:
        """Compute m_q / L_A, shape (k, e q), for ``particles`` (n, 2)."""
        _, length, around, total = self._sizes(particles)
        # m_q = fraction c_q l_e
        found = self.fractions * (length[..., None] * around / total)
        return found.reshape(len(found), -1)

    def weight_rates(self, particles, velocity) -> np.ndarray:
        """Differentiate the weights along design velocities (P, n, 2), shape (k, e q, P)."""
        tangent, length, around, total = self._sizes(particles)
        moved = velocity[:, self.edges[..., 1]] - velocity[:, self.edges[..., 0]]
        # l_e' = t . (V_b - V_a),  (c_q l_e)' = c_q l_e' + c_q' l_e
        rates = np.einsum("kei,pkei->kep", tangent, moved)[:, :, None] * around[..., None]
        if self.around.any():
            widened = self._circumferences(np.moveaxis(velocity, 0, 2))
            widened[~self.around] = 0.0
            rates = rates + widened * length[..., None, None]
        fractions, total = self.fractions[..., None], total[..., None]
        total_rate = (fractions * rates).sum(axis=(1, 2), keepdims=True)
        # (m_q / L)' = fraction ((c_q l_e)' - c_q l_e L' / L) / L
        share = (length[..., None] * around)[..., None] / total
        found = fractions * ((rates - share * total_rate) / total)
        # no -1 in shapes: with 0 design parameters or seeds it is not determined
        return found.reshape(len(found), self.gauss.group_size, velocity.shape[0])

    def add_weight_seeds(self, particles, weight_bar, x_bar) -> None:
        """Transpose of ``weight_rates``: seeds (k, e q, M) added to ``x_bar`` (n, 2, M)."""
        tangent, length, around, total = self._sizes(particles)
        fractions, total = self.fractions[..., None], total[..., None]
        seeds = fractions * weight_bar.reshape(*self.fractions.shape, x_bar.shape[2]) / total
        # seeds on (c_q l_e)' and, by L', on all of them
        share = (length[..., None] * around)[..., None] / total
        on_sizes = seeds - fractions * (share * seeds).sum(axis=(1, 2), keepdims=True)
        if self.around.any():
            # R_q_bar = 2 pi l_e (c_q l_e)_bar
            on_radius = CIRCUMFERENCE * length[..., None, None] * on_sizes
            on_radius[~self.around] = 0.0
            on_radius = on_radius.reshape(len(self.gauss.anchors), x_bar.shape[2])
            add_radius_seeds(self.gauss, particles, on_radius, x_bar)
        length_bar = (around[..., None] * on_sizes).sum(axis=2)
        pull = tangent[..., None] * length_bar[:, :, None]
        scatter_add(x_bar, self.edges[..., 1], pull)
        scatter_add(x_bar, self.edges[..., 0], -pull)

    def _sizes(self, particles) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Tangents t (k, e, 2) and lengths l_e (k, e) of the edges, a missing one of length one, c_q
        (k, e, q) and L_A (k, 1, 1)."""
        edge = particles[self.edges[..., 1]] - particles[self.edges[..., 0]]
        length = np.hypot(edge[..., 0], edge[..., 1])
        length = np.where(length > 0.0, length, 1.0)
        around = np.ones(self.fractions.shape)
        if self.around.any():
            around[self.around] = self._circumferences(particles)[self.around]
        total = np.einsum("keq,ke,keq->k", self.fractions, length, around)
        return edge / length[..., None], length, around, total[:, None, None]

    def _circumferences(self, vectors) -> np.ndarray:
        """c_q = 2 pi R_q, m, of particles or velocities (n, 2, ...), shape (k, e, q, ...)."""
        radii = self._gauss_at(vectors)[:, :, 0]
        return CIRCUMFERENCE * radii.reshape(*self.fractions.shape, *radii.shape[2:])

    def _gauss_at(self, vectors) -> np.ndarray:
        """Values (k, e q, ...) at the Gauss points of a field (n, ...) at the particles."""
        shape = len(self.edges), self.gauss.group_size, *vectors.shape[1:]
        return self.gauss.at(vectors).reshape(shape)

    def at(self, particles: np.ndarray) -> np.ndarray:
        """Compute the mean places, shape (k, 2)."""
        own = particles[self.edges[:, 0, 0]]
        q = self.gauss.group_size
        # X_A + sum_q (m_q / L_A) sum_k w_k (X_k - X_A), zero to the last bit along the axes
        away = particles[self.gauss.anchors] - np.repeat(own, q, axis=0)[:, None]
        away = np.einsum("pk,pki->pi", self.gauss.weights, away).reshape(len(own), q, 2)
        return own + np.einsum("kq,kqi->ki", self.weights(particles), away)

    def rates(self, particles, velocity) -> np.ndarray:
        """Differentiate the mean places along design velocities (P, n, 2), shape (k, 2, P)."""
        by_weight = np.einsum(
            "kqp,kqi->kip", self.weight_rates(particles, velocity), self._gauss_at(particles)
        )
        # X_A' = sum_q (m_q / L_A)' X_q + (m_q / L_A) V_q
        moved = self._gauss_at(np.moveaxis(velocity, 0, 2))
        return by_weight + np.einsum("kq,kqip->kip", self.weights(particles), moved)

    def add_seeds(self, particles, point_bar, x_bar) -> None:
        """Transpose of ``rates``: seeds (k, 2, M) added to ``x_bar`` (n, 2, M)."""
        x = self._gauss_at(particles)
        self.add_weight_seeds(particles, np.einsum("kqi,kim->kqm", x, point_bar), x_bar)
        on_gauss = self.weights(particles)[:, :, None, None] * point_bar[:, None]
        on_gauss = on_gauss.reshape(len(self.gauss.anchors), *point_bar.shape[1:])
        self.gauss.add_seeds(particles, on_gauss, x_bar)


@dataclass(frozen=True)
class AveragedTable:
    """Averaged shape functions: what a ``PointTable`` is for points.

    Attributes
    ----------
    averages : EdgeAverages
    weights : ndarray, shape (k, e q)
        m_q / L_A.
    gauss : PointTable
        Raw shape functions at the Gauss points.
    coordinates : ndarray, shape (k, 2)
        X_A, the undeformed means.
    raw, table : ShapeTable
        Phi_A before and after the essential transformation.
    transform : TableTransform
    """

    averages: EdgeAverages
    weights: np.ndarray
    gauss: PointTable
    coordinates: np.ndarray
    raw: ShapeTable
    table: ShapeTable
    transform: TableTransform

    def rates(self, velocity, matrix_rate=None) -> TableRates:
        """Differentiate the table along design velocities; as ``PointTable.rates``."""
        of_gauss = self.gauss.raw_rates(velocity, self.transform)
        start, weights = of_gauss.start, self.weights
        weight_rates = self.averages.weight_rates(self.gauss.cloud.particles, velocity)
        ends = entry_starts(np.diff(start[:, 0]), self.raw)
        phi, q = np.empty(ends[-1]), weights.shape[1]
        for g in np.flatnonzero(np.diff(start[:, 0])):
            which = of_gauss.active[start[g, 0] : start[g + 1, 0]]
            # Phi_A' = sum_q (m_q / L_A) Phi_q' + (m_q / L_A)' Phi_q
            moved = _summed(weights[g], of_gauss.phi[start[g, 1] : start[g + 1, 1]].reshape(q, -1))
            own = _summed(_values(self.gauss.raw, g), weight_rates[g][:, which])
            phi[ends[g] : ends[g + 1]] = moved + own.ravel()
        rates = TableRates(np.column_stack([start[:, 0], ends]), of_gauss.active, phi, np.empty(0))
        return self.transform.rates(rates, matrix_rate)

    def pull_back(self, phi_bar, grad_bar, x_bar) -> np.ndarray:
        """Apply the transpose of ``rates``; as ``PointTable.pull_back``."""
        raw, weights, gauss = self.raw, self.weights, self.gauss
        m, q = x_bar.shape[2], weights.shape[1]
        matrix_bar = np.zeros((*self.transform.transformation.matrix.shape, m))
        phi_bar = self.transform.pull_back((0, raw.n_groups), raw.phi, 1, phi_bar, matrix_bar)
        gauss_bar, weight_bar = np.empty((gauss.raw.phi.size, m)), np.empty((*weights.shape, m))
        for g in range(raw.n_groups):
            rows = slice(*raw.start[g : g + 2])
            # Phi_q_bar = (m_q / L_A) Phi_A_bar,   weight_bar_q = Phi_q . Phi_A_bar
            spread = weights[g][:, None, None] * phi_bar[rows]
            gauss_bar[q * rows.start : q * rows.stop] = spread.reshape(q * len(phi_bar[rows]), m)
            weight_bar[g] = _summed(_values(gauss.raw, g).T, phi_bar[rows])
        self.averages.add_weight_seeds(gauss.cloud.particles, weight_bar, x_bar)
        gauss.pull_back(gauss_bar, grad_bar, x_bar)
        return matrix_bar


def averaged_table(
    cloud: Cloud, averages: EdgeAverages, transformation: EssentialTransformation
) -> AveragedTable:
    """Average the shape functions at the Gauss points, with essential conditions.

    Raises
    ------
    SingularMomentMatrixError
        Where the supports of the particles do not cover a point well enough.
    """
    (gauss,) = raw_tables(cloud, averages.gauss)
    weights = averages.weights(cloud.particles)
    # Phi_A = sum_q (m_q / L_A) Phi_q
    means = [_summed(own, _values(gauss.raw, g)) for g, own in enumerate(weights)]
    raw = ShapeTable(gauss.raw.start, gauss.raw.neighbours, np.concatenate(means), np.empty(0), 1)
    transform = TableTransform(raw, transformation)
    x = averages.at(cloud.particles)
    return AveragedTable(averages, weights, gauss, x, raw, transform.table, transform)


def _summed(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Compute sum_q first_q second_q of (q, ...) and (q, m), always in the same order (BLAS may not)."""
    return (first[..., None] * second.reshape(len(second), *[1] * (first.ndim - 1), -1)).sum(axis=0)


def _values(raw: ShapeTable, g: int) -> np.ndarray:
    """View the values of group ``g`` as (point, neighbour)."""
    return of_group(raw.phi, raw.group_size * raw.start, g, raw.group_size)
