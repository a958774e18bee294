"""The O-ring of the examples between planes: a closed form for small squeeze, Lindley's for large."""

from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from verification.o_ring import (
    lindley_force,
    small_force,
    small_squeeze,
    squeeze_ring,
)
from verification.tolerances import TOLERANCES

pytest.importorskip("netgen")

FILE = Path(__file__).parents[2] / "examples" / "o_ring.toml"


@pytest.fixture(scope="module")
def ring():
    return squeeze_ring(sm.read_seal_file(FILE), 0.25)


def at(ring, squeeze):
    """The step with a squeeze, and what the laws want besides it."""
    step = int(np.abs(ring.squeeze - squeeze).argmin())
    assert ring.squeeze[step] == pytest.approx(squeeze, rel=1e-9)
    return step, (ring.diameter, ring.modulus)


def test_the_inverse_of_the_closed_form():
    squeeze, width, _ = small_squeeze(300.0, 6.0, 5000.0)
    assert small_force(squeeze, 6.0, 5000.0) == pytest.approx(300.0, rel=1e-9)
    assert width == pytest.approx(2.0 * np.sqrt(4.0 * 300.0 * 3.0 / (np.pi * 5000.0)))


def test_modulus_is_that_of_plane_strain(ring):
    """Nearly incompressible: four thirds of Young's modulus, which is three shear moduli of 1250 kPa."""
    assert ring.modulus == pytest.approx(4.0 * 1250.0, rel=5e-3)


@pytest.mark.parametrize("squeeze", [0.0125, 0.025, 0.0375, 0.05])
def test_small_squeeze(ring, figure, squeeze):
    step, size = at(ring, squeeze)
    name = f"O-ring squeezed by {100 * squeeze:g} %: "
    force = ring.force[step]
    error = abs(force / small_force(squeeze, *size) - 1.0)
    figure(name + "force, closed form", error, TOLERANCES["o_ring_small"])
    peak = abs(ring.peak[step] / small_squeeze(force, *size)[2] - 1.0)
    figure(name + "peak pressure, closed form", peak, TOLERANCES["o_ring_peak"])


@pytest.mark.parametrize("squeeze", [0.1, 0.15, 0.2, 0.25])
def test_large_squeeze(ring, figure, squeeze):
    step, size = at(ring, squeeze)
    error = abs(ring.force[step] / lindley_force(squeeze, *size) - 1.0)
    name = f"O-ring squeezed by {100 * squeeze:g} %: force, Lindley"
    figure(name, error, TOLERANCES["o_ring_large"])
