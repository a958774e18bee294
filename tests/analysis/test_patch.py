"""Linear patch test: imposed linear displacements on the rim of an irregular body, solved inside."""

import numpy as np
import pytest
from bodies import CONSTANTS, inside, pieces, square

import seal_mdao as sm
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.materials.isotropic import invariants
from seal_mdao.rkpm.tables import build_table
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.terms.points import edge_points

SLOPE = np.array([[0.12, 0.2], [-0.05, -0.08]])
RUBBER = sm.MooneyRivlin(*CONSTANTS)


def moved(disc, field, steps=2):
    """The path along which the rim is moved to ``field`` (n, 2)."""
    ramp = np.linspace(0.0, 1.0, steps + 1)[:, None, None]
    problem = PathProblem(disc, (elastic_body(RUBBER),), ImposedDisplacements(ramp * field))
    return solve_path(problem, steps, sm.NewtonOptions(1e-13))


@pytest.mark.parametrize(("order", "column"), [(1, 1), (2, 1), (1, 5), (2, 5)])
def test_homogeneous_deformation_is_solved_exactly(rng, order, column):
    disc = square(rng, order=order, column=column)
    path = moved(disc, disc.particles @ SLOPE.T)
    assert path.converged
    exact = disc.particles @ SLOPE.T
    np.testing.assert_allclose(path.displacement(), exact, rtol=0.0, atol=1e-10)
    table = build_table(disc.cloud, inside(rng, disc), disc.transformation).table
    F = deformation_gradients(table, path.steps[-1].d)[:, :4].reshape(-1, 2, 2)
    stress, exact = (RUBBER.von_mises(*invariants(f))[0] for f in (F, np.eye(2) + SLOPE))
    np.testing.assert_allclose(stress, exact, rtol=1e-9)


def test_imposed_displacements_are_physical(rng):
    """Of a field that is not linear: u(X_J) on the rim is what was imposed, by interpolation."""
    disc = square(rng)
    field = 0.1 * np.column_stack([np.sin(3 * disc.particles[:, 1]), disc.particles[:, 0] ** 2])
    path = moved(disc, field)
    rim = disc.body.constrained
    assert path.converged
    np.testing.assert_allclose(path.displacement()[rim], field[rim], rtol=0.0, atol=1e-13)


@pytest.mark.parametrize("kind", ["triangles", "mixed"])
@pytest.mark.parametrize("void", ["none", "hole", "notch", "interface"])
def test_triangles_and_voids_pass_the_patch_test(rng, kind, void):
    """The rim is moved, tractions act in a hole and in a notch that supports do not reach across, nor do
    they across an interface."""
    disc, sides = pieces(rng, kind, void)
    field = disc.particles @ SLOPE.T
    stress = first_piola(np.eye(2) + SLOPE)
    along = np.diff(disc.particles[sides], axis=1)[:, 0]
    normals = np.column_stack([along[:, 1], -along[:, 0]]) / np.hypot(*along.T)[:, None]
    density = np.repeat(normals @ stress.T, 2, axis=0)
    load = DeadLoad("void", edge_points(sides, 2), density, np.array([0.0, 1.0]))
    ramp = np.array([0.0, 1.0])[:, None, None]
    body = disc.body
    disc = discretize(body, disc.particles, (elastic_body(RUBBER), load))
    problem = PathProblem(disc, (elastic_body(RUBBER), load), ImposedDisplacements(ramp * field))
    path = solve_path(problem, 1, sm.NewtonOptions(1e-13))
    assert path.converged
    assert (void != "none") == (body.hidden_pairs.size > 0)
    assert (void in ("none", "interface")) == (sides.size == 0)
    np.testing.assert_allclose(path.displacement(), field, rtol=0.0, atol=1e-10)


def first_piola(F):
    """P = 2 W_T F + W_J cof F of the projected energy at a uniform deformation."""
    T, J = (np.array([value]) for value in invariants(F))
    slope_t, slope_j = RUBBER.derivatives(T, J)[:2]
    slope_j = slope_j + RUBBER.bulk_modulus * (J - 1.0)
    return 2.0 * slope_t * F + slope_j * np.array([[F[1, 1], -F[1, 0]], [-F[0, 1], F[0, 0]]])
