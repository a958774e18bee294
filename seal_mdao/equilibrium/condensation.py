"""The essential transformation on assembled systems: K~ = N^T K N and f~ = N^T f.

With T of ``rkpm.essential`` the raw coefficients are c = N d: c_C = T d_U at the constrained
particles C, c = d elsewhere. Cells and contact points that see C would couple the whole union U if
their shape functions were transformed; the raw system is assembled instead, with the rows and
columns of C aside, and these few are multiplied by T once.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled


class Condensation(NamedTuple):
    """Rows and columns of the constrained particles, and the slots of their products with T.

    Attributes
    ----------
    matrix : ndarray, shape (c, u)
        T.
    constrained_at, union_at : ndarray of int, shapes (c,), (u,)
        Indices of the constrained particles and of the union among the ``v`` coupled particles.
    union_equations : ndarray of int, shape (2, u)
    union_slots : ndarray of int, shape (2, u, 2, v)
        Slots of the rows of the union, (component, particle) both.
    coupled_slots : ndarray of int, shape (2, v, 2, u)
        Slots of the columns of the union.
    first_equation, first_row, first_column : int
        Where the constrained forces, rows and columns begin in their buffers.
    """

    matrix: np.ndarray
    constrained_at: np.ndarray
    union_at: np.ndarray
    union_equations: np.ndarray
    union_slots: np.ndarray
    coupled_slots: np.ndarray
    first_equation: int
    first_row: int
    first_column: int


@compiled
def condense_force(condensation, force):
    """Add T^T f_C of the raw ``force`` (n_equations + 2 c + 1) to its equations; the last entry
    collects prescribed components."""
    c, u = condensation.matrix.shape
    for i in range(2):
        # f~_U,i += T^T f_C,i for each component i; f_C behind the equations, flat (component, particle)
        at = condensation.first_equation + i * c
        for b in range(u):
            pulled = 0.0
            for a in range(c):
                pulled += condensation.matrix[a, b] * force[at + a]
            force[condensation.union_equations[i, b]] += pulled


@compiled
def condense_tangent(condensation, values):
    """Add T^T K_C. N and K_.C T to the tangent, from the rows and columns stored aside.

    The rows stored aside are overwritten. Explicit loops, for ``np.dot`` takes a second more to
    compile.
    """
    matrix, at_c, at_u = condensation.matrix, condensation.constrained_at, condensation.union_at
    c, u = matrix.shape
    v = condensation.union_slots.shape[3]
    row = np.empty(v)
    for i in range(2):
        for k in range(2):
            # rows aside are flat (i, constrained; k, coupled), columns (k, coupled; i, constrained)
            first = condensation.first_row + (2 * i * c + k) * v
            # (K_C. N): columns of C are carried to the union, K_CU += K_CC T, K_CC = 0
            for a in range(c):
                own = values[first + 2 * a * v : first + (2 * a + 1) * v]
                for b in range(c):
                    row[b] = own[at_c[b]]
                    own[at_c[b]] = 0.0
                for b in range(c):
                    for j in range(u):
                        own[at_u[j]] += row[b] * matrix[b, j]
            # K~_U. += T^T (K_C. N)
            for j in range(u):
                for b in range(v):
                    row[b] = 0.0
                for a in range(c):
                    own, factor = values[first + 2 * a * v : first + (2 * a + 1) * v], matrix[a, j]
                    for b in range(v):
                        row[b] += factor * own[b]
                for b in range(v):
                    values[condensation.union_slots[i, j, k, b]] += row[b]
            # K~_.U += K_.C T; rows of C are done above, so their slots are the dump
            first = condensation.first_column + (2 * k * v + i) * c
            for a in range(v):
                for j in range(u):
                    row[j] = 0.0
                for b in range(c):
                    factor = values[first + 2 * a * c + b]
                    for j in range(u):
                        row[j] += factor * matrix[b, j]
                for j in range(u):
                    values[condensation.coupled_slots[k, a, i, j]] += row[j]
