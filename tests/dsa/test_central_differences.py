"""Sensitivities against central differences of the whole path, step studies, same contact sequence."""

import numpy as np
import pytest
from step_study import column, errors, measured, own_scale, plateau, row_scale

import seal_mdao as sm

SCALARS = (
    "door_radius", "normal_penalty", "tangent_penalty", "friction", "c10", "c01", "bulk_modulus",
    "depth",
)  # fmt: skip
# relative to the parameter; small enough for the curvature, large enough for the rounding
SCALAR_STEPS = {
    "door_radius": (2e-5, 7e-6, 2e-6),
    "normal_penalty": (9e-4, 5e-4, 3e-4),
    "tangent_penalty": (6e-4, 2e-4, 7e-5),
    "friction": (1e-3, 3e-4, 1e-4),
    "c10": (1e-3, 3e-4, 1e-4),
    "c01": (1e-3, 3e-4, 1e-4),
    "bulk_modulus": (9e-4, 3e-4, 1e-4),
    "depth": (4e-5, 1.3e-5, 4e-6),
}
OFFSET_STEPS = (3e-5, 1e-5, 3e-6)
LONG_PATH_STEPS = (2e-5, 7e-6)


def quick_model(**changes):
    """A shorter path with larger steps; no particle touches exactly at the end of a step."""
    newton = sm.NewtonOptions(tolerance=1e-11)
    return sm.door_seal(
        **{"depth": 7.0, "n_steps": 40, "start": 10.03, "newton": newton, **changes}
    )


@pytest.fixture(scope="module")
def quick():
    """A random design on the shorter path: stick, slip, open points between, re-contact."""
    offsets = np.random.default_rng(3).uniform(-0.2, 0.2, 25)
    return sm.analyze(quick_model(), offsets, 4.1, keep_factors=True)


@pytest.fixture(scope="module")
def of_quick(quick):
    return sm.differentiate(quick, SCALARS)


def check_offset_or_radius(result, name, sides=(1, -1)):
    """The acceptance bounds: 1e-5 for all measures, 1e-7 for the sum of the squared gaps."""
    exact = sm.differentiate(result)
    found = plateau(result, result.points, name, LONG_PATH_STEPS, sides)
    worst = errors(found, column(exact, name), row_scale(exact, name, 26))
    assert max(worst.values()) <= 1e-5
    assert worst["gap_square_sum"] <= 1e-7


@pytest.mark.parametrize("name", ["boundary_offsets[0]", "boundary_offsets[10]", "door_radius"])
def test_drawn_seal(drawn, name):
    check_offset_or_radius(drawn, name)


def test_drawn_seal_where_the_touch_step_changes(drawn):
    """The top touches exactly at the end of step 5: one-sided, where the sequence is kept."""
    check_offset_or_radius(drawn, "boundary_offsets[6]", sides=(-1, -2))


@pytest.mark.parametrize("name", ["boundary_offsets[3]", "boundary_offsets[16]", "door_radius"])
def test_random_design(random_design, name):
    check_offset_or_radius(random_design, name)


@pytest.mark.parametrize("name", ["boundary_offsets[4]", "boundary_offsets[20]", *SCALARS])
def test_random_design_on_a_shorter_path(quick, of_quick, name):
    """All scalar parameters too; each is compared with its own column."""
    size = {"door_radius": 4.1, "bulk_modulus": 8e4, "c10": 80.0, "c01": 20.0}.get(name)
    size = size or getattr(quick.model, name, 1.0)
    steps = [size * step for step in SCALAR_STEPS.get(name, (9e-5, 3e-5, 1e-5))]
    exact = column(of_quick, name)
    assert len(exact["gap"]) >= 3
    worst = errors(plateau(quick, quick.points, name, steps), exact, own_scale(exact))
    assert max(worst.values()) <= 5e-6
    assert worst["gap_square_sum"] <= 2e-7


VARIANTS = {
    "flat door": ({"door": "flat"}, "boundary_offsets[5]"),
    "segments": ({"segments": 32}, "door_radius"),
    "incremental": ({"friction_history": "incremental"}, "boundary_offsets[8]"),
    "incremental, more slip": (
        {"friction_history": "incremental", "tangent_penalty": 1e3}, "boundary_offsets[20]"
    ),
    "frictionless": ({"friction": 0.0, "depth": 3.0}, "boundary_offsets[9]"),
    "quadratic basis": ({"basis_order": 2}, "boundary_offsets[18]"),
    "three Gauss points": ({"n_gauss": 3}, "boundary_offsets[18]"),
    "refined": ({"rays": 116, "n_steps": 8, "depth": 1.5}, "boundary_offsets[3]"),
}  # fmt: skip


@pytest.mark.parametrize("variant", VARIANTS)
def test_variants_of_the_model(variant):
    """At a design of 0.05 mm, small enough for every variant to converge."""
    changes, name = VARIANTS[variant]
    offsets = np.random.default_rng(5).uniform(-0.05, 0.05, 25)
    result = sm.analyze(quick_model(**changes), offsets, 4.05, keep_factors=True)
    assert result.converged
    exact = column(sm.differentiate(result), name)
    found = plateau(result, result.points, name, OFFSET_STEPS)
    worst = errors(found, exact, own_scale(exact))
    assert max(worst.values()) <= 1e-5


@pytest.mark.parametrize("name", ["boundary_offsets[10]", "door_radius"])
def test_path_with_cut_steps(cut, name):
    """The parts of a cut step carry history like whole ones."""
    assert cut.step_cuts > 0
    check_offset_or_radius(cut, name)


@pytest.mark.parametrize("name", ["boundary_offsets[6]", "boundary_offsets[19]"])
def test_point_that_touches_in_the_first_step(name):
    """Its slip counts from the undeformed position, which moves with the design."""
    offsets = np.concatenate([np.full(14, 0.05), np.linspace(-0.1, 0.1, 11)])
    result = sm.analyze(quick_model(start=9.6, n_steps=38), offsets, keep_factors=True)
    assert (result.path.steps[0].after.state != 0).any()
    exact = column(sm.differentiate(result), name)
    worst = errors(plateau(result, result.points, name, OFFSET_STEPS), exact, own_scale(exact))
    assert max(worst.values()) <= 1e-5


def test_measures_of_the_step_study_are_those_of_the_result(quick):
    found = measured(quick, quick.points)
    np.testing.assert_array_equal(found["von_mises"], quick.von_mises)
    np.testing.assert_array_equal(found["gap"], quick.gap)
    np.testing.assert_array_equal(found["reaction"], quick.reaction[-1])


def test_area_rate_is_exact(quick, of_quick):
    """Quadratic in the offsets, and not a function of anything else."""
    step, offsets = 0.01, quick.boundary_offsets
    for p in (2, 15):
        e = step * np.eye(25)[p]
        areas = [
            sm.SealResult(quick.model, o, 4.1, quick.path).area for o in (offsets + e, offsets - e)
        ]
        assert of_quick.area[p] == pytest.approx((areas[0] - areas[1]) / (2 * step), rel=1e-9)
    assert not of_quick.area[25:].any()
