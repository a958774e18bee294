"""Internal force and tangent of the structural form a(z, z-bar) and a*(z; dz, z-bar), Eqs. (43), (44).

They are the exact first and second derivatives of the energy of ``deformation``. The kernels know no
material: they take the derivatives of W(T, J) at the quadrature points as arrays. In a body of
revolution the strains have h as a fifth component, with the hoop row Phi / R of the table, and
W(T, J, h) has more derivatives (``materials.hoop_stretch``):

    P = 2 W_T F + W_J h cof F,    P_h = W_h + W_J det F,    J = h det F.

The pressure p = K sum_h N_h s_h, of mean p_c = K sum_h n_h s_h in a cell, acts by the volume strain of
``deformation``,

    P = 2 W_T F + (W_J + p) h cof F - p_c (cof F - 1),    p_c cof G of the rows of areas,

which is p 1 at the points of a cell with one pressure in plane strain.
"""

import math

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.rkpm.shape_functions import grad_rows
from seal_mdao.structure.deformation import (
    at_point,
    cell_mean,
    plane_jacobian,
    volume_of,
    widest_group,
)

# Rows of the derivatives of W that only bodies of revolution have.
W_H, W_TH, W_JH, W_HH = 5, 6, 7, 8


@inlined
def hoop_stretch(f):
    """h of a point, 1 in plane strain."""
    return f[5] if f.size == 6 else 1.0


@inlined
def piola_stress(f, w_t, w_j):
    """First Piola-Kirchhoff stress P = 2 W_T F + W_J h cof F: 11, 12, 21, 22."""
    on_cofactor = w_j * hoop_stretch(f)
    return (
        2.0 * w_t * f[0] + on_cofactor * f[3],
        2.0 * w_t * f[1] + on_cofactor * -f[2],
        2.0 * w_t * f[2] + on_cofactor * -f[1],
        2.0 * w_t * f[3] + on_cofactor * f[0],
    )


@inlined
def mean_pressure(functions, q, q_count, values):
    """sum_h n_h v_h of the cell of a point."""
    value = 0.0
    for h in range(values.size):
        value += cell_mean(functions, h, q, q_count) * values[h]
    return value


@inlined
def without_quadratic(stress, f, pressure):
    """P - p_c (cof F - 1): the derivative of what ``deformation`` leaves out, - p_c w det(F - 1)."""
    return (
        stress[0] - pressure * (f[3] - 1.0), stress[1] + pressure * f[2],
        stress[2] + pressure * f[1], stress[3] - pressure * (f[0] - 1.0),
    )  # fmt: skip


@internal
def remove_quadratic_moduli(pressure, a):
    """Remove p_c d(cof F)/dF from the moduli ``a``."""
    a[0, 3] -= pressure
    a[3, 0] -= pressure
    a[1, 2] += pressure
    a[2, 1] += pressure


@inlined
def carried_stress(f, carried):
    """Stress F H of the stress ``carried`` (11, 22, 12, and 33 with h): 11, 12, 21, 22."""
    return (
        f[0] * carried[0] + f[1] * carried[2],
        f[0] * carried[2] + f[1] * carried[1],
        f[2] * carried[0] + f[3] * carried[2],
        f[2] * carried[2] + f[3] * carried[1],
    )


@internal
def add_carried_moduli(carried, a):
    """Add d(F H)/dF = delta_ik H_jl, and H_33 of h, to the moduli ``a``."""
    for r in range(2):
        a[2 * r, 2 * r] += carried[0]
        a[2 * r + 1, 2 * r + 1] += carried[1]
        a[2 * r, 2 * r + 1] += carried[2]
        a[2 * r + 1, 2 * r] += carried[2]
    if len(a) == 5:
        a[4, 4] += carried[3]


@internal
def hoop_moduli(f, w_j, w_th, w_jh, w_hh, a):
    """Row and column of h in the moduli ``a`` (5, 5) at fixed pressure, which ``w_j`` contains."""
    # A_Fh = 2 W_Th F + (W_Jh h + W_J) cof F + det F (2 W_TJ F + W_JJ h cof F)
    # A_hh = W_hh + 2 W_Jh det F + W_JJ (det F)^2
    # the terms of W_TJ and W_JJ are those of dJ/dh = det F, see ``point_moduli``
    cof, det = (f[3], -f[2], -f[1], f[0]), plane_jacobian(f)
    for r in range(4):
        a[r, 4] += 2.0 * w_th * f[r] + (w_jh * f[5] + w_j) * cof[r]
        a[4, r] = a[r, 4]
    a[4, 4] += w_hh + 2.0 * w_jh * det


