"""Internal force and tangent of the structural form a(z, z-bar) and a*(z; dz, z-bar), Eqs. (43), (44).

They are the exact first and second derivatives of the energy of ``deformation``. The kernels know no
material: they take the derivatives of W(T, J) at the quadrature points as arrays.
"""

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.structure.deformation import at_point, volume_of, widest_group


@inlined
def point_stress(f, w_t, w_j, p):
    """First Piola-Kirchhoff stress P = 2 W_T F + W_J cof F in ``p`` (4,)."""
    p[0] = 2.0 * w_t * f[0] + w_j * f[3]
    p[1] = 2.0 * w_t * f[1] + w_j * -f[2]
    p[2] = 2.0 * w_t * f[2] + w_j * -f[1]
    p[3] = 2.0 * w_t * f[3] + w_j * f[0]


@internal
def point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a):
    """Moduli A = dP/dF in ``a`` (4, 4) at fixed pressure, which ``w_j`` contains."""
    cof = (f[3], -f[2], -f[1], f[0])
    for r in range(4):
        for c in range(4):
            a[r, c] = 2.0 * w_tj * (f[r] * cof[c] + cof[r] * f[c]) + w_jj * cof[r] * cof[c]
            a[r, c] += 4.0 * w_tt * f[r] * f[c]
        a[r, r] += 2.0 * w_t
    a[0, 3] += w_j
    a[3, 0] += w_j
    a[1, 2] -= w_j
    a[2, 1] -= w_j


@internal
def _moduli_rows(weight, a, b, n, c):
    """c = weight A B of one quadrature point, (4, 2 n): rows 11, 12, 21, 22, columns x then y."""
    for r in range(len(a)):  # not range(4): unrolled there is twice as much to compile
        ax0, ax1 = weight * a[r, 0], weight * a[r, 1]
        ay0, ay1 = weight * a[r, 2], weight * a[r, 3]
        row, b0, b1 = c[r], b[0], b[1]
        for j in range(n):
            row[j] = ax0 * b0[j] + ax1 * b1[j]
        for j in range(n):
            row[n + j] = ay0 * b0[j] + ay1 * b1[j]


@inlined
def _row_of_four(b, c, g, scale, i, a, row):
    """As ``_row_of_any`` for four points and one function, in one pass: a third faster."""
    b0, b1, b2, b3 = b[0, 0, a], b[0, 1, a], b[1, 0, a], b[1, 1, a]
    b4, b5, b6, b7 = b[2, 0, a], b[2, 1, a], b[3, 0, a], b[3, 1, a]
    c0, c1, c2, c3 = c[0, 2 * i], c[0, 2 * i + 1], c[1, 2 * i], c[1, 2 * i + 1]
    c4, c5, c6, c7 = c[2, 2 * i], c[2, 2 * i + 1], c[3, 2 * i], c[3, 2 * i + 1]
    for j in range(row.size):
        row[j] = (
            scale * g[j] + b0 * c0[j] + b1 * c1[j] + b2 * c2[j] + b3 * c3[j]
            + b4 * c4[j] + b5 * c5[j] + b6 * c6[j] + b7 * c7[j]
        )  # fmt: skip


@inlined
def _row_of_any(b, c, g, factor, i, a, row):
    """Row (component i, neighbour a) of sum_h K/V_h g_h g_h^T + sum_q B^T (w A B)."""
    at = i * b.shape[2] + a
    for j in range(row.size):
        row[j] = 0.0
    for h in range(factor.size):
        scale = factor[h] * g[h, at]
        for j in range(row.size):
            row[j] += scale * g[h, j]
    fours = b.shape[0] // 4 * 4
    for q in range(0, fours, 4):
        b0, b1, b2, b3 = b[q, 0, a], b[q, 1, a], b[q + 1, 0, a], b[q + 1, 1, a]
        b4, b5, b6, b7 = b[q + 2, 0, a], b[q + 2, 1, a], b[q + 3, 0, a], b[q + 3, 1, a]
        c0, c1, c2, c3 = c[q, 2 * i], c[q, 2 * i + 1], c[q + 1, 2 * i], c[q + 1, 2 * i + 1]
        c4, c5, c6, c7 = c[q + 2, 2 * i], c[q + 2, 2 * i + 1], c[q + 3, 2 * i], c[q + 3, 2 * i + 1]
        for j in range(row.size):
            row[j] += (
                b0 * c0[j] + b1 * c1[j] + b2 * c2[j] + b3 * c3[j]
                + b4 * c4[j] + b5 * c5[j] + b6 * c6[j] + b7 * c7[j]
            )  # fmt: skip
    for q in range(fours, b.shape[0]):
        b0, b1, c0, c1 = b[q, 0, a], b[q, 1, a], c[q, 2 * i], c[q, 2 * i + 1]
        for j in range(row.size):
            row[j] += b0 * c0[j] + b1 * c1[j]


@internal
def _scatter_tangent(grad, c, g, factor, buffer, slots, values):
    """Add sum_q B^T (w A B) + sum_h K/V_h g_h g_h^T of one column of cells to the tangent.

    The matrix is symmetric: its rows are added as columns, which lie together in memory; computing
    one triangle only is slower, for the scatter then strides. The last term is the projected
    pressure's, with g_h = sum_q N_h w cof B.
    """
    n, g_first = grad.shape[2], g[0]
    row = buffer[: 2 * n]
    for i in range(2):
        for a in range(n):
            if grad.shape[0] == 4 and factor.size == 1:
                _row_of_four(grad, c, g_first, factor[0] * g_first[i * n + a], i, a, row)
            else:
                _row_of_any(grad, c, g, factor, i, a, row)
            to = slots[(i * n + a) * row.size : (i * n + a + 1) * row.size]
            for j in range(row.size):
                values[to[j]] += row[j]


