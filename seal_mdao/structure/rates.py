"""Structural fictitious load a'_V of Eq. (46).

At fixed displacement coefficients d, a parameter moves the shape function gradients B and the
quadrature weights w. With the projected pressure p = K (J_c - 1):

    f_ia  = sum_q w P_ij B_ja
    f'_ia = sum_q (w' P_ij + w P'_ij) B_ja + w P_ij B'_ja,    P' = A : F' + p' cof F

Neither needs what is solved for at other steps, so whole blocks of load steps are taken at once:
what a cell does then is matrix products over (step, component) and a pass over its points.
"""

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.structure.deformation import block, cell_displacements, widest_group
from seal_mdao.structure.internal_force import point_moduli, point_stress


@internal
def _add_pressure(weight, f, e0, e1, e2, e3, out):
    """out += weight cof F : e, over all parameters."""
    c0, c1, c2, c3 = weight * f[3], -weight * f[2], -weight * f[1], weight * f[0]
    for m in range(out.size):
        out[m] += c0 * e0[m] + c1 * e1[m] + c2 * e2[m] + c3 * e3[m]


@internal
def _stress_of(w, a, f, pressure, e0, e1, e2, e3, d0, d1, d2, d3):
    """d = w (A : e + p cof F), components 11, 12, 21, 22, over all parameters."""
    for m in range(pressure.size):
        x0, x1, x2, x3, p = w * e0[m], w * e1[m], w * e2[m], w * e3[m], w * pressure[m]
        d0[m] = a[0, 0] * x0 + a[0, 1] * x1 + a[0, 2] * x2 + a[0, 3] * x3 + p * f[3]
        d1[m] = a[1, 0] * x0 + a[1, 1] * x1 + a[1, 2] * x2 + a[1, 3] * x3 - p * f[2]
        d2[m] = a[2, 0] * x0 + a[2, 1] * x1 + a[2, 2] * x2 + a[2, 3] * x3 - p * f[1]
        d3[m] = a[3, 0] * x0 + a[3, 1] * x1 + a[3, 2] * x2 + a[3, 3] * x3 + p * f[0]


@internal
def _add_scaled(out, factor, values):
    """out += factor values."""
    for m in range(out.size):
        out[m] += factor * values[m]


@internal
def _cell_stress_rates(
    cell, weights, weight_rate, deformation, w, bulk, slope_rates, stress, stress_rates
):
    """(w P) and (w P)' of one cell at all steps.

    Parameters
    ----------
    weights, weight_rate : ndarray, shapes (q,), (q, P)
    w : ndarray, shape (5, K, n_cells, q)
    bulk : float
    slope_rates : ndarray, shape (2 K, 2 q, P)
        F', rows (step, component).
    stress, stress_rates : ndarray, shapes (2 K, 2 q), (2 q, 2 K, P)
        Written.
    """
    q_count, volume = weights.size, weights.sum()
    p, a = np.empty(4), np.empty((4, 4))
    pressure_rate = np.empty(weight_rate.shape[1])
    for k in range(slope_rates.shape[0] // 2):
        f, swelling = deformation.f[k, cell], deformation.swelling[k, cell]
        i, j = 2 * k, 2 * k + 1
        pressure_rate[:] = 0.0
        for q in range(q_count):
            x, y = 2 * q, 2 * q + 1
            _add_pressure(
                weights[q] * bulk / volume, f[q], slope_rates[i, x], slope_rates[i, y],
                slope_rates[j, x], slope_rates[j, y], pressure_rate,
            )  # fmt: skip
            excess = (f[q, 4] - swelling) * bulk / volume
            _add_scaled(pressure_rate, excess, weight_rate[q])
        for q in range(q_count):
            x, y, weight = 2 * q, 2 * q + 1, weights[q]
            w_t, w_j = w[0, k, cell, q], w[1, k, cell, q] + bulk * swelling
            point_stress(f[q], w_t, w_j, p)
            point_moduli(f[q], w_t, w_j, w[2, k, cell, q], w[3, k, cell, q], w[4, k, cell, q], a)
            stress[i, x], stress[i, y] = weight * p[0], weight * p[1]
            stress[j, x], stress[j, y] = weight * p[2], weight * p[3]
            _stress_of(
                weight, a, f[q], pressure_rate, slope_rates[i, x], slope_rates[i, y],
                slope_rates[j, x], slope_rates[j, y], stress_rates[x, i], stress_rates[y, i],
                stress_rates[x, j], stress_rates[y, j],
            )  # fmt: skip
            _add_scaled(stress_rates[x, i], p[0], weight_rate[q])
            _add_scaled(stress_rates[y, i], p[1], weight_rate[q])
            _add_scaled(stress_rates[x, j], p[2], weight_rate[q])
            _add_scaled(stress_rates[y, j], p[3], weight_rate[q])


@compiled
def add_internal_rates(
    table, weights, rates, weight_rates, deformation, w, bulk, d, equations, out
):
    """Add f' of a block of K load steps for all parameters to ``out`` (K, n_equations + 1, P).

    Parameters
    ----------
    rates : TableRates
        B' of the cells.
    weight_rates : ndarray, shape (P, n_cells, q)
    deformation : Deformation
        Of the block.
    w : ndarray, shape (5, K, n_cells, q)
        W_T, W_J, W_TT, W_TJ, W_JJ.
    bulk : ndarray, shape (n_cells,)
    d : ndarray, shape (K, n, 2)
    """
    q_count, n_steps, most = table.group_size, d.shape[0], out.shape[2]
    n_cells, rows, points = table.start.size - 1, 2 * d.shape[0], 2 * table.group_size
    widest = widest_group(table)
    displacements, turned = np.empty(rows * widest), np.empty(points * widest)
    stress, by_neighbour = np.empty((rows, points)), np.empty(points * widest * most)
    slope_rates, stress_rates = np.empty(rows * points * most), np.empty(rows * points * most)
    moving, moved = np.empty(rows * widest * most), np.empty(rows * widest * most)
    weight_rate = np.empty(q_count * most)
    for cell in range(n_cells):
        which = rates.active[rates.start[cell, 0] : rates.start[cell + 1, 0]]
        count, s0 = which.size, table.start[cell]
        if count == 0:
            continue
        n = table.start[cell + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        at = 2 * rates.start[cell, 1]
        b_rate = rates.grad[at : at + points * n * count].reshape(points, n * count)
        u = block(displacements, rows, n)
        b = block(turned, n, points)
        b_rate_of = block(by_neighbour, n, points * count)
        cell_displacements(d, near, u)
        for r in range(points):
            for a in range(n):
                b[a, r] = grad[r, a]
                for p in range(count):
                    b_rate_of[a, r * count + p] = b_rate[r, a * count + p]
        w_rate = block(weight_rate, q_count, count)
        for q in range(q_count):
            for p in range(count):
                w_rate[q, p] = weight_rates[which[p], cell, q]
        f_rate = block(slope_rates, rows, points * count)
        np.dot(u, b_rate_of, f_rate)
        p_rate = block(stress_rates, points, rows * count)
        _cell_stress_rates(
            cell, weights[cell], w_rate, deformation, w, bulk[cell],
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