@internal
def point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a):
    """Moduli A = dP/dF in ``a`` (4, 4) at fixed pressure, which ``w_j`` contains; (5, 5) in a body of
    revolution, to which ``hoop_moduli`` adds what W_h does."""
    # A = 2 W_T 1 + 4 W_TT F F + 2 W_TJ (F J_F + J_F F) + W_JJ J_F J_F + W_J d(J_F)/dF, J_F = h cof F
    h = hoop_stretch(f)
    cof = (h * f[3], -h * f[2], -h * f[1], h * f[0])
    w_j = h * w_j
    for r in range(4):
        for c in range(4):
            a[r, c] = 2.0 * w_tj * (f[r] * cof[c] + cof[r] * f[c]) + w_jj * cof[r] * cof[c]
            a[r, c] += 4.0 * w_tt * f[r] * f[c]
        a[r, r] += 2.0 * w_t
    # d(cof F)/dF: 11 with 22, 12 with 21
    a[0, 3] += w_j
    a[3, 0] += w_j
    a[1, 2] -= w_j
    a[2, 1] -= w_j
    if len(a) == 5:
        # J_h = det F beside J_F
        det = plane_jacobian(f)
        for r in range(4):
            a[r, 4] = det * (2.0 * w_tj * f[r] + w_jj * cof[r])
        a[4, 4] = w_jj * det * det


@internal
def _moduli_rows(weight, a, b, n, c, first):
    """weight A B of one quadrature point in as many rows of ``c`` from ``first`` on as ``a`` has: 11,
    12, 21, 22 or h; columns x then y."""
    for r in range(len(a)):  # not range(4): unrolled there is twice as much to compile
        # w A B, the two components of B side by side
        ax0, ax1 = weight * a[r, 0], weight * a[r, 1]
        ay0, ay1 = weight * a[r, 2], weight * a[r, 3]
        row, b0, b1 = c[first + r], b[0], b[1]
        for j in range(n):
            row[j] = ax0 * b0[j] + ax1 * b1[j]
        for j in range(n):
            row[n + j] = ay0 * b0[j] + ay1 * b1[j]
        if len(b) == 3:
            for j in range(n):
                # w A_rh Phi_I / R
                row[j] += weight * a[r, 4] * b[2, j]


@inlined
def _of_four_points(b, c, first, j):
    """Entry ``j`` of a row of sum_q B^T (w A B) of four points: ``b`` their gradients at the row's
    neighbour, ``c`` of ``_moduli_rows`` from the row ``first`` of the first point on."""
    return (
        b[0] * c[first, j] + b[1] * c[first + 1, j]
        + b[2] * c[first + 4, j] + b[3] * c[first + 5, j]
        + b[4] * c[first + 8, j] + b[5] * c[first + 9, j]
        + b[6] * c[first + 12, j] + b[7] * c[first + 13, j]
    )  # fmt: skip


@inlined
def _fill_row(grad, c, g, i, a, row):
    """Row (component i, neighbour a) of sum_h g_h g_h^T + sum_q B^T (w A B), a function and four points
    at a time. Beyond the last function ``g`` is zero, beyond the last point ``c``."""
    count, _, n = grad.shape
    for k in range(len(g)):
        p, q, r, s = 4 * k, 4 * k + 1, 4 * k + 2, 4 * k + 3
        if s >= count:
            p, q, r, s = p % count, q % count, r % count, s % count
        b = (
            grad[p, 0, a], grad[p, 1, a], grad[q, 0, a], grad[q, 1, a],
            grad[r, 0, a], grad[r, 1, a], grad[s, 0, a], grad[s, 1, a],
        )  # fmt: skip
        first, own = 16 * k + 2 * i, g[k, i * n + a]
        if k == 0:  # writing is a tenth faster than adding to zero
            for j in range(row.size):
                row[j] = own * g[k, j] + _of_four_points(b, c, first, j)
        else:
            for j in range(row.size):
                row[j] += own * g[k, j] + _of_four_points(b, c, first, j)


