"""Laws that can be fitted: unknown constants, their bounds, and random starting points.

The stress is linear in all moduli; only exponents, limits and Poisson's ratios make a fit nonlinear.
A starting point therefore samples those alone, and the best moduli follow from a linear problem.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from seal_mdao.calibration.data import MaterialTests
from seal_mdao.calibration.loading_modes import MODES, Mode
from seal_mdao.materials.by_name import LAWS
from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh
from seal_mdao.values import one_of, real

EXPONENTS = (0.1, 25.0)
"""Range of |alpha|."""
POISSON = (0.0, 0.49)
"""Range of Poisson's ratio of a foam; with b >= 0 every term of its energy is convex."""
LARGEST_LIMIT = 1e5
"""Largest limit Jm of Gent's law, at which it is practically neo-Hookean."""
MAX_TERMS = 3


@dataclass(frozen=True)
class Unknown:
    """A constant to be fitted, with its bounds; the stress is linear in a ``modulus``."""

    name: str
    lower: float
    upper: float
    modulus: bool = True


@dataclass(frozen=True)
class Family:
    """A law with some of its constants unknown.

    Attributes
    ----------
    law : str
        Name in seal files and on the command line.
    template : Isotropic
        Holds the constants that are not fitted.
    draw : callable
        ``draw(rng)`` returns the unknowns of one start, and values of those that are not moduli.
    convex : bool
        Whether all unknowns are moduli, so that every start leads to the same solution.
    """

    law: str
    template: Isotropic
    draw: Callable
    convex: bool


FREE, POSITIVE = (-np.inf, np.inf), (0.0, np.inf)


def _linear(law, template, **bounds) -> Family:
    """A law of moduli alone."""
    unknowns = [Unknown(name, *box) for name, box in bounds.items()]
    return Family(law, template, lambda rng: (unknowns, {}), True)


def _neo_hookean(tests, terms, nu, bulk):
    return _linear("neo_hookean", NeoHookean(1.0, bulk), c10=POSITIVE)


def _mooney_rivlin(tests, terms, nu, bulk):
    return _linear("mooney_rivlin", MooneyRivlin(1.0, 1.0, bulk), c10=POSITIVE, c01=POSITIVE)


def _yeoh(tests, terms, nu, bulk):
    return _linear("yeoh", Yeoh(1.0, 0.0, 0.0, bulk), c10=POSITIVE, c20=FREE, c30=FREE)


def _gent(tests, terms, nu, bulk):
    # Jm > max(I1 - 3) of the data: the law must be defined at all readings
    least = 1.0001 * largest_distortion(tests)
    unknowns = [
        Unknown("shear_modulus", *POSITIVE),
        Unknown("limit", least, max(LARGEST_LIMIT, 2.0 * least), modulus=False),
    ]

    def draw(rng):
        # limit from 1.01 to 100 times the least one, log-uniform
        return unknowns, {"limit": least * 10.0 ** rng.uniform(0.005, 2.0)}

    return Family("gent", Gent(1.0, 2.0 * least, bulk), draw, False)


def _exponents(rng, terms: int):
    """Sample the signs of one start and the exponents: |alpha| log-uniform between 0.5 and 10."""
    signs = rng.choice([1.0, -1.0], terms, p=[0.6, 0.4])
    alpha = signs * 0.5 * 20.0 ** rng.uniform(0.0, 1.0, terms)
    # bounds keep the signs of the start
    unknowns = [_signed(f"alpha_{i}", s, *EXPONENTS, False) for i, s in enumerate(signs, 1)]
    return signs, unknowns, {f"alpha_{i}": a for i, a in enumerate(alpha, 1)}


def _signed(name: str, sign: float, lower: float, upper: float, modulus: bool) -> Unknown:
    return Unknown(name, *sorted((sign * lower, sign * upper)), modulus)


