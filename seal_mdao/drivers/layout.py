"""How design variables and constraints lie in the optimizer's flat arrays.

Everything here is in driver scaling, in the order in which OpenMDAO keeps the design variables
and the constraints. A row of the constraint vector is *active* when it depends on a design
variable; the other rows are constants, which no optimizer can do anything about.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from openmdao.core.group import Group

if TYPE_CHECKING:
    from numpy.typing import NDArray
    from openmdao.core.driver import Driver

INFINITE_BOUND = 1e20
"""Bounds at or beyond this size count as absent (users write 1e20 or 1e30 for infinity)."""


@dataclass(frozen=True)
class ProblemLayout:
    """Names, slices and bounds of an optimization problem, in driver scaling.

    Attributes
    ----------
    desvars, responses, linear : tuple of str
        Design variables; objective and nonlinear constraints in the row order of the total
        Jacobian; linear constraints.
    desvar_slices, constraint_slices : dict
        Slices of every design variable in ``x`` and of every constraint in ``c``.
    x_lower, x_upper : ndarray, shape (n,)
        Bounds of the design variables, infinite where there are none.
    c_lower, c_upper : ndarray, shape (m,)
        Bounds of the constraints; equal for equality constraints.
    nonlinear_rows, linear_rows : ndarray of int
        Rows of ``c`` in the row order of the nonlinear and of the linear total Jacobian.
    active : ndarray of bool, shape (m,)
        False for constraints that depend on no design variable.
    """

    desvars: tuple[str, ...]
    responses: tuple[str, ...]
    linear: tuple[str, ...]
    desvar_slices: dict[str, slice]
    constraint_slices: dict[str, slice]
    x_lower: NDArray[np.float64]
    x_upper: NDArray[np.float64]
    c_lower: NDArray[np.float64]
    c_upper: NDArray[np.float64]
    nonlinear_rows: NDArray[np.intp]
    linear_rows: NDArray[np.intp]
    active: NDArray[np.bool_]

    @property
    def n(self) -> int:
        """Number of design variables."""
        return self.x_lower.size

    @property
    def m(self) -> int:
        """Number of constraint rows, constants included."""
        return self.c_lower.size

    def clip(self, x: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return a copy of ``x`` moved onto the bounds where it lies outside them."""
        return np.clip(x, self.x_lower, self.x_upper)

    def violation(self, constraints: NDArray[np.float64]) -> float:
        """Return the largest constraint violation, 0 when all are satisfied.

        It is measured in driver scaling, relative to the bound where that is larger than 1.
        """
        return max(0.0, float(self._excess(constraints).max(initial=0.0)))

    def violated_constants(self, constraints: NDArray[np.float64], tol: float) -> list[str]:
        """Return names of violated constraints that depend on no design variable."""
        bad = (self._excess(constraints) > tol) & ~self.active
        return [name for name, rows in self.constraint_slices.items() if bad[rows].any()]

    def _excess(self, constraints: NDArray[np.float64]) -> NDArray[np.float64]:
        parts = []
        for bound, sign in ((self.c_lower, 1.0), (self.c_upper, -1.0)):
            finite = np.isfinite(bound)
            value = np.where(finite, bound, 0.0)
            distance = sign * (value - constraints) / np.maximum(1.0, np.abs(value))
            parts.append(np.where(finite, distance, 0.0))
        return np.maximum(*parts)


