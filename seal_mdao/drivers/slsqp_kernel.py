"""The compiled SLSQP of SciPy, driven step by step.

``scipy.optimize.minimize`` hides the steps of SLSQP in a loop of its own, in which there is no
place for an analysis that fails and none for a limit on the step. Underneath lies a kernel that
is called with the values at a point and says what it wants next (Kraft 1988): the values at a
trial point of its line search (mode 1), the derivatives at an accepted point (mode -1), or
nothing any more. Its whole memory is in the arrays passed to it, so that a copy of them is all
that is needed to take a step back. The kernel is private to SciPy; it has been called in this
way since SciPy 1.16.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

NEEDS_VALUES = 1
NEEDS_DERIVATIVES = -1
CONVERGED = 0
INCOMPATIBLE = 4
LINE_SEARCH_STUCK = 8

EXIT_MODES = {
    0: "Optimization terminated successfully",
    2: "More equality constraints than independent variables",
    3: "More than 3*n iterations in LSQ subproblem",
    4: "Inequality constraints incompatible",
    5: "Singular matrix E in LSQ subproblem",
    6: "Singular matrix C in LSQ subproblem",
    7: "Rank-deficient equality constraint subproblem HFTI",
    8: "Positive directional derivative for linesearch",
    9: "Iteration limit reached",
}


def load_kernel() -> Callable:
    """Return SciPy's compiled SLSQP.

    Raises
    ------
    ImportError
        If this SciPy has no such kernel.
    """
    try:
        from scipy.optimize._slsqplib import slsqp
    except ImportError as error:
        raise ImportError("ResilientSLSQPDriver needs the SLSQP of SciPy 1.16 or newer.") from error
    return slsqp


@dataclass(frozen=True)
class SlsqpValues:
    """Values and derivatives at a point, in the form the kernel takes.

    Attributes
    ----------
    x : ndarray, shape (n,)
        The point.
    f : float
        Objective.
    d : ndarray, shape (m,)
        Constraints: equalities, which are to be zero, then inequalities, to be non-negative.
    g : ndarray, shape (n,)
        Gradient of the objective.
    C : ndarray, shape (m, n)
        Normals of the constraints, in Fortran order.
    """

    x: NDArray[np.float64]
    f: float
    d: NDArray[np.float64]
    g: NDArray[np.float64]
    C: NDArray[np.float64]


class SlsqpKernel:
    """The state of one SLSQP run.

    Parameters
    ----------
    n, equalities, inequalities : int
        Numbers of variables and constraints.
    max_iterations : int
        Limit on the major iterations.
    """

    def __init__(self, n: int, equalities: int, inequalities: int, max_iterations: int):
        self._slsqp = load_kernel()
        m = equalities + inequalities
        self._state = dict.fromkeys(
            ("acc", "alpha", "f0", "gs", "h1", "h2", "h3", "h4", "t", "t0", "tol"), 0.0
        )
        self._state.update(dict.fromkeys(("exact", "inconsistent", "reset", "iter", "line"), 0))
        self._state.update(itermax=max_iterations, m=m, meq=equalities, mode=0, n=n)
        self.x = np.zeros(n)
        self._multipliers = np.zeros(max(1, m + 2 * n + 2))
        self._indices = np.zeros(max(m + 2 * n + 2, 1), dtype=np.int32)
        self._buffer = np.zeros(_buffer_size(n, equalities, inequalities))

    @property
    def mode(self) -> int:
        """What the kernel wants: 1 values, -1 derivatives, otherwise it has ended."""
        return self._state["mode"]

    def call(
        self,
        values: SlsqpValues,
        lower: NDArray[np.float64],
        upper: NDArray[np.float64],
        tol: float,
    ) -> int:
        """Pass the values at ``self.x`` on and return the new mode; ``self.x`` may move.

        Parameters
        ----------
        values : SlsqpValues
            Values, and after mode -1 also derivatives, at the kernel's point.
        lower, upper : ndarray
            Bounds, infinite where there are none.
        tol : float
            Tolerance of the kernel's convergence tests; 0 switches them off.
        """
        self._state["acc"] = tol
        self._state["tol"] = 10.0 * tol
        m = max(1, self._state["m"])
        normals = np.zeros((m, self.x.size), order="F")
        normals[: values.C.shape[0]] = values.C
        distances = np.zeros(m)
        distances[: values.d.size] = values.d
        self._slsqp(
            self._state,
            values.f,
            values.g.copy(),
            normals,
            distances,
            self.x,
            self._multipliers,
            np.where(np.isfinite(lower), lower, np.nan),
            np.where(np.isfinite(upper), upper, np.nan),
            self._buffer,
            self._indices,
        )
        return self.mode

    def contract(
        self,
        start: SlsqpValues,
        lower: NDArray[np.float64],
        upper: NDArray[np.float64],
        radius: float,
    ) -> int:
        """Halve the step from ``start`` until no variable changes by more than ``radius``.

        To be called when the kernel wants the values at a first trial point. Given the values
        of the start once more its line search finds that nothing has been gained, and halves the
        step exactly. This is not counted as part of the line search.
        """
        while self.mode == NEEDS_VALUES and np.abs(self.x - start.x).max() > radius:
            self._state["line"] = 0
            self.call(start, lower, upper, 0.0)
        self._state["line"] = min(self._state["line"], 1)
        return self.mode

    def move(self, x: NDArray[np.float64]) -> None:
        """Put another point in the place of the trial point that the kernel wants.

        The step is kept in the buffer, after the Hessian (n (n + 1) / 2 entries), the point it
        begins at (n), and the weights of the constraints (m).
        """
        n = self.x.size
        begin = n * (n + 1) // 2
        step = begin + n + self._state["m"]
        self._buffer[step : step + n] = x - self._buffer[begin : begin + n]
        self.x[:] = x

    def snapshot(self) -> tuple:
        """Return a copy of the state, for `restore`."""
        arrays = (self.x, self._multipliers, self._buffer, self._indices)
        return dict(self._state), tuple(array.copy() for array in arrays)

    def restore(self, snapshot: tuple) -> None:
        """Go back to a state taken by `snapshot`."""
        state, arrays = snapshot
        self._state.update(state)
        targets = (self.x, self._multipliers, self._buffer, self._indices)
        for target, array in zip(targets, arrays, strict=True):
            target[:] = array


def _buffer_size(n: int, meq: int, mineq: int) -> int:
    """Return the workspace the kernel needs, as SciPy computes it."""
    m = meq + mineq
    size = n * (n + 1) // 2 + 3 * m * n - (m + 5 * n + 7) * meq + 9 * m
    size += 8 * n * n + 35 * n + meq * meq + 28
    if mineq == 0:
        size += 2 * n * (n + 1)
    return max(size, 1)
