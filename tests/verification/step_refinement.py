"""Refinement of the load steps: which friction history converges, and with what order."""

from typing import NamedTuple

import numpy as np

from seal_mdao.seals.door.door_seal import door_seal, with_options
from seal_mdao.seals.result import analyze

STEPS = (50, 100, 200, 400)


class StepStudy(NamedTuple):
    """Results at the end of the path for several numbers of load steps.

    Attributes
    ----------
    steps : ndarray of int, shape (m,)
    reaction : ndarray, shape (m, 2)
        Force on the door, N/m.
    gap_square_sum : ndarray, shape (m,)
        mm^2, at the frozen contact points of the nominal seal.
    """

    steps: np.ndarray
    reaction: np.ndarray
    gap_square_sum: np.ndarray

    @property
    def columns(self) -> np.ndarray:
        """Both reactions and the gap measure side by side, shape (m, 3)."""
        return np.column_stack([self.reaction, self.gap_square_sum])

    @property
    def changes(self) -> np.ndarray:
        """Change of every column from one number of steps to the next, shape (m - 1, 3)."""
        return np.abs(np.diff(self.columns, axis=0))

    @property
    def errors(self) -> np.ndarray:
        """Relative distance of every column from the last, finest row, shape (m - 1, 3)."""
        return np.abs(self.columns[:-1] / self.columns[-1] - 1.0)

    @property
    def orders(self) -> np.ndarray:
        """Least-squares slope of log error over log steps of every column, shape (3,)."""
        return observed_orders(self.steps, self.errors)

    @property
    def first_order(self) -> float:
        """What ``orders`` would be for an error of exactly 1 / steps.

        A little more than one, because the finest row is not the limit.
        """
        exact = 1.0 / self.steps[:-1] - 1.0 / self.steps[-1]
        return float(observed_orders(self.steps, exact[:, None])[0])


def observed_orders(steps: np.ndarray, errors: np.ndarray) -> np.ndarray:
    """Least-squares slopes of log errors (m - 1, k) over log steps (m,), shape (k,)."""
    return -np.polyfit(np.log(steps[:-1]), np.log(errors), 1)[0]


def refine_steps(friction_history: str, steps=STEPS, **changes) -> StepStudy:
    """The door seal under the corner door with different numbers of equal load steps.

    Every other parameter is kept. ``accumulated`` converges with order one on the average: elastic
    slip is integrated by a backward Euler step, and a point counts its slip from the step in which
    it was first found in contact, which adds a scatter of the same order. ``incremental``, Eq. (19)
    as printed, forgets the slip of earlier steps: the friction force depends on the step length and
    the results drift with the number of steps.

    Parameters
    ----------
    friction_history : {"accumulated", "incremental"}
    steps : sequence of int
        The last one serves as the reference of ``StepStudy.errors``.
    """
    model = door_seal(friction_history=friction_history, **changes)
    frozen = list(analyze(door_seal(**changes)).measure("gap").points)
    reaction, gap = [], []
    for n in steps:
        end = analyze(with_options(model, n_steps=int(n))).contact
        reaction.append(end.total)
        gap.append(float(end.gap[frozen] @ end.gap[frozen]))
    return StepStudy(np.array(steps), np.array(reaction), np.array(gap))
