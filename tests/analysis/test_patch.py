"""Linear patch test: imposed linear displacements on the rim of an irregular body, solved inside."""

import numpy as np
import pytest
from bodies import CONSTANTS, inside, square

import seal_mdao as sm
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.loading import LoadProgram, still_profile
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.measures.stress import von_mises_at
from seal_mdao.rkpm.tables import build_table

SLOPE = np.array([[0.12, 0.2], [-0.05, -0.08]])
RUBBER = sm.MooneyRivlin(*CONSTANTS)
FAR = flat_profile()._replace(origin=np.array([[-100.0, 50.0]]))


def stretched(disc, slope=SLOPE, steps=2):
    """The path along which the rim is moved as by a homogeneous displacement gradient."""
    ramp = np.linspace(0.0, 1.0, steps + 1)[:, None, None]
    program = LoadProgram(still_profile(steps), imposed=ramp * (disc.particles @ slope.T))
    return solve_path(
        disc, RUBBER, FAR, ContactLaw(1.0, 1.0, 0.0, True), program, sm.NewtonOptions(1e-13)
    )


@pytest.mark.parametrize(("order", "solver"), [(1, "banded"), (1, "superlu"), (2, "banded")])
def test_homogeneous_deformation_is_solved_exactly(rng, order, solver):
    disc = square(rng, order=order, solver=solver)
    path = stretched(disc)
    assert path.converged
    exact = disc.particles @ SLOPE.T
    np.testing.assert_allclose(path.displacement(), exact, rtol=0.0, atol=1e-10)
    table = build_table(disc.cloud, inside(rng, disc), disc.transformation).table
    stress, _ = von_mises_at(table, path.steps[-1].d, RUBBER)
    np.testing.assert_allclose(stress, RUBBER.von_mises(np.eye(2) + SLOPE), rtol=1e-9)


def test_imposed_displacements_are_physical(rng):
    """Of a field that is not linear: u(X_J) on the rim is what was imposed, by interpolation."""
    disc = square(rng)
    field = 0.1 * np.column_stack([np.sin(3 * disc.particles[:, 1]), disc.particles[:, 0] ** 2])
    program = LoadProgram(still_profile(2), imposed=np.linspace(0, 1, 3)[:, None, None] * field)
    path = solve_path(disc, RUBBER, FAR, ContactLaw(1.0, 1.0, 0.0, True), program)
    rim = disc.body.constrained
    assert path.converged
    np.testing.assert_allclose(path.displacement()[rim], field[rim], rtol=0.0, atol=1e-13)