@internal
def _scatter_tangent(grad, c, hoop, g, area_stiffness, buffer, slots, values):
    """Add sum_q B^T (w A B) + sum_h g_h g_h^T of one column of cells to the tangent, with the rows
    ``hoop`` (q, 2 n) of w A B of h in a body of revolution, and ``area_stiffness`` (n, n), the
    antisymmetric block of u_x and u_y.

    The matrix is symmetric: its rows are added as columns, which lie together in memory; computing
    one triangle only is slower, for the scatter then strides. The last term is the projected
    pressure's, with g_h = sqrt(K / V_h) V_h ds_h/dd.
    """
    n = grad.shape[2]
    row = buffer[: 2 * n]
    for i in range(2):
        for a in range(n):
            _fill_row(grad, c, g, i, a, row)
            if i == 0:
                for q in range(len(hoop)):
                    for j in range(row.size):
                        # Phi_I / R (w A_h B)
                        row[j] += grad[q, 2, a] * hoop[q, j]
            # K_xy = C,  K_yx = C^T = -C
            sign = 1.0 if i == 0 else -1.0
            beside = row[n:] if i == 0 else row[:n]
            for j in range(n):
                beside[j] += sign * area_stiffness[a, j]
            first = (i * n + a) * row.size
            for j in range(row.size):
                values[slots[first + j]] += row[j]


@internal
def _fill_area_stiffness(rows, pressures, out):
    """Fill C = sum_t p_c (a b^T - b a^T), the second derivative of sum_t p_c det G_t in u_x and u_y, for
    the ``rows`` (t, 2 or 3, n) of areas and their ``pressures`` (t,)."""
    n = rows.shape[2]
    for i in range(n):
        row = out[i]
        for j in range(n):
            row[j] = 0.0
        for t in range(len(rows)):
            a, b = rows[t, 0], rows[t, 1]
            on_b, on_a = pressures[t] * a[i], pressures[t] * b[i]
            for j in range(n):
                row[j] += on_b * b[j] - on_a * a[j]


