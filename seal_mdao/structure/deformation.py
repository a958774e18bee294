"""Deformation gradients at the quadrature points, and the volume change projected for the pressure.

Pressure projection in the energy: J - 1 + c is averaged over each column of background cells with the
functions N_h of ``pressure_functions``,

    E = sum_q w W(F) + sum_h K/2 V_h s_h^2,   s_h = sum_q N_h w (J - 1 + c) / V_h,   V_h = sum_q N_h w,

where -c is the volume change that costs no energy. In plane strain J = det F; in a body of revolution
J = h det F with the hoop stretch h of the third strain row (``rkpm.axisymmetry``) and the in-plane F.

The sum of w det(F - 1) over a cell, which is part of that of w J, is replaced by what the rows of
``rkpm.cell_areas`` give, so that J has the mean of the deformed cell:

    V_h (s_h - c) = sum_q (N_h w (J - 1) - n_h w det(F - 1)) + sum_t n_h det G_t

with the mean n_h of N_h over the cell.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled, inlined, internal
from seal_mdao.rkpm.shape_functions import grad_rows


class Deformation(NamedTuple):
    """Deformation of all columns of cells at K displacement fields, q quadrature points a column.

    Attributes
    ----------
    f : ndarray, shape (K, n_columns, q, 5 or 6)
        F in the order 11, 12, 21, 22, and J - 1; in a body of revolution also h.
    square : ndarray, shape (K, n_columns, q)
        T = F : F.
    areas : ndarray, shape (K, n_columns, t, 4)
        G of the rows of areas, in the same order.
    volume_strain : ndarray, shape (K, n_columns, m)
        s_h.
    fractions : ndarray, shape (K,)
        Path parameters of the fields.
    offset : ndarray, shape (K, n_columns)
        c, minus the volume change that costs no energy (``materials.stretch_and_growth``); 0 in a body
        without environment.
    """

    f: np.ndarray
    square: np.ndarray
    areas: np.ndarray
    volume_strain: np.ndarray
    fractions: np.ndarray
    offset: np.ndarray

    @property
    def jacobian(self) -> np.ndarray:
        """J, shape (K, n_columns, q)."""
        return 1.0 + self.f[..., 4]

    @property
    def hoop(self) -> np.ndarray | None:
        """h of a body of revolution, shape (K, n_columns, q)."""
        return self.f[..., 5] if self.f.shape[-1] == 6 else None


def no_deformation(n_fields: int, cells, n_functions: int) -> Deformation:
    """Allocate ``n_fields`` displacement fields on the columns of a ``CellTable``."""
    shape = (n_fields, *cells.column_weights.shape)
    # with h in a body of revolution
    size, n_areas = 6 if cells.axisymmetric else 5, cells.raw.group_size - shape[2]
    return Deformation(
        np.empty((*shape, size)), np.empty(shape), np.empty((*shape[:2], n_areas, 4)),
        np.empty((*shape[:2], n_functions)), np.zeros(n_fields), np.zeros(shape[:2]),
    )  # fmt: skip


@inlined
def cell_mean(functions, h, q, q_count):
    """n_h of the cell of the quadrature point ``q``, of ``q_count`` of a column."""
    # one of the rows of areas of the cell
    return functions[h, q_count + q * (functions.shape[1] - q_count) // q_count]


@inlined
def plane_jacobian(f):
    """det F of the in-plane F, which is dJ/dh."""
    return f[0] * f[3] - f[1] * f[2]


@inlined
def gradient_determinant(f):
    """det(F - 1)."""
    return (f[0] - 1.0) * (f[3] - 1.0) - f[1] * f[2]


@inlined
def _volume_strain(functions, h, weights, column, f, areas):
    """s_h - c of one column."""
    volume, change, q_count = 0.0, 0.0, len(f)
    for q in range(q_count):
        # V_h += N_h w,  V_h (s_h - c) += N_h w (J - 1) - n_h w det(F - 1)
        weight = weights[column, q]
        volume += functions[h, q] * weight
        change += functions[h, q] * weight * f[q, 4]
        change -= cell_mean(functions, h, q, q_count) * weight * gradient_determinant(f[q])
    for t in range(len(areas)):
        # + n_h det G_t
        change += functions[h, q_count + t] * plane_jacobian(areas[t])
    return change / volume


@inlined
def volume_of(function, weights):
    """V = sum_q N w of one function N (q,)."""
    volume = 0.0
    for q in range(weights.size):
        volume += function[q] * weights[q]
    return volume


@inlined
def at_point(functions, q, values):
    """sum_h N_h(q) v_h."""
    value = 0.0
    for h in range(values.size):
        value += functions[h, q] * values[h]
    return value


@inlined
def pair_gradient(grad, first, displacement, n):
    """sum_I d_Ii a_I and sum_I d_Ii b_I in the order 11, 12, 21, 22, for the rows a and b that begin at
    the entry ``first`` of the flat ``grad``."""
    g11, g12, g21, g22 = 0.0, 0.0, 0.0, 0.0
    for i in range(n):
        a, b = grad[first + i], grad[first + n + i]
        g11 += displacement[0, i] * a
        g12 += displacement[0, i] * b
        g21 += displacement[1, i] * a
        g22 += displacement[1, i] * b
    return g11, g12, g21, g22


@inlined
def group_gradients(grad, displacement, n, q_count, f):
    """Deformation gradients of one group: ``f`` (q, 5) in the order 11, 12, 21, 22, and det F - 1; in a
    body of revolution (q, 6) with J - 1, J = h det F, and h.

    ``grad`` is flat (point, row, neighbour), ``displacement`` (2, n). J - 1 is formed from the
    displacement gradient: J itself would lose the small volume change that the bulk modulus
    multiplies.
    """
    rows = f.shape[1] - 3
    for q in range(q_count):
        # grad u_ij = sum_I d_Ii Phi_I,j
        f11, f12, f21, f22 = pair_gradient(grad, rows * q * n, displacement, n)
        # F = 1 + grad u,  det F - 1 = tr grad u + det grad u
        f[q, 0], f[q, 1], f[q, 2], f[q, 3] = 1.0 + f11, f12, f21, 1.0 + f22
        f[q, 4] = f11 + f22 + (f11 * f22 - f12 * f21)
        if rows == 3:
            widening = 0.0
            for a in range(n):
                # h - 1 = sum_I d_I1 Phi_I / R
                widening += displacement[0, a] * grad[(3 * q + 2) * n + a]
            # J - 1 = (det F - 1) + (h - 1) + (det F - 1)(h - 1)
            f[q, 4] += widening + f[q, 4] * widening
            f[q, 5] = 1.0 + widening


@inlined
def group_areas(grad, displacement, n, areas):
    """G of the rows of areas of one group, ``areas`` (t, 4) in the order 11, 12, 21, 22: ``grad`` is
    flat (t, row, neighbour), ``displacement`` (2, n)."""
    rows = grad.size // (len(areas) * n)
    for t in range(len(areas)):
        # G_i1 = sum_I d_Ii a_I,  G_i2 = sum_I d_Ii b_I
        g11, g12, g21, g22 = pair_gradient(grad, rows * t * n, displacement, n)
        areas[t, 0], areas[t, 1], areas[t, 2], areas[t, 3] = g11, g12, g21, g22


@internal
def widest_group(table):
    """Largest number of neighbours of a group."""
    widest = 0
    for group in range(table.start.size - 1):
        count = table.start[group + 1] - table.start[group]
        widest = count if count > widest else widest
    return widest


@compiled
def deform(table, weights, functions, d, out):
    """Fill the first field of ``out`` for displacements ``d`` (n, 2).

    Parameters
    ----------
    weights, functions : ndarray, shapes (n_columns, q), (m, q)
        Of the quadrature, and of the pressure.

    Returns
    -------
    int
        The first column with an inverted quadrature point, at which it stops, or -1.
    """
    (q_count, points), rows = (weights.shape[1], table.group_size), grad_rows(table)
    displacement = np.empty((2, widest_group(table)))
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        grad = table.grad[rows * s0 * points : rows * (s0 + n) * points]
        for i in range(n):
            near = table.neighbours[s0 + i]
            # d_I of the neighbours
            displacement[0, i], displacement[1, i] = d[near, 0], d[near, 1]
        f = out.f[0, column]
        group_gradients(grad, displacement, n, q_count, f)
        for q in range(q_count):
            # J <= 0 or h <= 0, or no number: inverted
            if not f[q, 4] > -1.0 or (rows == 3 and not f[q, 5] > 0.0):
                return column
            # T = F : F
            out.square[0, column, q] = (
                f[q, 0] * f[q, 0] + f[q, 1] * f[q, 1] + f[q, 2] * f[q, 2] + f[q, 3] * f[q, 3]
            )
        areas = out.areas[0, column]
        group_areas(grad[rows * n * q_count :], displacement, n, areas)
        for h in range(len(functions)):
            out.volume_strain[0, column, h] = (
                _volume_strain(functions, h, weights, column, f, areas) + out.offset[0, column]
            )
    return -1


@internal
def block(buffer, rows, columns):
    """The beginning of a flat buffer as a matrix."""
    return buffer[: rows * columns].reshape(rows, columns)


@internal
def group_displacements(d, near, out):
    """``out`` (2 K, n): d of the neighbours, rows (step, component)."""
    for k in range(d.shape[0]):
        for a in range(near.size):
            out[2 * k, a] = d[k, near[a], 0]
            out[2 * k + 1, a] = d[k, near[a], 1]


@compiled
def _deform_many(table, weights, functions, d, out):
    """As ``deform`` for fields that are known to be admissible, by one matrix product a column."""
    q_count, widest, rows = weights.shape[1], widest_group(table), 2 * len(d)
    per_point = grad_rows(table)
    points = per_point * table.group_size
    displacements, turned = np.empty(rows * widest), np.empty(widest * points)
    slopes = np.empty((rows, points))
    for column in range(table.start.size - 1):
        s0 = table.start[column]
        n = table.start[column + 1] - s0
        grad = table.grad[s0 * points : (s0 + n) * points].reshape(points, n)
        u, b = block(displacements, rows, n), block(turned, n, points)
        group_displacements(d, table.neighbours[s0 : s0 + n], u)
        for a in range(n):
            for r in range(points):
                b[a, r] = grad[r, a]
        # grad u of all steps and points: d^T B
        np.dot(u, b, slopes)
        for k in range(len(d)):
            for q in range(q_count):
                f = out.f[k, column, q]
                at = per_point * q
                f11, f12 = slopes[2 * k, at], slopes[2 * k, at + 1]
                f21, f22 = slopes[2 * k + 1, at], slopes[2 * k + 1, at + 1]
                f[0], f[1], f[2], f[3] = 1.0 + f11, f12, f21, 1.0 + f22
                f[4] = f11 + f22 + (f11 * f22 - f12 * f21)
                if per_point == 3:
                    # J - 1 = (det F - 1) + (h - 1) + (det F - 1)(h - 1)
                    widening = slopes[2 * k, at + 2]
                    f[4] += widening + f[4] * widening
                    f[5] = 1.0 + widening
                out.square[k, column, q] = f[0] * f[0] + f[1] * f[1] + f[2] * f[2] + f[3] * f[3]
            areas = out.areas[k, column]
            for t in range(len(areas)):
                at = per_point * (q_count + t)
                areas[t, 0], areas[t, 1] = slopes[2 * k, at], slopes[2 * k, at + 1]
                areas[t, 2], areas[t, 3] = slopes[2 * k + 1, at], slopes[2 * k + 1, at + 1]
            for h in range(len(functions)):
                out.volume_strain[k, column, h] = (
                    _volume_strain(functions, h, weights, column, out.f[k, column], areas)
                    + out.offset[k, column]
                )


def fill_deformations(cells, functions: np.ndarray, d: np.ndarray, out: Deformation) -> Deformation:
    """Fill the deformation of a ``CellTable`` at displacement fields (K, n, 2) of converged steps."""
    _deform_many(cells.table, cells.column_weights, functions, d, out)
    return out


def determinants(f: np.ndarray) -> np.ndarray:
    """Determinants of gradients (..., 4) in the order 11, 12, 21, 22."""
    return f[..., 0] * f[..., 3] - f[..., 1] * f[..., 2]


def lowest_jacobian(path) -> float:
    """Least det F, with the stretch across the section, of all quadrature points at the nominal steps of
    a path; 1 before the first."""
    structure, steps = path.problem.term("structure"), path.nominal_steps
    fields = (structure.deformation_of(step.d[None], [step.fraction]) for step in steps)
    # J = h det F in a stretched section; in a body of revolution h = r / R is part of the field
    found = [
        field.jacobian.min() * structure.definition.axial_stretch(step.fraction)
        for field, step in zip(fields, steps, strict=True)
    ]
    return float(min(found, default=1.0))
