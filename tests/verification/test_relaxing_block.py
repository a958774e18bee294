"""The viscoelastic rubber of the finite elements against the exact convolution."""

import json
from pathlib import Path

import numpy as np
import pytest

from verification.relaxing_block import (
    Program,
    Rubber,
    free_stretches,
    isochoric_stress,
    nominal_stress,
)

REFERENCE = Path(__file__).parent / "references" / "viscoelastic_block.json"
C10, C01 = 80.0, 20.0
KINDS = ["plane", "uniaxial"]
INCREMENTS = 1e-5
"""Largest error with 80 increments a second; 3e-6 of it are the compressibility of the elements."""


def long_term_stress(stretch, kind):
    """Nominal stress of an incompressible block (Rivlin), kPa."""
    if kind == "plane":
        return 2.0 * (C10 + C01) * (stretch - stretch**-3)
    return 2.0 * (C10 + C01 / stretch) * (stretch - stretch**-2)


@pytest.mark.parametrize("kind", KINDS)
def test_isochoric_stress_is_the_derivative_of_the_energy(rng, kind):
    """By complex steps of the principal stretches."""

    def energy(s):
        one, two, J = (s**2).sum(), s.prod() ** 2 * (s**-2).sum(), s.prod()
        return C10 * (one * J ** (-2 / 3) - 3) + C01 * (two * J ** (-4 / 3) - 3)

    stretches = free_stretches(rng.uniform(0.6, 1.5), kind)
    slopes = [energy(stretches + 1e-30j * axis).imag / 1e-30 for axis in np.eye(3)]
    found = isochoric_stress(stretches[:, None], C10, C01)[:, 0]
    np.testing.assert_allclose(found, slopes / stretches, rtol=1e-12, atol=1e-12 * C10)


@pytest.mark.parametrize("kind", KINDS)
def test_step_strain_relaxes_by_the_prony_series(kind):
    """P(t) = P_long (1 + sum beta_i exp(-t / tau_i)) after a step, which takes 1e-7 s here."""
    rubber = Rubber(C10, C01, (0.3, 0.2), (1.0, 50.0))
    program = Program((0.0, 1e-7, 1e3), (1.0, 0.8, 0.8))
    times = np.array([1e-7, 0.1, 1.0, 20.0, 200.0])
    series = 1.0 + 0.6 * np.exp(-times) + 0.4 * np.exp(-times / 50.0)
    found = nominal_stress(rubber, program, kind, times)
    np.testing.assert_allclose(found, long_term_stress(0.8, kind) * series, rtol=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_slow_compression_has_the_stress_of_the_long_term(kind):
    rubber = Rubber(C10, C01, (0.3, 0.2), (0.1, 0.2))
    (found,) = nominal_stress(rubber, Program((0.0, 1e6), (1.0, 0.8)), kind, [1e6])
    assert found == pytest.approx(long_term_stress(0.8, kind), rel=1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_finite_elements_have_the_exact_stress(kind, figure):
    """In compression, dwell and release; second order in the increment."""
    known = json.loads(REFERENCE.read_text(encoding="utf-8"))
    own = known["rubber"]
    rubber = Rubber(own["c10"], own["c01"], tuple(own["g"]), tuple(own["tau"]))
    program = Program(tuple(known["program_time_s"]), tuple(known["program_stretch"]))
    exact = nominal_stress(rubber, program, kind, known["time_s"])
    coarse, middle, fine = (np.array(v) for v in known["nominal_stress_kPa"][kind].values())
    error = np.abs(fine - exact).max() / np.abs(exact).max()
    figure(f"block of viscoelastic finite elements, {kind}: stress", error, INCREMENTS)
    # at the end of the compression
    order = np.log2((coarse - middle)[1] / (middle - fine)[1])
    figure(f"block of viscoelastic finite elements, {kind}: order from 2", abs(order - 2.0), 0.1)
