"""Cases of the sensitivity page, and the most certain derivatives out of finite differences."""

from functools import cache
from typing import NamedTuple

import numpy as np

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.result import SealResult
from verification.differences import (
    SCHEMES,
    Design,
    Differences,
    contact_states,
    evaluation_noise,
    measure_rates,
    measure_values,
)
from verification.estimates import plateau
from verification.gradients import design_away

TIGHT = sm.NewtonOptions(tolerance=1e-11)
STEPS = (3e-5, 1e-5, 3e-6)
"""Steps out of which the most certain derivative of every measure is taken, mm."""


class Case(NamedTuple):
    """A design analysed and differentiated.

    Attributes
    ----------
    design : Design
    result : SealResult
    analytic : ndarray, shape (m, P)
    """

    design: Design
    result: SealResult
    analytic: np.ndarray

    def differences_in_state(self, other: SealResult) -> int:
        """Entries in which the contact sequences of two paths differ, -1 for other step numbers."""
        here, there = contact_states(self.result), contact_states(other)
        return int(np.sum(here != there)) if here.shape == there.shape else -1


def _case(model: sm.Seal, values: np.ndarray) -> Case:
    design = Design(model, values)
    result = design.analyze(keep_factors=True)
    rates = sm.differentiate(result, method="direct")
    return Case(design, result, measure_rates(result, rates))


@cache
def away(seed: int) -> Case:
    """A random design 0.3 mm away from the nominal seal."""
    model = sm.door_seal(newton=TIGHT)
    return _case(model, design_away(model, seed))


@cache
def case(radius: float | None = None, **changes) -> Case:
    """The nominal seal, or another door radius or model; computed once."""
    model = sm.door_seal(newton=TIGHT, **changes)
    radius = options_of(model).nominal_door_radius if radius is None else radius
    return _case(model, np.append(np.zeros(model.n_offsets), radius))


class Quotient(NamedTuple):
    """A second-order difference quotient.

    Attributes
    ----------
    value : ndarray, shape (m,)
    changed : int
        Contact states that differ along the paths of its analyses.
    """

    value: np.ndarray
    changed: int


def at_step(origin: Case, parameter: int, scheme: str, step: float) -> Quotient:
    """One quotient, whatever the contact does."""
    value, changed = 0.0, 0
    for place, weight in SCHEMES[scheme]:
        result = origin.result
        if place != 0:
            result = origin.design.moved(parameter, place * step).analyze()
            changed += abs(origin.differences_in_state(result))
        value = value + weight / step * measure_values(result)
    return Quotient(value, changed)


class Estimated(NamedTuple):
    """Derivatives from finite differences.

    Attributes
    ----------
    value, uncertainty : ndarray, shape (m,)
    scheme : str
        central, forward or backward.
    """

    value: np.ndarray
    uncertainty: np.ndarray
    scheme: str


@cache
def noise() -> np.ndarray:
    """Rounding of the nominal seal's measures."""
    return evaluation_noise(case().design)


def estimate(origin: Case, parameter: int) -> Estimated:
    """The most certain derivative out of the quotients that keep the contact sequence.

    Without a number where the sequence changes at nearly every step.
    """
    found = Differences(origin.design, origin.result, parameter, noise(), STEPS)
    if found.same.sum() < 2:
        return Estimated(*np.full((2, noise().size), np.nan), found.scheme)
    size = np.linalg.norm([weight for _, weight in SCHEMES[found.scheme]])
    best = plateau(found.quotient[found.same], found.steps[found.same], size * noise())
    return Estimated(best.value, best.uncertainty, found.scheme)
