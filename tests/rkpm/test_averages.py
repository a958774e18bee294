"""Means of shape functions over boundary edges: what they reproduce, and their design derivatives."""

import numpy as np
import pytest
from clouds import irregular_cloud, rate_rows, rows

from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.rkpm.averages import averaged_table
from seal_mdao.rkpm.essential import essential_transformation
from seal_mdao.rkpm.tables import raw_tables
from seal_mdao.terms.averaged_points import averaged_points
from seal_mdao.terms.points import edge_points, single_points

N = 7
STEPS = (1e-3, 1e-4, 1e-5)


def table_of(cloud, where):
    """The means without essential conditions."""
    nothing = np.array([], int)
    (own,) = raw_tables(cloud, single_points(nothing)._replace(sloped=False))
    return averaged_table(cloud, where.moving, essential_transformation(nothing, own.raw))


STRAIGHT = np.arange(3, N * N, N)
"""A row of particles."""
ROWS = {
    "straight": STRAIGHT,
    # up to the middle of the row, then along the other direction
    "turned": np.concatenate([STRAIGHT[:4], 3 * N + np.arange(4, N)]),
    # along the first column, which is the axis, then along the row
    "from the axis": np.concatenate([np.arange(N - 1, 3, -1), STRAIGHT]),
}


@pytest.fixture(
    params=[
        (1, False, "straight"), (2, False, "straight"), (1, True, "straight"),
        (2, True, "straight"), (1, False, "turned"), (2, True, "turned"),
        (1, True, "from the axis"), (2, True, "from the axis"),
    ],
    ids=str,
)  # fmt: skip
def averaged(request, rng):
    """An irregular cloud, in plane strain or turned about an axis, the means along one of its rows of
    particles, which may turn by 90 degrees, and their table."""
    order, around, kind = request.param
    on_axis = kind == "from the axis"
    cloud = irregular_cloud(rng, n=N, order=order, origin=(2.0 * (around and not on_axis), 0.0))
    if on_axis:
        cloud.particles[:N, 0] = 0.0
    row = ROWS[kind]
    where = averaged_points(row, Edge(row, False).neighbours, cloud.particles, around)
    assert len(where) > len(row) or kind == "straight"
    return cloud, row, where, table_of(cloud, where)


def test_linear_fields_are_reproduced_at_the_mean_places(averaged):
    cloud, _, where, table = averaged
    phi, _ = rows(table.table, N * N)
    np.testing.assert_allclose(phi.sum(axis=1), 1.0, atol=1e-12)
    np.testing.assert_allclose(phi @ cloud.particles, where.moving.at(cloud.particles), atol=1e-12)
    np.testing.assert_array_equal(table.coordinates, where.moving.at(cloud.particles))


def test_forces_by_length_are_uniform_traction(rng):
    """Integrated with two Gauss points an edge, where the edges are straight, of any length."""
    cloud = irregular_cloud(rng, n=N)
    row = np.arange(3, N * N, N)
    cloud.particles[row, 1] = 3.0
    where, exact = (
        averaged_points(row, Edge(row, False).neighbours, cloud.particles),
        edge_points(Edge(row, False).sides, 2),
    )
    (gauss,) = raw_tables(cloud, exact.points._replace(sloped=False))
    own, whole = rows(table_of(cloud, where).table, N * N)[0], rows(gauss.raw, N * N)[0]
    found, wanted = where.lengths(cloud.particles) @ own, exact.lengths(cloud.particles) @ whole
    np.testing.assert_allclose(found, wanted, rtol=0.0, atol=1e-13)


def test_means_of_a_curve_lie_on_it():
    """The error falls with the fourth power of the spacing; half a circle, its ends left out."""
    errors = []
    for n in (8, 16, 32):
        angle = np.linspace(0.0, np.pi, n + 1)
        circle, row = np.column_stack([np.cos(angle), np.sin(angle)]), np.arange(n + 1)
        where = averaged_points(row, Edge(row, False).neighbours, circle)
        radius = np.hypot(*where.moving.at(circle)[2:-2].T)
        errors.append(np.abs(radius - 1.0).max())
    errors = np.array(errors)
    assert errors[0] < 2e-3
    assert np.all(errors[:-1] / errors[1:] > 14.0)


def test_straight_ends_stay_where_they_are_and_points_of_corners_lie_on_their_sides():
    """2 % of a side away from the corner."""
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.8, 0.0], [1.8, 0.5], [1.8, 1.7]])
    row = np.arange(5)
    where = averaged_points(row, Edge(row, False).neighbours, corner)
    assert where.points.anchors[:, 0].tolist() == [0, 1, 2, 2, 3, 4]
    found = where.moving.at(corner)[[0, 2, 3, 5]]
    exact = [[0.0, 0.0], [1.784, 0.0], [1.8, 0.01], [1.8, 1.7]]
    np.testing.assert_allclose(found, exact, atol=1e-15)


def test_rates_are_the_limit_of_central_differences(averaged, rng):
    """Of rows and places, with quadratic convergence over two decades of the step."""
    cloud, _, where, table = averaged
    velocity = rng.standard_normal((2, N * N, 2))
    phi, _ = rate_rows(table.table, table.rates(velocity), N * N, 2)
    place = where.moving.rates(cloud.particles, velocity)
    errors = []
    for step in STEPS:
        sides = []
        for sign in (1.0, -1.0):
            moved = cloud._replace(particles=cloud.particles + sign * step * velocity[1])
            again = table_of(moved, where)
            sides.append((rows(again.table, N * N)[0], again.coordinates))
        quotients = [(a - b) / (2.0 * step) for a, b in zip(*sides, strict=True)]
        pairs = zip(quotients, (phi[..., 1], place[..., 1]), strict=True)
        errors.append([np.abs(quotient - rate).max() for quotient, rate in pairs])
    errors = np.array(errors)
    assert np.all(errors[0] / errors[1] > 8.0)
    assert np.all(errors[2] <= 2e-8 * np.array([np.abs(phi).max(), np.abs(place).max()]))


def test_pull_back_is_the_transpose_of_rates(averaged, rng):
    cloud, _, where, table = averaged
    velocity = rng.standard_normal((3, N * N, 2))
    rates, place = table.rates(velocity), where.moving.rates(cloud.particles, velocity)
    phi_bar, place_bar = (
        rng.standard_normal((table.table.phi.size, 2)),
        rng.standard_normal((len(where), 2, 2)),
    )
    x_bar = np.zeros((N * N, 2, 2))
    table.pull_back(phi_bar, np.empty((0, 2)), x_bar)
    where.moving.add_seeds(cloud.particles, place_bar, x_bar)
    phi, _ = rate_rows(table.table, rates, N * N, 3)
    seeds = np.stack(
        [rows(table.table, N * N, (own, np.empty(0)))[0] for own in phi_bar.T], axis=-1
    )
    forward = np.einsum("kam,kap->mp", seeds, phi) + np.einsum("kim,kip->mp", place_bar, place)
    back = np.einsum("nim,pni->mp", x_bar, velocity)
    np.testing.assert_allclose(back, forward, rtol=1e-11, atol=1e-11 * np.abs(forward).max())
