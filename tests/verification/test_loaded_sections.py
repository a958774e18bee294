"""Air, fluid pressure, swelling, axial stretch and two bodies against independent finite elements."""

import pytest

from verification.loaded_sections import loaded_errors, loaded_result

pytest.importorskip("netgen")

AT_DEFAULT = {
    "air_ring": 0.008, "swollen_ring": 0.002, "stretched_bulb": 0.02, "two_humps": 0.016,
    "inflated_seal": 0.01, "pressed_dome": 0.018, "pressed_face_seal": 0.004,
}  # fmt: skip
"""Largest error of a force, energy or pressure at the default spacing."""
AT_HALF = 0.005
"""The same at half of it."""
UNCERTAIN = 0.003
"""Largest change of the finite elements by refinement or penalty."""


def check(name, refinement, largest, figure):
    errors = loaded_errors(name, loaded_result(name, refinement))
    figure(f"{name}: uncertainty of the finite elements", errors.uncertainty, UNCERTAIN)
    for quantity in ("force", "energy", "pressure"):
        figure(f"{name}, spacing / {refinement}: {quantity}", getattr(errors, quantity), largest)


@pytest.mark.parametrize("name", AT_DEFAULT)
def test_results_at_the_default_spacing(name, figure):
    check(name, 1, AT_DEFAULT[name], figure)


@pytest.mark.release
@pytest.mark.parametrize("name", AT_DEFAULT)
def test_results_at_half_of_the_default_spacing(name, figure):
    check(name, 2, AT_HALF, figure)
