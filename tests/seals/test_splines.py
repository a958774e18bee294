"""Boundary offsets: spline values, linearity, what stays put, design velocities."""

import numpy as np
import pytest
from scipy.interpolate import BSpline

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.door.section import Section
from seal_mdao.seals.door.splines import BoundarySplines, clamped_basis, periodic_basis
from seal_mdao.seals.wall_grid import ray_directions

MODEL = sm.door_seal()
SPLINES = options_of(MODEL).splines
D0 = options_of(MODEL).section.base_angle


def test_outer_spline_is_zero_on_the_base():
    angle = np.concatenate([np.linspace(0.0, D0, 9), np.linspace(2 * np.pi - D0, 2 * np.pi, 9)])
    np.testing.assert_allclose(SPLINES.outer_basis(angle), 0.0, atol=1e-15)


def test_outer_spline_is_a_partition_of_unity_away_from_its_ends():
    """Only the two end functions are left out, which reach over the first and last interval."""
    interval = (2 * np.pi - 2 * D0) / 13
    inside = np.linspace(D0 + interval, 2 * np.pi - D0 - interval, 50)
    values = SPLINES.outer_basis(inside)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, rtol=1e-14)
    near = SPLINES.outer_basis(np.linspace(D0, D0 + 0.9 * interval, 20))
    assert np.all(near.sum(axis=1) < 1.0)
    assert np.all(values >= 0.0)


def test_inner_spline_is_a_partition_of_unity_and_periodic():
    angle = np.linspace(-1.0, 8.0, 200)
    values = SPLINES.inner_basis(angle)
    np.testing.assert_allclose(values.sum(axis=1), 1.0, rtol=1e-14)
    np.testing.assert_allclose(SPLINES.inner_basis(angle + 2 * np.pi), values, atol=1e-13)
    assert np.all(values >= 0.0)


def test_inner_control_values_are_centred_at_equal_angles():
    """Value 2/3 at the own angle, 1/6 at the neighbours': the uniform cubic B-spline."""
    centres = 2 * np.pi * np.arange(11) / 11
    values = SPLINES.inner_basis(centres)
    circulant = [np.roll(np.eye(11), k, axis=1) for k in (0, 1, -1)]
    exact = 2 / 3 * circulant[0] + (circulant[1] + circulant[2]) / 6
    np.testing.assert_allclose(values, exact, atol=1e-14)


@pytest.mark.parametrize("basis", ["outer", "inner"])
def test_splines_have_two_continuous_derivatives(basis):
    """Third differences over a fine grid are bounded by the third derivative."""
    evaluate = SPLINES.outer_basis if basis == "outer" else SPLINES.inner_basis
    low, high = (D0, 2 * np.pi - D0) if basis == "outer" else (0.0, 2 * np.pi)
    counts = []
    for n in (2000, 4000):
        angle = np.linspace(low, high, n + 1)
        second = np.diff(evaluate(angle), 2, axis=0) / (angle[1] - angle[0]) ** 2
        counts.append(np.abs(np.diff(second, axis=0)).max())
    assert counts[1] < 0.6 * counts[0]


def test_outer_spline_reproduces_cubics_that_vanish_at_the_base_corners():
    """Greville-type check: a clamped cubic spline space contains all cubics."""
    low, high = D0, 2 * np.pi - D0
    angle = np.linspace(low, high, 300)
    values = clamped_basis(angle, 14, low, high)
    for power in (0, 1):
        cubic = (angle - low) * (high - angle) * angle**power
        fit, *_ = np.linalg.lstsq(values, cubic, rcond=None)
        np.testing.assert_allclose(values @ fit, cubic, atol=1e-10 * np.abs(cubic).max())


def test_periodic_spline_is_the_uniform_b_spline():
    count = 9
    step = 2 * np.pi / count
    angle = np.linspace(0.0, 2 * np.pi, 181)
    element = BSpline.basis_element(step * np.arange(-2, 3), extrapolate=False)
    values = periodic_basis(angle, count)
    for control in range(count):
        exact = sum(
            np.nan_to_num(element(angle - control * step + turn))
            for turn in (-2 * np.pi, 0, 2 * np.pi)
        )
        np.testing.assert_allclose(values[:, control], exact, atol=1e-13)


def test_base_does_not_move_for_any_design():
    moved = MODEL.design_velocity[:, options_of(MODEL).grid.base]
    assert not moved[:14].any()
    # nor do inner offsets move the outer boundary anywhere
    outer = options_of(MODEL).grid.particle(np.arange(58), 2)
    assert not MODEL.design_velocity[14:, outer].any()
    inner = options_of(MODEL).grid.particle(np.arange(58), 0)
    assert not MODEL.design_velocity[:14, inner].any()


