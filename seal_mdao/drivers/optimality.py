"""Residual of the first-order optimality (Karush-Kuhn-Tucker) conditions at a point.

Optimizers stop for many reasons, among them that the objective no longer changes. This measure
is independent of the optimizer. It computes the multipliers that minimise the gradient of the
Lagrangian and the complementarity products of multipliers and distances to the bounds. An interior
point close to its active bounds is thus assessed correctly, without classification of constraints
as active or inactive.

At a kink the gradient of no single side vanishes. The conditions then hold for a convex combination of
the gradients of all sides (Clarke, *Optimization and Nonsmooth Analysis*, 1983, Sect. 6.1): no direction
improves the objective on every side within the constraints on every side.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import lsq_linear

from seal_mdao.drivers.evaluation import ModelEvaluator
from seal_mdao.drivers.layout import flat, read_layout

if TYPE_CHECKING:
    from collections.abc import Sequence

    from numpy.typing import NDArray

    from seal_mdao.drivers.layout import ProblemLayout
    from seal_mdao.openmdao_access import FailedCases

NEAR = 1e-2
"""Bounds at a larger distance, relative to 1 + |bound|, have no multiplier."""
ROUNDING = 1e-12
"""Of design variables that are scaled back and forth."""


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
    weights : ndarray, shape (s,)
        Of the sides of a kink in the convex combination; [1] at a smooth point.
    descent : ndarray, shape (n,)
        Steepest descent within the constraints: minus the Lagrangian's gradient.

    The first two are divided by the larger of 1 and the largest entry of the objective's
    gradient.
    """

    stationarity: float
    complementarity: float
    infeasibility: float
    multipliers: float
    weights: NDArray[np.float64] = field(repr=False)
    descent: NDArray[np.float64] = field(repr=False)

    @property
    def sides(self) -> int:
        """Number of sides of a kink whose derivatives are combined; 1 at a smooth point."""
        return int(np.count_nonzero(self.weights))

    def satisfied(self, tol: float, feas_tol: float) -> bool:
        """Return whether the conditions hold to ``tol`` and the constraints to ``feas_tol``."""
        conditions = max(self.stationarity, self.complementarity)
        return conditions <= tol and self.infeasibility <= feas_tol

    def __str__(self) -> str:
        conditions = max(self.stationarity, self.complementarity)
        combined = (
            f" with the derivatives of {self.sides} sides of a kink" if self.sides > 1 else ""
        )
        return (
            f"optimality conditions hold to {conditions:.1e}{combined}, "
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
        others: Sequence[tuple] = (),
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
        others : sequence of (gradient, jacobian)
            Those of the other sides of a kink.
        """
        # grad f - N mu = 0,  mu_i d_i = 0, with inward normals N and distances d to the bounds
        normals, distances, free = _bound_terms(layout, x, constraints, jacobian)
        gradients = np.column_stack([gradient, *(side[0] for side in others)])
        scale = max(1.0, np.abs(gradients).max())
        weights, multipliers = _multipliers(normals, distances, free, gradients[:, :1] / scale)
        if others:
            # every side has multipliers of its own, those of an equality of one sign
            signs = np.where(free, np.sign(multipliers), 1.0)
            parts = [_bound_terms(layout, x, constraints, side[1])[0] for side in others]
            normals = np.hstack([part * signs for part in (normals, *parts)])
            distances, free = np.tile(distances, len(others) + 1), np.zeros(normals.shape[1], bool)
            weights, multipliers = _multipliers(normals, distances, free, gradients / scale)
        residual = gradients @ weights / scale - normals @ multipliers
        return cls(
            float(np.abs(residual).max()),
            float(np.abs(distances * multipliers).max(initial=0.0)),
            layout.violation(constraints),
            float(scale * np.abs(multipliers).sum()),
            weights,
            -scale * residual,
        )


def measure_optimality(driver: FailedCases) -> Optimality:
    """Compute the KKT residuals at the current point of the model of any driver that has been run.

    The total derivatives are computed once more; the model itself is not run. At the kink at which a
    driver ended (``OptimizerDriver.kink``) those of its other sides are used too.
    """
    layout = read_layout(driver)
    gradient, jacobian = ModelEvaluator(driver, layout).totals_here(once=True)
    x, constraints = flat(driver.get_design_var_values()), flat(driver.get_constraint_values())
    kink = getattr(driver, "kink", None)
    at_kink = kink is not None and np.allclose(x, kink.x, rtol=ROUNDING, atol=ROUNDING)
    return Optimality.at(layout, x, constraints, gradient, jacobian, kink.others if at_kink else ())


def _multipliers(normals, distances, free, gradients) -> tuple[NDArray, NDArray]:
    """Solve for the weights of the sides and the multipliers with the least residual.

    Multipliers are non-negative for inequalities (whose normals point inwards), ``free`` for equalities.
    """
    # min |G lambda - N mu|^2 + |diag(d) mu|^2,  lambda >= 0, sum lambda = 1, mu >= 0 for inequalities.
    # With 1 - sum lambda as a further residual the solution has the same direction, and is divided by
    # its sum of lambda: min over s of s^2 |p|^2 + (1 - s)^2 = |p|^2 / (1 + |p|^2)
    sides, m = gradients.shape[1], distances.size
    matrix = np.block([
        [gradients, -normals], [np.zeros((m, sides)), np.diag(distances)],
        [np.ones((1, sides)), np.zeros((1, m))],
    ])  # fmt: skip
    target = np.append(np.zeros(len(matrix) - 1), 1.0)
    lower = np.concatenate([np.zeros(sides), np.where(free, -np.inf, 0.0)])
    found = lsq_linear(matrix, target, (lower, np.inf), method="bvls").x
    return found[:sides] / found[:sides].sum(), found[sides:] / found[:sides].sum()


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
