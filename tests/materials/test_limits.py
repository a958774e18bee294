"""Where one law is another, or tends to it."""

import numpy as np
import pytest
from laws import FAR, NEAR, UNDEFORMED

from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh

T, J = (np.array(x) for x in zip(*(s.invariants for s in [UNDEFORMED, *NEAR, *FAR]), strict=True))
SAME = [
    (MooneyRivlin(70.0, 0.0), NeoHookean(70.0)),
    (Yeoh(70.0), NeoHookean(70.0)),
    (Ogden((140.0,), (2.0,)), NeoHookean(70.0)),
    (Ogden((140.0, -40.0), (2.0, -2.0)), MooneyRivlin(70.0, 20.0)),
    (Ogden((50.0, 90.0), (2.0, 2.0)), NeoHookean(70.0)),
]


@pytest.mark.parametrize(("one", "other"), SAME, ids=lambda law: type(law).__name__)
def test_the_same_law_in_two_forms(one, other):
    """To rounding of the second derivatives: 20 operations on numbers up to 30 moduli."""
    bound = 20 * 30 * np.finfo(float).eps * 140.0
    for name in ("energy", "derivatives", "across"):
        np.testing.assert_allclose(
            getattr(one, name)(T, J), getattr(other, name)(T, J), rtol=1e-14, atol=bound
        )
    assert one.shear_modulus == pytest.approx(other.shear_modulus, rel=1e-15)
    assert one.initial_bulk_modulus == pytest.approx(80_000.0, rel=1e-15)


@pytest.mark.parametrize("limit", [1e2, 1e4, 1e6])
def test_gent_tends_to_the_neo_hookean_law_with_the_inverse_of_its_limit(limit):
    """W_T by the factor 1 / (1 - x / Jm), W by 1 + x / (2 Jm) + (x / Jm)^2 / 3 + ..."""
    x = (T + 1) * J ** (-2 / 3) - 3
    t, j, x = T[x > 0.1], J[x > 0.1], x[x > 0.1]
    law, other, rounding = Gent(140.0, limit), NeoHookean(70.0), 10 * np.finfo(float).eps * limit
    found = (law.derivatives(t, j)[0] / other.derivatives(t, j)[0] - 1) * limit
    np.testing.assert_allclose(found, x / (1 - x / limit), rtol=0.0, atol=rounding)
    found = (law.energy(t, j) / other.energy(t, j) - 1) * limit
    assert np.all(np.abs(found - 0.5 * x) <= 0.4 * x**2 / limit + rounding)


@pytest.mark.parametrize("ratio", [0.999999, 1.0, 1.5])
def test_gent_has_no_value_from_its_limit_on(ratio):
    law = Gent(200.0, 3.0)
    # pure shear, x = (lambda - 1 / lambda)^2
    gamma = np.sqrt(3.0 * ratio)
    t, j = np.array([2.0 + gamma**2]), np.array([1.0])
    values = [law.energy(t, j), law.derivatives(t, j), law.von_mises(t, j), law.across(t, j)]
    if ratio < 1.0:
        assert all(np.isfinite(value).all() for value in values)
        assert law.derivatives(t, j)[0] > 1e5 * 200.0
    else:
        assert all(np.isnan(value).all() for value in values)


def test_gent_without_value_at_one_point_leaves_the_others():
    law = Gent(200.0, 3.0)
    t, j = np.array([2.5, 9.0, 2.2]), np.ones(3)
    found = law.derivatives(t, j)
    np.testing.assert_array_equal(np.isnan(found).any(axis=0), [False, True, False])
    np.testing.assert_array_equal(found[:, ::2], law.derivatives(t[::2], j[::2]))


@pytest.mark.parametrize("nu", [1e-12, 1e-9, 1e-6])
def test_foam_goes_smoothly_to_poissons_ratio_zero(nu):
    """The change is linear in nu: nothing is lost to the division by b."""
    at = {value: Hyperfoam((60.0, 25.0), (6.2, -3.1), (value, value)) for value in (0.0, nu)}
    change = at[nu].energy(T, J) - at[0.0].energy(T, J)
    log = np.log(J)  # d/db of (J^(-alpha b) - 1) / b at 0 is (alpha ln J)^2 / 2
    exact = nu * (60.0 + 25.0) * log**2
    np.testing.assert_allclose(change, exact, rtol=1e-4, atol=1e-12)


def test_initial_moduli():
    foam = Hyperfoam((60.0, 25.0), (6.2, -3.1), (0.3, 0.2))
    assert foam.shear_modulus == pytest.approx(85.0, rel=1e-14)
    bulk = 2 * 60.0 * (1 / 3 + 0.3 / 0.4) + 2 * 25.0 * (1 / 3 + 0.2 / 0.6)
    assert foam.initial_bulk_modulus == pytest.approx(bulk, rel=1e-14)
    assert foam.bulk_modulus == 0.0
    # one term: nu is Poisson's ratio
    foam = Hyperfoam((60.0,), (6.2,), (0.3,))
    shear, bulk = foam.shear_modulus, foam.initial_bulk_modulus
    assert (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear) == pytest.approx(0.3, rel=1e-14)
    assert Ogden((630.0, 1.2, -10.0), (1.3, 5.0, -2.0)).shear_modulus == pytest.approx(
        422.5, rel=1e-14
    )
    assert Gent(190.0, 12.0).derivatives(2.0, 1.0)[0] == pytest.approx(95.0, rel=1e-15)
    assert Yeoh(100.0, -8.0, 3.0).shear_modulus == 200.0
