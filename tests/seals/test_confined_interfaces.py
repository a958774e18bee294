"""Rubber that is confined at an interface between materials: a uniform state, and a warning."""

import numpy as np
import pytest

import seal_mdao as sm

BLOCK = """
[material.one]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 2e4
[material.two]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 2e4
[section]
material = "one"
spacing = 0.4
outer = [
  { edge = "base", line = [[-4.0, 0.0], [4.0, 0.0]] },
  { edge = "right", line = [[4.0, 0.0], [4.0, 4.0]] },
  { edge = "top", line = [[4.0, 4.0], [-4.0, 4.0]] },
  { edge = "left", line = [[-4.0, 4.0], [-4.0, 0.0]] },
]
region = [{ material = "two", at = [0.5, 3.0], line = [[-4.0, 1.5], [0.5, 2.2], [4.0, 1.5]] }]
[[symmetry]]
edges = ["left", "right"]
normal = "x"
[fixed]
edges = ["base"]
[[moved]]
edges = ["top"]
stage = [{ translate = [0.0, -TRAVEL], steps = 1 }]
"""
WARNING = "beside an interface between materials is"


def confined(folder, travel):
    """The block compressed by ``travel`` (mm) between rigid walls: p = K travel / 4."""
    path = folder / "block.toml"
    path.write_text(BLOCK.replace("TRAVEL", str(travel)), encoding="utf-8")
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    return result


@pytest.mark.parametrize("travel", [0.01, 0.04])
def test_a_uniform_strain_passes_through_a_bent_interface(tmp_path, travel):
    """Up to one shear modulus of pressure: u = -travel y / 4, to rounding."""
    result = confined(tmp_path, travel)
    particles = result.seal.nominal_particles
    exact = particles * [0.0, -travel / 4.0]
    np.testing.assert_allclose(result.deformed() - particles, exact, rtol=0.0, atol=1e-13)
    assert not any(WARNING in text for text in result.warnings)


def test_a_high_pressure_at_an_interface_is_reported(tmp_path):
    """Of 2.5 shear moduli, at which the particles beside the interface oscillate."""
    result = confined(tmp_path, 0.1)
    assert sum(WARNING in text for text in result.warnings) == 2
