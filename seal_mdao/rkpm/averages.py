"""Averages of shape functions over the boundary edges beside a particle, with dual hat functions.

N_A is the hat function of particle A along the boundary, one at A and zero at its neighbours, and
psi_A its dual function (B. I. Wohlmuth, SIAM J. Numer. Anal. 38 (2000) 989), on an edge from A to B

    psi_A = 2 N_A - N_B,    int psi_A N_B ds = delta_AB L_A,    L_A = int psi_A ds = int N_A ds.

At the Gauss points q of the edges e beside A, with m_q = w_q l_e psi_A(X_q),

    Phi_A = sum_q (m_q / L_A) Phi(X_q),    x_A = X_A + Phi_A d.

x_A is a weighted mean of the deformed boundary beside A. As psi_A is dual to the hat functions, the mean
of a linear field is its value at A: undeformed, x_A is particle A. The Gauss points are those with which
``integration`` integrates the edges, and sum_A psi_A = 1: forces L_A t at the means are the uniform
traction t to rounding. Contact at means passes the patch test, contact at particles does not.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import Cloud, PointSet, ShapeTable
from seal_mdao.rkpm.tables import PointTable, raw_tables
from seal_mdao.rkpm.transformed import TableRates, TableTransform, entry_starts


class EdgeAverages(NamedTuple):
    """Means over the boundary edges beside particles.

    Attributes
    ----------
    gauss : PointSet
        Gauss points of the edges beside a particle, a group each.
    edges : ndarray of int, shape (k, e, 2)
        From A to the other ends of these edges; to A itself where there is none.
    shares : ndarray, shape (k, e, q)
        m_q / l_e; zero for an edge that is missing.
    """

    gauss: PointSet
    edges: np.ndarray
    shares: np.ndarray

    def weights(self, particles: np.ndarray) -> np.ndarray:
        """Compute m_q / L_A, shape (k, e q), for ``particles`` (n, 2)."""
        parts = self.shares * self._sides(particles)[1][..., None]
        return (parts / parts.sum(axis=(1, 2), keepdims=True)).reshape(len(parts), -1)

    def weight_rates(self, particles, velocity) -> np.ndarray:
        """Differentiate the weights along design velocities (P, n, 2), shape (k, e q, P)."""
        edge, length = self._sides(particles)
        moved = velocity[:, self.edges[..., 1]] - velocity[:, self.edges[..., 0]]
        # l_e' = t . (V_b - V_a)
        rates = np.einsum("kei,pkei->kep", edge / length[..., None], moved)
        # (m_q / L)' = share (l_e' - l_e L' / L) / L
        of_edge = self.shares.sum(axis=2)
        total = (of_edge * length).sum(axis=1)[:, None, None]
        total_rate = np.einsum("ke,kep->kp", of_edge, rates)[:, None]
        change = (rates - length[..., None] * total_rate / total) / total
        found = self.shares[..., None] * change[:, :, None]
        return found.reshape(len(found), -1, velocity.shape[0])

    def add_weight_seeds(self, particles, weight_bar, x_bar) -> None:
        """Transpose of ``weight_rates``: seeds (k, e q, M) added to ``x_bar`` (n, 2, M)."""
        edge, length = self._sides(particles)
        seeds = weight_bar.reshape(*self.shares.shape, -1)
        # seeds on l_e' - l_e L' / L
        on_change = np.einsum("keq,keqm->kem", self.shares, seeds)
        of_edge = self.shares.sum(axis=2)
        total = (of_edge * length).sum(axis=1)[:, None, None]
        mean = np.einsum("ke,kem->km", length, on_change)[:, None] / total
        # l_e_bar = [seed_e - (share_e / L) sum_f l_f seed_f] / L
        length_bar = (on_change - of_edge[..., None] * mean) / total
        pull = (edge / length[..., None])[..., None] * length_bar[:, :, None]
        scatter_add(x_bar, self.edges[..., 1], pull)
        scatter_add(x_bar, self.edges[..., 0], -pull)

    def _sides(self, particles) -> tuple:
        """Vectors (k, e, 2) and lengths (k, e) of the edges; a missing one has length one."""
        edge = particles[self.edges[..., 1]] - particles[self.edges[..., 0]]
        length = np.hypot(edge[..., 0], edge[..., 1])
        return edge, np.where(length > 0.0, length, 1.0)

    def _gauss_at(self, vectors) -> np.ndarray:
        """Values (k, e q, ...) at the Gauss points of a field (n, ...) at the particles."""
        return self.gauss.at(vectors).reshape(len(self.edges), -1, *vectors.shape[1:])

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
        self.gauss.add_seeds(particles, on_gauss.reshape(-1, *point_bar.shape[1:]), x_bar)


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
        X_A, the particles.
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
            own = _summed(_of_group(self.gauss.raw, g), weight_rates[g][:, which])
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
            gauss_bar[q * rows.start : q * rows.stop] = spread.reshape(-1, m)
            weight_bar[g] = _summed(_of_group(gauss.raw, g).T, phi_bar[rows])
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
    means = [_summed(own, _of_group(gauss.raw, g)) for g, own in enumerate(weights)]
    raw = ShapeTable(gauss.raw.start, gauss.raw.neighbours, np.concatenate(means), np.empty(0), 1)
    transform = TableTransform(raw, transformation)
    x = averages.at(cloud.particles)
    return AveragedTable(averages, weights, gauss, x, raw, transform.table, transform)


def _summed(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    """Compute sum_q first_q second_q of (q, ...) and (q, m), always in the same order (BLAS may not)."""
    return (first[..., None] * second.reshape(len(second), *[1] * (first.ndim - 1), -1)).sum(axis=0)


def _of_group(raw: ShapeTable, g: int) -> np.ndarray:
    """View the values of group ``g`` as (point, neighbour)."""
    ends = raw.group_size * raw.start[g : g + 2]
    return raw.phi[slice(*ends)].reshape(raw.group_size, -1)
