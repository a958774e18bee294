"""Structural fictitious load a'_V of Eq. (46).

At fixed displacement coefficients d, a parameter moves the shape function gradients B and the
quadrature weights w. With the projected pressure p = K (J_c - 1):

    f_ia  = sum_q w P_ij B_ja
    f'_ia = sum_q (w' P_ij + w P'_ij) B_ja + w P_ij B'_ja,    P' = A : F' + p' cof F

Neither needs what is solved for at other steps, so whole blocks of load steps are taken at once:
what a cell does then is matrix products over (step, component) and a pass over its points.
"""

import numba as nb
import numpy as np

from seal_mdao.analysis.internal_force import point_moduli, projected_jacobian
from seal_mdao.dsa.cell_kernels import (
    add_pressure,
    add_scaled,
    block,
    cell_displacements,
    point_gradients,
    stress_of,
    widest_group,
)


@nb.njit(cache=True, error_model="numpy")
def _cell_stress_rates(weights, weight_rate, slopes, slope_rates, constants, stress, stress_rates):
    """(w P) and (w P)' of one cell at all steps.

    Parameters
    ----------
    weight_rate : ndarray, shape (q, P)
    slopes, slope_rates : ndarray, shapes (2 K, 2 q), (2 K, 2 q, P)
        grad u, and F'.
    stress, stress_rates : ndarray, shapes (2 K, 2 q), (2 q, 2 K, P)
        Written.
    """
    c10, c01, bulk = constants
    q_count = weights.size
    f, p, moduli = np.empty((q_count, 5)), np.empty((q_count, 4)), np.empty((q_count, 4, 4))
    pressure_rate = np.empty(weight_rate.shape[1])
    for k in range(slopes.shape[0] // 2):
        point_gradients(slopes, k, q_count, f)
        volume, swelling = projected_jacobian(weights, f, q_count)
        i, j = 2 * k, 2 * k + 1
        pressure_rate[:] = 0.0
        for q in range(q_count):
            x, y = 2 * q, 2 * q + 1
            point_moduli(f[q], bulk * swelling, c10, c01, p[q], moduli[q])
            add_pressure(
                weights[q] * bulk / volume, f[q], slope_rates[i, x], slope_rates[i, y],
                slope_rates[j, x], slope_rates[j, y], pressure_rate,
            )  # fmt: skip
            excess = (f[q, 4] - swelling) * bulk / volume
            add_scaled(pressure_rate, excess, weight_rate[q])
        for q in range(q_count):
            x, y, w = 2 * q, 2 * q + 1, weights[q]
            stress[i, x], stress[i, y] = w * p[q, 0], w * p[q, 1]
            stress[j, x], stress[j, y] = w * p[q, 2], w * p[q, 3]
            stress_of(
                w, moduli[q], f[q], pressure_rate, slope_rates[i, x], slope_rates[i, y],
                slope_rates[j, x], slope_rates[j, y], stress_rates[x, i], stress_rates[y, i],
                stress_rates[x, j], stress_rates[y, j],
            )  # fmt: skip
            add_scaled(stress_rates[x, i], p[q, 0], weight_rate[q])
            add_scaled(stress_rates[y, i], p[q, 1], weight_rate[q])
            add_scaled(stress_rates[x, j], p[q, 2], weight_rate[q])
            add_scaled(stress_rates[y, j], p[q, 3], weight_rate[q])


@nb.njit(cache=True, error_model="numpy")
def add_internal_rates(table, weights, rates, weight_rates, constants, d, equations, out):
    """Add f' of a block of K load steps for all parameters to ``out`` (K, n_equations + 1, P).

    Parameters
    ----------
    rates : TableRates
        B' of the cells.
    weight_rates : ndarray, shape (P, n_cells, q)
    d : ndarray, shape (K, n, 2)
    """
    q_count, n_steps, most = table.group_size, d.shape[0], out.shape[2]
    n_cells, rows, points = table.start.size - 1, 2 * d.shape[0], 2 * table.group_size
    widest = widest_group(table)
    displacements, turned = np.empty(rows * widest), np.empty(points * widest)
    slopes, stress = np.empty((rows, points)), np.empty((rows, points))
    by_neighbour = np.empty(points * widest * most)
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
        np.dot(u, b, slopes)
        f_rate = block(slope_rates, rows, points * count)
        np.dot(u, b_rate_of, f_rate)
        p_rate = block(stress_rates, points, rows * count)
        _cell_stress_rates(
            weights[cell], w_rate, slopes, f_rate.reshape(rows, points, count), constants, stress,
            p_rate.reshape(points, rows, count),
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
