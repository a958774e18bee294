"""Structural fictitious load a'_V of Eq. (46), and its transpose for the adjoint method.

At fixed displacement coefficients d, a parameter moves the shape function gradients B and the
quadrature weights w. With the projected pressure p = K (J_c - 1):

    f_ia  = sum_q w P_ij B_ja
    f'_ia = sum_q (w' P_ij + w P'_ij) B_ja + w P_ij B'_ja,    P' = A : F' + p' cof F
"""

import numba as nb
import numpy as np

from seal_mdao.analysis.internal_force import cell_gradients, point_moduli, projected_jacobian


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _gradient_rates(displacement, b_rate, n, count, f_rate):
    """F' (4, count) at fixed d: sum_a d_ia B'_ja."""
    f_rate[:, :count] = 0.0
    for a in range(n):
        dx, dy = displacement[0, a], displacement[1, a]
        for p in range(count):
            f_rate[0, p] += dx * b_rate[0, a, p]
            f_rate[1, p] += dx * b_rate[1, a, p]
            f_rate[2, p] += dy * b_rate[0, a, p]
            f_rate[3, p] += dy * b_rate[1, a, p]


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _add_force_rates(b, b_rate, stress, stress_rate, n, count, local):
    """local (2, n, count) += (w P)'_ij B_ja + w P_ij B'_ja."""
    p11, p12, p21, p22 = stress
    for a in range(n):
        bx, by = b[0, a], b[1, a]
        for p in range(count):
            rx, ry = b_rate[0, a, p], b_rate[1, a, p]
            local[0, a, p] += stress_rate[0, p] * bx + stress_rate[1, p] * by + p11 * rx + p12 * ry
            local[1, a, p] += stress_rate[2, p] * bx + stress_rate[3, p] * by + p21 * rx + p22 * ry


@nb.njit(cache=True, error_model="numpy")
def add_internal_rates(table, weights, rates, weight_rates, constants, d, equations, out):
    """Add f' for all parameters to ``out`` (n_equations + 1, P).

    Parameters
    ----------
    rates : TableRates
        B' of the cells.
    weight_rates : ndarray, shape (P, n_cells, q)
    """
    c10, c01, bulk = constants
    q_count, n_parameters = table.group_size, out.shape[1]
    widest = 0
    for cell in range(table.start.size - 1):
        widest = max(widest, table.start[cell + 1] - table.start[cell])
    displacement = np.empty((2, widest))
    f, stress, moduli = np.empty((q_count, 5)), np.empty((q_count, 4)), np.empty((q_count, 4, 4))
    f_rate = np.empty((q_count, 4, n_parameters))
    stress_rate, swelling_rate = np.empty((4, n_parameters)), np.empty(n_parameters)
    for cell in range(table.start.size - 1):
        which = rates.active[rates.start[cell, 0] : rates.start[cell + 1, 0]]
        count = which.size
        if count == 0:
            continue
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[2 * s0 * q_count : 2 * (s0 + n) * q_count].reshape(q_count, 2, n)
        at = 2 * rates.start[cell, 1]
        b_rate = rates.grad[at : at + 2 * q_count * n * count].reshape(q_count, 2, n, count)
        for i in range(n):
            displacement[0, i], displacement[1, i] = d[near[i], 0], d[near[i], 1]
        cell_gradients(grad, displacement, n, q_count, f)
        volume, swelling = projected_jacobian(weights[cell], f, q_count)
        swelling_rate[:count] = 0.0
        for q in range(q_count):
            point_moduli(f[q], bulk * swelling, c10, c01, stress[q], moduli[q])
            _gradient_rates(displacement, b_rate[q], n, count, f_rate[q])
            w, excess = weights[cell, q], f[q, 4] - swelling
            for p in range(count):
                j_rate = (
                    f[q, 3] * f_rate[q, 0, p] - f[q, 2] * f_rate[q, 1, p]
                    - f[q, 1] * f_rate[q, 2, p] + f[q, 0] * f_rate[q, 3, p]
                )  # fmt: skip
                swelling_rate[p] += (w * j_rate + weight_rates[which[p], cell, q] * excess) / volume
        local = np.zeros((2, n, count))
        for q in range(q_count):
            w = weights[cell, q]
            cof = (f[q, 3], -f[q, 2], -f[q, 1], f[q, 0])
            for r in range(4):
                for p in range(count):
                    stress_rate[r, p] = w * bulk * swelling_rate[p] * cof[r]
                    stress_rate[r, p] += weight_rates[which[p], cell, q] * stress[q, r]
                for c in range(4):
                    modulus = w * moduli[q, r, c]
                    for p in range(count):
                        stress_rate[r, p] += modulus * f_rate[q, c, p]
            weighted = (w * stress[q, 0], w * stress[q, 1], w * stress[q, 2], w * stress[q, 3])
            _add_force_rates(grad[q], b_rate[q], weighted, stress_rate, n, count, local)
        for i in range(n):
            for c in range(2):
                row = out[equations[near[i], c]]
                for p in range(count):
                    row[which[p]] += local[c, i, p]


