"""Internal force and tangent of the structural form a(z, z-bar) and a*(z; dz, z-bar), Eqs. (43), (44).

Pressure projection in the energy: J is averaged over each background cell,

    W = sum_q w_q W_dev(F_q) + sum_c K/2 V_c (J_c - 1)^2,   J_c = sum_q w_q J_q / V_c,

so residual and tangent are its exact first and second derivatives.
"""

import numba as nb
import numpy as np

from seal_mdao.materials.mooney_rivlin import energy_derivatives


@nb.njit(cache=True, error_model="numpy", inline="always")
def cell_gradients(grad, displacement, n, q_count, f):
    """Deformation gradients of one cell: ``f`` (q, 5) in the order 11, 12, 21, 22, and det F - 1.

    The last is formed from the displacement gradient: det F itself would lose the small volume
    change that the bulk modulus multiplies.
    """
    for q in range(q_count):
        f11, f12, f21, f22 = 0.0, 0.0, 0.0, 0.0
        for a in range(n):
            bx, by = grad[q, 0, a], grad[q, 1, a]
            f11 += displacement[0, a] * bx
            f12 += displacement[0, a] * by
            f21 += displacement[1, a] * bx
            f22 += displacement[1, a] * by
        f[q, 0], f[q, 1], f[q, 2], f[q, 3] = 1.0 + f11, f12, f21, 1.0 + f22
        f[q, 4] = f11 + f22 + (f11 * f22 - f12 * f21)


@nb.njit(cache=True, error_model="numpy", inline="always")
def projected_jacobian(weights, f, q_count):
    """Cell volume and projected J - 1; the volume is returned negative if a point is inverted."""
    volume, change, upright = 0.0, 0.0, True
    for q in range(q_count):
        upright &= f[q, 4] > -1.0
        volume += weights[q]
        change += weights[q] * f[q, 4]
    return (volume if upright else -volume), change / volume


@nb.njit(cache=True, error_model="numpy", inline="always")
def point_moduli(f, pressure, c10, c01, p, a):
    """First Piola-Kirchhoff stress ``p`` (4,) and moduli ``a`` (4, 4) at fixed cell pressure."""
    t = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3]
    j = 1.0 + f[4]
    w_t, w_j, w_tj, w_jj = energy_derivatives(t, j, c10, c01)
    w_j += pressure
    cof = (f[3], -f[2], -f[1], f[0])
    for r in range(4):
        p[r] = 2.0 * w_t * f[r] + w_j * cof[r]
        for c in range(4):
            a[r, c] = 2.0 * w_tj * (f[r] * cof[c] + cof[r] * f[c]) + w_jj * cof[r] * cof[c]
        a[r, r] += 2.0 * w_t
    a[0, 3] += w_j
    a[3, 0] += w_j
    a[1, 2] -= w_j
    a[2, 1] -= w_j


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _moduli_rows(weight, a, b, n, c):
    """c = weight A B of one quadrature point, (4, 2 n): rows 11, 12, 21, 22, columns x then y."""
    for r in range(4):
        ax0, ax1 = weight * a[r, 0], weight * a[r, 1]
        ay0, ay1 = weight * a[r, 2], weight * a[r, 3]
        row, b0, b1 = c[r], b[0], b[1]
        for j in range(n):
            row[j] = ax0 * b0[j] + ax1 * b1[j]
        for j in range(n):
            row[n + j] = ay0 * b0[j] + ay1 * b1[j]


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _scatter_tangent(grad, c, g, factor, n, q_count, row, slots, values):
    """Add sum_q B^T (w A B) + K / V_c g g^T of one cell to the tangent.

    The matrix is symmetric: its rows are added as columns, which lie together in memory; computing
    one triangle only is slower, for the scatter then strides. The last term is the projected
    pressure's, with g = sum_q w cof B.
    """
    whole = 2 * n
    for i in range(2):
        for a in range(n):
            scale = factor * g[i * n + a]
            for j in range(whole):
                row[j] = scale * g[j]
            for q in range(q_count):
                b0, b1 = grad[q, 0, a], grad[q, 1, a]
                c0, c1 = c[q, 2 * i], c[q, 2 * i + 1]
                for j in range(whole):
                    row[j] += b0 * c0[j] + b1 * c1[j]
            to = slots[(i * n + a) * whole : (i * n + a + 1) * whole]
            for j in range(whole):
                values[to[j]] += row[j]


