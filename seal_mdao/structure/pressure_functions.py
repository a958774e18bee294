"""Functions that the volume change is projected on: the space of the pressure.

With the volume change e = J - 1 + c of ``deformation`` at the quadrature points q of a column of cells,
weights w and m functions N_h whose sum is one,

    V_h = sum_q N_h w,    s_h = sum_q N_h w e / V_h,    p_q = K sum_h N_h(q) s_h,

and the energy is sum_h K/2 V_h s_h^2. The part of e that is quadratic in the displacement gradient is
that of ``cell_areas`` in the mean over a cell, where N_h is its mean over the Gauss points.

One value in every cell makes the pressure a staircase across a wall, which is too soft in bending.
Through m cells from one side of the wall to the other m hat functions on even knots make it continuous
with as many constraints. With a knot at every edge of a cell, m + 1, the wall locks: 40 % too stiff,
with an inf-sup constant of 0.01.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.cell_areas import AROUND, PLANE
from seal_mdao.rkpm.cells import in_both_directions


class PressureSpace(NamedTuple):
    """Functions of the pressure in a column of cells, the same in every column.

    Attributes
    ----------
    cells : int
        Cells of a column; they follow each other in the numbering.
    functions : ndarray, shape (m, cells * q + t)
        N_h at the quadrature points, then its mean over every cell at the t rows of ``cell_areas``;
        their sum is one.
    """

    cells: int
    functions: np.ndarray


def through_column(cells: int, n_gauss, axisymmetric: bool = False) -> PressureSpace:
    """Hat functions on ``cells`` even knots from the first to the last edge of as many cells.

    They run along the first direction of the cells, from the first corner to the second. Of one cell it
    is the constant, of two the linear functions.
    """
    along, beside = in_both_directions(n_gauss)
    # Gauss points on [0, 1] of every cell along the column
    gauss = 0.5 + 0.5 * np.polynomial.legendre.leggauss(along)[0]
    at = np.repeat(np.add.outer(np.arange(cells), gauss), beside)
    # m hat functions on m even knots from edge to edge
    knots = np.linspace(0.0, cells, cells)
    functions = np.array([np.interp(at, knots, hat) for hat in np.eye(cells)])
    means = functions.reshape(cells, cells, along * beside).mean(axis=2)
    at_areas = np.repeat(means, AROUND if axisymmetric else PLANE, axis=1)
    return PressureSpace(cells, np.hstack([functions, at_areas]))
