"""A plate whose radius of curvature is a thousand times the size of the seal."""

import numpy as np
import pytest
from round_tip import PRESSED_TIP

import seal_mdao as sm

PLATE = PRESSED_TIP.format(section="spacing = 0.25").replace("-0.01", "-0.3")
FLAT = "line = [[-9.0, 0.0], [9.0, 0.0]]"


def force(folder, curve: str) -> float:
    """Vertical force with a given curve of the plate, tilted so that it touches one point first."""
    path = folder / "tip.toml"
    path.write_text(PLATE.replace(FLAT, f"{curve}\nangle = 4.0").replace("3.5]\nn", "3.6]\nn"))
    result = sm.analyze(sm.build_seal(path))
    result.require_converged()
    return float(result.reaction[-1, 1])


@pytest.mark.parametrize("radius", [1e4, 5e4])
def test_a_slightly_curved_plate_presses_like_a_flat_one(tmp_path, radius):
    """The gap is the difference of two distances of ``radius``: rounding must not stop the analysis."""
    curved = force(tmp_path, f"circle = {{ centre = [0.0, {radius}], radius = {radius} }}")
    flat = force(tmp_path, FLAT)
    assert flat > 100.0
    np.testing.assert_allclose(curved, flat, rtol=2e-3)
