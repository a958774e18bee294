"""Von Mises stress at particles and its derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from pressed_block import pressed_block

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.materials.isotropic import invariants
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.particle_stress import particle_stress
from seal_mdao.structure.region import Region


def stress_of(result, d, points=None, **constants):
    """What ``particle_stress`` gives for coefficients ``d`` and perhaps other constants."""
    path, seal = result.path, result.seal.with_parameters(constants)
    problem = PathProblem(path.discretization, seal.terms())
    points = np.arange(len(d)) if points is None else points
    found = particle_stress(replace(path, problem=problem), points, replace(path.steps[-1], d=d))
    # elastic: of the step itself alone
    [(_, by_gradient)] = found.by_gradient
    return found.value, by_gradient, found.by_constants


def gradients_at(table, d):
    """Deformation gradients at single points."""
    out = []
    for i in range(table.n_groups):
        low, high = table.start[i], table.start[i + 1]
        grad = table.grad[2 * low : 2 * high].reshape(2, -1)
        out.append(np.eye(2) + d[table.neighbours[low:high]].T @ grad.T)
    return np.array(out)


def test_stress_at_particles_is_that_of_the_material(nominal):
    table = nominal.path.discretization.everywhere.table
    F = gradients_at(table, nominal.end.d)
    exact, _, _ = options_of(nominal.seal).material.von_mises(*invariants(F))
    np.testing.assert_allclose(nominal.stress_field(), exact, rtol=1e-11, atol=1e-9)


def test_stress_of_a_homogeneous_deformation_is_uniform(nominal):
    disc, slope = nominal.path.discretization, np.array([[0.2, 0.3], [0.0, -0.1]])
    stress = stress_of(nominal, disc.particles @ slope.T)[0]
    exact, _, _ = options_of(nominal.seal).material.von_mises(*invariants(np.eye(2) + slope))
    np.testing.assert_allclose(stress, exact, rtol=1e-9)


def test_derivative_with_respect_to_the_deformation_gradient(nominal, rng):
    """Through the coefficients d: a directional derivative by five points."""
    points, d = np.array(nominal.measure("von_mises").points), nominal.end.d
    table = nominal.path.discretization.table_at(points).table
    direction = rng.standard_normal(d.shape)
    _, by_gradient, _ = stress_of(nominal, d, points)
    rate = gradients_at(table, direction) - np.eye(2)
    exact = np.einsum("sij,sij->s", by_gradient.reshape(-1, 2, 2), rate)
    h = 1e-4
    values = [stress_of(nominal, d + k * h * direction, points)[0] for k in (-2, -1, 1, 2)]
    slope = (values[0] - 8 * values[1] + 8 * values[2] - values[3]) / (12 * h)
    np.testing.assert_allclose(slope, exact, rtol=0.0, atol=1e-8 * np.abs(exact).max())


def test_undeformed_particles_have_no_stress_and_no_derivative(nominal):
    stress, by_gradient, by_constants = stress_of(nominal, 0 * nominal.end.d, np.array([5, 60]))
    assert not stress.any()
    assert not by_gradient.any()
    assert not any(row.any() for row in by_constants.values())


def test_derivative_with_respect_to_the_constants(nominal):
    points, d, h = np.array(nominal.measure("von_mises").points), nominal.end.d, 1e-2
    constants = {"c10": 80.0, "c01": 20.0, "bulk_modulus": 80_000.0}
    stress, _, found = stress_of(nominal, d, points)
    assert set(found) == set(constants)
    for name, value in constants.items():
        values = [stress_of(nominal, d, points, **{name: value + s * h})[0] for s in (1, -1)]
        np.testing.assert_allclose(found[name], (values[0] - values[1]) / (2 * h), atol=1e-7)
    # homogeneous of degree one in (C10, C01)
    np.testing.assert_allclose(80.0 * found["c10"] + 20.0 * found["c01"], stress, rtol=1e-12)


def test_stress_does_not_change_under_a_rigid_rotation(nominal):
    disc, d = nominal.path.discretization, nominal.end.d
    c, s = np.cos(2.9), np.sin(2.9)
    more = (disc.particles + d) @ np.array([[c, s], [-s, c]]) - disc.particles
    before, after = (stress_of(nominal, field)[0] for field in (d, more))
    assert after == pytest.approx(before, rel=1e-9, abs=1e-8)


def test_stress_all_over_the_section(nominal):
    """The particles first, as they are; then the middles of the sides of all cells, and of all cells."""
    places, stress = nominal.section_stress()
    cells, n = nominal.seal.body.cells, len(nominal.particles)
    np.testing.assert_array_equal(stress[:n], nominal.stress_field())
    np.testing.assert_allclose(places[-len(cells) :], nominal.particles[cells].mean(axis=1))
    sides = {tuple(sorted(pair)) for c in cells for pair in zip(c, np.roll(c, -1), strict=True)}
    assert len(places) == n + len(sides) + len(cells)
    middles = {tuple(np.round(nominal.particles[list(side)].mean(axis=0), 9)) for side in sides}
    found = places[n : -len(cells)]
    assert {tuple(np.round(place, 9)) for place in found} == middles


def test_points_between_cells_have_the_material_beside_them():
    """Of two materials that of the region named last."""
    block = pressed_block()
    soft, hard = np.arange(12), np.arange(12, 24)
    body = ElasticBody(
        (
            Region(sm.NeoHookean(120.0, 20_000.0), soft, "low_"),
            Region(sm.NeoHookean(240.0, 20_000.0), hard, "high_"),
        )
    )
    result = sm.analyze(replace(block, definitions=(body, *block.definitions[1:])))
    regions, seal = result.term("structure").sample_regions, result.seal
    cells, n = seal.body.cells, len(result.particles)
    np.testing.assert_array_equal(regions[-len(cells) :], np.arange(24) >= 12)
    for anchors, region in zip(
        seal.body.samples.anchors[n : -len(cells)], regions[n : -len(cells)], strict=True
    ):
        beside = [i for i, cell in enumerate(cells) if np.isin(anchors[:2], cell).all()]
        assert region == max(i >= 12 for i in beside)
