"""Internal force and tangent of the structural form a(z, z-bar) and a*(z; dz, z-bar), Eqs. (43), (44).

They are the exact first and second derivatives of the energy of ``deformation``. The kernels know no
material: they take the derivatives of W(T, J) at the quadrature points as arrays.
"""

import math

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.structure.deformation import at_point, volume_of, widest_group


@inlined
def point_stress(f, w_t, w_j):
    """First Piola-Kirchhoff stress P = 2 W_T F + W_J cof F: 11, 12, 21, 22."""
    return (
        2.0 * w_t * f[0] + w_j * f[3],
        2.0 * w_t * f[1] + w_j * -f[2],
        2.0 * w_t * f[2] + w_j * -f[1],
        2.0 * w_t * f[3] + w_j * f[0],
    )


@internal
def point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a):
    """Moduli A = dP/dF in ``a`` (4, 4) at fixed pressure, which ``w_j`` contains."""
    # A = 2 W_T 1 + 4 W_TT F F + 2 W_TJ (F cof F + cof F F) + W_JJ cof F cof F + W_J d(cof F)/dF
    cof = (f[3], -f[2], -f[1], f[0])
    for r in range(4):
        for c in range(4):
            a[r, c] = 2.0 * w_tj * (f[r] * cof[c] + cof[r] * f[c]) + w_jj * cof[r] * cof[c]
            a[r, c] += 4.0 * w_tt * f[r] * f[c]
        a[r, r] += 2.0 * w_t
    # d(cof F)/dF: 11 with 22, 12 with 21
    a[0, 3] += w_j
    a[3, 0] += w_j
    a[1, 2] -= w_j
    a[2, 1] -= w_j


@internal
def _moduli_rows(weight, a, b, n, c, first):
    """weight A B of one quadrature point in four rows of ``c`` from ``first`` on: 11, 12, 21, 22;
    columns x then y."""
    for r in range(len(a)):  # not range(4): unrolled there is twice as much to compile
        # w A B, the two components of B side by side
        ax0, ax1 = weight * a[r, 0], weight * a[r, 1]
        ay0, ay1 = weight * a[r, 2], weight * a[r, 3]
        row, b0, b1 = c[first + r], b[0], b[1]
        for j in range(n):
            row[j] = ax0 * b0[j] + ax1 * b1[j]
        for j in range(n):
            row[n + j] = ay0 * b0[j] + ay1 * b1[j]


@inlined
def _of_four_points(b, c, first, j):
    """Entry ``j`` of a row of sum_q B^T (w A B) of four points: ``b`` their gradients at the row's
    neighbour, ``c`` of ``_moduli_rows`` from the row ``first`` of the first point on."""
    return (
        b[0] * c[first, j] + b[1] * c[first + 1, j]
        + b[2] * c[first + 4, j] + b[3] * c[first + 5, j]
        + b[4] * c[first + 8, j] + b[5] * c[first + 9, j]
        + b[6] * c[first + 12, j] + b[7] * c[first + 13, j]
    )  # fmt: skip


@inlined
def _fill_row(grad, c, g, i, a, row):
    """Row (component i, neighbour a) of sum_h g_h g_h^T + sum_q B^T (w A B), a function and four points
    at a time. Beyond the last function ``g`` is zero, beyond the last point ``c``."""
    count, _, n = grad.shape
    for k in range(len(g)):
        p, q, r, s = 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3
        if s >= count:
            p, q, r, s = p % count, q % count, r % count, s % count
        b = (
            grad[p, 0, a], grad[p, 1, a], grad[q, 0, a], grad[q, 1, a],
            grad[r, 0, a], grad[r, 1, a], grad[s, 0, a], grad[s, 1, a],
        )  # fmt: skip
        first, own = 16 * k + 2 * i, g[k, i * n + a]
        if k == 0:  # writing is a tenth faster than adding to zero
            for j in range(row.size):
                row[j] = own * g[k, j] + _of_four_points(b, c, first, j)
        else:
            for j in range(row.size):
                row[j] += own * g[k, j] + _of_four_points(b, c, first, j)


@internal
def _scatter_tangent(grad, c, g, buffer, slots, values):
    """Add sum_q B^T (w A B) + sum_h g_h g_h^T of one column of cells to the tangent.

    The matrix is symmetric: its rows are added as columns, which lie together in memory; computing
    one triangle only is slower, for the scatter then strides. The last term is the projected
    pressure's, with g_h = sqrt(K / V_h) sum_q N_h w cof B.
    """
    n = grad.shape[2]
    row = buffer[: 2 * n]
    for i in range(2):
        for a in range(n):
            _fill_row(grad, c, g, i, a, row)
            first = (i * n + a) * row.size
            for j in range(row.size):
                values[slots[first + j]] += row[j]


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
    a, local = np.empty((4, 4)), np.empty(2 * widest)
    # as many functions as fours of points, what is missing of either zero: see ``_fill_row``
    passes = (q_count + 3) // 4
    passes = passes if passes > len(functions) else len(functions)
    g, c = np.empty((passes, 2 * widest)), np.empty((16 * passes, 2 * widest))
    for i in range(2 * widest):
        for h in range(len(functions), passes):
            g[h, i] = 0.0
        for r in range(4 * q_count, 16 * passes):
            c[r, i] = 0.0
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        # s_h of the column
        swelling = deformation.swelling[k, column]
        for i in range(2 * n):
            local[i] = 0.0
            for h in range(len(functions)):
                g[h, i] = 0.0
        for q in range(q_count):
            f, weight, b = deformation.f[k, column, q], weights[column, q], grad[q]
            # P = 2 W_T F + (W_J + K sum_h N_h s_h) cof F
            pressure = bulk[column] * at_point(functions, q, swelling)
            w_t, w_j = w[0, column, q], w[1, column, q] + pressure
            p = point_stress(f, w_t, w_j)
            for i in range(n):
                # f_Ii = sum_q w P_ij Phi_I,j   Eq. (43)
                local[i] += weight * (p[0] * b[0, i] + p[1] * b[1, i])
                local[n + i] += weight * (p[2] * b[0, i] + p[3] * b[1, i])
            if values.size:
                # A = dP/dF at fixed pressure
                w_tt, w_tj, w_jj = w[2, column, q], w[3, column, q], w[4, column, q]
                point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a)
                f11, f12, f21, f22 = f[0], f[1], f[2], f[3]
                for h in range(len(functions)):
                    # g_h += N_h w cof F B
                    weighted = functions[h, q] * weight
                    if weighted != 0.0:
                        for i in range(n):
                            g[h, i] += weighted * (f22 * b[0, i] - f21 * b[1, i])
                        for i in range(n):
                            g[h, n + i] += weighted * (f11 * b[1, i] - f12 * b[0, i])
                _moduli_rows(weight, a, b, n, c, 4 * q)
        for i in range(n):
            # into the equations
            force[scatter.equations[near[i], 0]] += local[i]
            force[scatter.equations[near[i], 1]] += local[n + i]
        if values.size:
            for h in range(len(functions)):
                # K_p = sum_h K/V_h (sum_q N_h w cof F B)^T (...)
                root = math.sqrt(bulk[column] / volume_of(functions[h], weights[column]))
                for i in range(2 * n):
                    g[h, i] *= root
            slots = scatter.slots[scatter.start[column] : scatter.start[column + 1]]
            _scatter_tangent(grad, c, g, local, slots, values)
