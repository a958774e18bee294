"""Structural fictitious load a'_V of Eq. (46).

At fixed displacement coefficients d, a parameter moves the shape function gradients B and the
quadrature weights w. With the projected pressure p = K sum_h N_h s_h of ``pressure``:

    f_ia  = sum_q w P_ij B_ja
    f'_ia = sum_q (w' P_ij + w P'_ij) B_ja + w P_ij B'_ja,    P' = A : F' + p' cof F
    s_h'  = sum_q N_h (w cof F : F' + w' (det F - 1 - s_h)) / V_h

Neither needs what is solved for at other steps, so whole blocks of load steps are taken at once:
what a column of cells does then is matrix products over (step, component) and a pass over its points.
"""

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.structure.deformation import (
    at_point,
    block,
    group_displacements,
    volume_of,
    widest_group,
)
from seal_mdao.structure.internal_force import point_moduli, point_stress


@internal
def _add_pressure(weight, f, e0, e1, e2, e3, out):
    """out += weight cof F : e, over all parameters."""
    c0, c1, c2, c3 = weight * f[3], -weight * f[2], -weight * f[1], weight * f[0]
    for m in range(out.size):
        out[m] += c0 * e0[m] + c1 * e1[m] + c2 * e2[m] + c3 * e3[m]


@internal
def _stress_row(w, a, cofactor, p, e0, e1, e2, e3, pressure, weight_rate, out):
    """One component of (w P)' = w (A : e + p' cof F) + w' P, over all parameters."""
    a0, a1, a2, a3, c = w * a[0], w * a[1], w * a[2], w * a[3], w * cofactor
    for m in range(out.size):
        strained = a0 * e0[m] + a1 * e1[m] + a2 * e2[m] + a3 * e3[m]
        out[m] = strained + c * pressure[m] + p * weight_rate[m]


@internal
def _add_scaled(out, factor, values):
    """out += factor values."""
    for m in range(out.size):
        out[m] += factor * values[m]


@internal
def _swelling_rates(functions, weights, weight_rate, f, swelling, f_x, f_y, out):
    """s_h' of one column at one step, ``out`` (m, P); F' as rows ``f_x``, ``f_y`` (2 q, P)."""
    out[:] = 0.0
    for h in range(swelling.size):
        volume = volume_of(functions[h], weights)
        for q in range(weights.size):
            share = functions[h, q] / volume
            if share != 0.0:
                x, y = 2 * q, 2 * q + 1
                _add_pressure(share * weights[q], f[q], f_x[x], f_x[y], f_y[x], f_y[y], out[h])
                _add_scaled(out[h], share * (f[q, 4] - swelling[h]), weight_rate[q])


