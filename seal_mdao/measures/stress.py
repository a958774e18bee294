"""Von Mises stress of the deviatoric Cauchy stress at particles."""

import numba as nb
import numpy as np

from seal_mdao.analysis.internal_force import cell_gradients
from seal_mdao.materials.mooney_rivlin import von_mises
from seal_mdao.rkpm.shape_functions import ShapeTable


@nb.njit(cache=True, error_model="numpy")
def _stress(table, d, c10, c01, value, by_gradient):
    f = np.empty((1, 5))
    for i in range(table.start.size - 1):
        s0, s1 = table.start[i], table.start[i + 1]
        n = s1 - s0
        grad = table.grad[2 * s0 : 2 * s1].reshape(1, 2, n)
        cell_gradients(grad, d[table.neighbours[s0:s1]].T, n, 1, f)
        t = f[0, 0] ** 2 + f[0, 1] ** 2 + f[0, 2] ** 2 + f[0, 3] ** 2
        value[i], by_t, by_j = von_mises(t, 1.0 + f[0, 4], c10, c01)
        cof = (f[0, 3], -f[0, 2], -f[0, 1], f[0, 0])
        for r in range(4):
            by_gradient[i, r] = 2.0 * by_t * f[0, r] + by_j * cof[r]


def von_mises_at(table: ShapeTable, d: np.ndarray, material) -> tuple[np.ndarray, np.ndarray]:
    """Von Mises stress at the points of a table, and its derivative with respect to F.

    Parameters
    ----------
    table : ShapeTable
        Single points.
    d : ndarray, shape (n, 2)
        Generalised displacements.
    material : MooneyRivlin

    Returns
    -------
    stress : ndarray, shape (n_points,)
    by_gradient : ndarray, shape (n_points, 4)
        d stress / d F in the order 11, 12, 21, 22.
    """
    value, by_gradient = np.empty(table.n_groups), np.empty((table.n_groups, 4))
    _stress(table, d, material.c10, material.c01, value, by_gradient)
    return value, by_gradient


def constants_gradient(table, d, material) -> np.ndarray:
    """d stress / d(C10, C01, bulk modulus), shape (n_points, 3).

    sigma_vm is homogeneous of degree one in (C10, C01) and the square root of a quadratic form in
    them, so its derivative follows from the values at three pairs of constants.
    """
    out, _ = np.empty((table.n_groups, 3)), None
    values = [np.empty(table.n_groups) for _ in range(3)]
    scratch = np.empty((table.n_groups, 4))
    for (c10, c01), value in zip(((1.0, 0.0), (0.0, 1.0), (1.0, 1.0)), values, strict=True):
        _stress(table, d, c10, c01, value, scratch)
    first, second, mixed = values[0] ** 2, values[1] ** 2, values[2] ** 2
    cross = 0.5 * (mixed - first - second)
    stress = von_mises_at(table, d, material)[0]
    safe = np.where(stress > 0.0, stress, 1.0)
    out[:, 0] = (material.c10 * first + material.c01 * cross) / safe
    out[:, 1] = (material.c01 * second + material.c10 * cross) / safe
    out[:, 2] = 0.0
    return out
