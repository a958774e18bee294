"""The mixed transformation: Kronecker property, reproducing conditions, rates and their transpose."""

import numpy as np
import pytest
from clouds import irregular_cloud, random_points, rate_rows, rows

from seal_mdao.errors import GeometryError
from seal_mdao.rkpm.essential import (
    essential_transformation,
    transformation_rates,
    transformation_seeds,
)
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.tables import build_table

CONSTRAINED = np.array([0, 1, 2, 8, 15])
N = 49


def at(which):
    which = np.asarray(which).reshape(-1, 1)
    return PointSet(which, np.ones(which.shape), 1)


def transformed(cloud, points):
    """The constrained rows, the transformation and a transformed table."""
    constrained_rows = build_table(cloud, at(CONSTRAINED))
    transformation = essential_transformation(CONSTRAINED, constrained_rows.raw)
    return constrained_rows, transformation, build_table(cloud, points, transformation)


@pytest.fixture(params=[1, 2])
def cloud(request, rng):
    return irregular_cloud(rng, order=request.param)


def test_shape_functions_of_constrained_particles_interpolate_there(cloud):
    _, _, table = transformed(cloud, at(CONSTRAINED))
    phi, _ = rows(table.table, N)
    np.testing.assert_allclose(phi[:, CONSTRAINED], np.eye(5), rtol=0.0, atol=1e-13)


def test_free_shape_functions_vanish_at_constrained_particles(cloud):
    _, _, table = transformed(cloud, at(CONSTRAINED))
    phi, _ = rows(table.table, N)
    free = np.setdiff1d(np.arange(N), CONSTRAINED)
    np.testing.assert_allclose(phi[:, free], 0.0, atol=1e-13)


