"""Products with the linearised internal force: rates (Eq. (46)), seeds (their transpose) and tangent.

Each has L of ``column_law``, the linearisation of w P in a column of cells, between rows B = grad Phi:

    rates     e = B' d
              (w P)' = L (e, w')
              f' = B^T (w P)' + B'^T w P                                          Eq. (46)
    seeds     e = -B lambda
              B_bar = w P e^T + w (L e) d^T
              w_bar = P : e + sum_h K (N_h (J - 1 + c - s_h) - n_h det(F - 1)) s_h',    s_h' at w' = 0
    tangent   e = B u,    K u = B^T w L e                                         Eq. (44)

The rows of areas follow those of the quadrature points, with w = 1 (``column_law``). In a body of
revolution B has the hoop row Phi / R and e the strain of h.

The first two are kernels of their own, matrix products of a block of load steps in every column.
"""

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.rkpm.shape_functions import grad_rows
from seal_mdao.structure.column_law import (
    contract,
    empty_law,
    law_rows,
    linearize_column,
    product,
    strain_count,
)
from seal_mdao.structure.deformation import block, group_displacements, widest_group


@compiled
def add_internal_force_rates(states, rates, weight_rates, equations, out):
    """Add f' = B^T (w P)' + B'^T w P, a'_V of Eq. (46), at K steps for P parameters to ``out``.

    Parameters
    ----------
    states : BodyStates
    rates : TableRates
        B'.
    weight_rates : ndarray, shape (P, n_columns, q)
        w'.
    equations : ndarray of int, shape (n, 2)
    out : ndarray, shape (K, n_equations + 1, P)
    """
    table, functions, d = states.table, states.functions, states.d
    q_count, n_steps, most = states.weights.shape[1], d.shape[0], out.shape[2]
    per_point, at_row = grad_rows(table), law_rows(strain_count(table))
    rows, points, widest = 2 * n_steps, per_point * table.group_size, widest_group(table)
    law, every = empty_law(table, len(functions), q_count, n_steps), np.arange(n_steps)
    displacements, turned = np.empty(rows * widest), np.empty(points * widest)
    stress, by_parameter = np.empty((rows, points)), np.empty(points * widest * most)
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
        at = per_point * rates.start[column, 1]
        b_rate = rates.grad[at : at + points * n * count].reshape(points, n * count)
        # d of the neighbours, B and B' with the neighbour first, w' of the column
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
        weights = states.weights[column]
        linearize_column(states, column, every, law)
        for k in range(n_steps):
            for q in range(table.group_size):
                # w P, rows (component, step)
                weight = weights[q] if q < q_count else 1.0
                for r in range(4):
                    weighted = weight * law.values[q, at_row.stress + r, k]
                    stress[r // 2 * n_steps + k, per_point * q + r % 2] = weighted
                if per_point == 3:
                    # of h: along the first component
                    weighted = weight * law.values[q, at_row.stress + 4, k]
                    stress[k, per_point * q + 2], stress[n_steps + k, per_point * q + 2] = (
                        weighted,
                        0.0,
                    )
        # F' = B' d
        f_rate = block(slope_rates, points * count, rows)
        np.dot(b_rate_of, u, f_rate)
        # (w P)' = L (F', w')
        p_rate = block(stress_rates, points, count * rows)
        strain, found = (
            f_rate.reshape(points, count, 2, n_steps), p_rate.reshape(points, count, 2, n_steps)
        )  # fmt: skip
        for p in range(count):
            product(law, weights, strain, w_rate, p, found)
        # f' = B'^T w P + B^T (w P)'
        on_rates, on_b = block(moving, rows, n * count), block(moved, n, count * rows)
        np.dot(stress, b_rate, on_rates)
        np.dot(b, p_rate, on_b)
        # into the equations of the free components
        for k in range(n_steps):
            for i in range(2):
                row = i * n_steps + k
                for a in range(n):
                    to = out[k, equations[near[a], i]]
                    for p in range(count):
                        to[which[p]] += on_rates[row, a * count + p] + on_b[a, p * rows + row]


# ---- seeds: the transpose, for L = -lambda . f ----


@internal
def _outer(stress, lam, dual, d, out):
    """Compute B_bar = w P e^T + w S d^T of every j at a point and every neighbour.

    (rows, 2, S) of the stresses and (n, 2, S) of the displacements give (rows n, S).
    """
    n, _, total = lam.shape
    for r in range(len(stress)):
        for a in range(n):
            for s in range(total):
                # B_bar_ja = w P_ij (-lambda_ia) + w S_ij d_ia
                out[r * n + a, s] = (
                    stress[r, 0, s] * lam[a, 0, s]
                    + stress[r, 1, s] * lam[a, 1, s]
                    + dual[r, 0, s] * d[a, 0, s]
                    + dual[r, 1, s] * d[a, 1, s]
                )


@internal
def _weight_seeds(law, at, strain, q, out):
    """Compute w_bar = P : e + sum_h K (N_h (J - 1 + c - s_h) - n_h det(F - 1)) s_h' at point ``q``."""
    change, first = law.values[q, at.change], q * (len(strain) // len(law.values))
    determinant = law.values[q, at.determinant]
    contract(law.values[q], at.stress, at.strains, strain, first, 0, out)
    for h in range(len(law.functions)):
        for s in range(out.size):
            beyond = law.functions[h, q] * (change[s] - law.volume_strain[h, s])
            beyond -= law.means[h, q] * determinant[s]
            out[s] += law.bulk[s] * beyond * law.volume_strain_rate[h, s]


@internal
def _constant_seeds(law, strain, weights, states, column, by_constants, by_pressure, step_of, out):
    """Compute the seeds on the constants c, ``out`` (C, S): sum_q w (dP/dc) : e."""
    on_f, most = np.empty(step_of.size), len(by_constants)
    at, per_point = law_rows(strain_count(states.table)), grad_rows(states.table)
    out[:] = 0.0
    for q in range(weights.size if most > 0 else 0):
        on_cof = law.on_cofactor[q]
        contract(law.values[q], at.gradient, at.strains, strain, per_point * q, 0, on_f)
        for c in range(most):
            by_t, by_j = by_constants[c, 0], by_constants[c, 1]
            for s in range(step_of.size):
                # w dP/dc : e = 2 W_Tc w F : e + W_Jc w cof F : e
                along = 2.0 * weights[q] * by_t[step_of[s], column, q] * on_f[s]
                out[c, s] += along + by_j[step_of[s], column, q] * on_cof[s]
                if per_point == 3:
                    # + W_hc w e_h
                    by_h = by_constants[c, 2, step_of[s], column, q]
                    out[c, s] += weights[q] * by_h * strain[3 * q + 2, 0, 0, s]
    for c in range(most):
        for h in range(len(law.functions)):
            for s in range(step_of.size):
                # dP/dp_h : e = V_h ds_h/dF : e = V_h s_h' at w' = 0
                rate = by_pressure[c, step_of[s], column, h] * law.volumes[h]
                out[c, s] += rate * law.volume_strain_rate[h, s]


@internal
def _add_rows(values, first, end, out, at):
    """Rows ``first`` to ``end`` of ``values``, added to those of ``out`` from ``at`` on."""
    for row in range(first, end):
        for m in range(out.shape[1]):
            out[at + row - first, m] += values[row, m]


@compiled
def add_internal_force_seeds(
    states, by_constants, by_pressure, step_of, adjoints, mix, equations, out
):
    """Add the seeds of L = -lambda . f on B, w and the constants: transpose of
    ``add_internal_force_rates``.

    Parameters
    ----------
    states : BodyStates
    by_constants, by_pressure : ndarray, shapes (C, 2, K, n_columns, q), (C, K, n_columns, m)
        d(W_T, W_J)/dc, and dp_h/dc.
    step_of : ndarray of int, shape (S,)
        Step of every adjoint, sorted.
    adjoints, mix : ndarray, shapes (n_equations + 1, S), (S, M)
        lambda of the M measures at a step is the product of both, over the columns of that step; the
        last row of ``adjoints`` is zero.
    equations : ndarray of int, shape (n, 2)
    out : tuple of ndarray, shapes (grad.size, M), (n_columns, q, M), (C, M)
        Added to.
    """
    table, functions, d, (grad_bar, weight_bar, constants_bar) = (
        states.table, states.functions, states.d, out
    )  # fmt: skip
    q_count, per_point, rows = states.weights.shape[1], grad_rows(table), 2 * d.shape[0]
    points, at_row = per_point * table.group_size, law_rows(strain_count(table))
    (total, count), widest = mix.shape, widest_group(table)
    scalars = q_count + len(by_constants)
    law, still = empty_law(table, len(functions), q_count, total), np.zeros((q_count, 1))
    displacements, strain = np.empty(rows * widest), np.empty((points, 2 * total))
    stress, dual = np.empty((points, 2, total)), np.empty((points, 2, total))
    duals, moved = np.empty(widest * 2 * total), np.empty((widest, 2, total))
    terms = np.empty((points * widest + scalars) * total)
    mixed = np.empty((points * widest + scalars) * count)
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near, weights = table.neighbours[s0 : s0 + n], states.weights[column]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        # -lambda and d of the neighbours
        u, lam = block(displacements, rows, n), block(duals, n, 2 * total)
        group_displacements(d, near, u)
        for a in range(n):
            for i in range(2):
                own = adjoints[equations[near[a], i]]
                for s in range(total):
                    lam[a, i * total + s] = -own[s]
                    moved[a, i, s] = u[2 * step_of[s] + i, a]
        # e = -B lambda,  S = L e
        np.dot(grad, lam, strain)
        linearize_column(states, column, step_of, law)
        strains, on_dual = strain.reshape(points, 1, 2, total), dual.reshape(points, 1, 2, total)
        product(law, weights, strains, still, 0, on_dual)
        size = points * n
        of_adjoints = block(terms, size + scalars, total)
        for q in range(table.group_size):
            if q < q_count:
                _weight_seeds(law, at_row, strains, q, of_adjoints[size + q])
            weight = weights[q] if q < q_count else 1.0
            for r in range(4):
                own, p = stress[per_point * q + r % 2, r // 2], law.values[q, at_row.stress + r]
                for s in range(total):
                    own[s] = weight * p[s]
            if per_point == 3:
                own, p = stress[per_point * q + 2], law.values[q, at_row.stress + 4]
                for s in range(total):
                    # of h: along the first component
                    own[0, s], own[1, s] = weight * p[s], 0.0
        _constant_seeds(
            law, strains, weights, states, column, by_constants, by_pressure, step_of,
            of_adjoints[size + q_count :],
        )  # fmt: skip
        _outer(stress, lam.reshape(n, 2, total), dual, moved, of_adjoints)
        # of the measures: lambda = Lambda C
        of_measures = block(mixed, size + scalars, count)
        np.dot(of_adjoints, mix, of_measures)
        _add_rows(of_measures, 0, size, grad_bar, s0 * points)
        _add_rows(of_measures, size, size + q_count, weight_bar[column], 0)
        _add_rows(of_measures, size + q_count, size + scalars, constants_bar, 0)


# ---- tangent ----


@compiled
def add_tangent_product(states, nodal, equations, out):
    """Add K u of the first step for displacements u of all particles, Eq. (44).

    Parameters
    ----------
    states : BodyStates
    nodal : ndarray, shape (n, 2, P)
        u.
    equations : ndarray of int, shape (n, 2)
        Row of every component.
    out : ndarray, shape (rows, P)
        Added to.
    """
    table, functions = states.table, states.functions
    q_count, points, count = (
        states.weights.shape[1], grad_rows(table) * table.group_size, nodal.shape[2]
    )  # fmt: skip
    law, first = empty_law(table, len(functions), q_count, count), np.zeros(count, np.int64)
    still, stress = np.zeros((q_count, 1)), np.empty((points, 1, 2, count))
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near, weights = table.neighbours[s0 : s0 + n], states.weights[column]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        # e = B u
        u = np.empty((n, 2 * count))
        for a in range(n):
            u[a] = nodal[near[a]].reshape(-1)
        strain = np.dot(grad, u).reshape(points, 1, 2, count)
        linearize_column(states, column, first, law)
        product(law, weights, strain, still, 0, stress)
        # K u = B^T w L e
        force = np.dot(grad.T, stress.reshape(points, 2 * count)).reshape(n, 2, count)
        for a in range(n):
            for i in range(2):
                out[equations[near[a], i]] += force[a, i]