@compiled
def assemble_internal(
    table, weights, functions, deformation, k, w, bulk, carried, scatter, force, values
):
    """Add the internal force to ``force`` and, where ``values`` is not empty, the tangent to it.

    Parameters
    ----------
    table : ShapeTable
        Shape functions at the quadrature points and rows of areas, a group for a column of cells.
    weights, functions : ndarray, shapes (n_columns, q), (m, q + t)
        Of the quadrature, and of the pressure.
    deformation : Deformation
        Of ``deform``; its field ``k`` is taken.
    w : ndarray, shape (5 or 9, n_columns, q)
        W_T, W_J, W_TT, W_TJ, W_JJ at that field; in a body of revolution also W_h, W_Th, W_Jh, W_hh.
    bulk : ndarray, shape (n_columns,)
        K of the projected energy.
    carried : ndarray, shape (n_columns, q, 3 or 4), or empty
        H of a body that relaxes (``relaxation``), which acts with P = ... + F H, P_h = ... + h H_33.
    scatter : Scatter
    force, values : ndarray
        Length n_equations + 1 (the last collects imposed components), and the tangent buffer.
    """
    q_count, widest, rows = weights.shape[1], widest_group(table), grad_rows(table)
    around, points = rows == 3, table.group_size
    strains = 5 if around else 4
    a, local = np.empty((strains, strains)), np.empty(2 * widest)
    hoop = np.empty((q_count if around else 0, 2 * widest))
    # as many functions as fours of points, what is missing of either zero: see ``_fill_row``
    passes = (q_count + 3) // 4
    passes = passes if passes > len(functions) else len(functions)
    g, c = np.empty((passes, 2 * widest)), np.empty((16 * passes, 2 * widest))
    pressures, cofactor = np.empty(points - q_count), np.empty(2 * widest)
    area_stiffness = np.empty((widest, widest))
    for i in range(2 * widest):
        for h in range(len(functions), passes):
            g[h, i] = 0.0
        for r in range(4 * q_count, 16 * passes):
            c[r, i] = 0.0
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        near = table.neighbours[s0 : s0 + n]
        grad = table.grad[rows * s0 * points : rows * (s0 + n) * points]
        grad = grad.reshape(points, rows, n)
        # s_h of the column
        volume_strain = deformation.volume_strain[k, column]
        for i in range(2 * n):
            local[i] = 0.0
            for h in range(len(functions)):
                g[h, i] = 0.0
        for q in range(q_count):
            f, weight, b = deformation.f[k, column, q], weights[column, q], grad[q]
            # P = 2 W_T F + (W_J + p) h cof F - p_c (cof F - 1)
            pressure = bulk[column] * at_point(functions, q, volume_strain)
            of_cell = bulk[column] * mean_pressure(functions, q, q_count, volume_strain)
            w_t, w_j = w[0, column, q], w[1, column, q] + pressure
            p = without_quadratic(piola_stress(f, w_t, w_j), f, of_cell)
            if carried.size:
                # + F H
                more = carried_stress(f, carried[column, q])
                p = (p[0] + more[0], p[1] + more[1], p[2] + more[2], p[3] + more[3])
            for i in range(n):
                # f_Ii = sum_q w P_ij Phi_I,j   Eq. (43)
                local[i] += weight * (p[0] * b[0, i] + p[1] * b[1, i])
                local[n + i] += weight * (p[2] * b[0, i] + p[3] * b[1, i])
            if around:
                # P_h = W_h + W_J det F
                p_h = w[W_H, column, q] + w_j * plane_jacobian(f)
                if carried.size:
                    p_h += f[5] * carried[column, q, 3]
                for i in range(n):
                    # f_I1 += sum_q w P_h Phi_I / R
                    local[i] += weight * p_h * b[2, i]
            if values.size:
                # A = dP/dF at fixed pressure
                w_tt, w_tj, w_jj = w[2, column, q], w[3, column, q], w[4, column, q]
                point_moduli(f, w_t, w_j, w_tt, w_tj, w_jj, a)
                remove_quadratic_moduli(of_cell, a)
                if carried.size:
                    add_carried_moduli(carried[column, q], a)
                if around:
                    w_th, w_jh, w_hh = w[W_TH, column, q], w[W_JH, column, q], w[W_HH, column, q]
                    hoop_moduli(f, w_j, w_th, w_jh, w_hh, a)
                    _moduli_rows(weight, a[4:], b, n, hoop, q)
                for h in range(len(functions)):
                    # g_h += N_h w J_F B - n_h w (cof F - 1) B, J_F = h cof F and J_h = det F
                    mean = cell_mean(functions, h, q, q_count) * weight
                    if mean == 0.0:
                        # a function of other cells
                        continue
                    whole = functions[h, q] * weight * hoop_stretch(f) - mean
                    if around:
                        for i in range(n):
                            g[h, i] += functions[h, q] * weight * plane_jacobian(f) * b[2, i]
                    on_x, on_y = whole * f[3] + mean, -whole * f[2]
                    for i in range(n):
                        g[h, i] += on_x * b[0, i] + on_y * b[1, i]
                    on_x, on_y = -whole * f[1], whole * f[0] + mean
                    for i in range(n):
                        g[h, n + i] += on_x * b[0, i] + on_y * b[1, i]
                _moduli_rows(weight, a[:4], b, n, c, 4 * q)
        for t in range(points - q_count):
            # p_c cof G,  g_h += n_h cof G of the rows of areas
            on, b = deformation.areas[k, column, t], grad[q_count + t]
            pressures[t] = bulk[column] * at_point(functions, q_count + t, volume_strain)
            for i in range(n):
                cofactor[i] = on[3] * b[0, i] - on[2] * b[1, i]
                cofactor[n + i] = on[0] * b[1, i] - on[1] * b[0, i]
            for i in range(2 * n):
                local[i] += pressures[t] * cofactor[i]
            for h in range(len(functions) if values.size else 0):
                mean = functions[h, q_count + t]
                for i in range(2 * n if mean != 0.0 else 0):
                    g[h, i] += mean * cofactor[i]
        for i in range(n):
            # into the equations
            force[scatter.equations[near[i], 0]] += local[i]
            force[scatter.equations[near[i], 1]] += local[n + i]
        if values.size:
            for h in range(len(functions)):
                # sqrt(K / V_h) g_h: K_p = sum_h K / V_h g_h g_h^T,  g_h = V_h ds_h/dd
                root = math.sqrt(bulk[column] / volume_of(functions[h], weights[column]))
                for i in range(2 * n):
                    g[h, i] *= root
            slots = scatter.slots[scatter.start[column] : scatter.start[column + 1]]
            _fill_area_stiffness(grad[q_count:], pressures, area_stiffness)
            _scatter_tangent(grad[:q_count], c, hoop, g, area_stiffness, local, slots, values)