def read_layout(driver: Driver) -> ProblemLayout:
    """Read the layout of the problem a driver is attached to, after its final setup.

    Raises
    ------
    RuntimeError
        If the problem has no design variables.
    ValueError
        If a lower bound lies above its upper bound.
    """
    desvar_slices = _slices(driver, "design_var")
    constraint_slices = _slices(driver, "constraint")
    if not sum(rows.stop - rows.start for rows in desvar_slices.values()):
        raise RuntimeError("Problem has no design variables.")
    x_lower, x_upper = _bounds(driver, "design_var", desvar_slices)
    c_lower, c_upper = _bounds(driver, "constraint", constraint_slices)
    responses = tuple(driver._get_ordered_nl_responses())
    linear = tuple(name for name, meta in driver._cons.items() if meta["linear"])
    constants = constant_constraints(driver)
    active = np.ones(c_lower.size, dtype=bool)
    for name in constants:
        active[constraint_slices[name]] = False
    return ProblemLayout(
        desvars=tuple(desvar_slices),
        responses=responses,
        linear=linear,
        desvar_slices=desvar_slices,
        constraint_slices=constraint_slices,
        x_lower=x_lower,
        x_upper=x_upper,
        c_lower=c_lower,
        c_upper=c_upper,
        nonlinear_rows=_rows([n for n in responses if n in constraint_slices], constraint_slices),
        linear_rows=_rows(linear, constraint_slices),
        active=active,
    )


def constant_constraints(driver: Driver) -> list[str]:
    """Return names of the constraints that depend on no design variable.

    As in OpenMDAO nothing is said when a group approximates its derivatives, because the
    relevance graph is not reliable then.
    """
    model = driver._problem().model
    if approximates_derivatives(model):
        return []
    constants = set(model._relevance._no_dv_responses) - set(driver._designvars)
    return [name for name, meta in driver._cons.items() if meta["source"] in constants]


def approximates_derivatives(model: Group) -> bool:
    """Return whether any group of the model approximates its derivatives."""
    groups = model.system_iter(include_self=True, recurse=True, typ=Group)
    return any(group._has_approx for group in groups)


def _slices(driver: Driver, voi_type: str) -> dict[str, slice]:
    metadata = driver._vectors[voi_type].metadata
    return {name: meta["slice"] for name, meta in metadata.items()}


def _rows(names, slices: dict[str, slice]) -> NDArray[np.intp]:
    parts = [np.arange(slices[name].start, slices[name].stop) for name in names]
    return np.concatenate(parts) if parts else np.zeros(0, dtype=np.intp)


def _bounds(driver: Driver, voi_type: str, slices: dict[str, slice]):
    """Return flat scaled lower and upper bounds of design variables or constraints."""
    size = sum(rows.stop - rows.start for rows in slices.values())
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    scaled = driver.autoscaler.get_bounds_scaling(voi_type)
    for name, rows in slices.items():
        bounds = scaled[name]
        if bounds.equals is not None:
            lower[rows] = upper[rows] = bounds.equals
            continue
        if bounds.lower is not None:
            lower[rows] = bounds.lower
        if bounds.upper is not None:
            upper[rows] = bounds.upper
        _swap_reflected(lower[rows], upper[rows], _scaler(driver, voi_type, name))
    lower[lower <= -INFINITE_BOUND] = -np.inf
    upper[upper >= INFINITE_BOUND] = np.inf
    for name, rows in slices.items():
        if (lower[rows] > upper[rows]).any():
            raise ValueError(f"The lower bound of '{name}' lies above its upper bound.")
    return lower, upper


def _scaler(driver: Driver, voi_type: str, name: str):
    metadata = getattr(driver.autoscaler, "_var_meta", None)
    source = driver._designvars if voi_type == "design_var" else driver._cons
    return (metadata[voi_type] if metadata else source)[name]["total_scaler"]


def _swap_reflected(lower, upper, scaler) -> None:
    """Swap, in place, bounds that a negative scaler has turned round (OpenMDAO does not)."""
    if scaler is None or not np.any(np.asarray(scaler) < 0.0):
        return
    turned = np.broadcast_to(np.asarray(scaler).ravel() < 0.0, lower.shape)
    old_lower = lower.copy()
    lower[turned] = np.where(np.isposinf(upper), -np.inf, upper)[turned]
    upper[turned] = np.where(np.isneginf(old_lower), np.inf, old_lower)[turned]