@nb.njit(cache=True, error_model="numpy")
def add_internal_seeds(table, weights, constants, d, adjoint, grad_bar, weight_bar, constants_bar):
    """Transpose of ``add_internal_rates``: for L = -adjoint . f add dL/dB, dL/dw and dL/d(constants).

    Parameters
    ----------
    adjoint : ndarray, shape (M, n, 2)
        Adjoint displacements of M measures.
    grad_bar, weight_bar, constants_bar : ndarray, shapes (M, grad.size), (M, n_cells, q), (M, 3)
        Added to; the constants are C10, C01 and the bulk modulus.
    """
    c10, c01, bulk = constants
    q_count, n_measures = table.group_size, adjoint.shape[0]
    widest = 0
    for cell in range(table.start.size - 1):
        widest = max(widest, table.start[cell + 1] - table.start[cell])
    displacement, lam = np.empty((2, widest)), np.empty((2, widest))
    f, stress, moduli = np.empty((q_count, 5)), np.empty((q_count, 4)), np.empty((q_count, 4, 4))
    strain, dual, unit = np.empty((q_count, 4)), np.empty(4), np.empty((2, q_count, 4))
    for cell in range(table.start.size - 1):
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        at = 2 * s0 * q_count
        grad = table.grad[at : at + 2 * n * q_count].reshape(q_count, 2, n)
        for i in range(n):
            displacement[0, i], displacement[1, i] = d[near[i], 0], d[near[i], 1]
        cell_gradients(grad, displacement, n, q_count, f)
        volume, swelling = projected_jacobian(weights[cell], f, q_count)
        for q in range(q_count):
            point_moduli(f[q], 0.0, 1.0, 0.0, unit[0, q], moduli[q])
            point_moduli(f[q], 0.0, 0.0, 1.0, unit[1, q], moduli[q])
            point_moduli(f[q], bulk * swelling, c10, c01, stress[q], moduli[q])
        for measure in range(n_measures):
            for i in range(n):
                lam[0, i] = -adjoint[measure, near[i], 0]
                lam[1, i] = -adjoint[measure, near[i], 1]
            dilation = 0.0
            for q in range(q_count):
                e = strain[q]
                e[:] = 0.0
                for i in range(n):
                    e[0] += lam[0, i] * grad[q, 0, i]
                    e[1] += lam[0, i] * grad[q, 1, i]
                    e[2] += lam[1, i] * grad[q, 0, i]
                    e[3] += lam[1, i] * grad[q, 1, i]
                dilation += weights[cell, q] * (
                    f[q, 3] * e[0] - f[q, 2] * e[1] - f[q, 1] * e[2] + f[q, 0] * e[3]
                )
            pressure = bulk * dilation / volume
            constants_bar[measure, 2] += swelling * dilation
            for q in range(q_count):
                w, e = weights[cell, q], strain[q]
                p = stress[q]
                weight_bar[measure, cell, q] += (
                    p[0] * e[0] + p[1] * e[1] + p[2] * e[2] + p[3] * e[3]
                    + pressure * (f[q, 4] - swelling)
                )  # fmt: skip
                for r in range(4):
                    constants_bar[measure, 0] += w * unit[0, q, r] * e[r]
                    constants_bar[measure, 1] += w * unit[1, q, r] * e[r]
                cof = (f[q, 3], -f[q, 2], -f[q, 1], f[q, 0])
                for r in range(4):
                    dual[r] = pressure * cof[r]
                    for c in range(4):
                        dual[r] += moduli[q, r, c] * e[c]
                    dual[r] *= w
                first = grad_bar[measure, at + 2 * n * q : at + 2 * n * q + n]
                second = grad_bar[measure, at + 2 * n * q + n : at + 2 * n * (q + 1)]
                for i in range(n):
                    lx, ly = w * lam[0, i], w * lam[1, i]
                    ux, uy = displacement[0, i], displacement[1, i]
                    first[i] += p[0] * lx + p[2] * ly + dual[0] * ux + dual[2] * uy
                    second[i] += p[1] * lx + p[3] * ly + dual[1] * ux + dual[3] * uy