def test_transformation_keeps_the_reproducing_conditions(cloud, rng):
    """With coefficients that are the values of a linear field at all particles."""
    _, _, table = transformed(cloud, random_points(rng, cloud))
    phi, grad = rows(table.table, N)
    np.testing.assert_allclose(phi.sum(axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(phi @ cloud.particles, table.coordinates, rtol=0.0, atol=1e-11)
    slopes = np.broadcast_to(np.eye(2), (len(phi), 2, 2))
    np.testing.assert_allclose(grad @ cloud.particles, slopes, rtol=0.0, atol=1e-11)


def test_transformed_functions_span_the_same_space(cloud, rng):
    """d~_C = u(X_C), d~_F = d_F gives the field of the raw coefficients d."""
    _, _, table = transformed(cloud, random_points(rng, cloud))
    _, _, own = transformed(cloud, at(CONSTRAINED))
    d = rng.standard_normal((N, 2))
    changed = d.copy()
    changed[CONSTRAINED] = rows(own.raw, N)[0] @ d
    for raw, new in zip(rows(table.raw, N), rows(table.table, N), strict=True):
        np.testing.assert_allclose(new @ changed, raw @ d, rtol=0.0, atol=1e-11)


def test_groups_that_see_no_constrained_particle_are_left_alone(cloud, rng):
    _, transformation, table = transformed(cloud, random_points(rng, cloud, groups=40))
    raw, new = table.raw, table.table
    alone = 0
    for g in range(raw.n_groups):
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        here = new.neighbours[new.start[g] : new.start[g + 1]]
        if np.isin(near, CONSTRAINED).any():
            np.testing.assert_array_equal(here, np.union1d(near, transformation.union))
            continue
        alone += 1
        np.testing.assert_array_equal(here, near)
        np.testing.assert_array_equal(
            new.phi[3 * new.start[g] : 3 * new.start[g + 1]],
            raw.phi[3 * raw.start[g] : 3 * raw.start[g + 1]],
        )
    assert alone > 0


def rates_of(constrained_rows, transformation, velocity):
    """T' along design velocities, from the rates of the raw rows."""
    rates = constrained_rows.raw_rates(velocity)
    dense, _ = rate_rows(constrained_rows.raw, rates, N, len(velocity))
    return transformation_rates(transformation, dense[:, transformation.union])


def test_transformation_rates_are_the_limit_of_central_differences(cloud, rng):
    velocity = rng.standard_normal((2, N, 2))
    constrained_rows, transformation, _ = transformed(cloud, at(CONSTRAINED))
    exact = rates_of(constrained_rows, transformation, velocity)
    errors = []
    for step in (1e-4, 1e-5):
        sides = []
        for sign in (1.0, -1.0):
            moved = cloud._replace(particles=cloud.particles + sign * step * velocity[0])
            other = transformed(moved, at(CONSTRAINED))[1]
            dense = np.zeros((5, N))
            dense[:, other.union] = other.matrix
            sides.append(dense[:, transformation.union])
        errors.append(np.abs((sides[0] - sides[1]) / (2 * step) - exact[..., 0]).max())
    assert errors[0] > 20 * errors[1]
    assert errors[1] < 1e-7 * np.abs(exact).max()


def test_transformed_rates_are_the_limit_of_central_differences(cloud, rng):
    velocity = rng.standard_normal((2, N, 2))
    constrained_rows, transformation, table = transformed(cloud, random_points(rng, cloud))
    matrix_rate = rates_of(constrained_rows, transformation, velocity)
    rates = table.rates(velocity, matrix_rate)
    exact = [values[..., 0] for values in rate_rows(table.table, rates, N, 2)]
    step, sides = 1e-5, []
    for sign in (1.0, -1.0):
        moved = cloud._replace(particles=cloud.particles + sign * step * velocity[0])
        sides.append(rows(transformed(moved, table.points)[2].table, N))
    for plus, minus, rate in zip(*sides, exact, strict=True):
        error = np.abs((plus - minus) / (2 * step) - rate).max()
        assert error < 1e-6 * np.abs(rate).max()


def test_reverse_is_the_transpose_of_forward_through_the_transformation(cloud, rng):
    velocity = rng.standard_normal((3, N, 2))
    constrained_rows, transformation, table = transformed(cloud, random_points(rng, cloud))
    matrix_rate = rates_of(constrained_rows, transformation, velocity)
    rates = table.rates(velocity, matrix_rate)
    dphi, dgrad = rate_rows(table.table, rates, N, 3)
    phi_bar = rng.standard_normal((table.table.phi.size, 1))
    grad_bar = rng.standard_normal((table.table.grad.size, 1))
    seed_phi, seed_grad = rows(table.table, N, (phi_bar[:, 0], grad_bar[:, 0]))
    forward = np.einsum("qa,qap->p", seed_phi, dphi) + np.einsum("qja,qjap->p", seed_grad, dgrad)

    x_bar = np.zeros((N, 2, 1))
    matrix_bar = table.pull_back(phi_bar, grad_bar, x_bar)
    rows_bar = transformation_seeds(transformation, matrix_bar)
    raw = constrained_rows.raw
    point = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
    own_bar = rows_bar[point, np.searchsorted(transformation.union, raw.neighbours)]
    own_bar = np.ascontiguousarray(own_bar)
    constrained_rows.pull_back(own_bar, np.zeros((raw.grad.size, 1)), x_bar)
    backward = np.einsum("ai,pai->p", x_bar[..., 0], velocity)
    size = np.abs(x_bar[..., 0] * velocity).sum(axis=(1, 2))
    np.testing.assert_allclose(backward, forward, rtol=0.0, atol=1e-12 * size.max())


def test_transformation_seeds_are_the_transpose_of_transformation_rates(cloud, rng):
    _, transformation, _ = transformed(cloud, at(CONSTRAINED))
    u = transformation.union.size
    rows_rate, matrix_bar = rng.standard_normal((5, u, 4)), rng.standard_normal((5, u, 3))
    forward = np.einsum("cum,cup->mp", matrix_bar, transformation_rates(transformation, rows_rate))
    backward = np.einsum("cum,cup->mp", transformation_seeds(transformation, matrix_bar), rows_rate)
    np.testing.assert_allclose(backward, forward, rtol=1e-12, atol=1e-12 * np.abs(forward).max())


def test_dependent_constrained_particles_are_refused(rng):
    """Two particles at the same place with the same support have the same row of Phi."""
    cloud = irregular_cloud(rng)
    particles, radius = cloud.particles.copy(), cloud.radius.copy()
    particles[1], radius[1] = particles[0], radius[0]
    twice = cloud._replace(particles=particles, radius=radius)
    with pytest.raises(GeometryError, match="linearly dependent"):
        essential_transformation(CONSTRAINED, build_table(twice, at(CONSTRAINED)).raw)
