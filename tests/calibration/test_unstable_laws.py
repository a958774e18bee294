"""Where laws lose their stability, against closed forms."""

import numpy as np
import pytest
from laws import LAWS
from scipy.optimize import brentq

from seal_mdao.calibration.loading_modes import EQUIBIAXIAL, MODES, PLANAR, UNIAXIAL
from seal_mdao.calibration.material_stability import (
    UnstableMaterialError,
    check_mode,
    check_stability,
    require_stable,
    smallest_stiffness,
    widened,
)
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh

SOFTENING = Ogden(mu=(300.0, -20.0), alpha=(2.0, 3.0))


def ogden_slopes(law, stretch):
    """d tau / d ln lambda of one direction, sum mu alpha lambda^alpha."""
    return sum(m * a * stretch**a for m, a in zip(law.mu, law.alpha, strict=True))


def test_softening_ogden_in_tension():
    """Changes (2, -1, -1) and (0, 1, -1): 4 h_1 + 2 h_2 and 2 h_2 must be positive."""

    def lengthwise(stretch):
        return 2 * ogden_slopes(SOFTENING, stretch) + ogden_slopes(SOFTENING, stretch**-0.5)

    begin = brentq(lengthwise, 5.0, 15.0)
    found = check_mode(SOFTENING, UNIAXIAL, 1.0, 12.0)
    assert found.begins_above == pytest.approx(begin, rel=1e-9)
    assert not found.stable
    assert f"{begin:.4g}" in found.text
    assert check_mode(SOFTENING, UNIAXIAL, 1.0, 9.0).stable


def test_a_strip_that_fails_across():
    """Planar, h = (h(L), h(1), h(1/L)): on changes that keep the volume the determinant is
    h_1 h_2 + h_2 h_3 + h_3 h_1 over 3 (the trace counts as well)."""

    def determinant(stretch):
        h = [ogden_slopes(SOFTENING, s) for s in (stretch, 1.0, 1.0 / stretch)]
        return h[0] * h[1] + h[1] * h[2] + h[2] * h[0]

    begin = brentq(determinant, 3.0, 15.0)
    found = check_mode(SOFTENING, PLANAR, 1.0, 12.0)
    assert found.begins_above == pytest.approx(begin, rel=1e-9)


def test_softening_yeoh_against_differences_of_its_energy():
    """The Hessian of W over two logarithmic strains, by differences, is singular at that stretch."""
    law = Yeoh(c10=100.0, c20=-12.0, c30=0.0)
    found = check_mode(law, PLANAR, 1.0, 3.0).begins_above
    log = np.log(found)

    def energy(a, b):
        e = np.array([log + a, b, -log - a - b])
        x = np.sum(np.exp(2 * e)) - 3
        return law.c10 * x + law.c20 * x * x

    h = 1e-4
    first = (energy(h, 0) - 2 * energy(0, 0) + energy(-h, 0)) / h**2
    second = (energy(0, h) - 2 * energy(0, 0) + energy(0, -h)) / h**2
    mixed = (energy(h, h) - energy(h, -h) - energy(-h, h) + energy(-h, -h)) / (4 * h * h)
    # relative to the products of its entries; differences are good to h^2 and 1e-15 / h^2
    assert abs(first * second - mixed**2) <= 1e-5 * (abs(first * second) + mixed**2)


def test_what_is_stable_everywhere():
    """mu alpha > 0 in every term of Ogden; neo-Hookean; convex foams."""
    for law in (LAWS["ogden_3"], NeoHookean(), Hyperfoam((60.0, 25.0), (6.2, -3.1), (0.3, 0.1))):
        found = check_stability(law, dict.fromkeys(MODES, (0.3, 4.0)))
        assert all(s.stable and s.begins_above is None and s.begins_below is None
                   for s in found.values())  # fmt: skip
        require_stable(found)


def test_stiffness_of_the_undeformed_state_is_one():
    for law in LAWS.values():
        assert smallest_stiffness(law, UNIAXIAL, [1.0])[0] == pytest.approx(1.0, rel=1e-12)


def test_a_law_that_ends():
    """Gent in equibiaxial tension: x = 2 L^2 + L^-4 - 3 reaches its limit."""
    law = Gent(shear_modulus=190.0, limit=12.0)
    end = brentq(lambda s: 2 * s**2 + s**-4 - 15.0, 1.0, 5.0)
    found = check_mode(law, EQUIBIAXIAL, 1.0, 4.0)
    # to the spacing of the scan
    assert found.begins_above == pytest.approx(end, rel=np.log(5.0) / 299)
    assert found.begins_above <= end


def test_margin_and_refusal():
    assert widened(0.5, 2.0, 0.5) == pytest.approx((0.5**1.5, 2.0**1.5))
    assert widened(1.2, 2.0, 0.0) == (1.0, 2.0)
    law = Yeoh(c10=100.0, c20=-12.0, c30=0.0)
    begin = check_mode(law, UNIAXIAL, 1.0, 3.0).begins_above
    check = check_stability(law, {"uniaxial": (1.0, 0.999 * begin)}, margin=0.0)
    assert check["uniaxial"].stable
    assert check["planar"].stable  # not tested, only looked at
    assert "not tested" in check["planar"].text
    wider = check_stability(law, {"uniaxial": (1.0, 0.999 * begin)}, margin=0.1)
    with pytest.raises(
        UnstableMaterialError, match=f"uniaxial.*begins at a stretch of .*{begin:.4g}"
    ):
        require_stable(wider)
