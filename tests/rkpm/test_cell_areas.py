"""Areas of deformed cells from their boundary: exact, additive, and equal under rotations."""

from dataclasses import replace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.rkpm.cell_areas import PLANE
from seal_mdao.structure.elastic_body import elastic_body

AWAY = np.array([20.0, 0.0])
"""By which the seal that is turned about the axis is moved, mm."""


@pytest.fixture(params=[{"basis_order": 1}, {"basis_order": 2}, {"accuracy": "engineering"}])
def disc(request, rng):
    model = sm.door_seal(**request.param)
    return discretize(model.body, model.particles(rng.uniform(-0.2, 0.2, 25)))


def field(disc, rng, size=0.1):
    """Random displacements d (n, 2) without those of the supports."""
    return np.where(disc.body.fixed, 0.0, size * rng.standard_normal(disc.particles.shape))


def quadratic_areas(disc, d):
    """det G of the rows of every cell, (n_cells, pairs), and of them in a cell of the column."""
    structure = term(disc)
    areas = structure.deformation_of(d[None], [0.0]).areas[0]
    return (areas[..., 0] * areas[..., 3] - areas[..., 1] * areas[..., 2]).reshape(
        len(disc.body.cells), -1
    )


def term(disc):
    return elastic_body(sm.MooneyRivlin(80.0, 20.0, 1e4)).on(disc, 0)


def boundary_values(disc, d):
    """Displacements (n_cells, 12, 2) at the edge points and corners of every cell."""
    rule, raw = disc.body.edge_rule, disc.cells.edges.raw
    coefficients = disc.transformation.coefficients(d)
    cells, out = len(rule.point_of) // raw.n_groups, np.empty((len(rule.point_of), 12, 2))
    for cell, points in enumerate(rule.point_of):
        g = cell // cells
        near = raw.neighbours[raw.start[g] : raw.start[g + 1]]
        phi = raw.phi[raw.group_size * raw.start[g] : raw.group_size * raw.start[g + 1]]
        out[cell] = (phi.reshape(raw.group_size, -1) @ coefficients[near])[points]
    return out


def cross(a, b):
    """a x b of two vectors (2,)."""
    return a[0] * b[1] - a[1] * b[0]


def areas_of_curves(disc, values, parts=2000):
    """Areas (n_cells,) within the boundaries of deformed cells, polygons of many points on the parabolas
    with the ends and the integral of the edges."""
    s = np.linspace(0.0, 1.0, parts + 1)[:-1, None]
    out = np.empty(len(values))
    for cell, (corners, own) in enumerate(zip(disc.body.cells, values, strict=True)):
        line = []
        for e in range(4):
            a, b = own[8 + e], own[8 + (e + 1) % 4]
            middle = 0.5 * (own[2 * e] + own[2 * e + 1] - a - b)
            x = disc.particles[corners[e]], disc.particles[corners[(e + 1) % 4]]
            straight = (1 - s) * (x[0] + a) + s * (x[1] + b)
            # int 6 s (1 - s) ds = 1
            line.append(straight + 6 * s * (1 - s) * middle)
        x, y = np.concatenate(line).T
        out[cell] = 0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y)
    return out


def test_area_of_a_cell_is_that_within_its_deformed_edges(disc, rng):
    """A + sum_q w tr grad u + sum_t det G_t; a polygon of m points is exact to 1/m^2."""
    d = field(disc, rng)
    deformation = term(disc).deformation_of(d[None], [0.0])
    trace = (deformation.f[0, ..., 0] + deformation.f[0, ..., 3] - 2.0).reshape(disc.weights.shape)
    area = (disc.weights * (1.0 + trace)).sum(axis=1) + quadratic_areas(disc, d).sum(axis=1)
    curves = areas_of_curves(disc, boundary_values(disc, d))
    np.testing.assert_allclose(area, curves, rtol=0.0, atol=1e-6 * disc.weights.sum(axis=1).max())
    assert np.abs(area / disc.weights.sum(axis=1) - 1.0).max() > 0.1


def test_areas_of_all_cells_are_that_of_the_body(disc, rng):
    """Of displacements that are zero at the points of the boundary they do not depend."""
    rule = disc.body.edge_rule
    _, which, count = np.unique(
        np.sort(rule.ends, axis=2).reshape(-1, 2), axis=0, return_inverse=True, return_counts=True
    )
    outer = (count[which.ravel()] == 2).reshape(rule.ends.shape[:2])
    d = field(disc, rng)
    values = boundary_values(disc, d)
    # 1/2 sum over the outer edges of u_a x u_b and the area between chord and parabola
    total = 0.0
    for cell, e in np.argwhere(outer[:, ::2]):
        a, b = values[cell, 8 + e], values[cell, 8 + (e + 1) % 4]
        beyond = values[cell, 2 * e] + values[cell, 2 * e + 1] - a - b
        total += 0.5 * cross(a, b) + 0.5 * cross(beyond, b - a)
    found = quadratic_areas(disc, d)
    np.testing.assert_allclose(found.sum(), total, rtol=0.0, atol=1e-12 * np.abs(found).sum())


def test_volume_strain_does_not_change_in_a_rotation(disc, rng):
    """x = Q (X + u) has the volume strain of u, projected onto any function."""
    d, angle = field(disc, rng, 0.03), 0.7
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    # without supports every linear field is reproduced
    body = replace(disc.body, fixed=np.zeros_like(disc.body.fixed))
    free = discretize(body, disc.particles)
    coefficients = d
    turned = (disc.particles + coefficients) @ turn.T - disc.particles
    structure = term(free)
    found = [structure.volume_strain_at(own, 0.0) for own in (d, turned)]
    np.testing.assert_allclose(found[1], found[0], rtol=0.0, atol=1e-12)
    assert np.abs(found[0]).max() > 1e-2


@pytest.mark.parametrize("order", [1, 2])
def test_rows_of_a_ring_vanish_in_a_linear_field(order, rng):
    """Those of the boundary and of the quadrature have the same sum for u = A X, and the same derivative
    in every displacement: uniform states stay in equilibrium."""
    model = sm.door_seal(basis_order=order)
    body = replace(model.body, axisymmetric=True)
    ring = discretize(body, model.particles(rng.uniform(-0.1, 0.1, 25)) + AWAY)
    structure = term(ring)
    slope = np.array([[0.0, 0.0], [0.2, -0.1]])
    d = ring.particles @ slope.T

    def quadratic(d):
        """sum_t det G_t - sum_q c w det(F - 1) of every cell."""
        own = structure.deformation_of(d[None], [0.0])
        f = own.f[0].reshape(*ring.weights.shape, -1)
        det = (f[..., 0] - 1.0) * (f[..., 3] - 1.0) - f[..., 1] * f[..., 2]
        return quadratic_areas(ring, d).sum(axis=1) - (ring.cells.cell_weights * det).sum(axis=1)

    size = ring.cells.cell_weights.sum(axis=1).max()
    np.testing.assert_allclose(quadratic(d), 0.0, atol=1e-13 * size)
    v = rng.standard_normal(d.shape)
    # a quadratic form: the difference is its derivative
    change = 0.5 * (quadratic(d + v) - quadratic(d - v))
    np.testing.assert_allclose(change, 0.0, atol=1e-11 * np.abs(quadratic(v)).max())
    assert np.abs(quadratic(v)).max() > 1e-3 * size
    assert quadratic_areas(ring, d).shape[1] > PLANE
