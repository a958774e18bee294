"""Residual of the first-order optimality (Karush-Kuhn-Tucker) conditions at a point.

Optimizers stop for many reasons, among them that the objective no longer changes. This measure
is independent of the optimizer. It computes the multipliers that minimise the gradient of the
Lagrangian and the complementarity products of multipliers and distances to the bounds. An interior
point close to its active bounds is thus assessed correctly, without classification of constraints
as active or inactive.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import lsq_linear

from seal_mdao.drivers.evaluation import ModelEvaluator
from seal_mdao.drivers.layout import flat, read_layout

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.layout import ProblemLayout
    from seal_mdao.openmdao_access import FailedCases

NEAR = 1e-2
"""Bounds at a larger distance, relative to 1 + |bound|, have no multiplier."""


@dataclass(frozen=True)
class Optimality:
    """Residuals of the KKT conditions, in driver scaling.

    Attributes
    ----------
    stationarity : float
        Largest entry of the Lagrangian's gradient.
    complementarity : float
        Largest product of a multiplier and the distance to its bound.
    infeasibility : float
        Largest constraint violation.
    multipliers : float
        Sum of |multipliers|: the change of the objective per unit of violation of all bounds.

    The first two are divided by the larger of 1 and the largest entry of the objective's
    gradient.
    """

    stationarity: float
    complementarity: float
    infeasibility: float
    multipliers: float

    def satisfied(self, tol: float, feas_tol: float) -> bool:
        """Return whether the conditions hold to ``tol`` and the constraints to ``feas_tol``."""
        conditions = max(self.stationarity, self.complementarity)
        return conditions <= tol and self.infeasibility <= feas_tol

    def __str__(self) -> str:
        conditions = max(self.stationarity, self.complementarity)
        return (
            f"optimality conditions hold to {conditions:.1e}, "
            f"constraints to {self.infeasibility:.1e}"
        )

    @classmethod
    def at(
        cls,
        layout: ProblemLayout,
        x: NDArray[np.float64],
        constraints: NDArray[np.float64],
        gradient: NDArray[np.float64],
        jacobian: NDArray[np.float64],
    ) -> Optimality:
        """Compute the residuals at a point.

        Parameters
        ----------
        layout : ProblemLayout
            Bounds of the problem.
        x, constraints : ndarray, shapes (n,) and (m,)
            The point and its constraint values.
        gradient, jacobian : ndarray, shapes (n,) and (m, n)
            Total derivatives of the objective and of the constraints.
        """
        # grad f - N mu = 0,  mu_i d_i = 0, with inward normals N and distances d to the bounds
        normals, distances, free = _bound_terms(layout, x, constraints, jacobian)
        multipliers = _multipliers(normals, distances, free, gradient)
        residual, products = gradient - normals @ multipliers, distances * multipliers
        scale = max(1.0, np.abs(gradient).max())
        return cls(
            float(np.abs(residual).max() / scale),
            float(np.abs(products).max(initial=0.0) / scale),
            layout.violation(constraints),
            float(np.abs(multipliers).sum()),
        )


def measure_optimality(driver: FailedCases) -> Optimality:
    """Compute the KKT residuals at the current point of the model of any driver that has been run.

    The total derivatives are computed once more; the model itself is not run.
    """
    layout = read_layout(driver)
    gradient, jacobian = ModelEvaluator(driver, layout).totals_here(once=True)
    x, constraints = flat(driver.get_design_var_values()), flat(driver.get_constraint_values())
    return Optimality.at(layout, x, constraints, gradient, jacobian)


def _multipliers(normals, distances, free, gradient) -> NDArray[np.float64]:
    """Solve for the multipliers with the least gradient of the Lagrangian and products.

    They are non-negative for inequalities (whose normals point inwards), ``free`` for equalities.
    """
    if not distances.size:
        return np.zeros(0)
    # min |N mu - grad f|^2 + |diag(d) mu|^2,  mu >= 0 for inequalities
    matrix = np.vstack([normals, np.diag(distances)])
    target = np.concatenate([gradient, np.zeros(distances.size)])
    return lsq_linear(matrix, target, (np.where(free, -np.inf, 0.0), np.inf), method="bvls").x


def _bound_terms(layout, x, constraints, jacobian):
    """Return inward normals (n, k) of the near bounds, distances, and which multipliers are free."""
    # constraints and design variables alike: lower bounds with +normal, upper with -normal
    normals = np.vstack([jacobian, np.eye(layout.n)])
    values = np.concatenate([constraints, x])
    lower = np.concatenate([layout.c_lower, layout.x_lower])
    upper = np.concatenate([layout.c_upper, layout.x_upper])
    # equality constraints once, with a multiplier of either sign
    equal = lower == upper
    at_lower = equal | _near(values - lower, lower)
    at_upper = ~equal & _near(upper - values, upper)
    distances = np.concatenate([(values - lower)[at_lower], (upper - values)[at_upper]])
    free = np.concatenate([equal[at_lower], np.zeros(at_upper.sum(), dtype=bool)])
    inward = np.vstack([normals[at_lower], -normals[at_upper]]).T
    # equality constraints have no complementarity product
    return inward, np.where(free, 0.0, np.maximum(0.0, distances)), free


def _near(distance: NDArray[np.float64], bound: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Return where a finite bound is near, or violated."""
    size = np.where(np.isfinite(bound), np.abs(bound), 0.0)
    return np.isfinite(bound) & (distance <= NEAR * (1.0 + size))
