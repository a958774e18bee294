"""Relaxing seals against independent finite elements with the same law."""

import numpy as np
import pytest

from verification.relaxing_contact import relaxation_errors

WITHIN = 1e-2
"""Over the largest force, or peak pressure, of the finite elements."""
HEIGHT = 4e-4
"""Recovery, mm: 0.1 % of the set just after the release."""


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "friction"),
    [("relaxing_disc", 0.0), ("relaxing_ring", 0.0), ("relaxing_ring", 0.2)],
)
def test_relaxation_of_a_pressed_seal(name, friction, figure):
    """In press, dwell and release."""
    errors = relaxation_errors(name, friction)
    figure(f"{name}, friction {friction}: force", np.abs(errors.force).max(), WITHIN)
    figure(f"{name}, friction {friction}: peak pressure", np.abs(errors.peak).max(), WITHIN)


@pytest.mark.long
def test_recovery_of_the_disc(figure):
    """After its release from a dwell of 10000 s."""
    errors = relaxation_errors("relaxing_disc", 0.0)
    free = errors.time > 10002.0
    figure("relaxing_disc: height after the release", np.abs(errors.height[free]).max(), HEIGHT)
