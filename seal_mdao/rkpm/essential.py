"""Essential conditions by transformation (the mixed form of the direct transformation, ref. [24]), in
place of the Lagrange multipliers of Eqs. (14), (15).

Only the constrained particles C are transformed. With Lambda_CI = Phi_I(X_C), the new shape
functions of any group that sees a constrained particle are

    Phi~_u = [u not in C] Phi_u + sum_C Phi_C T_Cu,    T = Lambda_CC^-1 [ -Lambda_CF | I ]

so that Phi~_F vanishes at every constrained particle and Phi~_C is interpolating there: after the
transformation an imposed displacement is an imposed coefficient. The matrix stays sparse because
groups that see no constrained particle are left alone.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.errors import GeometryError
from seal_mdao.rkpm.shape_functions import ShapeTable


@dataclass(frozen=True)
class EssentialTransformation:
    """The matrix T of one design and where it acts.

    Attributes
    ----------
    constrained : ndarray of int, shape (c,)
        Particles with an imposed displacement component.
    union : ndarray of int, shape (u,)
        Sorted particles seen by any constrained particle, the constrained ones included.
    matrix : ndarray, shape (c, u)
        T.
    lambda_inverse : ndarray, shape (c, c)
    """

    constrained: np.ndarray
    union: np.ndarray
    matrix: np.ndarray
    lambda_inverse: np.ndarray

    @property
    def is_constrained(self):
        """Find the constrained particles, a mask over ``union``."""
        return np.isin(self.union, self.constrained)

    def coefficients(self, d: np.ndarray) -> np.ndarray:
        """Compute the coefficients of the raw shape functions, (n, 2), from the transformed ones."""
        if self.constrained.size == 0:
            return d
        # c_F = d_F, c_C = T d_U
        raw = d.copy()
        raw[self.constrained] = self.matrix @ d[self.union]
        return raw


def rows_on_union(table: ShapeTable, union: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Scatter a table of single points (flat (point, neighbour, ...)) to dense rows over ``union``."""
    rows = np.zeros((table.n_groups, union.size, *values.shape[1:]))
    point = np.repeat(np.arange(table.n_groups), np.diff(table.start))
    rows[point, np.searchsorted(union, table.neighbours)] = values
    return rows


def essential_transformation(constrained: np.ndarray, table: ShapeTable) -> EssentialTransformation:
    """Compute T of the mixed transformation from the raw shape functions at the constrained particles.

    Parameters
    ----------
    constrained : ndarray of int, shape (c,)
        Sorted particle numbers.
    table : ShapeTable
        Raw shape functions at those particles, one point a group.
    """
    union = np.unique(np.concatenate([table.neighbours, constrained]))
    # Lambda_CI = Phi_I(X_C) on the union of all neighbours
    rows = rows_on_union(table, union, table.phi)
    where = np.searchsorted(union, constrained)
    lambda_cc = rows[:, where]
    if constrained.size and np.linalg.cond(lambda_cc) > 1e10:
        raise GeometryError(
            "the RKPM shape functions at the constrained particles are linearly dependent; use a "
            "smaller kernel support or constrain fewer particles"
        )
    inverse = np.linalg.inv(lambda_cc)
    # E = [-Lambda_CF | I],  T = Lambda_CC^-1 E
    right = -rows
    right[:, where] = np.eye(constrained.size)
    return EssentialTransformation(constrained, union, inverse @ right, inverse)


def transformation_rates(transformation: EssentialTransformation, rows_rate: np.ndarray):
    """Differentiate T, given the rates of the raw rows.

    Parameters
    ----------
    rows_rate : ndarray, shape (c, u, P)
        Derivatives of Phi_u(X_C) for P design parameters.

    Returns
    -------
    ndarray, shape (c, u, P)
    """
    where = np.searchsorted(transformation.union, transformation.constrained)
    # Lambda_CC T = E:  T' = Lambda_CC^-1 (E' - Lambda_CC' T),  E' = [-Lambda_CF' | 0]
    right = -np.einsum("cdp,du->cup", rows_rate[:, where], transformation.matrix)
    free = ~transformation.is_constrained
    right[:, free] -= rows_rate[:, free]
    return np.einsum("cd,dup->cup", transformation.lambda_inverse, right)


def transformation_seeds(transformation: EssentialTransformation, matrix_bar: np.ndarray):
    """Apply the transpose of ``transformation_rates``: seeds on T (c, u, M) to seeds on raw rows."""
    # z = Lambda_CC^-T T_bar:  Lambda_CF_bar = -z_F,  Lambda_CC_bar = -z T^T
    z = np.einsum("dc,dum->cum", transformation.lambda_inverse, matrix_bar)
    rows_bar = np.where(transformation.is_constrained[:, None], 0.0, -z)
    where = np.searchsorted(transformation.union, transformation.constrained)
    rows_bar[:, where] -= np.einsum("cum,du->cdm", z, transformation.matrix)
    return rows_bar
