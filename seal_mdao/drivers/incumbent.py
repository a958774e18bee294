"""The best point seen so far, which an interrupted run falls back to."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seal_mdao.drivers.evaluation import Evaluation


class Incumbent:
    """Keeps the feasible point of lowest objective, or the least infeasible one until then.

    Parameters
    ----------
    feasibility_tol : float
        Largest scaled constraint violation of a point that counts as feasible.
    """

    def __init__(self, feasibility_tol: float):
        self.feasibility_tol = feasibility_tol
        self.best: Evaluation | None = None

    @property
    def feasible(self) -> bool:
        """Whether the best point satisfies the constraints."""
        return self.best is not None and self.best.violation <= self.feasibility_tol

    def offer(self, point: Evaluation) -> bool:
        """Keep ``point`` if it beats the best one; return whether it does."""
        better = self.best is None or self._rank(point) < self._rank(self.best)
        if better:
            self.best = point
        return better

    def _rank(self, point: Evaluation) -> tuple[bool, float]:
        infeasible = point.violation > self.feasibility_tol
        return infeasible, point.violation if infeasible else point.objective
