"""Structural fictitious load a'_V of Eq. (46).

At fixed displacement coefficients d, a parameter moves the shape function gradients B and the
quadrature weights w. With the projected pressure p = K sum_h N_h s_h of ``pressure``:

    f_ia  = sum_q w P_ij B_ja
    f'_ia = sum_q (w' P_ij + w P'_ij) B_ja + w P_ij B'_ja,    P' = A : F' + p' cof F
    s_h'  = sum_q N_h (w cof F : F' + w' (det F - 1 - s_h)) / V_h

Neither needs what is solved for at other steps, so whole blocks of load steps are taken at once:
what a column of cells does then is matrix products over (component, step) and a pass over its points
with the steps side by side in memory, for there are more of them than of parameters in a column.
"""

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.structure.deformation import at_point, block, volume_of, widest_group
from seal_mdao.structure.internal_force import point_moduli, point_stress

# Rows of the coefficients of a point, a column for each step: P, w cof F, w A, det F - 1.
STRESS, COFACTOR, MODULI, VOLUME_CHANGE = 0, 4, 8, 24
ROWS = 25


@internal
def _fill_coefficients(column, weights, functions, deformation, w, bulk, out):
    """Coefficients (q, ROWS, K) of the points of one column of cells."""
    a = np.empty((4, 4))
    for k in range(out.shape[2]):
        swelling = deformation.swelling[k, column]
        for q in range(weights.size):
            f, weight = deformation.f[k, column, q], weights[q]
            pressure = bulk * at_point(functions, q, swelling)
            w_t, w_j = w[0, k, column, q], w[1, k, column, q] + pressure
            w_tt, w_tj, w_jj = w[2, k, column, q], w[3, k, column, q], w[4, k, column, q]
            p = point_stress(f, w_t, w_j)
            point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a)
            for r in range(4):
                out[q, STRESS + r, k] = p[r]
                out[q, COFACTOR + r, k] = weight * (-f[3 - r] if r == 1 or r == 2 else f[3 - r])
                for c in range(4):
                    out[q, MODULI + 4 * r + c, k] = weight * a[r, c]
            out[q, VOLUME_CHANGE, k] = f[4]


@internal
def _contract(coefficients, row, rates, q, p, out):
    """Four rows of coefficients, from ``row`` on, times F' of one point and parameter."""
    a0, a1, a2, a3 = (
        coefficients[row], coefficients[row + 1], coefficients[row + 2], coefficients[row + 3]
    )  # fmt: skip
    e0, e1 = rates[2 * q, p, 0], rates[2 * q + 1, p, 0]
    e2, e3 = rates[2 * q, p, 1], rates[2 * q + 1, p, 1]
    for k in range(out.size):
        out[k] = a0[k] * e0[k] + a1[k] * e1[k] + a2[k] * e2[k] + a3[k] * e3[k]


@internal
def _add_swelling_rate(share, change, weight_rate, volume_change, swelling, out):
    """out += N_h / V_h (w cof F : F' + w' (det F - 1 - s_h)), over all steps."""
    for k in range(out.size):
        out[k] += share * (change[k] + weight_rate * (volume_change[k] - swelling[k]))


@internal
def _add_scaled(out, factor, values):
    """out += factor values."""
    for k in range(out.size):
        out[k] += factor * values[k]


@internal
def _add_stress_rate(cofactor, pressure, stress, weight_rate, out):
    """out += w p' cof F + w' P of one component, over all steps."""
    for k in range(out.size):
        out[k] += cofactor[k] * pressure[k] + stress[k] * weight_rate


