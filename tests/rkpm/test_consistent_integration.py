"""Cell gradients that obey the divergence theorem: identities, rates and their transpose."""

from dataclasses import replace

import numpy as np
import pytest
from clouds import rate_rows, rows

import seal_mdao as sm
from seal_mdao.dsa.shape_rates import discretization_rates
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.rkpm.consistent_gradients import (
    EDGE_POINTS,
    add_normal_seeds,
    edge_normals,
    edge_rule,
    integration_points,
)
from seal_mdao.rkpm.essential import transformation_seeds
from seal_mdao.rkpm.tables import build_table


def at_edge_points(rule, phi):
    """Values (distinct points, n) at the edge points of every cell, (n_cells, 8, n)."""
    n_columns, n_distinct = rule.distinct.shape
    column = np.arange(len(rule.point_of)) // (len(rule.point_of) // n_columns)
    own = rule.point_of[:, :EDGE_POINTS]
    return phi.reshape(n_columns, n_distinct, -1)[column[:, None], own]


def gauss_rows(cells, table, n):
    """Dense rows (points, 2 or 3, n) of the Gauss points, without those of the areas that follow them in
    each group."""
    _, grad = rows(table, n)
    grad = grad.reshape(table.n_groups, table.group_size, *grad.shape[1:])
    return grad[:, : cells.gauss.raw.group_size].reshape(-1, *grad.shape[2:])


SEALS = [{"basis_order": 1}, {"basis_order": 2}, {"accuracy": "engineering"}]
AWAY = np.array([20.0, 0.0])
"""By which the seal that is turned about the axis is moved, mm."""


@pytest.fixture(params=SEALS)
def seal(request, rng):
    """A random design of the coarsest seal with either basis, and one whose columns have three cells."""
    model = sm.door_seal(**request.param)
    return model, discretize(model.body, model.particles(rng.uniform(-0.2, 0.2, 25)))


@pytest.fixture(params=[*SEALS, {"axisymmetric": True}, {"axisymmetric": True, "basis_order": 2}])
def any_seal(request, rng):
    """As ``seal``, and such a seal turned about an axis."""
    options = dict(request.param)
    around = options.pop("axisymmetric", False)
    model = sm.door_seal(**options)
    particles = model.particles(rng.uniform(-0.2, 0.2, 25)) + around * AWAY
    body = replace(model.body, axisymmetric=around)
    return body, discretize(body, particles)


def test_edge_normals_of_every_cell_close():
    model = sm.door_seal()
    rule = model.body.edge_rule
    normals = edge_normals(rule, model.nominal_particles)
    np.testing.assert_allclose(normals.sum(axis=1), 0.0, atol=1e-14)
    # div x = 2: the boundary integral of x . n is twice the area
    points = np.einsum("cek,ceki->cei", rule.weights, model.nominal_particles[rule.ends])
    weights = discretize(model.body, model.nominal_particles).weights
    np.testing.assert_allclose(
        np.einsum("cei,cei->c", points, normals), 2 * weights.sum(axis=1), rtol=1e-13
    )


def test_edge_points_are_gauss_points_except_on_the_essential_boundary():
    """Three cells in a row, the bottom edge of the middle one essential."""
    cells = np.array([[0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6]])
    rule = edge_rule(cells, np.array([1, 2]))
    for cell in range(3):
        for edge in range(4):
            place = rule.weights[cell, 2 * edge : 2 * edge + 2]
            np.testing.assert_allclose(place.sum(axis=1), 1.0, rtol=1e-15)
            ends_only = (cell, edge) == (1, 0)
            second_moment = 0.5 * np.sum(place[:, 0] ** 2)
            assert second_moment == pytest.approx(0.5 if ends_only else 1 / 3, rel=1e-14)


def test_cells_of_a_column_share_the_points_between_them(seal):
    """Every edge point and corner lies where its distinct point does. No two of a column lie at one
    place, but for corners at the ends of essential edges."""
    model, disc = seal
    rule, particles = model.body.edge_rule, disc.particles
    n_columns, n_distinct = rule.distinct.shape
    cells = len(model.body.cells) // n_columns
    assert n_distinct == EDGE_POINTS + 4 + (cells - 1) * EDGE_POINTS
    x = np.einsum("cek,ceki->cei", rule.weights, particles[rule.ends])
    x = np.concatenate([x, particles[model.body.cells]], axis=1)
    _, points = integration_points(model.body.cell_map, rule)
    own = points.at(particles).reshape(n_columns, n_distinct, 2)
    column = np.arange(len(x)) // cells
    np.testing.assert_allclose(own[column[:, None], rule.point_of], x, rtol=0.0, atol=1e-14)
    essential = np.isin(rule.weights, (0.0, 1.0)).all(axis=2).any(axis=1)
    away = np.linalg.norm(own[:, :, None] - own[:, None], axis=3)
    away = away[np.bincount(column[essential], minlength=n_columns) == 0]
    assert away[:, ~np.eye(n_distinct, dtype=bool)].min() > 0.01


