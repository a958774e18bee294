"""Leak rate of rings: radial flow below a lid and flow along a shaft, in closed form."""

import numpy as np
import pytest
from ring_files import PLANE, ring, under_a_lid

import seal_mdao as sm
from seal_mdao.measures.contact_pressure import PointPressures
from seal_mdao.measures.roughness import Roughness

LEAK = """\
[[measure]]
type = "leak_rate"
rms_roughness = 20.0
roll_off_wavelength = 500.0
shortest_wavelength = 10.0
viscosity = 2.0
pressure = 30.0
"""
ROUGH = Roughness(20.0, 500.0, 10.0)


def analyzed(folder, text):
    path = folder / "ring.toml"
    path.write_text(text + LEAK)
    result = sm.analyze(sm.build_seal(path))
    result.require_converged()
    return result


def slit(pressure):
    """dp u^3 / (12 eta), mm^3/s, with 4 G = 8 (c10 + c01) = 800 kPa."""
    height = 1e-3 * ROUGH.constriction(pressure / 800.0)[0]
    return 30.0 * height**3 / (12.0 * 2e-6)


def test_radial_flow_through_a_uniform_slit(tmp_path):
    """Below a smooth lid the strain of a ring is uniform: Q = slit 2 pi / ln(r_2 / r_1)."""
    errors = []
    for spacing in (0.5, 0.25):
        text = PLANE + under_a_lid((3.0, 5.0), 2.0, 2.0, -0.3, 2, spacing=spacing)
        result = analyzed(tmp_path, text)
        pressure = PointPressures(result, "lid", nominal=False).value
        np.testing.assert_allclose(pressure, pressure.mean(), rtol=1e-8)
        exact = slit(pressure).mean() * 2.0 * np.pi / np.log(5.0 / 3.0)
        errors.append(result.value("leak_rate")[0] / exact - 1.0)
    # int dr / r over pieces h by their mean radius: error of the order (h / r)^2
    assert abs(errors[0]) < (0.5 / 3.0) ** 2
    assert errors[1] == pytest.approx(errors[0] / 4.0, rel=0.1)
    assert result.seal.units.of(result.measure("leak_rate").units) == "mm**3/s"


@pytest.mark.parametrize("points", ["particles", "edges", "averages"])
def test_along_a_shaft_it_is_the_plane_rate_times_the_circumference(points, tmp_path):
    text = ring(points=points, penalty=1e7, friction=0.0, translate=(0.2, 0.0))
    for old, new in (
        ('contact = ["top"]', 'contact = ["bore"]'), ("start = [0.0, 2.05]", "start = [2.98, 0.0]"),
        ("line = [[-40.0, 0.0], [40.0, 0.0]]", "line = [[0.0, -40.0], [0.0, 40.0]]"),
        ('directions = ["x", "y"]', 'directions = ["y"]'),
    ):  # fmt: skip
        assert old in text
        text = text.replace(old, new)
    result = analyzed(tmp_path, text)
    where, pressure = result.term("plate").where, PointPressures(result, "plate", False).value
    assert np.all(pressure > 0.0)
    # plane: slits in series; all of the bore is at the radius of the shaft but for its penetration
    plane = 1.0 / (where.lengths(result.deformed()) / slit(pressure)).sum()
    away = np.abs(result.deformed()[result.seal.body.edge("bore").particles, 0] - 3.18).max()
    assert away < 1e-3 * 3.18
    found = result.value("leak_rate")[0]
    assert found == pytest.approx(plane * 2.0 * np.pi * 3.18, rel=1.01 * away / 3.18)
