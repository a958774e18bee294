"""Nearly incompressible Mooney-Rivlin rubber in plane strain.

Isochoric invariants and F_33 = 1. With T = F : F and J = det F of the in-plane deformation gradient,
I1 = T + 1 and I2 = T + J^2, so that the energy is a function of T and J alone:

    W_dev(T, J) = C10 ((T + 1) J^(-2/3) - 3) + C01 ((T + J^2) J^(-4/3) - 3)
    W_vol(J)    = K/2 (J - 1)^2, with J projected on the background cell (refs. [29], [32])
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from seal_mdao.compilation import compiled, inlined
from seal_mdao.materials.isotropic import NO_VALUE, Isotropic, check_bulk, checked


@inlined
def unit_energy_gradients(t, j):
    """Evaluate W_T and W_J of the two isochoric terms for unit constants: C10 first, then C01."""
    a = j ** (-1.0 / 3.0)
    a2, i = a * a, 1.0 / j
    a4 = a2 * a2
    return (
        # J^(-2/3),  -2/3 (T + 1) J^(-5/3)
        a2, -2.0 / 3.0 * (t + 1.0) * a2 * i,
        # J^(-4/3),  (2 J^2 - 4 T) / 3 J^(-7/3)
        a4, (2.0 * j * j - 4.0 * t) / 3.0 * a4 * i,
    )  # fmt: skip


@inlined
def energy_derivatives(t, j, c10, c01):
    """Evaluate W_T, W_J, W_TJ, W_JJ of the isochoric energy (W_TT = 0), in the unit of C10.

    Parameters
    ----------
    t, j : float
        F : F and det F in the plane.
    """
    a2, first_j, a4, second_j = unit_energy_gradients(t, j)
    i = 1.0 / j
    w_t = c10 * a2 + c01 * a4
    w_j = c10 * first_j + c01 * second_j
    # W_TJ = -2/3 C10 J^(-5/3) - 4/3 C01 J^(-7/3)
    w_tj = -(2.0 * c10 * a2 + 4.0 * c01 * a4) * i / 3.0
    # W_JJ = 10/9 C10 (T + 1) J^(-8/3) + C01 (28/9 T - 2/9 J^2) J^(-10/3)
    w_jj = (
        (10.0 / 9.0 * c10 * (t + 1.0) * a2 + c01 * (28.0 / 9.0 * t - 2.0 / 9.0 * j * j) * a4)
        * i
        * i
    )
    return w_t, w_j, w_tj, w_jj


@compiled
def _fill_derivatives(t, j, c10, c01, out):
    for i in range(t.size):
        w_t, w_j, w_tj, w_jj = energy_derivatives(t[i], j[i], c10, c01)
        out[0, i], out[1, i] = w_t, w_j
        out[2, i], out[3, i], out[4, i] = 0.0, w_tj, w_jj


@compiled
def _fill_unit_gradients(t, j, out):
    for i in range(t.size):
        out[0, 0, i], out[0, 1, i], out[1, 0, i], out[1, 1, i] = unit_energy_gradients(t[i], j[i])


@dataclass(frozen=True)
class MooneyRivlin(Isotropic):
    """Mooney-Rivlin law; constants in any one stress unit (the door seal uses kPa).

    Attributes
    ----------
    c10, c01 : float
        Mooney-Rivlin constants, initial shear modulus 2 (c10 + c01).
    bulk_modulus : float
        K of the volumetric energy K/2 (J - 1)^2 with the projected volume ratio J, positive.
    """

    c10: float = 80.0
    c01: float = 20.0
    bulk_modulus: float = 80_000.0

    moduli: ClassVar = ("c10", "c01", "bulk_modulus")

    def __post_init__(self):
        checked(self, positive=("bulk_modulus",), nonnegative=("c10", "c01"))
        if self.c10 + self.c01 <= 0.0:
            raise ValueError(
                "c10 and c01 of MooneyRivlin are both zero; the shear modulus 2 (c10 + c01) must "
                "be positive"
            )
        check_bulk(self)

    @property
    def shear_modulus(self) -> float:
        return 2.0 * (self.c10 + self.c01)

    @np.errstate(**NO_VALUE)
    def energy(self, t, j):
        """Evaluate the isochoric strain energy density W_dev, shape of ``t``."""
        # C10 (I1 J^(-2/3) - 3) + C01 (I2 J^(-4/3) - 3),  I1 = T + 1,  I2 = T + J^2
        first, second = (t + 1) * j ** (-2 / 3) - 3, (t + j**2) * j ** (-4 / 3) - 3
        return self.c10 * first + self.c01 * second

    def derivatives(self, t, j):
        """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...), in one compiled loop."""
        t, j, out = _loop_arrays(t, j, 5)
        _fill_derivatives(t.ravel(), j.ravel(), self.c10, self.c01, out.reshape(5, -1))
        return out

    def constant_derivatives(self, t, j):
        """Evaluate d(W_T, W_J) / d(c10, c01, bulk_modulus), shape (3, 2, ...)."""
        t, j, out = _loop_arrays(t, j, 3, 2)
        # W_dev is linear in C10 and C01: the derivatives are those of its two parts
        _fill_unit_gradients(t.ravel(), j.ravel(), out.reshape(3, 2, -1))
        out[2] = 0.0
        return out


def _loop_arrays(t, j, *leading):
    """Make T and J arrays of floating numbers, and allocate the result."""
    kind = np.result_type(t, j, float)
    t, j = np.asarray(t, kind), np.asarray(j, kind)
    return t, j, np.empty((*leading, *t.shape), kind)