@internal
def _stress_rates(
    column, weights, weight_rate, functions, deformation, w, bulk, slope_rates, stress, stress_rates
):
    """(w P) and (w P)' of one column of cells at all steps.

    Parameters
    ----------
    weights, weight_rate, functions : ndarray, shapes (q,), (q, P), (m, q)
    w : ndarray, shape (5, K, n_columns, q)
    bulk : float
    slope_rates : ndarray, shape (2 K, 2 q, P)
        F', rows (step, component).
    stress, stress_rates : ndarray, shapes (2 K, 2 q), (2 q, 2 K, P)
        Written.
    """
    count, p, a = weight_rate.shape[1], np.empty(4), np.empty((4, 4))
    swelling_rate, pressure_rate = np.empty((len(functions), count)), np.empty(count)
    for k in range(slope_rates.shape[0] // 2):
        f, swelling = deformation.f[k, column], deformation.swelling[k, column]
        i, j = 2 * k, 2 * k + 1
        _swelling_rates(
            functions, weights, weight_rate, f, swelling, slope_rates[i], slope_rates[j],
            swelling_rate,
        )  # fmt: skip
        for q in range(weights.size):
            x, y, weight = 2 * q, 2 * q + 1, weights[q]
            pressure = bulk * at_point(functions, q, swelling)
            w_t, w_j = w[0, k, column, q], w[1, k, column, q] + pressure
            w_tt, w_tj, w_jj = w[2, k, column, q], w[3, k, column, q], w[4, k, column, q]
            point_stress(f[q], w_t, w_j, p)
            point_moduli(f[q], w_t, w_j, w_tt, w_tj, w_jj, a)
            stress[i, x], stress[i, y] = weight * p[0], weight * p[1]
            stress[j, x], stress[j, y] = weight * p[2], weight * p[3]
            pressure_rate[:] = 0.0
            for h in range(len(functions)):
                _add_scaled(pressure_rate, bulk * functions[h, q], swelling_rate[h])
            e0, e1 = slope_rates[i, x], slope_rates[i, y]
            e2, e3 = slope_rates[j, x], slope_rates[j, y]
            cofactors = f[q, 3], -f[q, 2], -f[q, 1], f[q, 0]
            for c in range(4):
                _stress_row(
                    weight, a[c], cofactors[c], p[c], e0, e1, e2, e3, pressure_rate, weight_rate[q],
                    stress_rates[x + c % 2, i + c // 2],
                )  # fmt: skip


@compiled
def add_internal_rates(
    table, weights, functions, rates, weight_rates, deformation, w, bulk, d, equations, out
):
    """Add f' of a block of K load steps for all parameters to ``out`` (K, n_equations + 1, P).

    Parameters
    ----------
    weights, functions : ndarray, shapes (n_columns, q), (m, q)
        Of the quadrature, and of the pressure.
    rates : TableRates
        B' of the columns of cells.
    weight_rates : ndarray, shape (P, n_columns, q)
    deformation : Deformation
        Of the block.
    w : ndarray, shape (5, K, n_columns, q)
        W_T, W_J, W_TT, W_TJ, W_JJ.
    bulk : ndarray, shape (n_columns,)
    d : ndarray, shape (K, n, 2)
    """
    q_count, n_steps, most = table.group_size, d.shape[0], out.shape[2]
    rows, points = 2 * d.shape[0], 2 * table.group_size
    widest = widest_group(table)
    displacements, turned = np.empty(rows * widest), np.empty(points * widest)
    stress, by_neighbour = np.empty((rows, points)), np.empty(points * widest * most)
    slope_rates, stress_rates = np.empty(rows * points * most), np.empty(rows * points * most)
    moving, moved = np.empty(rows * widest * most), np.empty(rows * widest * most)
    weight_rate = np.empty(q_count * most)
    for column in range(table.start.size - 1):
        which = rates.active[rates.start[column, 0] : rates.start[column + 1, 0]]
        count, s0 = which.size, table.start[column]
        if count == 0:
            continue
        n = table.start[column + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        at = 2 * rates.start[column, 1]
        b_rate = rates.grad[at : at + points * n * count].reshape(points, n * count)
        u = block(displacements, rows, n)
        b = block(turned, n, points)
        b_rate_of = block(by_neighbour, n, points * count)
        group_displacements(d, near, u)
        for r in range(points):
            for a in range(n):
                b[a, r] = grad[r, a]
                for p in range(count):
                    b_rate_of[a, r * count + p] = b_rate[r, a * count + p]
        w_rate = block(weight_rate, q_count, count)
        for q in range(q_count):
            for p in range(count):
                w_rate[q, p] = weight_rates[which[p], column, q]
        f_rate = block(slope_rates, rows, points * count)
        np.dot(u, b_rate_of, f_rate)
        p_rate = block(stress_rates, points, rows * count)
        _stress_rates(
            column, weights[column], w_rate, functions, deformation, w, bulk[column],
            f_rate.reshape(rows, points, count), stress, p_rate.reshape(points, rows, count),
        )  # fmt: skip
        on_rates, on_b = block(moving, rows, n * count), block(moved, n, rows * count)
        np.dot(stress, b_rate, on_rates)
        np.dot(b, p_rate, on_b)
        for k in range(n_steps):
            for i in range(2):
                row = 2 * k + i
                for a in range(n):
                    to = out[k, equations[near[a], i]]
                    for p in range(count):
                        to[which[p]] += on_rates[row, a * count + p] + on_b[a, row * count + p]
