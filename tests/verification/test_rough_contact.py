"""Persson's critical-junction theory against a direct simulation, itself against exact solutions."""

import numpy as np
import pytest

from seal_mdao.measures.roughness import Roughness
from verification.rough_contact import pressed, simulated, slit


@pytest.mark.parametrize("fraction", [0.1, 0.4, 0.8])
def test_wavy_surface(fraction):
    """Westergaard (1939): parts of the width 2/pi asin((p / p*)^(1/2)) touch, p* = pi E* a / lambda."""
    n, size = 256, 0.01
    heights = np.tile(size * np.cos(2.0 * np.pi * np.arange(n) / n), (4, 1))
    heights = np.repeat(heights, n // 4, axis=0)
    p, gap = pressed(heights, fraction * np.pi * size)
    assert p.mean() == pytest.approx(fraction * np.pi * size, rel=1e-12)
    assert not (p * gap).any()
    expected = 2.0 / np.pi * np.arcsin(np.sqrt(fraction))
    assert (p > 0.0).mean() == pytest.approx(expected, abs=2.0 / n)


def test_slits_in_series_and_in_parallel():
    gap = np.ones((8, 6))
    assert slit(gap) == pytest.approx(1.0, rel=1e-12)
    gap[4:] = 0.5
    # 2 / (1 + 8): resistances add up
    assert slit(gap) == pytest.approx(np.cbrt(2.0 / 9.0), rel=1e-12)
    gap = np.ones((8, 6))
    gap[:, 3:] = 0.0
    assert slit(gap) == pytest.approx(np.cbrt(0.5), rel=1e-12)
    gap[5] = 0.0
    assert slit(gap) == 0.0


def test_theory_against_simulation():
    """The leak rate falls by two and a half decades; the theory is above it, by less than ten times."""
    rough = Roughness(0.01, 1.0 / 4.0, 1.0 / 16.0)
    ratios = np.array([0.05, 0.2, 0.4, 0.6]) * rough.percolation_ratio
    found = np.array([simulated(rough, 128, seed, ratios) for seed in range(2)])
    area, separation, height = found.mean(axis=0).T
    theory = rough.constriction(ratios)[0]
    leaks = (theory / height) ** 3
    assert (height[0] / height[-1]) ** 3 > 300.0
    assert (leaks > 1.0).all()
    assert (leaks < 10.0).all()
    # contact areas of simulations are above those of the theory, by 1.7 to 1.3 here
    assert (area / rough.contact_area(ratios) < 1.8).all()
    assert (area / rough.contact_area(ratios) > 1.0).all()
    # the open paths are narrower than the mean gap
    assert (height < separation).all()
