"""Kinks at which an optimiser stops, where no smooth optimality condition can hold.

Where a contact point changes its state, the derivatives of the two sides differ, and an optimum may lie
at the kink itself. A bundle of gradients shows it (Burke, Lewis & Overton, SIAM J. Optim. 15, 2005): a
short step along the steepest descent has crossed the kink where the objective falls by less than the
derivatives predict. The derivatives there join those before, until their convex combination satisfies
the optimality conditions.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from seal_mdao.drivers.optimality import Optimality

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from seal_mdao.drivers.callbacks import SolverCallbacks
    from seal_mdao.drivers.evaluation import Evaluation

RADIUS = 1e-4
"""Length of a step across a kink, over 1 + |x|, in driver scaling."""
SIDES = 10
"""Points whose derivatives are combined, at the most."""
PROMISED = 0.5
"""Fraction of the predicted decrease that a step of a smooth function brings."""
NAMED = 3
"""Changes of state that a message names; it counts the others."""


class Side(NamedTuple):
    """Point beside a kink with its gradient and Jacobian, and the states of the model there by name."""

    point: Evaluation
    totals: tuple
    states: dict[str, str]


@dataclass(frozen=True)
class Kink:
    """A kink at which a run ended.

    Attributes
    ----------
    x : ndarray, shape (n,)
        Result of the run, in driver scaling.
    others : list of (gradient, jacobian)
        Total derivatives on the other sides.
    optimality : Optimality
        Of all sides together.
    changes : list of str
        States of the model that differ between the sides.
    """

    x: NDArray[np.float64]
    others: list
    optimality: Optimality
    changes: list[str]

    def __str__(self) -> str:
        named = "; ".join(self.changes[:NAMED])
        more = len(self.changes) - NAMED
        named += f"; and {more} more" if more > 0 else ""
        what = (
            f"a design at which contact points just begin to touch, stick or slip ({named})"
            if named
            else "a kink"
        )
        return f"Stationary at {what}, from which no direction improves; {self.optimality}"


def find_kink(
    callbacks: SolverCallbacks,
    totals: tuple,
    tol: float,
    feas_tol: float,
    states: Callable[[], dict[str, str]],
) -> Kink | None:
    """Search for a kink at the best point, where the optimality conditions do not hold.

    A better point that is found on the way becomes the best one.

    Parameters
    ----------
    callbacks : SolverCallbacks
    totals : (gradient, jacobian)
        At the best point.
    tol, feas_tol : float
        Of ``Optimality.satisfied``.
    states : callable
        Returns the states of the model at its current point, by their names.

    Returns
    -------
    Kink or None
        None where the point is smooth and can be improved, is infeasible, or a step cannot be analysed.
    """
    # bundle of gradients, that of the best point first
    layout, sides = callbacks.evaluator.layout, [_side(callbacks, callbacks.best, totals, states)]
    while sides[-1] is not None and callbacks.feasible and len(sides) <= SIDES:
        # conditions at the best point, its own derivatives first
        best = callbacks.best
        sides.sort(key=lambda side: side.point is not best)
        others = [side.totals for side in sides[1:]]
        found = Optimality.at(layout, best.x, best.constraints, *sides[0].totals, others)
        # a convex combination of all sides satisfies the KKT conditions
        if found.satisfied(tol, feas_tol):
            return Kink(best.x, others, found, _changes(sides, found.weights))
        size = float(np.linalg.norm(found.descent))
        # no common descent direction, though the conditions are not satisfied
        if size <= tol:
            return None
        # x + r d / |d|, predicted decrease r |d|
        length = RADIUS * (1.0 + np.abs(best.x).max())
        x = layout.clip(best.x + length / size * found.descent)
        point = callbacks.values(x)
        # the derivatives at the new point join the bundle
        totals = None if point is None else callbacks.derivatives(x)
        sides.append(_side(callbacks, point, totals, states))
        decrease = best.objective - callbacks.best.objective
        # decrease as predicted: the function is smooth here
        if decrease >= PROMISED * length * size:
            return None
    return None


def _side(callbacks: SolverCallbacks, point, totals, states) -> Side | None:
    """Add the states at a point; None if it was not evaluated or the run is to stop."""
    if totals is None:
        return None
    # derivatives of a continued run are read from its file: the model is at another point
    callbacks.guarded(callbacks.evaluator.load, point.x)
    return None if callbacks.stopping else Side(point, totals, states())


def _changes(sides: list[Side], weights) -> list[str]:
    """Describe the states in which the sides of the convex combination differ."""
    involved = [side.states for side, weight in zip(sides, weights, strict=True) if weight > 0.0]
    found = {}
    for states in involved:
        for name, state in states.items():
            # states of each component over the sides with nonzero weight
            found.setdefault(name, []).append(state)
    return [
        f"{name}: {' or '.join(dict.fromkeys(own))}" for name, own in found.items()
        if len(set(own)) > 1
    ]  # fmt: skip
