"""The transpose of ``rates`` for the adjoint method.

Of L = -lambda . f the seeds on B and w are, with the adjoint strains e = -grad lambda,

    dL/dB_ja = sum w P_ij (-lambda_ia) + w S_ij d_ia,    S = A : e + p cof F,
    dL/dw    = sum P : e + sum_h N_h (det F - 1 - s_h) p_h,

    p = sum_h N_h p_h,    p_h = K/V_h sum_q N_h w cof F : e    (``pressure``),

summed over load steps. What a few adjoints of every step give is mixed into the measures at the end.
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


@internal
def _outer(stress, lam, dual, d, out):
    """out = w P_ij (-lambda_i) + w S_ij d_i of every j at a point and every neighbour: (rows, 2, S) of
    the stresses and (n, 2, S) of the others give (rows n, S)."""
    n, _, total = lam.shape
    for r in range(len(stress)):
        for a in range(n):
            for c in range(total):
                out[r * n + a, c] = (
                    stress[r, 0, c] * lam[a, 0, c]
                    + stress[r, 1, c] * lam[a, 1, c]
                    + dual[r, 0, c] * d[a, 0, c]
                    + dual[r, 1, c] * d[a, 1, c]
                )


@internal
def _dual_stress(
    column,
    weights,
    functions,
    deformation,
    w_,
    by_constants,
    bulk,
    bulk_row,
    strain,
    first,
    stress,
    dual,
    scalars,
):
    """Stresses of one column of cells, and w S of the adjoint strains e, a column for each adjoint.

    With the energy in T = F : F and J, w S needs F : e and cof F : e only,

        S = 2 W_T e + W_J X e + (4 W_TT F : e + 2 W_TJ cof F : e) F
            + (2 W_TJ F : e + W_JJ cof F : e + p) cof F,        X e = (e_22, -e_21, -e_12, e_11).

    Parameters
    ----------
    w_, by_constants : ndarray, shapes (5, K, n_columns, q), (C, 2, K, n_columns, q)
        Derivatives of W, and those of W_T and W_J with respect to C constants.
    bulk, bulk_row : float, int
        K of the column and its place among the constants, -1 for none.
    strain : ndarray, shape (2 q, 2, S)
        e_ij at [(point, j), i].
    first : ndarray of int, shape (K + 1,)
        Where the adjoints of a step begin.
    stress, dual : ndarray, shape (2 q, 2, S)
        Written: w P of the adjoint's step, and w S.
    scalars : ndarray, shape (q + C, S)
        Written: dL/dw, and the derivatives of L with respect to the constants.
    """
    q_count, n_functions = weights.size, len(functions)
    on_f, on_cof, own = np.empty(q_count), np.empty(q_count), np.empty((q_count, 5))
    projected, shares = np.empty(q_count), np.empty(functions.shape)
    pressures = np.empty(n_functions)
    for h in range(n_functions):
        volume = volume_of(functions[h], weights)
        for q in range(q_count):
            shares[h, q] = functions[h, q] * weights[q] * bulk / volume
    constants = np.empty((q_count, by_constants.shape[0], 2))
    scalars[:] = 0.0
    for k in range(first.size - 1):
        f, swelling = deformation.f[k, column], deformation.swelling[k, column]
        # what all adjoints of the step use, side by side
        for q in range(q_count):
            for i in range(5):
                own[q, i] = w_[i, k, column, q]
            projected[q] = at_point(functions, q, swelling)
            own[q, 1] += bulk * projected[q]
            for m in range(by_constants.shape[0]):
                constants[q, m, 0] = by_constants[m, 0, k, column, q]
                constants[q, m, 1] = by_constants[m, 1, k, column, q]
        for c in range(first[k], first[k + 1]):
            for q in range(q_count):
                x, y = 2 * q, 2 * q + 1
                e0, e1, e2, e3 = strain[x, 0, c], strain[y, 0, c], strain[x, 1, c], strain[y, 1, c]
                on_f[q] = f[q, 0] * e0 + f[q, 1] * e1 + f[q, 2] * e2 + f[q, 3] * e3
                on_cof[q] = f[q, 3] * e0 - f[q, 2] * e1 - f[q, 1] * e2 + f[q, 0] * e3
            for h in range(n_functions):
                pressures[h] = 0.0
                for q in range(q_count):
                    pressures[h] += shares[h, q] * on_cof[q]
            for q in range(q_count):
                pressure = at_point(functions, q, pressures)
                x, y, w = 2 * q, 2 * q + 1, weights[q]
                e0, e1, e2, e3 = strain[x, 0, c], strain[y, 0, c], strain[x, 1, c], strain[y, 1, c]
                f0, f1, f2, f3 = f[q, 0], f[q, 1], f[q, 2], f[q, 3]
                by_t, by_j = own[q, 0], own[q, 1]
                by_tt, by_tj, by_jj = own[q, 2], own[q, 3], own[q, 4]
                stress[x, 0, c] = w * (2.0 * by_t * f0 + by_j * f3)
                stress[y, 0, c] = w * (2.0 * by_t * f1 - by_j * f2)
                stress[x, 1, c] = w * (2.0 * by_t * f2 - by_j * f1)
                stress[y, 1, c] = w * (2.0 * by_t * f3 + by_j * f0)
                along_f = 4.0 * by_tt * on_f[q] + 2.0 * by_tj * on_cof[q]
                along_cof = 2.0 * by_tj * on_f[q] + by_jj * on_cof[q] + pressure
                dual[x, 0, c] = w * (2.0 * by_t * e0 + by_j * e3 + along_f * f0 + along_cof * f3)
                dual[y, 0, c] = w * (2.0 * by_t * e1 - by_j * e2 + along_f * f1 - along_cof * f2)
                dual[x, 1, c] = w * (2.0 * by_t * e2 - by_j * e1 + along_f * f2 - along_cof * f1)
                dual[y, 1, c] = w * (2.0 * by_t * e3 + by_j * e0 + along_f * f3 + along_cof * f0)
                scalars[q, c] = 2.0 * by_t * on_f[q] + by_j * on_cof[q]
                for h in range(n_functions):
                    scalars[q, c] += functions[h, q] * (f[q, 4] - swelling[h]) * pressures[h]
                for m in range(by_constants.shape[0]):
                    along = 2.0 * constants[q, m, 0] * on_f[q] + constants[q, m, 1] * on_cof[q]
                    scalars[q_count + m, c] += w * along
                if bulk_row >= 0:
                    scalars[q_count + bulk_row, c] += w * projected[q] * on_cof[q]


@internal
def _add_rows(values, first, end, out, at):
    """Rows ``first`` to ``end`` of ``values``, added to those of ``out`` from ``at`` on."""
    for row in range(first, end):
        for m in range(out.shape[1]):
            out[at + row - first, m] += values[row, m]


@compiled
def add_internal_seeds(
    table, weights, functions, deformation, w, by_constants, bulk, bulk_row, d, first, adjoints, mix,
    equations, grad_bar, weight_bar, constants_bar,
):  # fmt: skip
    """Of L = -lambda . f add dL/dB, dL/dw, dL/d(constants) over a block of K load steps.

    Parameters
    ----------
    weights, functions : ndarray, shapes (n_columns, q), (m, q)
        Of the quadrature, and of the pressure.
    deformation : Deformation
        Of the block.
    w, by_constants : ndarray, shapes (5, K, n_columns, q), (C, 2, K, n_columns, q)
        Derivatives of W, and those of W_T and W_J with respect to the constants.
    bulk, bulk_row : ndarray, shape (n_columns,)
        K of the projected energy, and its row among the constants, -1 for none.
    d : ndarray, shape (K, n, 2)
    first : ndarray of int, shape (K + 1,)
        Where the adjoints of a step begin.
    adjoints : ndarray, shape (n_equations + 1, S)
        Adjoint displacements of all steps side by side; the last row is zero.
    mix : ndarray, shape (S, M)
        lambda of the M measures is ``adjoints[:, k] @ mix[k]`` with the columns k of a step.
    grad_bar, weight_bar, constants_bar : ndarray, shapes (grad.size, M), (n_columns, q, M), (C, M)
        Added to.
    """
    q_count, rows, points = table.group_size, 2 * d.shape[0], 2 * table.group_size
    total, count = mix.shape
    n_scalars = q_count + by_constants.shape[0]
    step_of = np.empty(total, np.int64)
    for k in range(first.size - 1):
        step_of[first[k] : first[k + 1]] = k
    widest = widest_group(table)
    displacements, strain = np.empty(rows * widest), np.empty((points, 2 * total))
    stress, dual = np.empty((points, 2, total)), np.empty((points, 2, total))
    duals, moved = np.empty(widest * 2 * total), np.empty((widest, 2, total))
    terms = np.empty((points * widest + n_scalars) * total)
    mixed = np.empty((points * widest + n_scalars) * count)
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        u, lam = block(displacements, rows, n), block(duals, n, 2 * total)
        group_displacements(d, near, u)
        for a in range(n):
            for i in range(2):
                own = adjoints[equations[near[a], i]]
                for c in range(total):
                    lam[a, i * total + c] = -own[c]
                    moved[a, i, c] = u[2 * step_of[c] + i, a]
        np.dot(grad, lam, strain)
        size = points * n
        of_adjoints = block(terms, size + n_scalars, total)
        _dual_stress(
            column, weights[column], functions, deformation, w, by_constants, bulk[column],
            bulk_row[column], strain.reshape(points, 2, total), first, stress, dual, of_adjoints[size:],
        )  # fmt: skip
        _outer(stress, lam.reshape(n, 2, total), dual, moved, of_adjoints)
        of_measures = block(mixed, size + n_scalars, count)
        np.dot(of_adjoints, mix, of_measures)
        _add_rows(of_measures, 0, size, grad_bar, s0 * points)
        _add_rows(of_measures, size, size + q_count, weight_bar[column], 0)
        _add_rows(of_measures, size + q_count, size + n_scalars, constants_bar, 0)
