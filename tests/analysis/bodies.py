"""A small irregular square body, and dense copies of tangents in either layout."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.equilibrium.discretization import Body, discretize
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.visibility import hidden_pairs
from seal_mdao.structure.elastic_body import elastic_body

CONSTANTS = (80.0, 20.0, 3000.0)


@dataclass(frozen=True)
class AnyConstants(MooneyRivlin):
    """Without the checks: a single constant, which no rubber has."""

    def __post_init__(self):
        pass


def square(rng, n=6, order=1, fixed="rim", column=1, n_gauss=2, inner=None):
    """``n`` x ``n`` particles on the unit square, the inner ones moved; the rim or nothing fixed.

    The pressure is continuous upwards through ``column`` cells. With an ``inner`` radius the square is
    turned about the axis.
    """
    grid = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 2)
    rim = np.any((grid == 0) | (grid == n - 1), axis=1)
    particles = (grid + np.where(rim, 0, 1)[:, None] * rng.uniform(-0.25, 0.25, grid.shape)) / (
        n - 1
    )
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n - 1), np.arange(n - 1), indexing="ij"))
    particles[:, 0] += inner or 0.0
    # the first direction is upwards
    cells = np.column_stack([(i + 1) * n + j, (i + 1) * n + j + 1, i * n + j + 1, i * n + j])
    prescribed = np.zeros((n * n, 2), bool)
    prescribed[rim] = fixed == "rim"
    radius = np.full(n * n, (2.3 if order == 1 else 3.1) / (n - 1))
    body = Body(
        cells=cells,
        support_radius=radius,
        fixed=prescribed,
        basis_order=order,
        column=column,
        n_gauss=n_gauss,
        axisymmetric=inner is not None,
    )
    return discretize(body, particles)


def pieces(rng, kind, void, n=9):
    """A square of triangles, or of triangles and quadrilaterals, with a hole, a notch or an interface.

    The rim of the square is fixed. Returns the discretisation and the sides (m, 2) of the void, the
    body on the left.
    """
    whole = square(rng, n)
    particles, cells = whole.particles, whole.body.cells
    i, j = np.divmod(np.arange(len(cells)), n - 1)
    if void == "hole":
        cells = cells[~((abs(i - 3.5) < 1) & (abs(j - 3.5) < 1))]
    elif void == "notch":
        cells = cells[~((i == 4) & (j >= 2))]
    cut = np.arange(len(cells)) % 3 > 0 if kind == "mixed" else np.ones(len(cells), bool)
    a, b, c, d = cells[cut].T
    other = rng.random(a.size) < 0.5
    one = np.where(other, [a, b, c, c], [b, c, d, d]).T
    two = np.where(other, [a, c, d, d], [b, d, a, a]).T
    cells = np.vstack([cells[~cut], one, two])
    used, flat = np.unique(cells, return_inverse=True)
    cells, particles = flat.reshape(-1, 4), particles[used]
    ends = np.stack([cells, np.roll(cells, -1, axis=1)], axis=2).reshape(-1, 2)
    ends = ends[ends[:, 0] != ends[:, 1]]
    known = set(map(tuple, ends.tolist()))
    outer = np.array([end for end in ends.tolist() if (end[1], end[0]) not in known])
    prescribed = whole.body.fixed[used]
    on_square = np.isin(particles, (0.0, 1.0))[outer]
    sides = outer[~(on_square[:, 0] & on_square[:, 1]).any(axis=1)]
    radius = np.full(len(used), 2.3 / (n - 1))
    # the interface bends in the middle
    x, y = particles[cells].mean(axis=1).T
    parts = (y > 0.5 + np.maximum(x - 0.5, 0.0)).astype(int) if void == "interface" else None
    hidden = hidden_pairs(cells, particles, radius, parts)
    body = Body(cells=cells, support_radius=radius, fixed=prescribed, hidden_pairs=hidden)
    return discretize(body, particles), sides


def structure(disc, constants=CONSTANTS):
    """The structural form on a body."""
    return elastic_body(AnyConstants(*constants)).on(disc, 0)


def internal(disc, d, constants=CONSTANTS, tangent=True):
    """Internal force (n_equations,) and the tangent buffer, through raw shape functions."""
    layout, raw = disc.layout, disc.transformation.coefficients(d)
    force, values = np.zeros(layout.force_size), np.zeros(layout.size if tangent else 0)
    assert structure(disc, constants).add(d, raw, 0.0, None, force, values) is not None
    layout.condense_force(force)
    if tangent:
        layout.condense_tangent(values)
    return force[: layout.n_equations], values


def energy(disc, d, constants=CONSTANTS):
    return structure(disc, constants).energy(d, 0.0)


def dense(layout, values):
    """The matrix in a tangent buffer."""
    storage, n = layout.storage, layout.n_equations
    blocks, matrix = storage.blocks, np.zeros((n, n))
    columns = zip(blocks.starts, blocks.shapes, blocks.rows, blocks.stored, strict=False)
    for start, shape, own, stored in columns:
        block = values[start : start + shape[0] * shape[1]].reshape(shape, order="F")
        matrix[stored, own] = block
    # entries of links outside the blocks
    column = np.repeat(np.arange(n), np.diff(storage.start))
    matrix[storage.outside, column] = values[blocks.size : storage.size]
    return matrix


def wave(disc, size, phase=0.0):
    """A smooth displacement field at the particles, zero on nothing."""
    x, y = (disc.particles / np.abs(disc.particles).max()).T
    return size * np.column_stack([np.sin(2 * x + y + phase), np.cos(x - 2 * y + phase)])


def inside(rng, disc, count=5):
    """Random points in the cells."""
    cells = disc.body.cells[rng.integers(0, len(disc.body.cells), count)]
    return PointSet(cells, rng.dirichlet(np.ones(4), count), 1)
