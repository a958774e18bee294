"""Snap-through and sway of a shallow arch: Fung and Kaplan, NACA TN 2840."""

import pytest

from verification.shallow_arch import critical_load, press_arch, released_energy
from verification.tolerances import TOLERANCES


def test_closed_form():
    """c = 2: R = u^3 - ... has its peak 4 at u = 1; c = 3 sways at R = 3 + 3 sqrt 5."""
    assert critical_load(2.0) == pytest.approx(4.0, rel=1e-14)
    assert critical_load(3.0) == pytest.approx(9.708203932499369, rel=1e-14)
    assert released_energy(2.0) == pytest.approx(6.75, rel=1e-14)


@pytest.mark.parametrize(("rise", "kind"), [(2.0, "limit"), (3.0, "branch")])
def test_critical_load_and_energy(rise, kind):
    arch = press_arch(rise)
    first = arch.path.critical_points[0]
    assert first.kind == kind
    assert arch.load == pytest.approx(1.0, rel=TOLERANCES["arch"])
    assert all(step.stable for step in arch.path.steps)
    if kind == "limit":
        assert arch.released == pytest.approx(1.0, rel=TOLERANCES["arch"])
        assert first.mode[:, 1].min() == pytest.approx(-1.0)