@compiled
def assemble_internal(table, weights, functions, deformation, k, w, bulk, scatter, force, values):
    """Add the internal force to ``force`` and, where ``values`` is not empty, the tangent to it.

    Parameters
    ----------
    table : ShapeTable
        Shape functions at the quadrature points, a group for a column of cells.
    weights, functions : ndarray, shapes (n_columns, q), (m, q)
        Of the quadrature, and of the pressure.
    deformation : Deformation
        Of ``deform``; its field ``k`` is taken.
    w : ndarray, shape (5, n_columns, q)
        W_T, W_J, W_TT, W_TJ, W_JJ at that field.
    bulk : ndarray, shape (n_columns,)
        K of the projected energy.
    scatter : Scatter
    force, values : ndarray
        Length n_equations + 1 (the last collects imposed components), and the tangent buffer.
    """
    q_count, widest = table.group_size, widest_group(table)
    local, p, a = np.empty((2, widest)), np.empty(4), np.empty((4, 4))
    g, factor = np.empty((len(functions), 2 * widest)), np.empty(len(functions))
    row, c = np.empty(2 * widest), np.empty((q_count, 4, 2 * widest))
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        swelling = deformation.swelling[k, column]
        for i in range(n):
            local[0, i] = local[1, i] = 0.0
        for h in range(factor.size):
            factor[h] = 0.0
            for i in range(2 * n):
                g[h, i] = 0.0
        for q in range(q_count):
            f, weight, b = deformation.f[k, column, q], weights[column, q], grad[q]
            pressure = bulk[column] * at_point(functions, q, swelling)
            w_t, w_j = w[0, column, q], w[1, column, q] + pressure
            point_stress(f, w_t, w_j, p)
            for i in range(n):
                local[0, i] += weight * (p[0] * b[0, i] + p[1] * b[1, i])
                local[1, i] += weight * (p[2] * b[0, i] + p[3] * b[1, i])
            if values.size:
                w_tt, w_tj, w_jj = w[2, column, q], w[3, column, q], w[4, column, q]
                point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a)
                f11, f12, f21, f22 = f[0], f[1], f[2], f[3]
                for h in range(factor.size):
                    share = functions[h, q] * weight
                    factor[h] += share
                    if share != 0.0:
                        for i in range(n):
                            g[h, i] += share * (f22 * b[0, i] - f21 * b[1, i])
                        for i in range(n):
                            g[h, n + i] += share * (f11 * b[1, i] - f12 * b[0, i])
                _moduli_rows(weight, a, b, n, c[q])
        for i in range(n):
            force[scatter.equations[near[i], 0]] += local[0, i]
            force[scatter.equations[near[i], 1]] += local[1, i]
        if values.size:
            for h in range(factor.size):
                factor[h] = bulk[column] / factor[h]
            slots = scatter.slots[scatter.start[column] : scatter.start[column + 1]]
            _scatter_tangent(grad, c, g, factor, row, slots, values)


@compiled
def add_internal_change(table, weights, functions, deformation, k, w, bulk, nodal, equations, out):
    """Add K u for displacements u of all particles, ``nodal`` (n, 2, P), to ``out`` (rows, P).

    Parameters
    ----------
    weights, functions, deformation, k, w, bulk :
        As of ``assemble_internal``.
    equations : ndarray of int, shape (n, 2)
        Row of every component.
    """
    q_count, count = table.group_size, nodal.shape[2]
    slopes, change, a = np.empty((q_count, 4, count)), np.empty((4, count)), np.empty((4, 4))
    swelling_change = np.empty((len(functions), count))
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        slopes[:], swelling_change[:] = 0.0, 0.0
        swelling = deformation.swelling[k, column]
        for q in range(q_count):
            f = deformation.f[k, column, q]
            for i in range(n):
                for c in range(2):
                    for j in range(2):
                        slopes[q, 2 * c + j] += grad[q, j, i] * nodal[near[i], c]
            on_cof = f[3] * slopes[q, 0] - f[2] * slopes[q, 1] - f[1] * slopes[q, 2]
            on_cof += f[0] * slopes[q, 3]
            for h in range(len(functions)):
                volume = volume_of(functions[h], weights[column])
                swelling_change[h] += functions[h, q] * weights[column, q] / volume * on_cof
        for q in range(q_count):
            f, cof = deformation.f[k, column, q], np.empty(4)
            cof[0], cof[1], cof[2], cof[3] = f[3], -f[2], -f[1], f[0]
            pressure = bulk[column] * at_point(functions, q, swelling)
            w_t, w_j = w[0, column, q], w[1, column, q] + pressure
            w_tt, w_tj, w_jj = w[2, column, q], w[3, column, q], w[4, column, q]
            point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a)
            pressure_change = np.zeros(count)
            for h in range(len(functions)):
                pressure_change += bulk[column] * functions[h, q] * swelling_change[h]
            for r in range(4):
                change[r] = cof[r] * pressure_change
                for s in range(4):
                    change[r] += a[r, s] * slopes[q, s]
            for i in range(n):
                for c in range(2):
                    row = out[equations[near[i], c]]
                    for j in range(2):
                        row += weights[column, q] * grad[q, j, i] * change[2 * c + j]
