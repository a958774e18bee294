"""Measure of the difference between the load-deflection curve of a profile and a target curve."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.measures.measure import Derived
from seal_mdao.measures.reaction import Reaction
from seal_mdao.values import numbers


@dataclass(frozen=True)
class LoadDeflectionError(Derived):
    """Sum of the squared differences between forces and target forces, relative to the targets.

    Attributes
    ----------
    base : Reaction
        The forces, one value at every travel or time.
    targets : tuple of float
        Target force at every travel, in the units of ``base``.
    weights : tuple of float, or None
        Weight of every travel; 1 for all when None.

    Raises
    ------
    ValueError
        For targets or weights that are not one number for every travel, a target that is zero, weights
        that are negative or all zero.
    """

    base: Reaction
    targets: tuple
    weights: tuple | None = None
    name: str = "load_deflection_error"
    units = None
    text = "Sum of the squared differences from target forces, relative to these."

    def __post_init__(self):
        count = self.base.count
        if self.base.direction is None and len(self.base.components) > 1:
            raise ValueError(
                f"the measure {self.name!r} compares a single component of the force with targets, "
                "but the force has two components; give one component or a direction"
            )
        given = np.ones(count) if self.weights is None else self.weights
        for what, own in (("targets", self.targets), ("weights", given)):
            own = numbers(f"{what} of {self.name!r}", own)
            if own.shape != (count,) or not np.isfinite(own).all():
                raise ValueError(
                    f"{what} of {self.name!r} must be {count} finite numbers, one per travel, got "
                    f"{own.tolist()}"
                )
            object.__setattr__(self, what, tuple(own.tolist()))
        if not all(self.targets):
            raise ValueError(
                f"a target force of the measure {self.name!r} is zero, but differences are "
                "relative to the targets; leave out the travel with this target"
            )
        if min(self.weights) < 0.0 or not any(self.weights):
            raise ValueError(
                f"the weights of the target forces of {self.name!r} must not be negative, and at "
                "least one must be positive"
            )

    def value(self, values):
        # m = sum_i w_i (F_i / T_i - 1)^2,  dm/dF_i = 2 w_i (F_i / T_i - 1) / T_i
        targets, weights = np.array(self.targets), np.array(self.weights)
        away = values / targets - 1.0
        return weights @ away**2, 2.0 * weights * away / targets


class ForceTarget(NamedTuple):
    """Target or bounds of the force on a profile at some travels, for figures.

    Attributes
    ----------
    name : str
        Name of the measure.
    reaction : Reaction
        With one value at every travel.
    target, lower, upper : ndarray, shape (k,), or None
        Target and bounds at its k travels, in its unit.
    """

    name: str
    reaction: Reaction
    target: np.ndarray | None = None
    lower: np.ndarray | None = None
    upper: np.ndarray | None = None
