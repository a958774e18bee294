"""Stagnation of an optimiser at a jump of the model, on both sides of which it tries designs endlessly.

A response jumps, for instance, where the seal snaps through in one load case beyond a certain design.
No derivative predicts the jump: a step across it is rejected and halved, the next one is accepted and
doubled.
"""

from collections import deque

import numpy as np

from seal_mdao.drivers.evaluation import Evaluation
from seal_mdao.drivers.layout import ProblemLayout

PATIENCE = 20
"""Number of successive designs that must be nearly the same."""
SAME_DESIGN = 1e-3
"""Largest difference of a variable among them, over its largest difference among all designs."""
JUMP = 0.02
"""Difference of a response among them that is a jump, over the larger of 1 and its size; a smooth
response of moderate slope differs by about ``SAME_DESIGN``."""


class Stagnation:
    """Designs that an optimiser has tried."""

    def __init__(self):
        self._last: deque[Evaluation] = deque(maxlen=PATIENCE)
        self._low = self._high = None

    def add(self, point: Evaluation) -> None:
        """Add a design; repetitions of the last one do not count."""
        if self._last and np.array_equal(self._last[-1].x, point.x):
            return
        self._last.append(point)
        # range of all designs so far
        first = self._low is None
        self._low = point.x if first else np.minimum(self._low, point.x)
        self._high = point.x if first else np.maximum(self._high, point.x)

    def __bool__(self) -> bool:
        if len(self._last) < PATIENCE:
            return False
        # max_i (max x_i - min x_i) of the last designs << that of all designs
        recent = np.ptp([point.x for point in self._last], axis=0)
        same = recent.max() < SAME_DESIGN * (self._high - self._low).max()
        return bool(same and max(self._changes()) > JUMP)

    def jumps(self, layout: ProblemLayout) -> str:
        """Name the responses that jump between the last designs, with their changes."""
        objective, *constraints = self._changes()
        changes = {"the objective": objective} | {
            repr(name): max(constraints[rows], default=0.0)
            for name, rows in layout.constraints.items()
        }
        return ", ".join(f"{name} by {own:.2%}" for name, own in changes.items() if own > JUMP)

    def _changes(self) -> list[float]:
        """Compute the relative changes of objective and constraints between the last designs."""
        values = np.array([[point.objective, *point.constraints] for point in self._last])
        return list(np.ptp(values, axis=0) / np.maximum(1.0, np.abs(values).max(axis=0)))