def test_columns_with_fewer_points_repeat_one():
    """Two squares that share an edge, two that share none, and a triangle beside one."""
    cells = np.array(
        [
            [0, 1, 2, 3],
            [1, 4, 5, 2],
            [6, 7, 8, 9],
            [10, 11, 12, 13],
            [14, 15, 16, 16],
            [15, 17, 18, 16],
        ]
    )
    rule = edge_rule(cells, np.empty(0, int), 2)
    assert rule.distinct.shape == (3, 24)
    assert [np.unique(own).size for own in rule.distinct] == [20, 24, 17]
    height = np.random.default_rng(1).random(19)
    values = np.sum(rule.weights * height[rule.ends], axis=2)
    values = np.concatenate([values, height[cells]], axis=1)
    column = np.arange(6) // 2
    np.testing.assert_allclose(
        values.ravel()[rule.distinct][column[:, None], rule.point_of], values, rtol=1e-15
    )


def test_mean_gradient_of_every_cell_is_the_boundary_integral(seal):
    """sum_q w_q grad~_q = sum_e Phi_e n_e for the raw functions of each cell."""
    model, disc = seal
    cells, q = disc.cells, disc.weights.shape[1]
    n = len(disc.particles)
    phi, _ = rows(cells.edges.raw, n)
    grad = gauss_rows(cells, cells.raw, n)
    at_edges = at_edge_points(model.body.edge_rule, phi)
    normals = edge_normals(model.body.edge_rule, disc.particles)
    boundary = np.einsum("cea,cej->cja", at_edges, normals)
    mean = np.einsum("cq,cqja->cja", disc.weights, grad.reshape(-1, q, 2, n))
    np.testing.assert_allclose(mean, boundary, atol=1e-13)


def test_correction_is_one_constant_for_each_cell_and_neighbour(seal):
    _, disc = seal
    q, n = disc.weights.shape[1], len(disc.particles)
    _, grad = rows(disc.cells.gauss.raw, n)
    new_grad = gauss_rows(disc.cells, disc.cells.raw, n)
    shift = (new_grad - grad).reshape(-1, q, 2, n)
    np.testing.assert_allclose(shift, shift[:, :1] + 0 * shift, rtol=0.0, atol=1e-14)
    assert np.abs(shift).max() > 1e-6


def test_gauss_and_edge_points_have_one_list_of_neighbours(seal):
    """Each of them covers the particles that a point of either kind sees."""
    _, disc = seal
    gauss, edges = disc.cells.gauss.raw, disc.cells.edges.raw
    np.testing.assert_array_equal(gauss.start, edges.start)
    np.testing.assert_array_equal(gauss.neighbours, edges.neighbours)
    n = len(disc.particles)
    at_edges = np.abs(rows(edges, n)[0]).reshape(gauss.n_groups, -1, n)
    inside = np.abs(rows(gauss, n)[1]).reshape(gauss.n_groups, -1, n)
    sees = np.concatenate([at_edges, inside], axis=1).any(axis=1)
    listed = [np.flatnonzero(own) for own in sees]
    for g, near in enumerate(listed):
        np.testing.assert_array_equal(gauss.neighbours[gauss.start[g] : gauss.start[g + 1]], near)


def test_consistent_gradients_reproduce_linear_fields(seal):
    """Also after the essential transformation, with values of the field as coefficients."""
    _, disc = seal
    points = integration_points(disc.body.cell_map, disc.body.edge_rule)
    for own in points:
        valued = build_table(disc.cloud, own._replace(valued=True), disc.transformation)
        for table in (valued.raw, valued.table):
            phi, _ = rows(table, len(disc.particles))
            np.testing.assert_allclose(phi.sum(axis=1), 1.0, rtol=1e-12)
    for table in (disc.cells.raw, disc.cells.table):
        grad = gauss_rows(disc.cells, table, len(disc.particles))
        np.testing.assert_allclose(grad.sum(axis=2), 0.0, atol=1e-11)
        slopes = np.broadcast_to(np.eye(2), (len(grad), 2, 2))
        np.testing.assert_allclose(grad @ disc.particles, slopes, rtol=0.0, atol=1e-10)


