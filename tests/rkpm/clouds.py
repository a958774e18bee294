"""Irregular particle clouds, and shape functions written once more for complex arguments."""

import numpy as np

from seal_mdao.rkpm.cells import circumscribed_radii
from seal_mdao.rkpm.shape_functions import Cloud, PointSet, grad_rows


def irregular_cloud(rng, n=7, order=1, size=1.0, origin=(0.0, 0.0)):
    """``n`` x ``n`` particles, each moved by up to 30 % of the spacing, unequal supports."""
    grid = np.stack(np.meshgrid(np.arange(n), np.arange(n), indexing="ij"), -1).reshape(-1, 2)
    particles = (grid + rng.uniform(-0.3, 0.3, grid.shape)) * size + origin
    radius = rng.uniform(2.4, 3.2, len(particles)) * size * (1.0 if order == 1 else 1.25)
    return Cloud(particles, radius, float(radius.max()), {1: 3, 2: 6}[order])


def product_cloud(rng, n=7, order=1, size=1.0):
    """As ``irregular_cloud`` with product kernels, turned and sheared a little each."""
    cloud = irregular_cloud(rng, n, order, size)
    angle = rng.uniform(0.0, np.pi, len(cloud.particles))
    turn = np.moveaxis(
        np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]), 2, 0
    )
    widths = rng.uniform(2.4, 3.4, (len(angle), 1, 2)) * size * (1.0 if order == 1 else 1.25)
    axes = np.linalg.inv((turn + rng.uniform(-0.1, 0.1, turn.shape)) * widths)
    return cloud._replace(radius=circumscribed_radii(axes), axes=axes)


def random_points(rng, cloud, groups=12, group_size=3):
    """Points inside the cloud as random mixtures of particles, in groups that lie together."""
    n = round(len(cloud.particles) ** 0.5)
    corner = rng.integers(0, n - 1, (groups, 2)).repeat(group_size, 0)
    first = corner[:, 0] * n + corner[:, 1]
    anchors = np.column_stack([first, first + n, first + n + 1, first + 1])
    return PointSet(anchors, rng.dirichlet(np.ones(4), len(anchors)), group_size)


def rows(table, n_particles, values=None):
    """A flat table as dense rows, zero where it has no entries: phi (point, particle) and grad (point,
    component, particle)."""
    q = table.group_size
    of_point = grad_rows(table) or 2
    phi = np.zeros((table.n_groups * q, n_particles))
    grad = np.zeros((table.n_groups * q, of_point, n_particles))
    source = (table.phi, table.grad) if values is None else values
    for g in range(table.n_groups):
        near = table.neighbours[table.start[g] : table.start[g + 1]]
        low, high = q * table.start[g], q * table.start[g + 1]
        here = slice(g * q, (g + 1) * q)
        if source[0].size:
            phi[here, near] = source[0][low:high].reshape(q, near.size)
        if source[1].size:
            block = source[1][of_point * low : of_point * high]
            grad[here, :, near] = block.reshape(q, of_point, near.size)
    return phi, grad


def rate_rows(table, rates, n_particles, n_parameters):
    """Dense rates: phi (point, particle, parameter) and grad (point, component, particle, ...)."""
    q = table.group_size
    of_point = grad_rows(table) or 2
    phi = np.zeros((table.n_groups * q, n_particles, n_parameters))
    grad = np.zeros((table.n_groups * q, of_point, n_particles, n_parameters))
    for g in range(table.n_groups):
        near = table.neighbours[table.start[g] : table.start[g + 1]]
        active = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        low, high = rates.start[g, 1], rates.start[g + 1, 1]
        shape = (near.size, active.size)
        for i in range(q):
            if rates.phi.size:
                block = rates.phi[low:high].reshape(q, *shape)[i]
                phi[g * q + i][np.ix_(near, active)] = block
            for c in range(of_point if rates.grad.size else 0):
                block = rates.grad[of_point * low : of_point * high]
                block = block.reshape(q, of_point, *shape)[i, c]
                grad[g * q + i, c][np.ix_(near, active)] = block
    return phi, grad


def spline(z, derivative=0):
    """Cubic B-spline with knots -1, -1/2, 0, 1/2, 1 from truncated powers, complex z allowed."""
    sign, total = (1, -4, 6, -4, 1), 0 * z
    for k in range(5):
        base = 2 - k - 2 * z
        if base.real > 0.0:
            total = total + sign[k] * (base**3, -6 * base**2, 24 * base)[derivative]
    return total / 6.0


def monomials(r, scale, order):
    """H(r / scale) and its two first derivatives, shape (3, m)."""
    x, y = r / scale
    h = [[1, x, y], [0, 1 / scale, 0], [0, 0, 1 / scale]]
    if order == 2:
        second = [[x * x, x * y, y * y], [2 * x, y, 0], [0, x, 2 * y]]
        h = np.hstack([h, np.array(second) / [[1], [scale], [scale]]])
    return np.asarray(h, complex)


def round_kernel(r, a):
    """Value and gradient of the kernel of radius ``a``."""
    distance = np.sqrt(r @ r)
    return spline(distance / a), spline(distance / a, 1) * r / (a * distance)


def product_kernel(r, axes):
    """Value and gradient of the product kernel with ``axes`` (2, 2)."""
    s = axes @ r
    sign = np.where(s.real < 0.0, -1.0, 1.0)
    values, slopes = ([spline(sign[i] * s[i], k) for i in range(2)] for k in (0, 1))
    return values[0] * values[1], axes.T @ (sign * slopes * np.array(values[::-1]))


def reference_shape(x, particles, cloud, order):
    """Phi_I(x) and grad Phi_I(x) of Eqs. (10)-(13) by a plain solution, complex data allowed."""
    terms, product = [], cloud.axes is not None
    for particle, own in zip(particles, cloud.axes if product else cloud.radius, strict=True):
        r = x - particle
        f, slope = product_kernel(r, own) if product else round_kernel(r, own)
        h = monomials(r, cloud.radius[0], order)
        g = np.array([h[0] * f, h[1] * f + h[0] * slope[0], h[2] * f + h[0] * slope[1]])
        terms.append((h, g))
    moment = sum(np.outer(h[0], g[0]) for h, g in terms)
    q = np.linalg.solve(moment, np.eye(len(moment), 1)[:, 0].astype(complex))
    phi, grad = np.array([q @ g[0] for _, g in terms]), []
    for j in (1, 2):
        moment_j = sum(np.outer(h[j], g[0]) + np.outer(h[0], g[j]) for h, g in terms)
        q_j = -np.linalg.solve(moment, moment_j @ q)
        grad.append([q_j @ g[0] + q @ g[j] for _, g in terms])
    return phi, np.array(grad)
