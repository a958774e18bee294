"""Von Mises stress at particles and its derivatives."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.measures.stress import constants_gradient, von_mises_at


def gradients_at(table, d):
    """Deformation gradients at single points."""
    out = []
    for i in range(table.n_groups):
        low, high = table.start[i], table.start[i + 1]
        grad = table.grad[2 * low : 2 * high].reshape(2, -1)
        out.append(np.eye(2) + d[table.neighbours[low:high]].T @ grad.T)
    return np.array(out)


def test_stress_at_particles_is_that_of_the_material(drawn):
    table = drawn.path.discretization.everywhere.table
    F = gradients_at(table, drawn.end.d)
    np.testing.assert_allclose(
        drawn.stress_field(), drawn.model.material.von_mises(F), rtol=1e-11, atol=1e-9
    )


def test_stress_of_a_homogeneous_deformation_is_uniform(drawn):
    disc, slope = drawn.path.discretization, np.array([[0.2, 0.3], [0.0, -0.1]])
    stress, _ = von_mises_at(disc.everywhere.table, disc.particles @ slope.T, drawn.model.material)
    np.testing.assert_allclose(stress, drawn.model.material.von_mises(np.eye(2) + slope), rtol=1e-9)


def test_derivative_with_respect_to_the_deformation_gradient(drawn, rng):
    """Through the coefficients d: a directional derivative by five points."""
    disc, material = drawn.path.discretization, drawn.model.material
    table = disc.table_at(drawn.points.stress).table
    direction = rng.standard_normal(drawn.end.d.shape)
    _, by_gradient = von_mises_at(table, drawn.end.d, material)
    rate = gradients_at(table, direction) - np.eye(2)
    exact = np.einsum("sij,sij->s", by_gradient.reshape(-1, 2, 2), rate)
    h = 1e-4
    values = [
        von_mises_at(table, drawn.end.d + k * h * direction, material)[0] for k in (-2, -1, 1, 2)
    ]
    slope = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * h)
    np.testing.assert_allclose(slope, exact, rtol=0.0, atol=1e-8 * np.abs(exact).max())


def test_undeformed_particles_have_no_stress_and_no_derivative(drawn):
    table = drawn.path.discretization.table_at(np.array([5, 60])).table
    stress, by_gradient = von_mises_at(table, 0 * drawn.end.d, drawn.model.material)
    assert not stress.any()
    assert not by_gradient.any()
    assert not constants_gradient(table, 0 * drawn.end.d, drawn.model.material).any()


def test_derivative_with_respect_to_the_constants(drawn):
    table, d = drawn.path.discretization.table_at(drawn.points.stress).table, drawn.end.d
    material = drawn.model.material
    found = constants_gradient(table, d, material)
    h = 1e-2
    for column, name in enumerate(("c10", "c01", "bulk_modulus")):
        constants = {"c10": 80.0, "c01": 20.0, "bulk_modulus": 80_000.0}
        values = []
        for sign in (1, -1):
            moved = constants | {name: constants[name] + sign * h}
            values.append(von_mises_at(table, d, sm.MooneyRivlin(**moved))[0])
        np.testing.assert_allclose(found[:, column], (values[0] - values[1]) / (2 * h), atol=1e-7)
    # homogeneous of degree one in (C10, C01)
    stress = von_mises_at(table, d, material)[0]
    np.testing.assert_allclose(found @ [80.0, 20.0, 0.0], stress, rtol=1e-12)


def test_stress_does_not_change_under_a_rigid_rotation(drawn):
    disc, d = drawn.path.discretization, drawn.end.d
    c, s = np.cos(2.9), np.sin(2.9)
    more = (disc.particles + d) @ np.array([[c, s], [-s, c]]) - disc.particles
    table = disc.everywhere.table
    before, after = (von_mises_at(table, field, drawn.model.material)[0] for field in (d, more))
    assert after == pytest.approx(before, rel=1e-9, abs=1e-8)
