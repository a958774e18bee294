"""Supports that do not cover a point are refused, with the place."""

import re

import numpy as np
import pytest
from clouds import irregular_cloud

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.errors import GeometryError, SingularMomentMatrixError
from seal_mdao.rkpm.shape_functions import Cloud, PointSet
from seal_mdao.rkpm.tables import build_table


def place(error):
    """The coordinates named in a message."""
    return np.array(re.search(r"\(([-+.\de]+), ([-+.\de]+)\)", str(error.value)).groups(), float)


def single(weights, anchors):
    return PointSet(np.array([anchors]), np.array([weights]), 1)


def test_uncovered_point_is_named(rng):
    cloud = irregular_cloud(rng)
    away = np.linalg.norm(cloud.particles - cloud.particles[24], axis=1)
    radius = np.where(away < 2.9, 0.4, 2.0)
    holed = cloud._replace(radius=radius)
    points = PointSet(np.array([[0, 1], [24, 25]]), np.array([[0.5, 0.5], [0.5, 0.5]]), 1)
    with pytest.raises(SingularMomentMatrixError) as error:
        build_table(holed, points)
    np.testing.assert_allclose(place(error), points.at(cloud.particles)[1], rtol=1e-3)


@pytest.mark.parametrize(("count", "order"), [(2, 1), (5, 2)])
def test_too_few_neighbours_are_singular(rng, count, order):
    """The moment matrix of m monomials needs m particles."""
    particles = rng.uniform(-1, 1, (count + 1, 2))
    cloud = Cloud(particles, np.full(count + 1, 5.0), 5.0, {1: 3, 2: 6}[order])
    build_table(cloud, single([1.0], [0]))
    fewer = Cloud(particles[:-1], cloud.radius[:-1], 5.0, cloud.n_basis)
    with pytest.raises(SingularMomentMatrixError):
        build_table(fewer, single([1.0], [0]))


@pytest.mark.parametrize(("order", "curve"), [(1, lambda s: 2 * s), (2, lambda s: s * s)])
def test_neighbours_on_a_curve_that_the_basis_contains_are_singular(order, curve):
    """However many there are: a line for the linear basis, a parabola for the quadratic one."""
    s = np.linspace(-1.0, 1.0, 12)
    particles = np.column_stack([s, curve(s)])
    cloud = Cloud(particles, np.full(12, 5.0), 5.0, {1: 3, 2: 6}[order])
    with pytest.raises(SingularMomentMatrixError):
        build_table(cloud, single([0.5, 0.5], [4, 7]))


@pytest.mark.parametrize(("support", "order"), [(0.6, 1), (1.05, 2)])
def test_seal_with_too_small_a_support_says_where(support, order):
    model = sm.door_seal(support=support, basis_order=order)
    with pytest.raises(SingularMomentMatrixError) as error:
        discretize(model.body, model.nominal_particles)
    assert isinstance(error.value, GeometryError)
    distance = np.linalg.norm(model.nominal_particles - place(error), axis=1)
    assert np.sum(distance < model.body.support_radius) < {1: 4, 2: 9}[order]