@internal
def _stress_rates(
    weights, weight_rate, functions, swelling, bulk, coefficients, slope_rates, swelling_rates,
    stress_rates,
):  # fmt: skip
    """(w P)' of one column of cells at all steps.

    Parameters
    ----------
    weights, weight_rate, functions : ndarray, shapes (q,), (q, P), (m, q)
    swelling : ndarray, shape (m, K)
        s_h.
    bulk : float
    coefficients : ndarray, shape (q, ROWS, K)
    slope_rates : ndarray, shape (2 q, P, 2, K)
        F'_ij at [(point, j), parameter, i].
    swelling_rates : ndarray, shape (m, P, K)
        Written: s_h'.
    stress_rates : ndarray, shape (2 q, P, 2, K)
        Written, as F'.
    """
    pressure, volume = np.empty(swelling.shape[1]), np.empty(len(functions))
    for h in range(len(functions)):
        volume[h] = volume_of(functions[h], weights)
    swelling_rates[:] = 0.0
    for q in range(weights.size):
        own = coefficients[q]
        for p in range(weight_rate.shape[1]):
            _contract(own, COFACTOR, slope_rates, q, p, pressure)
            for h in range(len(functions)):
                if functions[h, q] != 0.0:
                    _add_swelling_rate(
                        functions[h, q] / volume[h], pressure, weight_rate[q, p],
                        own[VOLUME_CHANGE], swelling[h], swelling_rates[h, p],
                    )  # fmt: skip
    for q in range(weights.size):
        own = coefficients[q]
        for p in range(weight_rate.shape[1]):
            pressure[:] = 0.0
            for h in range(len(functions)):
                _add_scaled(pressure, bulk * functions[h, q], swelling_rates[h, p])
            for c in range(4):
                out = stress_rates[2 * q + c % 2, p, c // 2]
                _contract(own, MODULI + 4 * c, slope_rates, q, p, out)
                _add_stress_rate(
                    own[COFACTOR + c], pressure, own[STRESS + c], weight_rate[q, p], out
                )


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
    rows, points, m = 2 * d.shape[0], 2 * table.group_size, len(functions)
    widest = widest_group(table)
    displacements, turned = np.empty(rows * widest), np.empty(points * widest)
    stress, by_parameter = np.empty((rows, points)), np.empty(points * widest * most)
    slope_rates, stress_rates = np.empty(rows * points * most), np.empty(rows * points * most)
    moving, moved = np.empty(rows * widest * most), np.empty(rows * widest * most)
    weight_rate, coefficients = np.empty(q_count * most), np.empty((q_count, ROWS, n_steps))
    swelling, swelling_rates = np.empty((m, n_steps)), np.empty((m, most, n_steps))
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
        u, b = block(displacements, n, rows), block(turned, n, points)
        b_rate_of = block(by_parameter, points * count, n)
        for a in range(n):
            for k in range(n_steps):
                u[a, k], u[a, n_steps + k] = d[k, near[a], 0], d[k, near[a], 1]
            for r in range(points):
                b[a, r] = grad[r, a]
                for p in range(count):
                    b_rate_of[r * count + p, a] = b_rate[r, a * count + p]
        w_rate = block(weight_rate, q_count, count)
        for q in range(q_count):
            for p in range(count):
                w_rate[q, p] = weight_rates[which[p], column, q]
        _fill_coefficients(
            column, weights[column], functions, deformation, w, bulk[column], coefficients
        )
        for k in range(n_steps):
            for h in range(m):
                swelling[h, k] = deformation.swelling[k, column, h]
            for q in range(q_count):
                for r in range(4):
                    weighted = weights[column, q] * coefficients[q, STRESS + r, k]
                    stress[r // 2 * n_steps + k, 2 * q + r % 2] = weighted
        f_rate = block(slope_rates, points * count, rows)
        np.dot(b_rate_of, u, f_rate)
        p_rate = block(stress_rates, points, count * rows)
        _stress_rates(
            weights[column], w_rate, functions, swelling, bulk[column], coefficients,
            f_rate.reshape(points, count, 2, n_steps), swelling_rates[:, :count],
            p_rate.reshape(points, count, 2, n_steps),
        )  # fmt: skip
        on_rates, on_b = block(moving, rows, n * count), block(moved, n, count * rows)
        np.dot(stress, b_rate, on_rates)
        np.dot(b, p_rate, on_b)
        for k in range(n_steps):
            for i in range(2):
                row = i * n_steps + k
                for a in range(n):
                    to = out[k, equations[near[a], i]]
                    for p in range(count):
                        to[which[p]] += on_rates[row, a * count + p] + on_b[a, p * rows + row]