def test_particles_are_linear_in_the_offsets(rng):
    a, b = rng.uniform(-0.4, 0.4, (2, 25))
    nominal = MODEL.particles()
    first, second, both = (MODEL.particles(o) - nominal for o in (a, b, 2 * a - 0.5 * b))
    np.testing.assert_allclose(both, 2 * first - 0.5 * second, atol=1e-13)
    np.testing.assert_array_equal(nominal, MODEL.nominal_particles)


def test_offsets_move_particles_along_their_rays(rng):
    """By the spline values on the boundaries, linearly between across the wall."""
    offsets = rng.uniform(-0.4, 0.4, 25)
    motion = (MODEL.particles(offsets) - MODEL.nominal_particles).reshape(58, 3, 2)
    angle = options_of(MODEL).grid.angles
    rays = ray_directions(angle)
    along = np.einsum("rki,ri->rk", motion, rays)
    across = motion - along[..., None] * rays[:, None]
    outer = SPLINES.outer_basis(angle) @ offsets[:14]
    inner = SPLINES.inner_basis(angle) @ offsets[14:]
    np.testing.assert_allclose(across, 0.0, atol=1e-13)
    exact = np.column_stack([inner, 0.5 * (inner + outer), outer])
    np.testing.assert_allclose(along, exact, atol=1e-13)


def test_design_velocity_is_the_derivative_of_the_particles():
    for p in (0, 6, 13, 14, 24):
        unit = np.eye(25)[p]
        exact = (MODEL.particles(0.3 * unit) - MODEL.particles(-0.3 * unit)) / 0.6
        np.testing.assert_allclose(MODEL.design_velocity[p], exact, atol=1e-13)


def test_refined_model_has_the_same_boundary():
    """Every second ray of the finer ring carries the same boundary particles."""
    fine = sm.door_seal(rays=116, layers=5)
    offsets = np.linspace(-0.3, 0.3, 25)
    coarse_x, fine_x = MODEL.particles(offsets), fine.particles(offsets)
    rays = np.arange(58)
    for coarse_layer, fine_layer in ((0, 0), (1, 2), (2, 4)):
        np.testing.assert_allclose(
            coarse_x[options_of(MODEL).grid.particle(rays, coarse_layer)],
            fine_x[options_of(fine).grid.particle(2 * rays, fine_layer)],
            rtol=0.0,
            atol=1e-13,
        )


@pytest.mark.parametrize("wrong", [{"outer_parameters": 1}, {"inner_parameters": 3}])
def test_too_few_control_values_are_refused(wrong):
    with pytest.raises(ValueError, match=next(iter(wrong))):
        BoundarySplines(Section(), **wrong)


@pytest.mark.parametrize("wrong", [{"outer_parameters": 5.0}, {"inner_parameters": "11"}])
def test_numbers_of_control_values_are_integers(wrong):
    with pytest.raises((TypeError, ValueError), match=next(iter(wrong))):
        BoundarySplines(Section(), **wrong)


def test_symmetric_splines_are_those_of_mirrored_control_values():
    half = BoundarySplines(SPLINES.section, 5, 4, symmetric=True)
    whole = BoundarySplines(SPLINES.section, 10, 7)
    angle = np.linspace(0.0, 2 * np.pi, 181)
    outer, inner = np.arange(1.0, 6.0), np.arange(1.0, 5.0)
    np.testing.assert_allclose(
        half.outer_basis(angle) @ outer, whole.outer_basis(angle) @ [*outer, *outer[::-1]]
    )
    np.testing.assert_allclose(
        half.inner_basis(angle) @ inner, whole.inner_basis(angle) @ [*inner, *inner[:0:-1]]
    )
    np.testing.assert_array_equal(half.breaks, whole.breaks)


def test_symmetric_designs_are_their_own_mirror_images(rng):
    model = sm.door_seal(symmetric=True, outer_parameters=5, inner_parameters=4)
    section = model.particles(rng.uniform(-0.5, 0.5, model.n_offsets))
    row = section.reshape(-1, options_of(model).layers, 2)
    np.testing.assert_allclose(row[:, :, 0], -np.roll(row[::-1], 1, axis=0)[:, :, 0], atol=1e-13)
    np.testing.assert_allclose(row[:, :, 1], np.roll(row[::-1], 1, axis=0)[:, :, 1], atol=1e-13)
