"""Sparsity pattern of the tangent: particles coupled through cells, points and pairs of points."""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csr_array, identity

from seal_mdao.rkpm.essential import EssentialTransformation
from seal_mdao.rkpm.shape_functions import ShapeTable


class Link(NamedTuple):
    """Pairs of points of one term that may interact, as in self-contact.

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
        """Symmetric pattern 1 + P + P^T of the pairs, shape (k, k)."""
        k = self.table.n_groups
        ones = np.ones(len(self.pairs), np.int32)
        between = csr_array((ones, (self.pairs[:, 0], self.pairs[:, 1])), shape=(k, k))
        return csr_array(identity(k, np.int32, format="csr") + between + between.T)


def _seen(table, n_particles: int, raw=None) -> csr_array:
    """Build the incidence S (groups, n) of groups and particles, without those with ``raw`` zero."""
    # flat list of (group, particle) from the compressed rows of the table
    group, particle = np.repeat(np.arange(table.n_groups), np.diff(table.start)), table.neighbours
    if raw is not None:
        # constrained particles are left out: the transformation carries them to the union
        kept = raw[particle] > 0
        group, particle = group[kept], particle[kept]
    ones = np.ones(group.size, np.int32)
    return csr_array((ones, (group, particle)), shape=(table.n_groups, n_particles))


def coupled_particles(transformation: EssentialTransformation, tables, links=()) -> np.ndarray:
    """List the particles that share a group or a pair with a constrained one, and the union."""
    # everything that shares a row or a column with C, so that T^T K_C. and K_.C T have slots
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
        # points that see C, then their partners, then all particles that these see
        reached = link.partners @ (sees @ constrained) > 0
        found.append(np.flatnonzero(sees.T @ reached.astype(np.int32)))
    return np.unique(np.concatenate(found))


def couplings(n_particles: int, tables, transformation, links=()):
    """Find the particles coupled with constrained ones, and the patterns of couplings.

    Parameters
    ----------
    tables : sequence of ShapeTable
        Raw; the particles that a group sees are all coupled.
    transformation : EssentialTransformation, optional
    links : sequence of Link

    Returns
    -------
    coupled : ndarray of int
    body, whole : csr_array, shape (n, n)
        Couplings without links, and with them. Without the raw couplings of constrained particles,
        which the transformation brings to its union.
    """
    coupled, shape = np.empty(0, int), (n_particles, n_particles)
    body, raw = csr_array(shape, dtype=np.int32), None
    if transformation is not None:
        raw = np.ones(n_particles, np.int32)
        raw[transformation.constrained] = 0
        coupled = coupled_particles(transformation, tables)
        body = _with_transformed(body, transformation, coupled)
    for table in tables:
        # particles of one group are all coupled: S^T S
        sees = _seen(table, n_particles, raw)
        body = body + sees.T @ sees
    whole = body
    if links and transformation is not None:
        coupled = coupled_particles(transformation, tables, links)
        whole = _with_transformed(whole, transformation, coupled)
    for link in links:
        # pairs of points couple what both see: S^T (1 + P + P^T) S
        sees = _seen(link.table, n_particles, raw)
        whole = whole + sees.T @ (link.partners @ sees)
    body, whole = csr_array(body), csr_array(whole)
    body.sort_indices()
    whole.sort_indices()
    return coupled, body, whole


def _with_transformed(pattern, transformation: EssentialTransformation, coupled):
    """Add the blocks of union x coupled, and transposed, to a pattern: K~_U. = T^T K_C. N."""
    rows = np.repeat(transformation.union, coupled.size)
    columns = np.tile(coupled, transformation.union.size)
    clique = csr_array((np.ones(rows.size, np.int32), (rows, columns)), shape=pattern.shape)
    return pattern + clique + clique.T
