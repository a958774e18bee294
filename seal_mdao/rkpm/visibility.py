"""Supports that do not reach across a void.

A particle belongs to the neighbours of a point only if the two are joined through cells inside its
support, not across a notch, a slit or the gap between a lip and its body. Decided once, for the nominal
body, and then frozen, so that shape functions stay smooth in the design.

The part of a cell inside a disc is convex. Two cells that share a side are therefore joined inside
the disc where the side comes into it, and the least radius at which a particle and a cell are joined
is that of the best chain of sides between them.
"""

import heapq

import numpy as np
from scipy.spatial import cKDTree

# Pairs up to this distance over the support radius are examined: some come closer in other designs.
MARGIN = 1.5

# Least support radius over the longest side of a cell at a particle: covers every point of a cell by
# three of its corners.
LEAST = 1.5
# Largest support radius of a particle over its distance from a vertex around which it must not reach.
SHORT = 0.99


def side_distances(points: np.ndarray, start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Compute distances of points (..., 2) from straight sides between (..., 2) and (..., 2)."""
    along, to = end - start, points - start
    # closest point start + s along, s = along . (x - start) / |along|^2 clipped to [0, 1]
    square = (along**2).sum(axis=-1)
    s = np.clip((along * to).sum(axis=-1) / np.where(square > 0.0, square, 1.0), 0.0, 1.0)
    return np.hypot(*np.moveaxis(to - s[..., None] * along, -1, 0))


def hidden_pairs(cells: np.ndarray, particles: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Find pairs (m, 2): a particle, and one within its support that is not visible from it.

    Parameters
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        Triangles repeat a corner.
    particles : ndarray, shape (n, 2)
        Of the nominal body.
    radius : ndarray, shape (n,)
        Support radii.
    """
    beyond = _sides(cells)
    sides, around = beyond.tolist(), _cells_at_particles(cells, len(particles))
    tree = cKDTree(particles)
    # in a disc without boundary every straight line from its centre lies in the body
    near_boundary = np.flatnonzero(_boundary_distances(cells, beyond, particles) <= MARGIN * radius)
    near = tree.query_ball_point(
        particles[near_boundary], MARGIN * radius[near_boundary], return_sorted=True
    )
    # smallest distance to which cells at a particle are joined; a particle of no cell is not hidden
    unjoined = np.where([bool(len(own)) for own in around], np.inf, 0.0)
    least, found = unjoined.copy(), []
    for particle, candidates in zip(near_boundary.tolist(), near, strict=True):
        nearby = np.unique(np.concatenate([around[other] for other in candidates]))
        own = around[particle]
        # only the particle's own cells are near: nothing can be hidden
        if nearby.size == own.size:
            continue
        ends = cells[nearby], np.roll(cells[nearby], -1, axis=1)
        reach = side_distances(particles[particle], *(particles[end] for end in ends))
        joined = _joined_within(sides, own, dict(zip(nearby.tolist(), reach.tolist(), strict=True)))
        corners = cells[list(joined)]
        np.minimum.at(least, corners, np.array(list(joined.values()))[:, None])
        # hidden: joined only beyond the support radius and the straight distance
        others = np.array(candidates)
        apart = np.hypot(*(particles[others] - particles[particle]).T)
        hidden = others[least[others] > np.maximum(apart, radius[particle])]
        found.append(np.column_stack([np.full_like(hidden, particle), hidden]))
        least[corners] = unjoined[corners]
    return np.concatenate(found) if found else np.empty((0, 2), int)


def ended_at(places, particles: np.ndarray, radius: np.ndarray, support: float) -> np.ndarray:
    """Shorten support radii (n,) so that supports end before the vertices of notches.

    A particle whose support does not contain the vertex is hidden from the other face of the notch.

    Parameters
    ----------
    places : ndarray, shape (k, 2)
        Vertices.
    particles : ndarray, shape (n, 2)
        Of the nominal body.
    radius : ndarray, shape (n,)
        Support radii.
    support : float
        These over the longest sides of cells at the particles; they are no shorter than ``LEAST`` sides.
    """
    if not len(places):
        return radius
    # a_I = min(a_I, max(0.99 |X_I - X_v|, 1.5 h_I)),  h_I = a_I / support
    away = cKDTree(places).query(particles)[0]
    return np.minimum(radius, np.maximum(SHORT * away, LEAST / support * radius))


def _sides(cells: np.ndarray) -> np.ndarray:
    """Find the neighbour cell across every side, -1 for none, shape (n_cells, 4)."""
    ends = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    # equal pairs of end particles become consecutive; a collapsed side (a, a) has no neighbour
    order = np.lexsort(ends.T)
    same = (ends[order[1:]] == ends[order[:-1]]).all(axis=1)
    same &= ends[order[1:], 0] != ends[order[1:], 1]
    first, second = order[:-1][same], order[1:][same]
    beyond = np.full(ends.shape[0], -1)
    beyond[first], beyond[second] = second // 4, first // 4
    return beyond.reshape(-1, 4)


def _boundary_distances(cells: np.ndarray, beyond: np.ndarray, particles: np.ndarray) -> np.ndarray:
    """Compute lower bounds of the distances of particles from the sides without a neighbour (n,)."""
    following = np.roll(cells, -1, axis=1)
    outside = (beyond < 0) & (cells != following)
    start, end = particles[cells[outside]], particles[following[outside]]
    # |x - s| >= |x - m| - h / 2 for a side s of length h with the middle m
    half = 0.5 * np.hypot(*(end - start).T).max()
    return cKDTree(0.5 * (start + end)).query(particles)[0] - half


def _cells_at_particles(cells: np.ndarray, n: int) -> list:
    found = [[] for _ in range(n)]
    for cell, corners in enumerate(cells):
        for corner in dict.fromkeys(corners.tolist()):
            found[corner].append(cell)
    return [np.array(at, int) for at in found]


def _joined_within(beyond: list, own: np.ndarray, reach: dict) -> dict:
    """Find the least radius at which each cell of ``reach`` (side distances) is joined to ``own``.

    ``beyond`` has the neighbour cell across every side.
    """
    least, heap = {}, [(0.0, int(cell)) for cell in own]
    while heap:
        # Dijkstra with the largest distance on a path in place of its length
        radius, cell = heapq.heappop(heap)
        if cell in least:
            continue
        least[cell] = radius
        for distance, other in zip(reach[cell], beyond[cell], strict=True):
            if other >= 0 and other in reach and other not in least:
                heapq.heappush(heap, (max(radius, distance), other))
    return least
