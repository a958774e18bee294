"""The transpose of ``rates`` for the adjoint method.

Of L = -lambda . f the seeds on B and w are, with the adjoint strains e = -grad lambda,

    dL/dB_ja = sum w P_ij (-lambda_ia) + w S_ij d_ia,    S = A : e + p cof F,
    dL/dw    = sum P : e + (J - J_c) p,                  p = K/V_c sum_q w cof F : e,

summed over load steps. What a few adjoints of every step give is mixed into the measures at the end.
"""

import numpy as np

from seal_mdao.compilation import compiled, internal
from seal_mdao.structure.deformation import block, cell_displacements, widest_group


@internal
def _outer(stress, lam, dual, d, out):
    """out = w P_ij (-lambda_i) + w S_ij d_i for one neighbour and one j; all (2, S) but ``out``."""
    for c in range(out.size):
        out[c] = (
            stress[0, c] * lam[0, c]
            + stress[1, c] * lam[1, c]
            + dual[0, c] * d[0, c]
            + dual[1, c] * d[1, c]
        )


@internal
def _cell_dual_stress(
    cell,
    weights,
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
    """Stresses of one cell, and w S of the adjoint strains e, a column for each adjoint.

    With the energy in T = F : F and J, w S needs F : e and cof F : e only,

        S = 2 W_T e + W_J X e + (4 W_TT F : e + 2 W_TJ cof F : e) F
            + (2 W_TJ F : e + W_JJ cof F : e + p) cof F,        X e = (e_22, -e_21, -e_12, e_11).

    Parameters
    ----------
    w_, by_constants : ndarray, shapes (5, K, n_cells, q), (C, 2, K, n_cells, q)
        Derivatives of W, and those of W_T and W_J with respect to C constants.
    bulk, bulk_row : float, int
        K of the cell and its place among the constants, -1 for none.
    strain : ndarray, shape (2 q, 2, S)
        e_ij at [(point, j), i].
    first : ndarray of int, shape (K + 1,)
        Where the adjoints of a step begin.
    stress, dual : ndarray, shape (2 q, 2, S)
        Written: w P of the adjoint's step, and w S.
    scalars : ndarray, shape (q + C, S)
        Written: dL/dw, and the derivatives of L with respect to the constants.
    """
    q_count, volume = weights.size, weights.sum()
    on_f, on_cof, own = np.empty(q_count), np.empty(q_count), np.empty((q_count, 5))
    constants = np.empty((q_count, by_constants.shape[0], 2))
    scalars[:] = 0.0
    for k in range(first.size - 1):
        f, swelling = deformation.f[k, cell], deformation.swelling[k, cell]
        # what all adjoints of the step use, side by side
        for q in range(q_count):
            for i in range(5):
                own[q, i] = w_[i, k, cell, q]
            own[q, 1] += bulk * swelling
            for m in range(by_constants.shape[0]):
                constants[q, m, 0] = by_constants[m, 0, k, cell, q]
                constants[q, m, 1] = by_constants[m, 1, k, cell, q]
        for c in range(first[k], first[k + 1]):
            pressure = 0.0
            for q in range(q_count):
                x, y = 2 * q, 2 * q + 1
                e0, e1, e2, e3 = strain[x, 0, c], strain[y, 0, c], strain[x, 1, c], strain[y, 1, c]
                on_f[q] = f[q, 0] * e0 + f[q, 1] * e1 + f[q, 2] * e2 + f[q, 3] * e3
                on_cof[q] = f[q, 3] * e0 - f[q, 2] * e1 - f[q, 1] * e2 + f[q, 0] * e3
                pressure += weights[q] * bulk / volume * on_cof[q]
            for q in range(q_count):
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
                scalars[q, c] += (f[q, 4] - swelling) * pressure
                for m in range(by_constants.shape[0]):
                    along = 2.0 * constants[q, m, 0] * on_f[q] + constants[q, m, 1] * on_cof[q]
                    scalars[q_count + m, c] += w * along
                if bulk_row >= 0:
                    scalars[q_count + bulk_row, c] += w * swelling * on_cof[q]


@internal
def _add_rows(values, first, end, out, at):
    """Rows ``first`` to ``end`` of ``values``, added to those of ``out`` from ``at`` on."""
    for row in range(first, end):
        for m in range(out.shape[1]):
            out[at + row - first, m] += values[row, m]


@compiled
def add_internal_seeds(
    table, weights, deformation, w, by_constants, bulk, bulk_row, d, first, adjoints, mix, equations,
    grad_bar, weight_bar, constants_bar,
):  # fmt: skip
    """Of L = -lambda . f add dL/dB, dL/dw, dL/d(constants) over a block of K load steps.

    Parameters
    ----------
    deformation : Deformation
        Of the block.
    w, by_constants : ndarray, shapes (5, K, n_cells, q), (C, 2, K, n_cells, q)
        Derivatives of W, and those of W_T and W_J with respect to the constants.
    bulk, bulk_row : ndarray, shape (n_cells,)
        K of the projected energy, and its row among the constants, -1 for none.
    d : ndarray, shape (K, n, 2)
    first : ndarray of int, shape (K + 1,)
        Where the adjoints of a step begin.
    adjoints : ndarray, shape (n_equations + 1, S)
        Adjoint displacements of all steps side by side; the last row is zero.
    mix : ndarray, shape (S, M)
        lambda of the M measures is ``adjoints[:, k] @ mix[k]`` with the columns k of a step.
    grad_bar, weight_bar, constants_bar : ndarray, shapes (grad.size, M), (n_cells, q, M), (C, M)
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
    for cell in range(table.start.size - 1):
        s0 = table.start[cell]
        n = table.start[cell + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        u, lam = block(displacements, rows, n), block(duals, n, 2 * total)
        cell_displacements(d, near, u)
        for a in range(n):
            for i in range(2):
                own = adjoints[equations[near[a], i]]
                for c in range(total):
                    lam[a, i * total + c] = -own[c]
                    moved[a, i, c] = u[2 * step_of[c] + i, a]
        np.dot(grad, lam, strain)
        size = points * n
        of_adjoints = block(terms, size + n_scalars, total)
        _cell_dual_stress(
            cell, weights[cell], deformation, w, by_constants, bulk[cell], bulk_row[cell],
            strain.reshape(points, 2, total), first, stress, dual, of_adjoints[size:],
        )  # fmt: skip
        by_neighbour = lam.reshape(n, 2, total)
        for r in range(points):
            for a in range(n):
                _outer(stress[r], by_neighbour[a], dual[r], moved[a], of_adjoints[r * n + a])
        of_measures = block(mixed, size + n_scalars, count)
        np.dot(of_adjoints, mix, of_measures)
        _add_rows(of_measures, 0, size, grad_bar, s0 * points)
        _add_rows(of_measures, size, size + q_count, weight_bar[cell], 0)
        _add_rows(of_measures, size + q_count, size + n_scalars, constants_bar, 0)