@nb.njit(cache=True, error_model="numpy")
def assemble_internal(table, weights, constants, d, scatter, force, values):
    """Add the internal force to ``force`` and, where ``values`` is not empty, the tangent to it.

    Parameters
    ----------
    table : ShapeTable
        Shape functions at the quadrature points, one group a cell.
    weights : ndarray, shape (n_cells, q)
    constants : tuple of float
        C10, C01, bulk modulus.
    d : ndarray, shape (n, 2)
        Generalised displacements.
    scatter : Scatter
    force, values : ndarray
        Length n_equations + 1 (the last collects imposed components), and the tangent buffer.

    Returns
    -------
    int
        The first cell with an inverted quadrature point, or -1.
    """
    c10, c01, bulk = constants
    q_count = table.group_size
    widest = 0
    for cell in range(table.start.size - 1):
        widest = max(widest, table.start[cell + 1] - table.start[cell])
    displacement, local = np.empty((2, widest)), np.empty((2, widest))
    f, p, a = np.empty((q_count, 5)), np.empty(4), np.empty((4, 4))
    g, row, c = np.empty(2 * widest), np.empty(2 * widest), np.empty((q_count, 4, 2 * widest))
    for cell in range(table.start.size - 1):
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        for i in range(n):
            displacement[0, i], displacement[1, i] = d[near[i], 0], d[near[i], 1]
        local[:, :n] = 0.0
        g[: 2 * n] = 0.0
        cell_gradients(grad, displacement, n, q_count, f)
        volume, swelling = projected_jacobian(weights[cell], f, q_count)
        if not volume > 0.0:
            return cell
        pressure = bulk * swelling
        for q in range(q_count):
            w = weights[cell, q]
            point_moduli(f[q], pressure, c10, c01, p, a)
            b = grad[q]
            for i in range(n):
                local[0, i] += w * (p[0] * b[0, i] + p[1] * b[1, i])
                local[1, i] += w * (p[2] * b[0, i] + p[3] * b[1, i])
            if values.size:
                for i in range(n):
                    g[i] += w * (f[q, 3] * b[0, i] - f[q, 2] * b[1, i])
                    g[n + i] += w * (f[q, 0] * b[1, i] - f[q, 1] * b[0, i])
                _moduli_rows(w, a, b, n, c[q])
        for i in range(n):
            force[scatter.equations[near[i], 0]] += local[0, i]
            force[scatter.equations[near[i], 1]] += local[1, i]
        if values.size:
            slots = scatter.slots[scatter.start[cell] : scatter.start[cell + 1]]
            _scatter_tangent(grad, c, g, bulk / volume, n, q_count, row, slots, values)
    return -1


@nb.njit(cache=True, error_model="numpy")
def particle_gradients(table, cells, d, out):
    """Deformation gradients at the particles: means over the quadrature points of the cells around.

    Parameters
    ----------
    table : ShapeTable
        Shape functions at the quadrature points, one group a cell.
    cells : ndarray of int, shape (n_cells, 4)
        Corner particles.
    d : ndarray, shape (n, 2)
        Generalised displacements.
    out : ndarray, shape (n, 2, 2)
        Written; the unit matrix for a particle at no cell.
    """
    q_count = table.group_size
    f, count = np.empty((q_count, 5)), np.zeros(len(out))
    out[:] = 0.0
    for cell in range(table.start.size - 1):
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        cell_gradients(grad, d[table.neighbours[s0 : s0 + n]].T, n, q_count, f)
        for particle in cells[cell]:
            count[particle] += q_count
            for q in range(q_count):
                for i in range(2):
                    for k in range(2):
                        out[particle, i, k] += f[q, 2 * i + k]
    for particle in range(len(out)):
        if count[particle] > 0.0:
            out[particle] /= count[particle]
        else:
            out[particle] = np.eye(2)


@nb.njit(cache=True, error_model="numpy")
def internal_energy(table, weights, constants, d):
    """Strain energy W of the whole body per unit depth."""
    c10, c01, bulk = constants
    q_count = table.group_size
    total = 0.0
    f = np.empty((q_count, 5))
    for cell in range(table.start.size - 1):
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        cell_gradients(grad, d[table.neighbours[s0 : s0 + n]].T, n, q_count, f)
        volume, swelling = projected_jacobian(weights[cell], f, q_count)
        total += 0.5 * bulk * abs(volume) * swelling * swelling
        for q in range(q_count):
            t = (f[q, :4] ** 2).sum()
            j = 1.0 + f[q, 4]
            total += weights[cell, q] * (
                c10 * ((t + 1.0) * j ** (-2.0 / 3.0) - 3.0)
                + c01 * ((t + j * j) * j ** (-4.0 / 3.0) - 3.0)
            )
    return total
