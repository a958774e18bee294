"""Law of Ogden and Roxburgh: its factor, its potential, and impossible constants."""

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.special import erf

from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh, softened, step_potential

LAWS = [(2.0, 10.0, 0.1), (1.2, 0.0, 0.4), (5.0, 3.0, 0.0)]
ENERGIES, LARGEST = np.array([0.0, 3.0, 19.0, 24.999]), 25.0


@pytest.mark.parametrize("constants", LAWS)
def test_factor_and_its_derivatives(constants):
    r, m, beta = constants
    found = softened(ENERGIES, LARGEST, *constants)
    z = (LARGEST - ENERGIES) / (m + beta * LARGEST)
    np.testing.assert_allclose(found.factor, 1.0 - erf(z) / r, rtol=1e-15)
    given = np.array([LARGEST, *constants])

    def factor(energy, changed):
        return softened(energy, *changed).factor

    step = 1e-5
    ends = [factor(ENERGIES + s * step, given) for s in (0.5, -0.5)]
    np.testing.assert_allclose(found.by_energy, (ends[0] - ends[1]) / step, atol=1e-9)
    exact = [found.by_largest, *found.by_constants]
    for row, own in enumerate(exact):
        ends = [factor(ENERGIES, given + s * step * np.eye(4)[row]) for s in (0.5, -0.5)]
        # m = 0 has one side
        if given[row] > 0.0:
            np.testing.assert_allclose(own, (ends[0] - ends[1]) / step, atol=1e-8)


@pytest.mark.parametrize("constants", LAWS)
def test_the_potential_has_the_slope_of_the_factor(constants):
    """It is W at W_max and above, and eta is its slope below."""
    for energy in ENERGIES:
        fallen = quad(lambda w: softened(w, LARGEST, *constants).factor, energy, LARGEST)[0]
        potential = step_potential(np.array(energy), LARGEST, *constants)
        assert potential == pytest.approx(LARGEST - fallen, rel=1e-12)
    assert step_potential(np.array(31.0), LARGEST, *constants) == 31.0


@pytest.mark.parametrize("constants", [*LAWS, (np.inf, 1.0, 0.0)])
def test_the_primary_branch_is_the_elastic_law(constants):
    """To the bit, in the undeformed state with an energy below zero by rounding, too."""
    for energy, largest in ((25.0, 25.0), (26.0, 25.0), (0.0, 0.0), (-1e-16, 0.0)):
        found = softened(np.array(energy), np.array(largest), *constants)
        assert found.factor == 1.0
        if energy >= largest:
            assert not any(np.any(own) for own in found[1:])
        assert np.isfinite([*found[1:3], *found[3]]).all()


def test_a_point_that_does_not_soften():
    """An infinite r."""
    found = softened(ENERGIES, LARGEST, np.inf, 1.0, 0.0)
    np.testing.assert_array_equal(found.factor, 1.0)
    assert not any(own.any() for own in found[1:])
    np.testing.assert_array_equal(step_potential(ENERGIES, LARGEST, np.inf, 1.0, 0.0), ENERGIES)


@pytest.mark.parametrize(
    ("constants", "words"),
    [((1.0, 10.0, 0.1), "r of softening must be a number above 1"),
     ((2.0, -1.0, 0.1), "m of softening must be a number of at least 0"),
     ((2.0, 1.0, -0.1), "beta of softening must be a number of at least 0"),
     ((2.0, 0.0, 0.0), "both zero"), ((np.nan, 1.0, 0.0), "r of softening")],
)  # fmt: skip
def test_impossible_constants_are_refused(constants, words):
    with pytest.raises(ValueError, match=words):
        OgdenRoxburgh(*constants)


def test_constants_by_name():
    law = OgdenRoxburgh(2.0, 10.0, 0.1)
    assert law.constants == {"softening_r": 2.0, "softening_m": 10.0, "softening_beta": 0.1}
    assert law.with_(softening_m=4.0) == OgdenRoxburgh(2.0, 4.0, 0.1)