def test_net_gradients_are_fluxes_through_the_free_boundary(seal):
    """int grad Phi~_I = boundary integral of Phi~_I n: the constraint behind the patch test.

    Inner edges cancel between their two cells; the essential ones do not count for free particles.
    """
    model, disc = seal
    n, q = len(disc.particles), disc.weights.shape[1]
    rule = model.body.edge_rule
    _, points = integration_points(model.body.cell_map, rule)
    phi, _ = rows(build_table(disc.cloud, points, disc.transformation).table, n)
    at_edges = at_edge_points(rule, phi)
    normals = edge_normals(rule, disc.particles)
    pairs = np.sort(rule.ends, axis=2)
    _, which, count = np.unique(
        pairs.reshape(-1, 2), axis=0, return_inverse=True, return_counts=True
    )
    outer = (count[which.ravel()] == 2).reshape(pairs.shape[:2])
    on_base = np.isin(rule.ends, disc.body.constrained).all(axis=2)
    free = np.setdiff1d(np.arange(n), disc.body.constrained)
    flux = np.einsum("cea,cej->ja", at_edges, normals * (outer & ~on_base)[..., None])
    grad = gauss_rows(disc.cells, disc.cells.table, n)
    total = np.einsum("cq,cqja->ja", disc.weights, grad.reshape(-1, q, 2, n))
    assert np.sum(outer & on_base) == 12
    np.testing.assert_allclose(total[:, free], flux[:, free], rtol=0.0, atol=1e-12)


def test_normal_seeds_are_the_transpose_of_edge_normals(rng):
    model = sm.door_seal()
    rule, n = model.body.edge_rule, len(model.nominal_particles)
    velocity = rng.standard_normal((2, n, 2))
    seed = rng.standard_normal((*rule.ends.shape[:2], 2, 3))
    x_bar = np.zeros((n, 2, 3))
    add_normal_seeds(rule, seed, x_bar)
    forward = np.einsum("cejm,pcej->mp", seed, edge_normals(rule, velocity))
    np.testing.assert_allclose(np.einsum("aim,pai->mp", x_bar, velocity), forward, rtol=1e-11)


def test_integration_points_lie_on_the_edges(seal):
    model, disc = seal
    rule = model.body.edge_rule
    _, points = integration_points(model.body.cell_map, rule)
    x = at_edge_points(rule, points.at(disc.particles))
    ends = disc.particles[rule.ends]
    along, away = ends[..., 1, :] - ends[..., 0, :], x - ends[..., 0, :]
    cross = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    np.testing.assert_allclose(cross, 0.0, atol=1e-13)


def test_cell_rates_are_the_limit_of_central_differences(seal, rng):
    model, disc = seal
    n = len(disc.particles)
    velocity = rng.standard_normal((1, n, 2))
    rates = discretization_rates(disc, velocity).cells
    at_edges = disc.cells.edges.raw_rates(velocity)
    exact = (
        rate_rows(disc.cells.edges.raw, at_edges, n, 1)[0][..., 0],
        rate_rows(disc.cells.table, rates, n, 1)[1][..., 0],
    )
    errors = []
    for step in (1e-4, 1e-5):
        moved = [
            discretize(model.body, disc.particles + s * step * velocity[0]).cells for s in (1, -1)
        ]
        sides = [(rows(cells.edges.raw, n)[0], rows(cells.table, n)[1]) for cells in moved]
        errors.append(
            [
                np.abs((plus - minus) / (2 * step) - rate).max() / np.abs(rate).max()
                for plus, minus, rate in zip(*sides, exact, strict=True)
            ]
        )
    assert np.all(np.array(errors[1]) < 1e-6)
    # gradients have a Lipschitz derivative only, values one order more
    assert np.all(np.array(errors[0]) > 5 * np.array(errors[1]))


@pytest.mark.parametrize("order", [1, 2])
def test_cell_rates_of_a_ring_are_those_of_its_rows(order, rng):
    """The five-point formula; third derivatives of splines have corners: its order is above two."""
    model = sm.door_seal(basis_order=order)
    body = replace(model.body, axisymmetric=True)
    particles = model.particles(rng.uniform(-0.1, 0.1, 25)) + AWAY
    disc, n = discretize(body, particles), len(particles)
    velocity = rng.standard_normal((1, n, 2))
    rates = discretization_rates(disc, velocity).cells
    rate = rate_rows(disc.cells.table, rates, n, 1)[1][..., 0]
    errors = []
    for step in (4e-4, 1e-4):
        moved = [discretize(body, particles + s * step * velocity[0]) for s in (-2, -1, 1, 2)]
        a, b, c, d = (rows(own.cells.table, n)[1] for own in moved)
        quotient = (a - 8 * b + 8 * c - d) / (12 * step)
        errors.append(np.abs(quotient - rate).max(axis=(0, 2)) / np.abs(rate).max(axis=(0, 2)))
    assert errors[1].max() < 1e-6
    assert np.all(errors[1] < 0.2 * errors[0])


