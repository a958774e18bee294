"""Structural fictitious load a'_V of Eq. (46), and its transpose for the adjoint method.

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
from seal_mdao.materials.mooney_rivlin import unit_energy_gradients


@nb.njit(cache=True, error_model="numpy")
def _widest(table):
    """Largest number of neighbours of a group."""
    widest = 0
    for cell in range(table.start.size - 1):
        widest = max(widest, table.start[cell + 1] - table.start[cell])
    return widest


@nb.njit(cache=True, error_model="numpy")
def _block(buffer, rows, columns):
    """The beginning of a flat buffer as a matrix."""
    return buffer[: rows * columns].reshape(rows, columns)


@nb.njit(cache=True, error_model="numpy")
def _cell_displacements(d, near, out):
    """``out`` (2 K, n): d of the neighbours, rows (step, component)."""
    for k in range(d.shape[0]):
        for a in range(near.size):
            out[2 * k, a] = d[k, near[a], 0]
            out[2 * k + 1, a] = d[k, near[a], 1]


@nb.njit(cache=True, error_model="numpy", inline="always")
def _point_gradients(slopes, k, q_count, f):
    """``f`` (q, 5): F and det F - 1 at one step, from grad u with rows (step, component)."""
    for q in range(q_count):
        f11, f12 = slopes[2 * k, 2 * q], slopes[2 * k, 2 * q + 1]
        f21, f22 = slopes[2 * k + 1, 2 * q], slopes[2 * k + 1, 2 * q + 1]
        f[q, 0], f[q, 1], f[q, 2], f[q, 3] = 1.0 + f11, f12, f21, 1.0 + f22
        f[q, 4] = f11 + f22 + (f11 * f22 - f12 * f21)


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _add_pressure(weight, f, e0, e1, e2, e3, out):
    """out += weight cof F : e, over all parameters or measures."""
    c0, c1, c2, c3 = weight * f[3], -weight * f[2], -weight * f[1], weight * f[0]
    for m in range(out.size):
        out[m] += c0 * e0[m] + c1 * e1[m] + c2 * e2[m] + c3 * e3[m]


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _stress_of(w, a, f, pressure, e0, e1, e2, e3, d0, d1, d2, d3):
    """d = w (A : e + p cof F), components 11, 12, 21, 22, over all parameters or measures."""
    for m in range(pressure.size):
        x0, x1, x2, x3, p = w * e0[m], w * e1[m], w * e2[m], w * e3[m], w * pressure[m]
        d0[m] = a[0, 0] * x0 + a[0, 1] * x1 + a[0, 2] * x2 + a[0, 3] * x3 + p * f[3]
        d1[m] = a[1, 0] * x0 + a[1, 1] * x1 + a[1, 2] * x2 + a[1, 3] * x3 - p * f[2]
        d2[m] = a[2, 0] * x0 + a[2, 1] * x1 + a[2, 2] * x2 + a[2, 3] * x3 - p * f[1]
        d3[m] = a[3, 0] * x0 + a[3, 1] * x1 + a[3, 2] * x2 + a[3, 3] * x3 + p * f[0]


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _add_scaled(out, factor, values):
    """out += factor values."""
    for m in range(out.size):
        out[m] += factor * values[m]


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
        _point_gradients(slopes, k, q_count, f)
        volume, swelling = projected_jacobian(weights, f, q_count)
        i, j = 2 * k, 2 * k + 1
        pressure_rate[:] = 0.0
        for q in range(q_count):
            x, y = 2 * q, 2 * q + 1
            point_moduli(f[q], bulk * swelling, c10, c01, p[q], moduli[q])
            _add_pressure(
                weights[q] * bulk / volume, f[q], slope_rates[i, x], slope_rates[i, y],
                slope_rates[j, x], slope_rates[j, y], pressure_rate,
            )  # fmt: skip
            excess = (f[q, 4] - swelling) * bulk / volume
            _add_scaled(pressure_rate, excess, weight_rate[q])
        for q in range(q_count):
            x, y, w = 2 * q, 2 * q + 1, weights[q]
            stress[i, x], stress[i, y] = w * p[q, 0], w * p[q, 1]
            stress[j, x], stress[j, y] = w * p[q, 2], w * p[q, 3]
            _stress_of(
                w, moduli[q], f[q], pressure_rate, slope_rates[i, x], slope_rates[i, y],
                slope_rates[j, x], slope_rates[j, y], stress_rates[x, i], stress_rates[y, i],
                stress_rates[x, j], stress_rates[y, j],
            )  # fmt: skip
            _add_scaled(stress_rates[x, i], p[q, 0], weight_rate[q])
            _add_scaled(stress_rates[y, i], p[q, 1], weight_rate[q])
            _add_scaled(stress_rates[x, j], p[q, 2], weight_rate[q])
            _add_scaled(stress_rates[y, j], p[q, 3], weight_rate[q])


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
    widest = _widest(table)
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
        u = _block(displacements, rows, n)
        b = _block(turned, n, points)
        b_rate_of = _block(by_neighbour, n, points * count)
        _cell_displacements(d, near, u)
        for r in range(points):
            for a in range(n):
                b[a, r] = grad[r, a]
                for p in range(count):
                    b_rate_of[a, r * count + p] = b_rate[r, a * count + p]
        w_rate = _block(weight_rate, q_count, count)
        for q in range(q_count):
            for p in range(count):
                w_rate[q, p] = weight_rates[which[p], cell, q]
        np.dot(u, b, slopes)
        f_rate = _block(slope_rates, rows, points * count)
        np.dot(u, b_rate_of, f_rate)
        p_rate = _block(stress_rates, points, rows * count)
        _cell_stress_rates(
            weights[cell], w_rate, slopes, f_rate.reshape(rows, points, count), constants, stress,
            p_rate.reshape(points, rows, count),
        )  # fmt: skip
        on_rates, on_b = _block(moving, rows, n * count), _block(moved, n, rows * count)
        np.dot(stress, b_rate, on_rates)
        np.dot(b, p_rate, on_b)
        for k in range(n_steps):
            for i in range(2):
                row = 2 * k + i
                for a in range(n):
                    to = out[k, equations[near[a], i]]
                    for p in range(count):
                        to[which[p]] += on_rates[row, a * count + p] + on_b[a, row * count + p]


@nb.njit(cache=True, error_model="numpy", inline="always")
def _weighted_stress(f, by_t, by_j, x, i, out):
    """2 W_T F + W_J cof F of point ``f`` at rows ``x`` (component j) and columns ``i`` of ``out``."""
    a = 2.0 * by_t
    out[x, i], out[x + 1, i] = a * f[0] + by_j * f[3], a * f[1] - by_j * f[2]
    out[x, i + 1], out[x + 1, i + 1] = a * f[2] - by_j * f[1], a * f[3] + by_j * f[0]


@nb.njit(cache=True, error_model="numpy")
def _cell_dual_stress(weights, slopes, strain, constants, count, stresses, dual, pressures):
    """Stresses of one cell at all steps, and w (A : e + p cof F) of the adjoint strains e.

    Parameters
    ----------
    slopes : ndarray, shape (2 K, 2 q)
    strain, dual : ndarray, shape (2 q, 2 K, M)
        Adjoint strains e, with the sign of L = -adjoint . f; ``dual`` is written.
    stresses : ndarray, shape (4, 2 q, 2 K)
        Written: w P, and its derivatives with respect to C10, C01 and K.
    pressures : ndarray, shape (q, M)
        Written: sum over the steps of (J - J_c) p.
    """
    c10, c01, bulk = constants
    q_count = weights.size
    f, p, moduli = np.empty((q_count, 5)), np.empty((q_count, 4)), np.empty((q_count, 4, 4))
    pressure = np.empty(count)
    pressures[:] = 0.0
    for k in range(slopes.shape[0] // 2):
        _point_gradients(slopes, k, q_count, f)
        volume, swelling = projected_jacobian(weights, f, q_count)
        i, j = 2 * k, 2 * k + 1
        pressure[:] = 0.0
        for q in range(q_count):
            x, y, w = 2 * q, 2 * q + 1, weights[q]
            _add_pressure(
                w * bulk / volume, f[q], strain[x, i], strain[y, i], strain[x, j], strain[y, j],
                pressure,
            )  # fmt: skip
            point_moduli(f[q], bulk * swelling, c10, c01, p[q], moduli[q])
            stresses[0, x, i], stresses[0, y, i] = w * p[q, 0], w * p[q, 1]
            stresses[0, x, j], stresses[0, y, j] = w * p[q, 2], w * p[q, 3]
            t = f[q, 0] ** 2 + f[q, 1] ** 2 + f[q, 2] ** 2 + f[q, 3] ** 2
            first, first_j, second, second_j = unit_energy_gradients(t, 1.0 + f[q, 4])
            _weighted_stress(f[q], w * first, w * first_j, x, i, stresses[1])
            _weighted_stress(f[q], w * second, w * second_j, x, i, stresses[2])
            _weighted_stress(f[q], 0.0, w * swelling, x, i, stresses[3])
        for q in range(q_count):
            x, y = 2 * q, 2 * q + 1
            excess = f[q, 4] - swelling
            _add_scaled(pressures[q], excess, pressure)
            _stress_of(
                weights[q], moduli[q], f[q], pressure, strain[x, i], strain[y, i], strain[x, j],
                strain[y, j], dual[x, i], dual[y, i], dual[x, j], dual[y, j],
            )  # fmt: skip


@nb.njit(cache=True, error_model="numpy")
def add_internal_seeds(
    table, weights, constants, d, adjoint, equations, grad_bar, weight_bar, constants_bar
):
    """Transpose of ``add_internal_rates``: of L = -adjoint . f add dL/dB, dL/dw, dL/d(constants).

    Parameters
    ----------
    d : ndarray, shape (K, n, 2)
    adjoint : ndarray, shape (K, n_equations + 1, M)
        Adjoint displacements of M measures; the last row is zero.
    grad_bar, weight_bar, constants_bar : ndarray, shapes (grad.size, M), (n_cells, q, M), (3, M)
        Added to; the constants are C10, C01 and the bulk modulus.
    """
    n_steps, count = d.shape[0], adjoint.shape[2]
    rows, points = 2 * n_steps, 2 * table.group_size
    widest = _widest(table)
    displacements, turned = np.empty(rows * widest), np.empty(points * widest)
    slopes, stresses = np.empty((rows, points)), np.empty((4, points, rows))
    duals, pressures = np.empty(widest * rows * count), np.empty((table.group_size, count))
    strain, dual = np.empty((points, rows * count)), np.empty((points, rows * count))
    of_lambda, of_d = np.empty((points, count)), np.empty(widest * count)
    for cell in range(table.start.size - 1):
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        u, b, lam = (
            _block(displacements, rows, n), _block(turned, n, points),
            _block(duals, n, rows * count),
        )  # fmt: skip
        _cell_displacements(d, near, u)
        for a in range(n):
            for r in range(points):
                b[a, r] = grad[r, a]
            for k in range(n_steps):
                for i in range(2):
                    value = adjoint[k, equations[near[a], i]]
                    at = (2 * k + i) * count
                    for m in range(count):
                        lam[a, at + m] = -value[m]
        np.dot(u, b, slopes)
        np.dot(grad, lam, strain)
        _cell_dual_stress(
            weights[cell], slopes, strain.reshape(points, rows, count), constants, count, stresses,
            dual.reshape(points, rows, count), pressures,
        )  # fmt: skip
        every = strain.reshape(points * rows, count)
        constants_bar += np.dot(stresses[1:].reshape(3, points * rows), every)
        for q in range(table.group_size):
            here = slice(2 * q * rows, 2 * (q + 1) * rows)
            work = np.dot(stresses[0].reshape(points * rows)[here], every[here])
            for m in range(count):
                weight_bar[cell, q, m] += work[m] / weights[cell, q] + pressures[q, m]
        out = grad_bar[s0 * points : (s0 + n) * points]
        u_turned = np.ascontiguousarray(u.T)
        by_d = _block(of_d, n, count)
        for a in range(n):
            np.dot(stresses[0], lam[a].reshape(rows, count), of_lambda)
            for r in range(points):
                for m in range(count):
                    out[r * n + a, m] += of_lambda[r, m]
        for r in range(points):
            np.dot(u_turned, dual[r].reshape(rows, count), by_d)
            for a in range(n):
                for m in range(count):
                    out[r * n + a, m] += by_d[a, m]
