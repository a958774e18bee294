"""Background quadrature: area, exactness, rates and their transpose, folded cells."""

import re

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.errors import GeometryError
from seal_mdao.rkpm.cells import (
    add_weight_seeds,
    cell_map,
    circumscribed_radii,
    quadrature_points,
    quadrature_weights,
    support_axes,
    weight_rates,
)
from seal_mdao.seals.door.door_seal import options_of

# two irregular cells that share an edge
PARTICLES = np.array([[0.0, 0.0], [1.3, -0.2], [1.1, 0.9], [-0.2, 1.2], [2.4, 0.3], [2.0, 1.5]])
CELLS = np.array([[0, 1, 2, 3], [1, 4, 5, 2]])
# the second one cut in two triangles, whose repeated corners stand at different places
MIXED = np.array([[0, 1, 2, 3], [1, 4, 5, 5], [1, 1, 5, 2]])
BOTH = pytest.mark.parametrize("cells", [CELLS, MIXED], ids=["quadrilaterals", "mixed"])


def polygon_moment(corners, a, b):
    """int x^a y^b over a polygon by Green's theorem, exact Gauss rule on its edges."""
    g, w = np.polynomial.legendre.leggauss(8)
    total = 0.0
    for p, q in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        x = p + 0.5 * (1 + g)[:, None] * (q - p)
        total += 0.5 * np.sum(w * x[:, 0] ** (a + 1) * x[:, 1] ** b) * (q - p)[1] / (a + 1)
    return total


@BOTH
@pytest.mark.parametrize(("n_gauss", "degree"), [(1, 0), (2, 2), (3, 4), (4, 6), ((3, 2), 2)])
def test_quadrature_is_exact_on_cells(cells, n_gauss, degree):
    """x^a y^b det J is of degree a + b + 1 in each coordinate; n points are exact to 2 n - 1. Of two
    numbers the smaller one counts where a cell is no rectangle."""
    mapping = cell_map(cells, n_gauss)
    weights = quadrature_weights(mapping, PARTICLES)
    points = quadrature_points(mapping).at(PARTICLES).reshape(*weights.shape, 2)
    for a in range(degree + 1):
        for b in range(degree + 1 - a):
            values = np.sum(weights * points[..., 0] ** a * points[..., 1] ** b, axis=1)
            exact = [polygon_moment(PARTICLES[cell], a, b) for cell in cells]
            np.testing.assert_allclose(values, exact, rtol=1e-13)


@pytest.mark.parametrize("n_gauss", [1, 2])
def test_no_corner_of_a_triangle_is_special(n_gauss):
    """Whichever corner comes first, and whichever is the repeated one: the same points."""
    stored = np.array([[1, 4, 5, 5], [4, 5, 5, 1], [5, 1, 1, 4], [4, 5, 1, 1], [5, 1, 4, 4]])
    mapping = cell_map(stored, n_gauss)
    weights = quadrature_weights(mapping, PARTICLES)
    points = quadrature_points(mapping).at(PARTICLES).reshape(*weights.shape, 2)
    for places, share in zip(points, weights, strict=True):
        np.testing.assert_allclose(share, weights[0], rtol=1e-14)
        order, first = np.lexsort(places.round(12).T), np.lexsort(points[0].round(12).T)
        np.testing.assert_allclose(places[order], points[0][first], atol=1e-15)


def test_two_numbers_of_points_are_along_the_two_directions():
    """First corner to second, second to third: exact to 2 n - 1 in either, and not beyond."""
    rectangle = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]])
    mapping = cell_map(np.array([[0, 1, 2, 3]]), (2, 3))
    weights = quadrature_weights(mapping, rectangle).ravel()
    x, y = quadrature_points(mapping).at(rectangle).T
    assert weights @ x**3 == pytest.approx(4.0, rel=1e-14)
    assert abs(weights @ x**4 - 6.4) > 0.1
    assert weights @ y**5 == pytest.approx(2.0 / 6.0, rel=1e-14)
    assert abs(weights @ y**6 - 2.0 / 7.0) > 1e-4


def test_one_degree_more_is_not_exact():
    mapping = cell_map(CELLS, 2)
    weights = quadrature_weights(mapping, PARTICLES)
    points = quadrature_points(mapping).at(PARTICLES).reshape(*weights.shape, 2)
    error = np.sum(weights * points[..., 0] ** 3, axis=1) - [
        polygon_moment(PARTICLES[cell], 3, 0) for cell in CELLS
    ]
    assert np.abs(error).max() > 1e-5