def test_weight_rates_are_those_of_the_weights(any_seal, rng):
    """The weights are polynomials of the third degree in the particles."""
    body, disc = any_seal
    velocity = rng.standard_normal((1, len(disc.particles), 2))
    rate = disc.cells.weight_rates(velocity)[0]
    moved = [
        discretize(body, disc.particles + s * 1e-3 * velocity[0]).cells.cell_weights
        for s in (-2, -1, 1, 2)
    ]
    quotient = (moved[0] - 8 * moved[1] + 8 * moved[2] - moved[3]) / (12 * 1e-3)
    np.testing.assert_allclose(rate, quotient, rtol=0.0, atol=1e-11 * np.abs(rate).max())


@pytest.mark.parametrize("order", [1, 2])
def test_cells_of_a_ring_obey_the_divergence_theorem_around_the_axis(order, rng):
    """sum c w (grad_j + delta_j1 Phi / R) = sum c Phi n_j of every cell, and linear fields are exact."""
    model = sm.door_seal(basis_order=order)
    body = replace(model.body, axisymmetric=True)
    particles = model.particles(rng.uniform(-0.2, 0.2, 25)) + AWAY
    disc = discretize(body, particles)
    cells, n = disc.cells, len(particles)
    rows_of = gauss_rows(cells, cells.raw, n)
    weights = cells.cell_weights.ravel()
    phi = at_edge_points(cells.rule, rows(cells.edges.raw, n)[0])
    divergence = rows_of[:, :2].copy()
    divergence[:, 0] += rows_of[:, 2]
    shape = (*cells.weights.shape, 2, n)
    inside = (weights[:, None, None] * divergence).reshape(shape).sum(axis=1)
    flux = np.einsum("cen,cej->cjn", phi, cells.normals)
    np.testing.assert_allclose(inside, flux, rtol=0.0, atol=1e-13 * np.abs(flux).max())
    # u = (a R + b z, c R + d z): F and h = 1 + a + b z / R
    found = gauss_rows(cells, cells.table, n)
    moved = found @ (particles @ np.array([[0.1, 0.3], [-0.2, 0.15]]))
    radius, height = cells.gauss.coordinates.T
    np.testing.assert_allclose(moved[:, :2, 0], np.tile([0.1, -0.2], (len(radius), 1)), atol=1e-12)
    np.testing.assert_allclose(moved[:, :2, 1], np.tile([0.3, 0.15], (len(radius), 1)), atol=1e-12)
    np.testing.assert_allclose(moved[:, 2, 0], 0.1 - 0.2 * height / radius, atol=1e-12)


def test_cell_seeds_are_the_transpose_of_cell_rates(any_seal, rng):
    """Dot-product test through transformation, weights, normals and shape functions."""
    _, disc = any_seal
    transformation, n = disc.transformation, len(disc.particles)
    velocity = rng.standard_normal((2, n, 2))
    forward = discretization_rates(disc, velocity)
    _, dgrad = rate_rows(disc.cells.table, forward.cells, n, 2)
    grad_bar = rng.standard_normal((disc.cells.table.grad.size, 1))
    weight_bar = rng.standard_normal((*disc.weights.shape, 1))
    _, seed = rows(disc.cells.table, n, (np.empty(0), grad_bar[:, 0]))
    ahead = np.einsum("qja,qjap->p", seed, dgrad)
    ahead += np.einsum("cq,pcq->p", weight_bar[..., 0], forward.weights)

    x_bar, weight_bar = np.zeros((n, 2, 1)), weight_bar.copy()
    matrix_bar = disc.cells.pull_back(grad_bar, weight_bar, x_bar)
    disc.cells.add_weight_seeds(weight_bar, x_bar)
    raw = disc.constrained_rows.raw
    point = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
    rows_bar = transformation_seeds(transformation, matrix_bar)
    own = rows_bar[point, np.searchsorted(transformation.union, raw.neighbours)]
    own_bar = np.ascontiguousarray(own)
    disc.constrained_rows.pull_back(own_bar, np.zeros((raw.grad.size, 1)), x_bar)
    back = np.einsum("ai,pai->p", x_bar[..., 0], velocity)
    size = np.abs(x_bar[..., 0] * velocity).sum(axis=(1, 2))
    np.testing.assert_allclose(back, ahead, rtol=0.0, atol=1e-12 * size.max())
