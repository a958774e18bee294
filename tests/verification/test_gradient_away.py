"""Gradients at designs 0.3 mm away from the drawn seal are as exact as at the drawn seal itself."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.verification.differences import (
    Design,
    Differences,
    measure_names,
    measure_rates,
)
from seal_mdao.verification.estimates import error_scale
from seal_mdao.verification.gradients import DISTANCE, design_away, second_order_limit
from seal_mdao.verification.tolerances import TOLERANCES

STEPS = (2e-5, 7e-6)
PARAMETERS = (0, 4, 9, 13, 16, 20, 25)
"""On both boundaries; the last one is the door's radius."""


def gradient_errors(design, result, rates):
    """Relative errors (parameters, measures) against quotients of the same contact sequence."""
    scale = error_scale(rates)
    none = np.zeros(len(rates))
    errors = []
    for p in PARAMETERS:
        found = Differences(design, result, p, none, STEPS)
        assert found.same.sum() >= 2, f"parameter {p}: the contact sequence changes"
        value = second_order_limit(found.steps[found.same], found.quotient[found.same])
        errors.append(np.abs(value - rates[:, p]) / scale[:, p])
    return np.array(errors)


@pytest.mark.parametrize("seed", [1, 3])
def test_gradient_is_as_exact_as_at_the_drawn_seal(figure, seed):
    model = sm.door_seal(newton=sm.NewtonOptions(tolerance=1e-11))
    design = Design(model, design_away(model, seed))
    result = design.analyze(keep_factors=True)
    assert np.abs(result.boundary_offsets).max() == pytest.approx(DISTANCE)
    # another seal indeed
    assert abs(result.gap_square_sum / 0.0519 - 1.0) > 0.5
    names = measure_names(result)
    assert len(names) == 18
    rates = measure_rates(sm.differentiate(result))
    errors = gradient_errors(design, result, rates)
    worst = errors[:, names.index("gap_square_sum")].max()
    name = f"gradient 0.3 mm away, design {seed}: "
    figure(name + "all 18 measures", errors.max(), TOLERANCES["differences"])
    figure(name + "sum of squared gaps", worst, TOLERANCES["differences_gap"])


def test_limit_of_quotients_is_exact_for_a_cubic():
    """Central quotients of x^3 at 1 are 3 + h^2."""
    steps = np.array([0.1, 0.08, 0.05])
    quotients = (3.0 + steps**2)[:, None]
    assert second_order_limit(steps, quotients) == pytest.approx(3.0, rel=1e-14)
    with pytest.raises(ValueError, match="near"):
        second_order_limit(steps[:2], quotients[:2])
