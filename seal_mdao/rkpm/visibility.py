"""Supports that do not reach across a void, round a corner of one, or across an interface.

A particle sees another one if cells join them without much of a detour: a chain of sides between cells
of one part of the section, each of which has a point x with

    |x - X_I| + |x - X_J| <= kappa |X_J - X_I|,    kappa = 1.1.

The points inside this ellipse are those of detours up to kappa. The part of a cell inside it is convex,
so two cells that share a side are joined inside the ellipse where the side comes into it.

Decided once, for the nominal body, and then frozen, so that shape functions stay smooth in the design.
A point sees the particles that are hidden from none of its anchors. Shape functions therefore jump from
cell to cell where a particle is hidden. A point on a side has the same values in both cells, which is
all that the consistent integration needs (``consistent_gradients``).
"""

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.compilation import compiled, internal

# Pairs up to this distance over the support radius are examined: some come closer in other designs.
# Beside cells that are large against the support, corners of cells that it reaches are farther away.
MARGIN = 1.5

# Longest accepted path round a corner over the straight distance. Particles beside each other along a
# curved boundary are 1.03 times apart on its sides (45 degrees of an arc), those on both sides of a
# right-angled corner up to 1.41 times.
DETOUR = 1.1

# The ellipse of a pair lies in the disc of this radius, over their distance, about each of both. In a
# disc without boundary every particle is visible.
DISC = 0.5 * (1.0 + DETOUR)


def hidden_pairs(cells: np.ndarray, particles: np.ndarray, radius: np.ndarray, parts=None):
    """Find pairs (m, 2): a particle, and one within its support that is not visible from it.

    Parameters
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        Triangles repeat a corner.
    particles : ndarray, shape (n, 2)
        Of the nominal body.
    radius : ndarray, shape (n,)
        Support radii.
    parts : ndarray of int, shape (n_cells,), optional
        Part of the section that each cell belongs to; supports end at the interfaces of parts.

    Returns
    -------
    ndarray of int, shape (m, 2)
        In order.
    """
    beyond = _sides(cells, parts)
    from_boundary = _boundary_distances(cells, beyond, particles)
    # a support of radius a reaches into a cell at J, of longest diagonal d, if |X_J - X_I| <= a + d;
    # where that is beyond the margin, a < 2 d, and so |X_J - X_I| < 3 d
    diagonal = _longest_diagonals(cells, particles)
    of_support = _within(particles, MARGIN * radius, from_boundary)
    of_cell = _within(particles, 3.0 * diagonal, from_boundary)[:, ::-1]
    reached = radius[of_cell[:, 0]] + diagonal[of_cell[:, 1]]
    of_cell = of_cell[_apart(particles, of_cell) <= reached]
    # in order
    key = np.union1d(*(pairs @ (len(particles), 1) for pairs in (of_support, of_cell)))
    pairs = np.column_stack(np.divmod(key, len(particles)))
    pairs = pairs[from_boundary[pairs[:, 0]] <= DISC * _apart(particles, pairs)]
    start, around = _cells_at_particles(cells, len(particles))
    # a particle of no cell is not hidden
    pairs = pairs[(np.diff(start)[pairs] > 0).all(axis=1)]
    return pairs[~_visible(cells, beyond, particles, start, around, pairs)]


def _within(particles, reach, from_boundary) -> np.ndarray:
    """Find pairs (m, 2) of a particle and one within its ``reach`` (n,), near the boundary."""
    near = np.flatnonzero(from_boundary <= DISC * reach)
    found = cKDTree(particles).query_ball_point(particles[near], reach[near])
    return np.column_stack([
        np.repeat(near, [len(own) for own in found]),
        np.concatenate([np.empty(0, int), *found]).astype(int),
    ])  # fmt: skip


def _apart(particles: np.ndarray, pairs: np.ndarray) -> np.ndarray:
    """Compute the distances of pairs (m, 2) of particles, shape (m,)."""
    return np.hypot(*(particles[pairs[:, 1]] - particles[pairs[:, 0]]).T)


def _longest_diagonals(cells: np.ndarray, particles: np.ndarray) -> np.ndarray:
    """Find the longest distance of two corners of the cells at every particle (n,), zero without."""
    corners = particles[cells]
    size = np.linalg.norm(corners[:, :, None] - corners[:, None], axis=3).max(axis=(1, 2))
    out = np.zeros(len(particles))
    np.maximum.at(out, cells, size[:, None])
    return out