@pytest.mark.parametrize("offset", [0.0, 0.2])
def test_weights_sum_to_the_area_between_the_boundary_polygons(offset, rng):
    model = sm.door_seal(rays=116, layers=4)
    particles = model.particles(rng.uniform(-offset, offset, model.n_offsets))
    weights = quadrature_weights(model.body.cell_map, particles)
    rays = np.arange(116)
    outer, inner = (particles[options_of(model).grid.particle(rays, k)] for k in (3, 0))
    area = polygon_moment(outer, 0, 0) - polygon_moment(inner, 0, 0)
    assert weights.sum() == pytest.approx(area, rel=1e-13)


@BOTH
def test_weight_rates_are_exact(rng, cells):
    """Weights are quadratic in the coordinates: central differences have no truncation error."""
    mapping = cell_map(cells, 2)
    velocity = rng.standard_normal((3, 6, 2))
    rates = weight_rates(mapping, PARTICLES, velocity)
    for p, v in enumerate(velocity):
        plus, minus = (quadrature_weights(mapping, PARTICLES + s * 0.1 * v) for s in (1, -1))
        np.testing.assert_allclose(rates[p], (plus - minus) / 0.2, rtol=0.0, atol=1e-14)


@BOTH
def test_weight_seeds_are_the_transpose_of_weight_rates(rng, cells):
    mapping = cell_map(cells, 2)
    velocity, seed = rng.standard_normal((3, 6, 2)), rng.standard_normal((len(cells), 4, 2))
    x_bar = np.zeros((6, 2, 2))
    add_weight_seeds(mapping, PARTICLES, seed, x_bar)
    forward = np.einsum("cqm,pcq->mp", seed, weight_rates(mapping, PARTICLES, velocity))
    np.testing.assert_allclose(np.einsum("aim,pai->mp", x_bar, velocity), forward, atol=1e-14)


@pytest.mark.parametrize("corner", [[0.3, 0.4], [-1.0, -1.0]])
def test_folded_cell_is_refused_and_named(corner):
    """Corner 2 pulled through the opposite diagonal: both cells use it, one of them folds first."""
    folded = PARTICLES.copy()
    folded[2] = corner
    with pytest.raises(GeometryError, match="folded") as error:
        quadrature_weights(cell_map(CELLS, 2), folded)
    cell = int(re.search(r"cell (\d+)", str(error.value))[1])
    x = np.array(re.search(r"\(([-.\d]+), ([-.\d]+)\)", str(error.value)).groups(), float)
    edges = np.roll(folded[CELLS[cell]], -1, axis=0) - folded[CELLS[cell]]
    turns = np.cross(np.column_stack([edges, np.zeros(4)]),
                     np.column_stack([np.roll(edges, -1, axis=0), np.zeros(4)]))[:, 2]  # fmt: skip
    assert turns.min() < 0.0
    np.testing.assert_allclose(x, folded[CELLS[cell]].mean(axis=0), rtol=1e-3)


def test_offsets_that_turn_the_wall_inside_out_are_refused():
    """Inner boundary pushed out and outer boundary pulled in, by 1.2 mm each: the wall is 2 mm."""
    model = sm.door_seal()
    offsets = np.concatenate([np.full(14, -1.2), np.full(11, 1.2)])
    with pytest.raises(GeometryError, match="folded"):
        sm.analyze(model, offsets)


def test_product_kernels_of_a_sheared_grid_have_the_edges_as_axes():
    """Half-widths 1.5 and 2.5 edges (1, 0) and (-0.5, 1) long, and the longer diagonal of both."""
    i, j = (own.ravel() for own in np.meshgrid(np.arange(4), np.arange(4), indexing="ij"))
    x = np.column_stack([i - 0.5 * j, 1.0 * j])
    at = np.arange(16).reshape(4, 4)
    corners = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    axes = support_axes(np.column_stack([own.ravel() for own in corners]), x, (1.5, 2.5))
    widths = np.array([[1.5, -1.25], [0.0, 2.5]])
    np.testing.assert_allclose(axes, np.tile(np.linalg.inv(widths), (16, 1, 1)), atol=1e-14)
    np.testing.assert_allclose(circumscribed_radii(axes), np.hypot(1.5 + 1.25, 2.5), rtol=1e-14)


def test_a_cell_without_area_is_refused():
    x = np.array([[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [1.0, 0.0]])
    with pytest.raises(GeometryError, match="negative or zero area"):
        quadrature_weights(cell_map(np.array([[0, 1, 2, 3]])), x)
