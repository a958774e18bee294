"""The pressure through columns of cells: its functions, and one value a cell as a special case."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from bodies import CONSTANTS, dense, energy, internal, square, structure, wave
from verification.quadratic_integration import discretize_quadratic

import seal_mdao as sm
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.rkpm.cell_areas import PLANE
from seal_mdao.structure.elastic_body import ElasticBody, elastic_body
from seal_mdao.structure.energy_gradient import energy_gradient
from seal_mdao.structure.force_products import add_tangent_product
from seal_mdao.structure.pressure_functions import PressureSpace, through_column
from seal_mdao.structure.region import Region

RUBBER = sm.MooneyRivlin(*CONSTANTS)


def with_pressure(body, space):
    """The body with another space of the pressure."""
    body = replace(body, column=space.cells)
    body.__dict__["pressure"] = space
    return body


def cell_by_cell(cells, points=4):
    """One value in every cell of a column."""
    at = np.repeat(np.eye(cells), points, axis=1), np.repeat(np.eye(cells), PLANE, axis=1)
    return PressureSpace(cells, np.hstack(at))


# ---- the functions ----


@pytest.mark.parametrize("cells", [1, 2, 3, 6])
@pytest.mark.parametrize("n_gauss", [2, 3, (3, 2)])
def test_functions_are_as_many_as_cells_and_add_up_to_one(cells, n_gauss):
    functions, points = (
        through_column(cells, n_gauss).functions,
        np.prod(np.broadcast_to(n_gauss, 2)),
    )
    assert functions.shape == (cells, cells * (points + PLANE))
    means = functions[:, : cells * points].reshape(cells, cells, points).mean(axis=2)
    at_areas = np.repeat(means, PLANE, axis=1)
    np.testing.assert_array_equal(functions[:, cells * points :], at_areas)
    assert np.linalg.matrix_rank(functions) == cells
    np.testing.assert_allclose(functions.sum(axis=0), 1.0, rtol=0.0, atol=1e-15)


@pytest.mark.parametrize("cells", [2, 3, 6])
@pytest.mark.parametrize("n_gauss", [2, (3, 2)])
def test_functions_hold_what_is_linear_across_the_column_and_constant_along_it(cells, n_gauss):
    """In the places of the points in the cell map, first direction."""
    disc = square(np.random.default_rng(1), cells + 1, fixed="nothing", n_gauss=n_gauss)
    space = through_column(cells, n_gauss)
    across = np.einsum("cqa,ca->cq", disc.body.cell_map.values, disc.body.cells % (cells + 1))
    for column in across.reshape(cells, -1):
        knots = np.linspace(0.0, cells, cells)
        at_points = space.functions[:, : column.size]
        np.testing.assert_allclose(knots @ at_points, column, rtol=0.0, atol=1e-14)


def test_one_cell_has_the_constant():
    np.testing.assert_array_equal(through_column(1, 3).functions, np.ones((1, 9 + PLANE)))


# ---- through columns, but one value a cell ----


@pytest.fixture(params=[1, 2])
def both(request, rng):
    """A deformed square by cells, and by columns with the same pressure."""
    by_cell = square(rng, order=request.param, fixed="nothing")
    body = with_pressure(by_cell.body, cell_by_cell(5))
    return by_cell, discretize(body, by_cell.particles), wave(by_cell, 0.15)


def test_forces_and_energy_are_those_of_cells(both):
    by_cell, by_column, d = both
    expected, found = (internal(disc, d)[0][disc.layout.equations] for disc in both[:2])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())
    assert energy(by_column, d) == pytest.approx(energy(by_cell, d), rel=1e-13)


def test_tangent_is_that_of_cells(both):
    d, matrices = both[2], []
    for disc in both[:2]:
        order = disc.layout.equations.ravel()
        matrices.append(dense(disc.layout, internal(disc, d)[1])[np.ix_(order, order)])
    expected, found = matrices
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_quadratic_integration_by_columns_is_that_of_cells(both):
    *discs, d = both
    found = [
        structure(discretize_quadratic(disc.body, disc.particles)).forces(d, 0.0) for disc in discs
    ]
    np.testing.assert_allclose(found[1], found[0], rtol=0.0, atol=1e-11 * np.abs(found[0]).max())


def test_analysis_and_derivatives_are_those_of_cells():
    """Two measures in all parameters by both methods."""
    changes = {"depth": 3.0, "n_steps": 16, "start": 10.03, "newton": sm.NewtonOptions(1e-11)}
    seal = sm.door_seal(**changes, layers=4, support=(1.8, 2.5))
    other = replace(seal)
    other.__dict__["body"] = with_pressure(other.body, cell_by_cell(3))
    offsets = np.random.default_rng(2).uniform(-0.04, 0.04, seal.n_offsets)
    results = [sm.analyze(s, offsets, keep_factors=True) for s in (seal, other)]
    np.testing.assert_allclose(results[1].reaction, results[0].reaction, rtol=0.0, atol=1e-9)
    for method in ("direct", "adjoint"):
        found = [
            sm.differentiate(r, tuple(seal.scalars), ("reaction", "von_mises"), method)
            for r in results
        ]
        for name in ("reaction", "von_mises"):
            size = np.abs(found[0][name]).max(axis=0)
            assert np.all(
                np.abs(found[1][name] - found[0][name]) <= 1e-9 * size + 1e-13 * size.max()
            )


# ---- continuous through columns ----


def test_energy_is_that_of_the_projected_volume_change(rng):
    """With the bulk term alone it is sum_k K/2 V_k s_k^2, where the mean of det(F - 1) over every cell
    is that of the rows of areas."""
    disc = square(rng, fixed="nothing", column=5)
    d, space, table = wave(disc, 0.2), disc.body.pressure, disc.cells.table
    total, points, q = 0.0, table.group_size, disc.cells.column_weights.shape[1]
    functions, means = space.functions[:, :q], space.functions[:, q::PLANE]
    for column, weights in enumerate(disc.cells.column_weights):
        low, high = table.start[column], table.start[column + 1]
        grad = table.grad[2 * points * low : 2 * points * high].reshape(points, 2, -1)
        slopes = np.einsum("qja,ai->qij", grad, d[table.neighbours[low:high]])
        det, F = np.linalg.det(slopes), np.eye(2) + slopes[:q]
        of_cells = det[q:].reshape(-1, PLANE).sum(axis=1)
        of_cells -= (weights * det[:q]).reshape(len(of_cells), -1).sum(axis=1)
        volumes = functions @ weights
        volume_strain = functions @ (weights * (np.linalg.det(F) - 1)) + means @ of_cells
        volume_strain /= volumes
        total += 0.5 * volumes @ volume_strain**2
    assert energy(disc, d, (0.0, 0.0, 1.0)) == pytest.approx(total, rel=1e-12)


def test_change_of_the_force_is_the_tangent_times_the_displacement(rng):
    disc = square(rng, fixed="nothing", column=5)
    d, motions, term = wave(disc, 0.15), rng.standard_normal((36, 2, 3)), structure(disc)
    found = np.zeros((disc.layout.n_equations, 3))
    add_tangent_product(
        term.states([SimpleNamespace(d=d, fraction=0.0)]), motions, disc.layout.equations, found
    )
    matrix = dense(disc.layout, internal(disc, d)[1])
    expected = np.column_stack([matrix @ disc.layout.reduce(u) for u in np.moveaxis(motions, 2, 0)])
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-12 * np.abs(expected).max())


def test_gradient_of_the_energy_in_weights_slopes_and_constants(rng):
    """Along any change of both arrays, by the five-point formula; it is linear in the constants."""
    disc = square(rng, fixed="nothing", column=5)
    d, term, cells = wave(disc, 0.15), structure(disc), disc.cells
    gradient, step = energy_gradient(term, SimpleNamespace(d=d, fraction=0.0)), 1e-3
    of_weights = rng.standard_normal(cells.weights.shape) * cells.weights
    of_slopes = rng.standard_normal(cells.table.grad.size)

    def energy_at(s):
        table = cells.table._replace(grad=cells.table.grad + s * of_slopes)
        term.cells = replace(cells, weights=cells.weights + s * of_weights, table=table)
        return term.energy(d, 0.0)

    values = [energy_at(s * step) for s in (-2, -1, 1, 2)]
    slope = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * step)
    exact = gradient.grad @ of_slopes + np.sum(gradient.weights * of_weights)
    assert slope == pytest.approx(exact, rel=1e-8)
    term.cells = cells
    assert gradient.constants @ CONSTANTS == pytest.approx(term.energy(d, 0.0), rel=1e-12)


def test_two_regions_of_one_material_are_one(rng):
    """Regions number cells, whatever the columns."""
    disc = square(rng, fixed="nothing", column=5)
    cells, d = np.arange(25), wave(disc, 0.15)
    parts = Region(RUBBER, cells[cells % 5 < 2], "low_"), Region(RUBBER, cells[cells % 5 >= 2])
    shared = tuple(part._replace(prefix="") for part in parts)
    one, two = elastic_body(RUBBER).on(disc, 0), ElasticBody(shared).on(disc, 0)
    np.testing.assert_array_equal(two.forces(d, 0.0), one.forces(d, 0.0))
    assert two.energy(d, 0.0) == one.energy(d, 0.0)


def test_two_bulk_moduli_in_a_column_are_refused(rng):
    disc = square(rng, fixed="nothing", column=5)
    cells = np.arange(25)
    parts = Region(RUBBER, cells[cells != 13]), Region(RUBBER.with_(bulk_modulus=5e3), cells[13:14])
    with pytest.raises(ValueError, match=r"column 2 of 5 background cells .* two bulk moduli"):
        ElasticBody(parts).on(disc, 0)