def particles_in_parts(cells: np.ndarray, parts: np.ndarray, n: int) -> np.ndarray:
    """Find the parts of the cells at every particle, a mask (n, number of parts)."""
    found = np.zeros((n, parts.max() + 1), bool)
    found[cells, parts[:, None]] = True
    return found


def parts_of_sides(cells: np.ndarray, parts: np.ndarray, sides: np.ndarray) -> np.ndarray:
    """Find the first and the last part of the cells at every side (m, 2) between two particles, which
    differ on interfaces, shape (2, m)."""
    n = cells.max() + 1
    # a side as one integer
    ends = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2), axis=2)
    known, which = np.unique(ends @ (n, 1), return_inverse=True)
    first, last = np.full(known.size, parts.max()), np.zeros(known.size, int)
    of_ends = np.repeat(parts, 4)
    np.minimum.at(first, which.ravel(), of_ends)
    np.maximum.at(last, which.ravel(), of_ends)
    return np.stack([first, last])[:, np.searchsorted(known, np.sort(sides, axis=1) @ (n, 1))]


@internal
def _detour(ax, ay, bx, by, fx, fy, gx, gy):
    """Compute min |x - f| + |x - g| of the points x of the side from a to b."""
    dx, dy = bx - ax, by - ay
    length = np.hypot(dx, dy)
    tx, ty = dx / length, dy / length
    # distances d from the line of the side, and positions s along it
    df, dg = abs(tx * (fy - ay) - ty * (fx - ax)), abs(tx * (gy - ay) - ty * (gx - ax))
    sf, sg = tx * (fx - ax) + ty * (fy - ay), tx * (gx - ax) + ty * (gy - ay)
    # s = (s_f d_g + s_g d_f) / (d_f + d_g): the path over x has equal angles with the side
    s = sf if df + dg == 0.0 else (sf * dg + sg * df) / (df + dg)
    # the sum is convex along the side
    s = min(max(s, 0.0), length)
    x, y = ax + s * tx, ay + s * ty
    return np.hypot(x - fx, y - fy) + np.hypot(x - gx, y - gy)


@compiled
def _visible(cells, beyond, particles, start, around, pairs):
    """Find the pairs (k, 2) of particles that see each other, a mask (k,); the cells at particle i are
    ``around[start[i]:start[i + 1]]``."""
    visible = np.zeros(len(pairs), np.bool_)
    reached, stack = np.full(len(cells), -1), np.empty(len(cells), np.int64)
    for pair in range(len(pairs)):
        i, j = pairs[pair]
        fx, fy, gx, gy = particles[i, 0], particles[i, 1], particles[j, 0], particles[j, 1]
        longest = DETOUR * np.hypot(gx - fx, gy - fy)
        size = 0
        for cell in around[start[i] : start[i + 1]]:
            stack[size] = cell
            reached[cell] = pair
            size += 1
        # flood the cells through sides inside the ellipse, until one of particle j is reached
        while size > 0 and not visible[pair]:
            size -= 1
            cell = stack[size]
            for k in range(4):
                a, b = cells[cell, k], cells[cell, (k + 1) % 4]
                if a == j:
                    visible[pair] = True
                other = beyond[cell, k]
                if other < 0 or reached[other] == pair:
                    continue
                if (
                    _detour(
                        particles[a, 0], particles[a, 1], particles[b, 0], particles[b, 1],
                        fx, fy, gx, gy,
                    )
                    <= longest
                ):  # fmt: skip
                    reached[other] = pair
                    stack[size] = other
                    size += 1
    return visible


def _sides(cells: np.ndarray, parts) -> np.ndarray:
    """Find the neighbour cell of the same part across every side, -1 for none, shape (n_cells, 4)."""
    ends = np.sort(np.stack([cells, np.roll(cells, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    # equal pairs of end particles become consecutive; a collapsed side (a, a) has no neighbour
    order = np.lexsort(ends.T)
    same = (ends[order[1:]] == ends[order[:-1]]).all(axis=1)
    same &= ends[order[1:], 0] != ends[order[1:], 1]
    first, second = order[:-1][same], order[1:][same]
    if parts is not None:
        of_one = parts[first // 4] == parts[second // 4]
        first, second = first[of_one], second[of_one]
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


def _cells_at_particles(cells: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    """Cells at every particle, in order, as (start, cells); a triangle's repeated corner counts once."""
    cell = np.repeat(np.arange(len(cells)), 4)
    key = np.unique(cells.ravel() * len(cells) + cell)
    particle, around = np.divmod(key, len(cells))
    return np.searchsorted(particle, np.arange(n + 1)), around
