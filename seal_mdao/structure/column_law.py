"""Linearisation L of the internal force in a column of cells: moduli and projected pressure, Eq. (44).

With F = 1 + B d at the quadrature points q, weights w, and the projected pressure p of ``deformation``,

    P = 2 W_T F + (W_J + p) cof F,    p = K sum_h N_h s_h,    s_h = sum_q N_h w (J - 1 + c) / V_h.

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
from seal_mdao.structure.deformation import Deformation, at_point, volume_of
from seal_mdao.structure.internal_force import (
    W_H,
    W_HH,
    W_JH,
    W_TH,
    add_carried_moduli,
    carried_stress,
    hoop_moduli,
    hoop_stretch,
    piola_stress,
    plane_jacobian,
    point_moduli,
)


class BodyStates(NamedTuple):
    """The body at K converged steps.

    Attributes
    ----------
    table : ShapeTable
        B, a group for a column of cells.
    weights, functions : ndarray, shapes (n_columns, q), (m, q)
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
    values : ndarray, shape (q, rows, S)
        P, w cof F, w A, F and J - 1 + c of every point, at the rows of ``LawRows``.
    volume_strain : ndarray, shape (m, S)
        s_h.
    mean, functions : ndarray, shape (m, q)
        N_h / V_h, and N_h.
    bulk : ndarray, shape (S,)
        K.
    on_cofactor : ndarray, shape (q, S)
        Written by ``product``: w cof F : e.
    volume_strain_rate : ndarray, shape (m, S)
        Written by ``product``: s_h'.
    pressure : ndarray, shape (S,)
        Written by ``product``: p' of a point.
    """

    values: np.ndarray
    volume_strain: np.ndarray
    mean: np.ndarray
    functions: np.ndarray
    bulk: np.ndarray
    on_cofactor: np.ndarray
    volume_strain_rate: np.ndarray
    pressure: np.ndarray


class LawRows(NamedTuple):
    """First rows in ``ColumnLaw.values`` of P, w cof F, w A, F, J - 1 + c with so many ``strains``, 4
    or 5, and the number of all rows."""

    strains: int
    stress: int
    cofactor: int
    moduli: int
    gradient: int
    change: int
    count: int


@inlined
def law_rows(strains):
    """``LawRows`` of 4 strains, or of 5 in a body of revolution."""
    # P, w cof F: one row a strain;  w A: one a pair;  F;  J - 1 + c
    moduli, gradient = 2 * strains, 2 * strains + strains * strains
    return LawRows(
        strains, 0, strains, moduli, gradient, gradient + strains, gradient + strains + 1
    )


@inlined
def strain_count(table):
    """Strains of a point: 11, 12, 21, 22, and h in a body of revolution."""
    return 5 if grad_rows(table) == 3 else 4


@internal
def empty_law(table, m, count):
    """Allocate the L of a column of a ``ShapeTable`` at ``count`` states."""
    q_count, rows = table.group_size, law_rows(strain_count(table))
    return ColumnLaw(
        np.empty((q_count, rows.count, count)), np.empty((m, count)), np.empty((m, q_count)),
        np.empty((m, q_count)), np.empty(count), np.empty((q_count, count)), np.empty((m, count)),
        np.empty(count),
    )  # fmt: skip


@internal
def linearize_column(states, column, step_of, law):
    """Compute L of one column at the steps ``step_of`` (S,), sorted."""
    weights, functions = states.weights[column], states.functions
    w, strains = states.w, strain_count(states.table)
    at, moduli = law_rows(strains), np.empty((strains, strains))
    # N_h / V_h and N_h
    for h in range(len(functions)):
        volume = volume_of(functions[h], weights)
        for q in range(weights.size):
            law.mean[h, q], law.functions[h, q] = functions[h, q] / volume, functions[h, q]
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
            # the pressure acts with W_J: P = 2 W_T F + (W_J + K sum_h N_h s_h) h cof F
            f, w_t = states.deformation.f[k, column, q], w[0, k, column, q]
            volume_strain = states.deformation.volume_strain[k, column]
            w_j = w[1, k, column, q] + law.bulk[s] * at_point(functions, q, volume_strain)
            w_tt, w_tj, w_jj = w[2, k, column, q], w[3, k, column, q], w[4, k, column, q]
            # P of the energy with the pressure, A = dP/dF at fixed pressure
            stress = piola_stress(f, w_t, w_j)
            point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, moduli)
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
                sign = -weight if r == 1 or r == 2 else weight
                values[at.cofactor + r, s] = sign * f[3 - r]
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
                values[at.gradient + 4, s] = 0.0
            # w A
            for r in range(strains):
                for c in range(strains):
                    values[at.moduli + strains * r + c, s] = weights[q] * moduli[r, c]
            # J - 1 + c
            values[at.change, s] = f[4] + states.deformation.offset[k, column]


@internal
def product(law, weights, strain, weight_rate, p, out):
    """Compute L (e, w') of one column: (w P)' = w A : e + w p' cof F + w' P, with

    s_h' = sum_q N_h (w cof F : e + w' (J - 1 + c - s_h)) / V_h,    p' = K sum_h N_h s_h'.

    Parameters
    ----------
    law : ColumnLaw
    strain : ndarray, shape (rows q, P, 2, S)
        e_ij at [(point, j), p, i], two rows a point; in a body of revolution three, e_h at
        [(point, 2), p, 0].
    weight_rate : ndarray, shape (q, P)
        w'; zero gives the product with the transpose of L, for A and the pressure are symmetric.
    p : int
        The column of ``strain`` and ``weight_rate`` that is taken.
    out : ndarray, shape (rows q, P, 2, S)
        Written, as ``strain``.
    """
    law.volume_strain_rate[:] = 0.0
    rows = len(strain) // weights.size
    at = law_rows(5 if rows == 3 else 4)
    for q in range(weights.size):
        on_cof, change = law.on_cofactor[q], law.values[q, at.change]
        # w cof F : e
        contract(law.values[q], at.cofactor, at.strains, strain, rows * q, p, on_cof)
        for h in range(len(law.mean)):
            if law.mean[h, q] != 0.0:
                _add_volume_strain_rate(
                    law.mean[h, q], on_cof, weight_rate[q, p], change, law.volume_strain[h],
                    law.volume_strain_rate[h],
                )  # fmt: skip
    for q in range(weights.size):
        values, pressure = law.values[q], law.pressure
        # p' = K sum_h N_h s_h'
        pressure[:] = 0.0
        for h in range(len(law.functions)):
            _add_pressure_rate(law.bulk, law.functions[h, q], law.volume_strain_rate[h], pressure)
        for r in range(at.strains):
            found = out[rows * q + r % 2, p, r // 2] if r < 4 else out[rows * q + 2, p, 0]
            # w A : e + w p' cof F + w' P
            row = at.moduli + at.strains * r
            contract(values, row, at.strains, strain, rows * q, p, found)
            _add_stress_rate(
                values[at.cofactor + r], pressure, values[at.stress + r], weight_rate[q, p], found
            )
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
def _add_volume_strain_rate(mean, on_cof, weight_rate, change, volume_strain, out):
    """s_h' += N_h / V_h (w cof F : e + w' (J - 1 + c - s_h)), over all states."""
    for s in range(out.size):
        out[s] += mean * (on_cof[s] + weight_rate * (change[s] - volume_strain[s]))


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
