"""Which particles are coupled: through cells, through single points, through pairs of points."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, identity

from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.shape_functions import ShapeTable


class Link(NamedTuple):
    """Points of one term that may act on each other.

    Attributes
    ----------
    table : ShapeTable
        Raw shape functions at the points, one a group.
    pairs : ndarray of int, shape (m, 2)
        Each pair couples both ways.
    """

    table: ShapeTable
    pairs: np.ndarray

    @property
    def partners(self) -> csr_array:
        """Pattern of the pairs, every point with itself included, shape (k, k)."""
        k = self.table.n_groups
        ones = np.ones(len(self.pairs), np.int32)
        between = csr_array((ones, (self.pairs[:, 0], self.pairs[:, 1])), shape=(k, k))
        return csr_array(identity(k, np.int32, format="csr") + between + between.T)


def _seen(table, n_particles: int, raw=None) -> csr_array:
    """Which particles every group sees, those with ``raw`` zero left out, shape (groups, n)."""
    group, particle = np.repeat(np.arange(table.n_groups), np.diff(table.start)), table.neighbours
    if raw is not None:
        kept = raw[particle] > 0
        group, particle = group[kept], particle[kept]
    ones = np.ones(group.size, np.int32)
    return csr_array((ones, (group, particle)), shape=(table.n_groups, n_particles))


def coupled_particles(transformation: EssentialTransformation, tables, links=()) -> np.ndarray:
    """Sorted particles that share a group or a pair with a constrained one, and the union."""
    found = [transformation.union]
    for table in tables:
        group = np.repeat(np.arange(table.n_groups), np.diff(table.start))
        seen = np.zeros(table.n_groups, bool)
        seen[group[np.isin(table.neighbours, transformation.constrained)]] = True
        found.append(table.neighbours[seen[group]])
    for link in links:
        n = int(max(link.table.neighbours.max(), transformation.union.max())) + 1
        sees, constrained = _seen(link.table, n), np.zeros(n, np.int32)
        constrained[transformation.constrained] = 1
        reached = link.partners @ (sees @ constrained) > 0
        found.append(np.flatnonzero(sees.T @ reached.astype(np.int32)))
    return np.unique(np.concatenate(found))


def couplings(n_particles: int, tables, transformation, links=()):
    """Particles coupled with constrained ones, and the pattern of all couplings.

    Parameters
    ----------
    tables : sequence of ShapeTable
        Raw; the particles that a group sees are all coupled.
    transformation : EssentialTransformation, optional
    links : sequence of Link

    Returns
    -------
    coupled : ndarray of int
    pattern : csr_array, shape (n, n)
        Without the raw couplings of constrained particles, which the transformation brings to its union.
    """
    coupled = np.empty(0, int)
    pattern, raw = csr_array((n_particles, n_particles), dtype=np.int32), None
    if transformation is not None:
        coupled = coupled_particles(transformation, tables, links)
        raw = np.ones(n_particles, np.int32)
        raw[transformation.constrained] = 0
        rows = np.repeat(transformation.union, coupled.size)
        columns = np.tile(coupled, transformation.union.size)
        clique = csr_array((np.ones(rows.size, np.int32), (rows, columns)), shape=pattern.shape)
        pattern = pattern + clique + clique.T
    for table in tables:
        sees = _seen(table, n_particles, raw)
        pattern = pattern + sees.T @ sees
    for link in links:
        sees = _seen(link.table, n_particles, raw)
        pattern = pattern + sees.T @ (link.partners @ sees)
    pattern = csr_array(pattern)
    pattern.sort_indices()
    return coupled, pattern
