"""Settings of kernels, basis, pressure and integration of a cloud."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Kernels:
    """Kernels, basis, pressure and integration of a cloud.

    The defaults are for clouds with a spacing: the least error per second of the variants tried on
    many sections (page on accuracy).

    Attributes
    ----------
    support : float, or pair of float
        Support radius over the longest side of a cell at a particle; of product kernels the half-widths
        along the cells' two directions over their sides.
    basis_order : int
        1 (linear) or 2 (quadratic).
    column : int
        Cells in succession through which the pressure is continuous and linear; 1 for one value a cell.
    n_gauss : int, or pair of int
        Gauss points along both directions of a cell, or along each.
    """

    support: float | tuple = 2.2
    basis_order: int = 1
    column: int = 1
    n_gauss: int | tuple[int, int] = 2
