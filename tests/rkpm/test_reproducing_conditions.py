"""Reproducing conditions (6) and agreement with a plain complex evaluation of Eqs. (10)-(13)."""

import numpy as np
import pytest
from clouds import irregular_cloud, product_cloud, random_points, reference_shape, rows

from seal_mdao.rkpm.cells import circumscribed_radii, support_axes
from seal_mdao.rkpm.kernel import product_kernel_derivatives
from seal_mdao.rkpm.shape_functions import Cloud, PointSet
from seal_mdao.rkpm.tables import build_table

ORDERS = (1, 2)


def shape_rows(cloud, points):
    table = build_table(cloud, points)
    return table.coordinates, *rows(table.table, len(cloud.particles))


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
def test_constants_and_linear_fields_are_reproduced(rng, order, size):
    cloud = irregular_cloud(rng, order=order, size=size)
    x, phi, grad = shape_rows(cloud, random_points(rng, cloud))
    particles = cloud.particles / size
    np.testing.assert_allclose(phi.sum(axis=1), 1.0, rtol=1e-12)
    np.testing.assert_allclose(phi @ particles, x / size, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(grad.sum(axis=2) * size, 0.0, atol=1e-12)
    slopes = np.broadcast_to(np.eye(2), (len(x), 2, 2))
    np.testing.assert_allclose(grad @ cloud.particles, slopes, rtol=0.0, atol=1e-12)


def test_quadratic_fields_are_reproduced_by_the_quadratic_basis(rng):
    cloud = irregular_cloud(rng, order=2)
    x, phi, grad = shape_rows(cloud, random_points(rng, cloud))
    for i, k in ((0, 0), (0, 1), (1, 1)):
        field = cloud.particles[:, i] * cloud.particles[:, k]
        exact = x[:, [i]] * np.eye(2)[k] + x[:, [k]] * np.eye(2)[i]
        np.testing.assert_allclose(phi @ field, x[:, i] * x[:, k], rtol=0.0, atol=2e-12)
        np.testing.assert_allclose(grad @ field, exact, rtol=0.0, atol=1e-11)


def test_quadratic_fields_are_not_reproduced_by_the_linear_basis(rng):
    cloud = irregular_cloud(rng, order=1)
    x, phi, _ = shape_rows(cloud, random_points(rng, cloud))
    assert np.abs(phi @ cloud.particles[:, 0] ** 2 - x[:, 0] ** 2).max() > 1e-2


@pytest.mark.parametrize("make", [irregular_cloud, product_cloud])
@pytest.mark.parametrize("order", ORDERS)
def test_values_and_gradients_are_those_of_a_plain_evaluation(rng, order, make):
    cloud = make(rng, n=5, order=order)
    x, phi, grad = shape_rows(cloud, random_points(rng, cloud, groups=4))
    for point in range(len(x)):
        value, slope = reference_shape(x[point], cloud.particles, cloud, order)
        np.testing.assert_allclose(phi[point], value.real, rtol=0.0, atol=1e-12)
        np.testing.assert_allclose(grad[point], slope.real, rtol=0.0, atol=1e-11)


@pytest.mark.parametrize("order", ORDERS)
def test_gradients_are_the_complex_step_of_the_values(rng, order):
    cloud = irregular_cloud(rng, n=5, order=order)
    x, _, grad = shape_rows(cloud, random_points(rng, cloud, groups=4))
    for point in range(len(x)):
        for j in range(2):
            moved = x[point] + 1e-30j * np.eye(2)[j]
            value, _ = reference_shape(moved, cloud.particles, cloud, order)
            np.testing.assert_allclose(grad[point, j], value.imag / 1e-30, rtol=0.0, atol=1e-11)


def test_product_kernels_on_a_regular_grid_give_the_bicubic_b_splines(rng):
    """Supports of two spacings in cells of 3 x 1, turned: no correction is left away from the sides."""
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    index = np.stack(np.meshgrid(np.arange(9), np.arange(9), indexing="ij"), -1).reshape(-1, 2)
    particles = index * [3.0, 1.0] @ turn.T
    first = (9 * np.arange(8)[:, None] + np.arange(8)).ravel()
    cells = np.column_stack([first, first + 9, first + 10, first + 1])
    axes = support_axes(cells, particles, (2.0, 2.0))
    cloud = Cloud(particles, circumscribed_radii(axes), 1.0, 3, axes=axes)
    inside = PointSet(cells[[36, 27, 45]], rng.dirichlet(np.ones(4), 3), 1)
    x, phi, _ = shape_rows(cloud, inside)
    for place, row in zip(x, phi, strict=True):
        exact = [product_kernel_derivatives(*(place - p), *axes[0].ravel())[0] for p in particles]
        np.testing.assert_allclose(row, np.array(exact), atol=1e-14)


def test_shape_functions_do_not_depend_on_units_or_origin(rng):
    """Integer powers of two scale without rounding: the values are the same bit for bit."""
    cloud = irregular_cloud(rng, order=2)
    points = random_points(rng, cloud)
    _, phi, grad = shape_rows(cloud, points)
    scaled = Cloud(1024 * cloud.particles, 1024 * cloud.radius, 1024 * cloud.scale, cloud.n_basis)
    _, phi_s, grad_s = shape_rows(scaled, points)
    np.testing.assert_array_equal(phi_s, phi)
    np.testing.assert_array_equal(1024 * grad_s, grad)
    shifted = cloud._replace(particles=cloud.particles + np.array([30.0, -50.0]))
    _, phi_m, grad_m = shape_rows(shifted, points)
    np.testing.assert_allclose(phi_m, phi, rtol=0.0, atol=1e-11)
    np.testing.assert_allclose(grad_m, grad, rtol=0.0, atol=1e-10)


def test_grouping_of_points_does_not_change_the_shape_functions(rng):
    cloud = irregular_cloud(rng)
    points = random_points(rng, cloud, groups=6, group_size=4)
    single = PointSet(points.anchors, points.weights, 1)
    for together, alone in zip(shape_rows(cloud, points), shape_rows(cloud, single), strict=True):
        np.testing.assert_allclose(together, alone, rtol=0.0, atol=1e-13)


def test_shape_functions_are_not_interpolating(rng):
    """Which is why essential conditions need a transformation."""
    cloud = irregular_cloud(rng)
    centre = PointSet(np.array([[24]]), np.ones((1, 1)), 1)
    _, phi, _ = shape_rows(cloud, centre)
    assert phi[0, 24] < 0.9
