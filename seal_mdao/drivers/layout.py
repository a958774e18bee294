"""Layout of design variables and constraints in the flat arrays of an optimiser, in driver scaling."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from openmdao.core.driver import Driver

from seal_mdao import openmdao_access as access

INFINITE_BOUND = 1e20
"""Bounds at or beyond this size count as absent (users write 1e20 or 1e30 for infinity)."""


@dataclass(frozen=True)
class ProblemLayout:
    """Names, slices and bounds of an optimisation problem, in driver scaling.

    Attributes
    ----------
    desvars, constraints : dict of str to slice
        Slice of every design variable in ``x`` and of every constraint in ``c``.
    responses, linear : list of str
        Objective and nonlinear constraints in the row order of their total derivatives; linear
        constraints.
    x_lower, x_upper : ndarray, shape (n,)
        Bounds of the design variables, infinite where there are none.
    c_lower, c_upper : ndarray, shape (m,)
        Bounds of the constraints; equal for equality constraints.
    active : ndarray of bool, shape (m,)
        False for constraints that depend on no design variable, which no optimiser can change.
    """

    desvars: dict[str, slice]
    constraints: dict[str, slice]
    responses: list[str]
    linear: list[str]
    x_lower: NDArray[np.float64]
    x_upper: NDArray[np.float64]
    c_lower: NDArray[np.float64]
    c_upper: NDArray[np.float64]
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
        """Return a copy of ``x`` clipped to the bounds."""
        return np.clip(x, self.x_lower, self.x_upper)

    @property
    def jacobian_pattern(self) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Rows and columns of the dense Jacobian of the active constraints, row by row."""
        count = int(self.active.sum())
        return np.repeat(np.arange(count), self.n), np.tile(np.arange(self.n), count)

    def rows(self, names: list[str]) -> NDArray[np.intp]:
        """Return the rows of the constraint vector of the constraints among ``names``."""
        # the empty part gives an array of integers if no name is a constraint
        every = np.arange(self.m)
        parts = [every[self.constraints[name]] for name in names if name in self.constraints]
        return np.concatenate([every[:0], *parts])

    def violation(self, constraints: NDArray[np.float64]) -> float:
        """Return the largest constraint violation, relative to the bound where that exceeds 1."""
        return max(0.0, float(self._excess(constraints).max(initial=0.0)))

    def violated(self, constraints: NDArray[np.float64], tol: float) -> str:
        """Name the constraints that are violated by more than ``tol`` with their largest violation, for
        messages; empty without any."""
        excess = self._excess(constraints)
        largest = {n: float(excess[rows].max(initial=0.0)) for n, rows in self.constraints.items()}
        return ", ".join(f"{name} by {own:.2g}" for name, own in largest.items() if own > tol)

    def violated_constants(self, constraints: NDArray[np.float64], tol: float) -> list[str]:
        """Return names of violated constraints that depend on no design variable."""
        violated = (self._excess(constraints) > tol) & ~self.active
        return [name for name, rows in self.constraints.items() if violated[rows].any()]

    def _excess(self, constraints: NDArray[np.float64]) -> NDArray[np.float64]:
        # (lower - c) / max(1, |lower|) and (c - upper) / max(1, |upper|); zero for absent bounds
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
        If the problem has no design variables, or an objective with several entries.
    ValueError
        If a lower bound lies above its upper bound.
    """
    desvars = _slices(driver.get_design_var_values())
    constraints = _slices(driver.get_constraint_values())
    x_lower, x_upper = _bounds(access.scaled_bounds(driver, "design_var"), desvars)
    c_lower, c_upper = _bounds(access.scaled_bounds(driver, "constraint"), constraints)
    if not x_lower.size:
        raise RuntimeError("Problem has no design variables.")
    require_single_objective(driver)
    # constraints whose responses depend on no design variable
    active = np.ones(c_lower.size, dtype=bool)
    for name in access.constant_constraints(driver):
        active[constraints[name]] = False
    return ProblemLayout(
        desvars, constraints, access.nonlinear_responses(driver), access.linear_constraints(driver),
        x_lower, x_upper, c_lower, c_upper, active,
    )  # fmt: skip


def require_single_objective(driver: Driver) -> None:
    """Raise RuntimeError for an objective that is an array of several numbers."""
    for name, value in driver.get_objective_values().items():
        if np.size(value) != 1:
            raise RuntimeError(
                f"{driver.msginfo}: the objective {name!r} has {np.size(value)} entries, but an "
                "objective must be a single number; choose one entry (add_objective(..., index=0)), or "
                "an output with a single value, such as gap_square_sum in place of gap; limits of "
                "all entries are a constraint (add_constraint)"
            )


def flat(values: dict) -> NDArray[np.float64]:
    """Concatenate values by name, as OpenMDAO returns them, to one flat array; a copy."""
    return np.concatenate([np.zeros(0), *(np.ravel(value) for value in values.values())])


def _slices(values: dict) -> dict[str, slice]:
    # consecutive slices of a flat array
    ends = np.cumsum([0, *(np.size(value) for value in values.values())]).tolist()
    return {name: slice(*ends[i : i + 2]) for i, name in enumerate(values)}


def _bounds(scaled: dict, slices: dict[str, slice]):
    """Return flat scaled lower and upper bounds of design variables or constraints."""
    size = max((rows.stop for rows in slices.values()), default=0)
    lower, upper = np.full(size, -np.inf), np.full(size, np.inf)
    for name, (low, high, equals, scaler) in scaled.items():
        rows = slices[name]
        if equals is not None:
            low = high = equals
        if low is not None:
            lower[rows] = low
        if high is not None:
            upper[rows] = high
        # OpenMDAO does not exchange lower and upper bounds for a negative scaler
        if scaler is not None and equals is None:
            turned = np.broadcast_to(np.ravel(scaler) < 0.0, lower[rows].shape)
            low, high = lower[rows][turned], upper[rows][turned]
            # an absent bound stays absent on the other side
            lower[rows][turned] = np.where(high >= INFINITE_BOUND, -np.inf, high)
            upper[rows][turned] = np.where(low <= -INFINITE_BOUND, np.inf, low)
    # OpenMDAO's 1e30 and the like, after scaling
    lower[lower <= -INFINITE_BOUND] = -np.inf
    upper[upper >= INFINITE_BOUND] = np.inf
    for name, rows in slices.items():
        if (lower[rows] > upper[rows]).any():
            raise ValueError(f"The lower bound of '{name}' lies above its upper bound.")
    return lower, upper