def _ogden(tests, terms, nu, bulk):
    def draw(rng):
        signs, exponents, values = _exponents(rng, terms)
        # mu alpha > 0: every term, hence the law, is stable at every stretch
        moduli = [_signed(f"mu_{i}", s, *POSITIVE, True) for i, s in enumerate(signs, 1)]
        return [*moduli, *exponents], values

    return Family("ogden", Ogden((1.0,) * terms, (2.0,) * terms, bulk), draw, False)


def _hyperfoam(tests, terms, nu, bulk):
    if nu is None and not tests.has_lateral:
        raise ValueError(
            f"{tests.source}: the law hyperfoam can be fitted only to tests with the column "
            "lateral_stretch in every mode, or with a given Poisson's ratio (nu, --nu)"
        )
    numbers = range(1, terms + 1)

    def draw(rng):
        _, exponents, values = _exponents(rng, terms)
        # mu_i > 0 and beta_i >= 0: a convex energy
        unknowns = [*(Unknown(f"mu_{i}", *POSITIVE) for i in numbers), *exponents]
        if nu is None:
            unknowns += [Unknown(f"nu_{i}", *POISSON, modulus=False) for i in numbers]
            values |= {f"nu_{i}": rng.uniform(0.02, 0.45) for i in numbers}
        return unknowns, values

    # a template: its values are replaced by those of the starts
    ratios = (0.2 if nu is None else nu,) * terms
    return Family("hyperfoam", Hyperfoam((1.0,) * terms, (2.0,) * terms, ratios), draw, False)


_FAMILY_OF = {
    NeoHookean: _neo_hookean,
    MooneyRivlin: _mooney_rivlin,
    Yeoh: _yeoh,
    Gent: _gent,
    Ogden: _ogden,
    Hyperfoam: _hyperfoam,
}
OF_TERMS = ("ogden", "hyperfoam")
"""Laws that are sums of 1 to ``MAX_TERMS`` terms."""


def family(
    law: str,
    tests: MaterialTests,
    terms: int = 1,
    nu: float | None = None,
    bulk_modulus: float = 80_000.0,
) -> Family:
    """Build the family of a law for some data: its unknowns, bounds and starting points.

    Parameters
    ----------
    law : str
        One of ``materials.by_name.LAWS``.
    tests : MaterialTests
        Gent's limit lies above them; a foam needs their lateral stretches unless ``nu`` is given.
    terms : int
        Number of terms of ``ogden`` and ``hyperfoam``, 1 to 3; 1 for the others.
    nu : float, optional
        Poisson's ratio of all terms of a foam, if it is not fitted.
    bulk_modulus : float
        Of nearly incompressible laws, which these tests do not determine, kPa.

    Raises
    ------
    ValueError
        For an unknown law, or options that the law does not have.
    """
    one_of("law", law, tuple(LAWS))
    # only sums of terms have a number of them, only foams a Poisson's ratio
    most = MAX_TERMS if law in OF_TERMS else 1
    if not 1 <= terms <= most:
        raise ValueError(
            f"the material law {law} has 1 to {most} terms, got {terms}; only "
            f"{' and '.join(OF_TERMS)} can have more than one"
        )
    if nu is not None and law != "hyperfoam":
        raise ValueError(
            f"{law} is nearly incompressible and has no Poisson's ratio, got nu = {nu:g}; leave nu "
            "out (only hyperfoam has it)"
        )
    if nu is not None:
        real("nu", nu, *POISSON)
    return _FAMILY_OF[LAWS[law]](tests, terms, nu, bulk_modulus)


def largest_distortion(tests: MaterialTests) -> float:
    """Compute the largest I1 - 3 of the data at J = 1."""
    found = [distortion(MODES[name], data.stretch).max() for name, data in tests.modes.items()]
    return max(0.0, *map(float, found))


def distortion(mode: Mode, stretch: np.ndarray) -> np.ndarray:
    """Compute I1 - 3 of stretches in one mode at J = 1."""
    # lambda, its lateral stretches at J = 1
    state = mode.stretches(stretch, stretch**mode.incompressible_rate)
    # I1 - 3 = sum lambda_i^2 - 3
    return np.sum(state**2, axis=0) - 3.0
