"""Direct and adjoint sensitivities agree to rounding: a check without any step size."""

import numpy as np
import pytest
from lines import ALWAYS as MEASURES

import seal_mdao as sm

SCALARS = (
    "door_radius", "normal_penalty", "tangent_penalty", "friction", "c10", "c01", "bulk_modulus",
    "depth",
)  # fmt: skip


def compare(result, tolerance=1e-9):
    """Every column of every measure, relative to the column's largest entry.

    Tolerance: the seal's tangents have a condition of 2e5, so that one solution is exact to 4e-11;
    twenty times that for the path's steps, whose errors add up at random.
    """
    direct = sm.differentiate(result, SCALARS, method="direct")
    adjoint = sm.differentiate(result, SCALARS, method="adjoint")
    for name in MEASURES:
        a, b = (np.atleast_2d(s[name]) for s in (direct, adjoint))
        assert a.shape == b.shape
        scale = np.abs(a).max(axis=0, initial=0.0)
        # columns that vanish identically do so in both
        floor = 1e-13 * scale.max(initial=0.0)
        assert np.all(np.abs(a - b) <= tolerance * scale + floor)
    return direct


def test_drawn_seal(nominal):
    compare(nominal)


def test_random_design(random_design):
    compare(random_design)


def test_flat_door(flat):
    """The radius of a flat door is no parameter: its column vanishes."""
    found = compare(flat)
    radius = found.parameters.index("door_radius")
    assert not found.von_mises[:, radius].any()
    assert not found.reaction[:, radius].any()


def test_without_friction(frictionless):
    """Only the last step is solved; the friction parameters' columns vanish."""
    found = compare(frictionless)
    column = found.parameters.index("tangent_penalty")
    assert not found.von_mises[:, column].any()
    assert found.von_mises[:, found.parameters.index("normal_penalty")].any()


VARIANTS = {
    "quadratic basis": {"basis_order": 2},
    "three Gauss points": {"n_gauss": 3},
    "fine": {"accuracy": "fine", "depth": 1.5, "n_steps": 8},
    "wider support": {"support": 2.5},
    "product kernels": {"support": (1.8, 2.5), "layers": 4},
    "pressure through the wall": {"pressure": "wall", "support": (1.8, 2.5), "layers": 4},
    "soft door": {"normal_penalty": 1e3, "tangent_penalty": 30.0},
    "touch in the first step": {"start": 9.6, "n_steps": 30},
    "refined": {"rays": 116, "depth": 1.5, "n_steps": 8},
}


@pytest.mark.parametrize("variant", VARIANTS)
def test_variants_of_the_model(variant, tight, random_offsets):
    """A fifth of the random design, on a shorter path."""
    changes = {"depth": 7.0, "n_steps": 40, "start": 10.03, "newton": tight} | VARIANTS[variant]
    result = sm.analyze(sm.door_seal(**changes), 0.2 * random_offsets, {"door_radius": 4.05})
    assert result.converged
    compare(result)


def test_automatic_choice_takes_fewer_right_hand_sides(nominal):
    """26 parameters against 7 stresses, 7 gaps and 2 reactions: adjoint, bit for bit."""
    automatic = sm.differentiate(nominal)
    adjoint = sm.differentiate(nominal, method="adjoint")
    np.testing.assert_array_equal(automatic.von_mises, adjoint.von_mises)
    np.testing.assert_array_equal(automatic.gap, adjoint.gap)
