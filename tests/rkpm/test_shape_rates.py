"""Shape functions when the particles move: forward rates, their transpose, complex step, differences."""

import numpy as np
import pytest
from clouds import (
    irregular_cloud,
    product_cloud,
    random_points,
    rate_rows,
    reference_shape,
    rows,
)

from seal_mdao.rkpm.tables import build_table

ORDERS = (1, 2)


@pytest.fixture(
    params=[(make, order) for make in (irregular_cloud, product_cloud) for order in ORDERS]
)
def moving(request, rng):
    """A cloud of either kernel and order, a point table, and three design velocities."""
    make, order = request.param
    cloud = make(rng, n=5, order=order)
    table = build_table(cloud, random_points(rng, cloud, groups=4))
    return order, cloud, table, rng.standard_normal((3, 25, 2))


def test_rates_are_the_complex_step_of_a_plain_evaluation(moving):
    order, cloud, table, velocity = moving
    rates = table.rates(velocity)
    phi, grad = rate_rows(table.table, rates, 25, 3)
    for p, v in enumerate(velocity):
        particles = cloud.particles + 1e-30j * v
        for point, x in enumerate(table.points.at(particles)):
            value, slope = reference_shape(x, particles, cloud, order)
            np.testing.assert_allclose(phi[point, :, p], value.imag / 1e-30, rtol=0.0, atol=1e-11)
            np.testing.assert_allclose(
                grad[point, :, :, p], slope.imag / 1e-30, rtol=0.0, atol=1e-10
            )


def test_rates_are_the_limit_of_central_differences(moving):
    """Quadratic convergence of the differences over two decades of the step."""
    _, cloud, table, velocity = moving
    phi, grad = rate_rows(table.table, table.rates(velocity), 25, 3)
    errors = []
    for step in (1e-3, 1e-4, 1e-5):
        sides = []
        for sign in (1.0, -1.0):
            moved = cloud._replace(particles=cloud.particles + sign * step * velocity[0])
            sides.append(rows(build_table(moved, table.points).table, 25))
        difference = [(a - b) / (2 * step) for a, b in zip(*sides, strict=True)]
        errors.append(
            [np.abs(difference[0] - phi[..., 0]).max(), np.abs(difference[1] - grad[..., 0]).max()]
        )
    errors = np.array(errors)
    scale = np.array([np.abs(phi).max(), np.abs(grad).max()])
    # the kernel's third derivative jumps, but its second is Lipschitz: phi is of second order
    assert np.all(errors[0] / errors[1] > 8.0)
    assert np.all(errors[2] <= 2e-8 * scale)


def test_a_common_translation_changes_nothing(moving):
    *_, table, _ = moving
    velocity = np.broadcast_to([0.7, -0.4], (1, 25, 2))
    rates = table.rates(np.ascontiguousarray(velocity))
    np.testing.assert_allclose(rates.phi, 0.0, atol=1e-13)
    np.testing.assert_allclose(rates.grad, 0.0, atol=1e-12)


@pytest.mark.parametrize("order", ORDERS)
def test_a_common_rotation_turns_the_gradients(rng, order):
    """With W skew: Phi' = 0 and (Phi_,j)' = W_ji Phi_,i; round kernels look the same from all sides."""
    cloud = irregular_cloud(rng, n=5, order=order)
    table = build_table(cloud, random_points(rng, cloud, groups=4))
    spin = np.array([[0.0, -1.0], [1.0, 0.0]])
    velocity = (cloud.particles @ spin.T)[None]
    rates = table.rates(velocity)
    dphi, dgrad = rate_rows(table.table, rates, 25, 1)
    _, grad = rows(table.table, 25)
    np.testing.assert_allclose(dphi, 0.0, atol=1e-12)
    np.testing.assert_allclose(dgrad[..., 0], spin @ grad, rtol=0.0, atol=1e-11)


def test_rates_keep_the_reproducing_conditions(moving):
    """Derivatives of the sums: sum Phi' = 0, sum Phi' X + Phi V = x', and the same for gradients."""
    _, cloud, table, velocity = moving
    dphi, dgrad = rate_rows(table.table, table.rates(velocity), 25, 3)
    phi, grad = rows(table.table, 25)
    x_rate = np.einsum("qk,pqki->qip", table.points.weights, velocity[:, table.points.anchors])
    first = np.einsum("qap,ai->qip", dphi, cloud.particles) + np.einsum(
        "qa,pai->qip", phi, velocity
    )
    slopes = np.einsum("qjap,ai->qjip", dgrad, cloud.particles) + np.einsum(
        "qja,pai->qjip", grad, velocity
    )
    np.testing.assert_allclose(dphi.sum(axis=1), 0.0, atol=1e-12)
    np.testing.assert_allclose(dgrad.sum(axis=2), 0.0, atol=1e-11)
    np.testing.assert_allclose(first, x_rate, rtol=0.0, atol=1e-12)
    np.testing.assert_allclose(slopes, 0.0, atol=1e-11)


def test_reverse_is_the_transpose_of_forward(moving, rng):
    *_, table, velocity = moving
    rates = table.rates(velocity)
    dphi, dgrad = rate_rows(table.table, rates, 25, 3)
    phi_bar = rng.standard_normal((table.table.phi.size, 2))
    grad_bar = rng.standard_normal((table.table.grad.size, 2))
    x_bar = np.zeros((25, 2, 2))
    assert table.pull_back(phi_bar, grad_bar, x_bar) is None
    for m in range(2):
        seed_phi, seed_grad = rows(table.table, 25, (phi_bar[:, m], grad_bar[:, m]))
        forward = np.einsum("qa,qap->p", seed_phi, dphi) + np.einsum(
            "qja,qjap->p", seed_grad, dgrad
        )
        size = np.abs(np.einsum("qja,qjap->qjap", seed_grad, dgrad)).sum()
        backward = np.einsum("ai,pai->p", x_bar[..., m], velocity)
        np.testing.assert_allclose(forward, backward, rtol=0.0, atol=1e-13 * size)


def test_only_parameters_that_reach_a_group_are_stored(rng):
    cloud = irregular_cloud(rng)
    table = build_table(cloud, random_points(rng, cloud))
    velocity = np.zeros((49, 49, 2))
    velocity[np.arange(49), np.arange(49)] = [1.0, 0.5]
    rates = table.raw_rates(velocity)
    for g in range(table.table.n_groups):
        near = table.table.neighbours[table.table.start[g] : table.table.start[g + 1]]
        anchors = table.points.anchors[3 * g : 3 * g + 3].ravel()
        active = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        np.testing.assert_array_equal(active, np.union1d(near, anchors))
