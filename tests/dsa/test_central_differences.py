"""Sensitivities against differences of the whole path that go through the same contact sequence."""

from functools import partial

import numpy as np
import pytest
from lines import BACKWARD, check, slopes
from verification.differences import beside, perturbed
from verification.gradients import design_away

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import FURTHER, STANDARD, options_of

FURTHER_NAMES = tuple(measure.name for measure in FURTHER)
STEP = 7e-6
"""Of lengths, mm: small enough for the curvature, large enough for the rounding."""
# scalars and their steps relative to the value, where truncation and rounding leave about as much
SCALARS = {
    "door_radius": 5e-6, "normal_penalty": 1e-3, "tangent_penalty": 1e-3, "friction": 2e-4,
    "c10": 2e-4, "c01": 2e-4, "bulk_modulus": 2e-4, "depth": 1e-5,
}  # fmt: skip


def moved(result, way, t):
    """The analysis at a distance ``t`` along ``way``, offsets and door radius (26,)."""
    radius = options_of(result.seal).radius + t * way[-1]
    offsets = result.boundary_offsets + t * way[:-1]
    return beside(result, offsets, {"door_radius": radius})


def any_way(seed, count=26):
    """A random direction whose largest component is one."""
    way = np.random.default_rng(seed).uniform(-1.0, 1.0, count)
    return way / np.abs(way).max()


def check_along(result, way, step=STEP, further=(), **stencil):
    found = slopes(result, partial(moved, result, way), step, further, **stencil)
    check(found, sm.differentiate(result, measures=(*STANDARD, *further)), way)


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
    return sm.analyze(quick_model(), offsets, {"door_radius": 4.1}, keep_factors=True)


def analyzed(seal, design):
    """The analysis at offsets and door radius (26,), factors kept."""
    return sm.analyze(seal, design[:-1], {"door_radius": design[-1]}, keep_factors=True)


@pytest.mark.parametrize(
    "parameter",
    [0, *(pytest.param(p, marks=pytest.mark.long) for p in (10, 25))],
)
def test_drawn_seal(nominal, parameter):
    """An outer and an inner offset and the door's radius, each for itself; full length."""
    check_along(nominal, np.eye(26)[parameter])


@pytest.mark.long
def test_drawn_seal_where_the_touch_step_changes(nominal):
    """The top touches exactly at the end of step 5: one-sided, where the sequence is kept."""
    check_along(nominal, np.eye(26)[6], stencil=BACKWARD)


def test_seal_far_from_the_drawn_one(drawn_model):
    """All design parameters at once, 0.3 mm away; the optional measures too."""
    design = design_away(drawn_model, 1)
    result = analyzed(drawn_model, design)
    # another seal indeed
    assert abs(result.gap_square_sum / 0.0519 - 1.0) > 0.5
    check_along(result, any_way(2), further=FURTHER_NAMES)


@pytest.mark.parametrize(
    "parameter",
    [pytest.param(p, marks=pytest.mark.release if p % 3 else pytest.mark.long) for p in range(26)],
)
def test_every_parameter_far_from_the_drawn_seal(drawn_model, parameter):
    """At one design: elsewhere the quotients of a norm of order 40 are too uncertain to show much."""
    design = design_away(drawn_model, 1)
    result = analyzed(drawn_model, design)
    check_along(result, np.eye(26)[parameter], further=FURTHER_NAMES)


@pytest.mark.parametrize("name", SCALARS)
def test_scalar_parameters(quick, name):
    step = SCALARS[name] * quick.seal.scalars[name].value
    found = slopes(quick, partial(perturbed, quick, name), step)
    rates = sm.differentiate(quick, (name,))
    check(found, rates, np.eye(26)[25])


@pytest.mark.parametrize("name", ["bulk_modulus", "c10"])
def test_material_with_the_pressure_through_the_wall(name):
    offsets = 0.05 * any_way(5, 25)
    seal = quick_model(pressure="wall", layers=4, support=(1.8, 2.5))
    result = sm.analyze(seal, offsets, {"door_radius": 4.05}, keep_factors=True)
    found = slopes(
        result, partial(perturbed, result, name), SCALARS[name] * seal.scalars[name].value
    )
    check(found, sm.differentiate(result, (name,)), np.eye(26)[25])


VARIANTS = {
    "flat door": {"door": "flat"},
    "segments": {"segments": 32},
    "incremental": {"friction_history": "incremental"},
    "incremental, more slip": {"friction_history": "incremental", "tangent_penalty": 1e3},
    "frictionless": {"friction": 0.0, "depth": 3.0},
    "quadratic basis": {"basis_order": 2},
    "three Gauss points": {"n_gauss": 3},
    "product kernels": {"support": (1.8, 2.5)},
    "pressure through the wall": {"support": (1.8, 2.5), "layers": 4, "pressure": "wall"},
    "functions of the fine accuracy": {"accuracy": "fine", "rays": 58},
    "refined": {"support": (1.8, 2.5), "refinement": 2, "depth": 6.9},
}


QUICK_VARIANTS = "flat door", "incremental", "product kernels", "pressure through the wall"


@pytest.mark.parametrize(
    "variant",
    [pytest.param(v, marks=() if v in QUICK_VARIANTS else pytest.mark.long) for v in VARIANTS],
)
def test_variants_of_the_model(variant):
    """At a design of 0.05 mm, small enough for every variant to converge."""
    offsets = 0.05 * any_way(5, 25)
    result = sm.analyze(
        quick_model(**VARIANTS[variant]), offsets, {"door_radius": 4.05}, keep_factors=True
    )
    assert result.converged
    # along the first way the contact sequence of this variant changes
    way = any_way(2 if variant == "three Gauss points" else 1)
    # its path rounds more: a larger step
    check_along(result, way, step=3.0 * STEP if variant == "quadratic basis" else STEP)


def test_path_with_cut_steps(cut):
    """The parts of a cut step carry history like whole ones."""
    assert cut.step_cuts > 0
    # nothing that raises the top: it touches exactly at the end of step 5
    check_along(cut, np.eye(26)[10] + np.eye(26)[25])


def test_point_that_touches_in_the_first_step():
    """Its slip counts from the undeformed position, which moves with the design."""
    offsets = np.concatenate([np.full(14, 0.05), np.linspace(-0.1, 0.1, 11)])
    result = sm.analyze(quick_model(start=9.6, n_steps=38), offsets, keep_factors=True)
    assert result.path.responses("door")[0].state.any()
    check_along(result, any_way(4))
    direct, adjoint = (
        sm.differentiate(result, measures=("reaction",), method=method).reaction
        for method in ("direct", "adjoint")
    )
    np.testing.assert_allclose(direct, adjoint, rtol=0.0, atol=1e-9 * np.abs(adjoint).max())


def test_area_gradient_is_exact(quick):
    """Quadratic in the offsets."""
    step, offsets, seal = 0.01, quick.boundary_offsets, quick.seal
    gradient = seal.area(offsets)[1]
    for p in (2, 15):
        e = step * np.eye(25)[p]
        areas = [seal.area(o)[0] for o in (offsets + e, offsets - e)]
        assert gradient[p] == pytest.approx((areas[0] - areas[1]) / (2 * step), rel=1e-9)
