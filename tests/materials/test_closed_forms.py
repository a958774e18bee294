"""Stress in simple states against the textbook's formulas in the stretch.

In plane strain every isochoric state appears with lambda_3 = 1: stretches over J^(1/3) are what
counts. Uniaxial (L, L^-1/2, L^-1/2) is diag(L^(3/2), 1), equibiaxial (L, L, L^-2) is diag(L^3, L^3),
planar (L, 1, 1/L) is itself. The Kirchhoff stress differences J (sigma_i - sigma_j) are the same.
"""

import numpy as np
import pytest
from arruda_boyce import SERIES, ArrudaBoyce
from laws import size

from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.ogden import Ogden

STRETCHES = [0.4, 0.7, 0.9, 1.0, 1.1, 1.5, 2.0]


def response(law, stretches):
    """beta_1 and beta_2 of tau_i - tau_j = beta_1 (l_i^2 - l_j^2) - beta_2 (l_i^-2 - l_j^-2)."""
    x = np.sum(stretches**2) - 3
    if isinstance(law, MooneyRivlin):
        return 2 * law.c10, 2 * law.c01
    if isinstance(law, Gent):
        return law.shear_modulus * law.limit / (law.limit - x), 0.0
    if isinstance(law, ArrudaBoyce):
        terms = enumerate(SERIES)
        return 2 * law.modulus * sum(
            c * (i + 1) * ((x + 3) / law.links) ** i for i, c in terms
        ), 0.0
    c10, c20, c30 = (law.constants.get(name, 0.0) for name in ("c10", "c20", "c30"))
    return 2 * (c10 + 2 * c20 * x + 3 * c30 * x**2), 0.0


def difference(law, stretches, i, j):
    """tau_i - tau_j of an incompressible material in the principal stretches, product one."""
    one, two = stretches[i], stretches[j]
    if isinstance(law, Ogden):
        return sum(m * (one**a - two**a) for m, a in zip(law.mu, law.alpha, strict=True))
    first, second = response(law, stretches)
    return first * (one**2 - two**2) - second * (one**-2.0 - two**-2.0)


def kirchhoff(law, first, second):
    """J times the three principal Cauchy stresses of diag(first, second, 1)."""
    F = np.diag([first, second])
    t, j = np.float64(first**2 + second**2), np.float64(first * second)
    return np.array([*np.diag(law.stress(F) @ F.T), j * law.across(t, j)[0]])


@pytest.mark.parametrize("stretch", STRETCHES)
@pytest.mark.parametrize("kind", ["uniaxial", "equibiaxial", "planar"])
def test_simple_tension_and_compression_of_rubber(isochoric, kind, stretch):
    """Rounding of the sums in 12 operations, times the powers of the stretches (below 30)."""
    plane, full = {
        "uniaxial": ((stretch**1.5, 1.0), (stretch, stretch**-0.5, stretch**-0.5)),
        "equibiaxial": ((stretch**3, stretch**3), (stretch, stretch, stretch**-2)),
        "planar": ((stretch, 1 / stretch), (stretch, 1 / stretch, 1.0)),
    }[kind]
    if isinstance(isochoric, Gent) and np.sum(np.square(full)) - 3 >= isochoric.limit:
        t, j = np.float64(plane[0] ** 2 + plane[1] ** 2), np.float64(plane[0] * plane[1])
        assert np.isnan(isochoric.derivatives(t, j)).all()
        return
    tau, exact = kirchhoff(isochoric, *plane), np.array(full)
    for i, j in ((0, 1), (0, 2), (1, 2)):
        expected = difference(isochoric, exact, i, j)
        bound = 1e-12 * max(size(isochoric), abs(expected))
        assert tau[i] - tau[j] == pytest.approx(expected, rel=0.0, abs=bound)
    assert tau.sum() == pytest.approx(0.0, abs=1e-12 * max(size(isochoric), np.abs(tau).max()))


@pytest.mark.parametrize("stretch", STRETCHES)
@pytest.mark.parametrize("nu", [0.0, 0.1, 0.3, 0.45])
@pytest.mark.parametrize("alpha", [2.0, 6.2, -3.1])
def test_foam_in_plane_strain_compression(stretch, nu, alpha):
    """Free in y: lambda_y = lambda_x^(-nu / (1 - nu)), and with J^(-alpha b) = lambda_y^alpha

    P_x = 2 mu/alpha (lambda_x^alpha - lambda_y^alpha) / lambda_x,
    sigma_z = 2 mu/alpha (1 - lambda_y^alpha) / J.
    """
    law = Hyperfoam(mu=(70.0,), alpha=(alpha,), nu=(nu,))
    free = stretch ** (-nu / (1 - nu))
    tau = kirchhoff(law, stretch, free)
    scale = 1e-12 * 2 * 70.0 / abs(alpha) * max(1.0, stretch**alpha, free**alpha) * 10
    pull = 2 * 70.0 / alpha * (stretch**alpha - free**alpha)
    across = 2 * 70.0 / alpha * (1 - free**alpha)
    np.testing.assert_allclose(tau, [pull, 0.0, across], rtol=0.0, atol=scale)


@pytest.mark.parametrize("stretch", STRETCHES)
def test_foam_without_poisson_effect(stretch):
    """nu = 0: every principal stress depends on its own stretch alone."""
    law = Hyperfoam(mu=(60.0, 25.0), alpha=(6.2, -3.1), nu=(0.0, 0.0))
    for other in (0.8, 1.0, 1.2):
        tau = kirchhoff(law, stretch, other)
        exact = [
            sum(2 * m / a * (x**a - 1) for m, a in zip(law.mu, law.alpha, strict=True))
            for x in (stretch, other, 1.0)
        ]
        bound = 1e-12 * max(size(law), np.abs(exact).max())
        np.testing.assert_allclose(tau, exact, rtol=0.0, atol=bound)


def test_simple_shear_of_rubber():
    """Gent: sigma_12 = G gamma / (1 - gamma^2 / Jm); Ogden by its principal stretches."""
    for gamma in (1e-3, 0.1, 1.0, 3.0):
        F = np.array([[1.0, gamma], [0.0, 1.0]])
        law = Gent(shear_modulus=190.0, limit=12.0)
        exact = 190.0 * gamma / (1 - gamma**2 / 12.0)
        assert law.stress(F)[0, 1] == pytest.approx(exact, rel=1e-12)
        law = Ogden(mu=(630.0, 1.2, -10.0), alpha=(1.3, 5.0, -2.0))
        long = 0.5 * gamma + np.sqrt(1 + 0.25 * gamma**2)  # gamma = lambda - 1 / lambda
        spread = difference(law, np.array([long, 1 / long, 1.0]), 0, 1)
        exact = spread / (long + 1 / long)
        assert law.stress(F)[0, 1] == pytest.approx(exact, rel=1e-11)
