"""Linearisation L of the internal force in a column of cells: moduli and projected pressure, Eq. (44).

With F = 1 + B d at the quadrature points q, weights w, and the projected pressure p of ``deformation``,

    P = 2 W_T F + (W_J + p) cof F - p_c (cof F - 1),    p = K sum_h N_h s_h,    p_c = K sum_h n_h s_h,
    V_h (s_h - c) = sum_q (N_h w (J - 1) - n_h w det(F - 1)) + sum_t n_h det G_t.

The rows of areas are points with F = G, P = p_c cof G and w = 1.
L = d(w P)/dF is a block of the column: the moduli A = dP/dF of every point, and what the pressure
adds, of rank m. Both are symmetric, so that one product with strains e serves a tangent (e = B u), the
rates of the direct method (e = B' d) and the seeds of the adjoint method (e = -B lambda): see
``force_products``.

In plane strain J = det F. In a body of revolution the strains e have a fifth component, that of h, in a
third row of every point of which only the first component counts; cof F becomes (h cof F, det F), the
derivatives of J = h det F.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import inlined, internal
from seal_mdao.rkpm.shape_functions import ShapeTable, grad_rows
from seal_mdao.structure.deformation import (
    Deformation,
    at_point,
    cell_mean,
    gradient_determinant,
    plane_jacobian,
    volume_of,
)
from seal_mdao.structure.internal_force import (
    W_H,
    W_HH,
    W_JH,
    W_TH,
    add_carried_moduli,
    carried_stress,
    hoop_moduli,
    hoop_stretch,
    mean_pressure,
    piola_stress,
    point_moduli,
    remove_quadratic_moduli,
    without_quadratic,
)


class BodyStates(NamedTuple):
    """The body at K converged steps.

    Attributes
    ----------
    table : ShapeTable
        B, a group for a column of cells, with the rows of areas.
    weights, functions : ndarray, shapes (n_columns, q), (m, q + t)
        Of the quadrature, and of the pressure.
    bulk : ndarray, shape (K, n_columns)
        K of the projected energy.
    d : ndarray, shape (K, n, 2)
    deformation : Deformation
    w : ndarray, shape (5 or 9, K, n_columns, q)
        W_T, W_J, W_TT, W_TJ, W_JJ; in a body of revolution also W_h, W_Th, W_Jh, W_hh.
    carried : ndarray, shape (K, n_columns, q, 3 or 4), or empty
        H of a body that relaxes.
    """

    table: ShapeTable
    weights: np.ndarray
    functions: np.ndarray
    bulk: np.ndarray
    d: np.ndarray
    deformation: Deformation
    w: np.ndarray
    carried: np.ndarray


class ColumnLaw(NamedTuple):
    """L of a column of cells at S states side by side.

    Attributes
    ----------
    values : ndarray, shape (q + t, rows, S)
        P, w cof F, w (cof F - 1), w A, F, J - 1 + c and det(F - 1) of every quadrature point, at the
        rows of ``LawRows``; P, cof G and p_c of the rows of areas, the last in the first row of w A.
    volume_strain : ndarray, shape (m, S)
        s_h.
    functions : ndarray, shape (m, q + t)
        N_h, and n_h at the rows of areas.
    means : ndarray, shape (m, q)
        n_h.
    volumes : ndarray, shape (m,)
        V_h.
    bulk : ndarray, shape (S,)
        K.
    on_cofactor : ndarray, shape (q + t, S)
        Written by ``product``: w cof F : e.
    on_quadratic : ndarray, shape (q, S)
        Written by ``product``: w (cof F - 1) : e.
    volume_strain_rate : ndarray, shape (m, S)
        Written by ``product``: s_h'.
    pressure : ndarray, shape (S,)
        Written by ``product``: p' or p_c' of a point.
    """

    values: np.ndarray
    volume_strain: np.ndarray
    functions: np.ndarray
    means: np.ndarray
    volumes: np.ndarray
    bulk: np.ndarray
    on_cofactor: np.ndarray
    on_quadratic: np.ndarray
    volume_strain_rate: np.ndarray
    pressure: np.ndarray


class LawRows(NamedTuple):
    """First rows in ``ColumnLaw.values`` of P, w cof F, w (cof F - 1), w A, F, J - 1 + c, det(F - 1)
    with so many ``strains``, 4 or 5, and the number of all rows."""

    strains: int
    stress: int
    cofactor: int
    quadratic: int
    moduli: int
    gradient: int
    change: int
    determinant: int
    count: int


@inlined
def law_rows(strains):
    """``LawRows`` of 4 strains, or of 5 in a body of revolution."""
    # P, w cof F, w (cof F - 1), F: one row a strain;  w A: one a pair
    moduli, gradient = 3 * strains, 3 * strains + strains * strains
    change = gradient + strains
    return LawRows(
        strains, 0, strains, 2 * strains, moduli, gradient, change, change + 1, change + 2
    )


@inlined
def strain_count(table):
    """Strains of a point: 11, 12, 21, 22, and h in a body of revolution."""
    return 5 if grad_rows(table) == 3 else 4


@internal
def empty_law(table, m, q_count, count):
    """Allocate the L of a column of a ``ShapeTable`` with ``q_count`` quadrature points at ``count``
    states."""
    points, rows = table.group_size, law_rows(strain_count(table))
    # what the rows of areas do not have is zero
    return ColumnLaw(
        np.zeros((points, rows.count, count)), np.empty((m, count)), np.empty((m, points)),
        np.empty((m, q_count)), np.empty(m), np.empty(count), np.empty((points, count)),
        np.empty((q_count, count)), np.empty((m, count)), np.empty(count),
    )  # fmt: skip


@internal
def linearize_column(states, column, step_of, law):
    """Compute L of one column at the steps ``step_of`` (S,), sorted."""
    weights, functions = states.weights[column], states.functions
    w, strains = states.w, strain_count(states.table)
    at, moduli = law_rows(strains), np.empty((strains, strains))
    # N_h, n_h and V_h
    for h in range(len(functions)):
        law.volumes[h] = volume_of(functions[h], weights)
        for q in range(functions.shape[1]):
            law.functions[h, q] = functions[h, q]
        for q in range(weights.size):
            law.means[h, q] = cell_mean(functions, h, q, weights.size)
    for s in range(step_of.size):
        law.bulk[s] = states.bulk[step_of[s], column]
        for h in range(len(functions)):
            law.volume_strain[h, s] = states.deformation.volume_strain[step_of[s], column, h]
    for q in range(weights.size):
        values = law.values[q]
        for s in range(step_of.size):
            k = step_of[s]
            # another column of the same step
            if s > 0 and step_of[s - 1] == k:
                for row in range(at.count):
                    values[row, s] = values[row, s - 1]
                continue
            # P = 2 W_T F + (W_J + p) h cof F - p_c (cof F - 1)
            f, w_t = states.deformation.f[k, column, q], w[0, k, column, q]
            volume_strain = states.deformation.volume_strain[k, column]
            w_j = w[1, k, column, q] + law.bulk[s] * at_point(functions, q, volume_strain)
            of_cell = law.bulk[s] * mean_pressure(functions, q, weights.size, volume_strain)
            w_tt, w_tj, w_jj = w[2, k, column, q], w[3, k, column, q], w[4, k, column, q]
            # P of the energy with the pressure, A = dP/dF at fixed pressure
            stress = without_quadratic(piola_stress(f, w_t, w_j), f, of_cell)
            point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, moduli)
            remove_quadratic_moduli(of_cell, moduli)
            if states.carried.size:
                # of a body that relaxes P += F H,  A += d(F H)/dF
                own = states.carried[k, column, q]
                more = carried_stress(f, own)
                stress = (
                    stress[0] + more[0], stress[1] + more[1], stress[2] + more[2],
                    stress[3] + more[3],
                )  # fmt: skip
                add_carried_moduli(own, moduli)
            # w h cof F: cof F = (F_22, -F_21, -F_12, F_11)
            weight = weights[q] * hoop_stretch(f)
            for r in range(4):
                values[at.stress + r, s], values[at.gradient + r, s] = stress[r], f[r]
                sign = -1.0 if r == 1 or r == 2 else 1.0
                values[at.cofactor + r, s] = sign * weight * f[3 - r]
                # w (cof F - 1)
                own = 1.0 if r == 0 or r == 3 else 0.0
                values[at.quadratic + r, s] = weights[q] * (sign * f[3 - r] - own)
            if strains == 5:
                w_th, w_jh, w_hh = (
                    w[W_TH, k, column, q],
                    w[W_JH, k, column, q],
                    w[W_HH, k, column, q],
                )
                hoop_moduli(f, w_j, w_th, w_jh, w_hh, moduli)
                # P_h = W_h + W_J det F,  J_h = det F
                values[at.stress + 4, s] = w[W_H, k, column, q] + w_j * plane_jacobian(f)
                if states.carried.size:
                    values[at.stress + 4, s] += f[5] * states.carried[k, column, q, 3]
                values[at.cofactor + 4, s] = weights[q] * plane_jacobian(f)
                values[at.gradient + 4, s], values[at.quadratic + 4, s] = 0.0, 0.0
            # w A
            for r in range(strains):
                for c in range(strains):
                    values[at.moduli + strains * r + c, s] = weights[q] * moduli[r, c]
            # J - 1 + c
            values[at.change, s] = f[4] + states.deformation.offset[k, column]
            values[at.determinant, s] = gradient_determinant(f)
    for t in range(weights.size, functions.shape[1]):
        values = law.values[t]
        for s in range(step_of.size):
            k = step_of[s]
            volume_strain = states.deformation.volume_strain[k, column]
            of_cell = law.bulk[s] * at_point(functions, t, volume_strain)
            g = states.deformation.areas[k, column, t - weights.size]
            for r in range(4):
                # P = p_c cof G
                sign = -1.0 if r == 1 or r == 2 else 1.0
                values[at.cofactor + r, s] = sign * g[3 - r]
                values[at.stress + r, s] = of_cell * sign * g[3 - r]
            values[at.moduli, s] = of_cell


@internal
def product(law, weights, strain, weight_rate, p, out):
    """Compute L (e, w') of one column: (w P)' = w A : e + w p' cof F - w p_c' (cof F - 1) + w' P, with

    V_h s_h' = sum_q (N_h w cof F - n_h w (cof F - 1)) : e + sum_t n_h cof G : e + r_h',
    r_h' = sum_q w' (N_h (J - 1 + c - s_h) - n_h det(F - 1)),
    p' = K sum_h N_h s_h',    p_c' = K sum_h n_h s_h'.

    Parameters
    ----------
    law : ColumnLaw
    strain : ndarray, shape (rows (q + t), P, 2, S)
        e_ij at [(point, j), p, i], two rows a point; in a body of revolution three, e_h at
        [(point, 2), p, 0].
    weight_rate : ndarray, shape (q, P)
        w'; zero gives the product with the transpose of L, for A and the pressure are symmetric.
    p : int
        The column of ``strain`` and ``weight_rate`` that is taken.
    out : ndarray, shape (rows (q + t), P, 2, S)
        Written, as ``strain``.
    """
    law.volume_strain_rate[:] = 0.0
    points = law.functions.shape[1]
    rows = len(strain) // points
    at = law_rows(5 if rows == 3 else 4)
    for q in range(points):
        on_cof = law.on_cofactor[q]
        # w cof F : e
        contract(law.values[q], at.cofactor, at.strains, strain, rows * q, p, on_cof)
        for h in range(len(law.functions)):
            if law.functions[h, q] != 0.0:
                share = law.functions[h, q] / law.volumes[h]
                _add_product(share, on_cof, law.volume_strain_rate[h])
    for q in range(weights.size):
        on_quadratic, values = law.on_quadratic[q], law.values[q]
        # - w (cof F - 1) : e
        contract(values, at.quadratic, at.strains, strain, rows * q, p, on_quadratic)
        for h in range(len(law.functions)):
            if law.means[h, q] == 0.0:
                # a function of other cells
                continue
            share = law.means[h, q] / law.volumes[h]
            _add_product(-share, on_quadratic, law.volume_strain_rate[h])
            if weight_rate[q, p] != 0.0:
                # w' (N_h (J - 1 + c - s_h) - n_h det(F - 1))
                rate = weight_rate[q, p] * law.functions[h, q] / law.volumes[h]
                _add_product(rate, values[at.change], law.volume_strain_rate[h])
                _add_product(-rate, law.volume_strain[h], law.volume_strain_rate[h])
                rate = weight_rate[q, p] * share
                _add_product(-rate, values[at.determinant], law.volume_strain_rate[h])
    for q in range(points):
        values, pressure = law.values[q], law.pressure
        # p' = K sum_h N_h s_h'; p_c' at the rows of areas
        pressure[:] = 0.0
        for h in range(len(law.functions)):
            _add_pressure_rate(law.bulk, law.functions[h, q], law.volume_strain_rate[h], pressure)
        if q < weights.size:
            for r in range(at.strains):
                found = out[rows * q + r % 2, p, r // 2] if r < 4 else out[rows * q + 2, p, 0]
                # w A : e + w p' cof F + w' P
                row = at.moduli + at.strains * r
                contract(values, row, at.strains, strain, rows * q, p, found)
                _add_stress_rate(
                    values[at.cofactor + r], pressure, values[at.stress + r], weight_rate[q, p],
                    found,
                )  # fmt: skip
            # - w p_c' (cof F - 1), p_c' = K sum_h n_h s_h'
            pressure[:] = 0.0
            for h in range(len(law.functions)):
                _add_pressure_rate(law.bulk, -law.means[h, q], law.volume_strain_rate[h], pressure)
            for r in range(4):
                found = out[rows * q + r % 2, p, r // 2]
                _add_products(pressure, values[at.quadratic + r], found)
        else:
            for r in range(4):
                # p_c d(cof G)/dG : e + p_c' cof G
                found, other = out[rows * q + r % 2, p, r // 2], 3 - r
                sign, own = -1.0 if r == 1 or r == 2 else 1.0, values[at.moduli]
                strains = strain[rows * q + other % 2, p, other // 2]
                for s in range(found.size):
                    found[s] = sign * own[s] * strains[s]
                _add_products(pressure, values[at.cofactor + r], found)
            for s in range(pressure.size if rows == 3 else 0):
                out[rows * q + 2, p, 0, s] = 0.0
        if rows == 3:
            # no strain
            out[rows * q + 2, p, 1, :] = 0.0


@internal
def contract(values, row, strains, strain, first, p, out):
    """Contract ``strains`` rows of ``values``, from ``row`` on, with the strains of a point, whose rows
    of ``strain`` begin at ``first``."""
    # a : e = a_11 e_11 + a_12 e_12 + a_21 e_21 + a_22 e_22
    a0, a1, a2, a3 = values[row], values[row + 1], values[row + 2], values[row + 3]
    e0, e1 = strain[first, p, 0], strain[first + 1, p, 0]
    e2, e3 = strain[first, p, 1], strain[first + 1, p, 1]
    for s in range(out.size):
        out[s] = a0[s] * e0[s] + a1[s] * e1[s] + a2[s] * e2[s] + a3[s] * e3[s]
    if strains == 5:
        a4, e4 = values[row + 4], strain[first + 2, p, 0]
        for s in range(out.size):
            # + a_h e_h
            out[s] += a4[s] * e4[s]


@internal
def _add_products(factors, values, out):
    """Add products of two factors, over all states."""
    for s in range(out.size):
        out[s] += factors[s] * values[s]


@internal
def _add_product(factor, values, out):
    """Add a factor times values, over all states."""
    for s in range(out.size):
        out[s] += factor * values[s]


@internal
def _add_pressure_rate(bulk, function, volume_strain_rate, out):
    """p' += K N_h s_h', over all states."""
    for s in range(out.size):
        out[s] += bulk[s] * function * volume_strain_rate[s]


@internal
def _add_stress_rate(cofactor, pressure, stress, weight_rate, out):
    """out += w p' cof F + w' P of one component, over all states."""
    for s in range(out.size):
        out[s] += cofactor[s] * pressure[s] + stress[s] * weight_rate
