"""Terms with a potential: it is what their forces derive from, and the tangent is symmetric."""

import numpy as np
import pytest
from air_ring import air_ring
from lines import CENTRAL

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.discretization import discretize
from seal_mdao.loads.dead_load import DeadLoad


@pytest.fixture(scope="module", params=[1.0, 1.4])
def squeezed(request):
    """A sealed ring under a plate without friction and a load, pressed."""
    seal = air_ring(friction=0.0, gamma=request.param)
    n = seal.n_steps
    load = DeadLoad(
        "load", seal.body.edge_points("outer"), np.array([0.5, -0.8]), np.linspace(0.0, 1.0, n + 1)
    )
    terms = *seal.terms(), load
    problem = PathProblem(discretize(seal.body, seal.nominal_particles, terms), terms)
    step = sm.analyze(seal).path.nominal_steps[1]
    return problem, step, (*step.before, None)


def test_forces_derive_from_the_potential(squeezed, rng):
    problem, step, history = squeezed
    layout = problem.discretization.layout
    way = layout.gather(rng.standard_normal(layout.n_equations))
    places, (fine, _) = CENTRAL
    size = 1e-4

    def potential(t):
        return problem.evaluate(step.d + t * way, step.fraction, history).potential

    slope = fine @ [potential(size * k) for k in places] / size
    assembly = problem.evaluate(step.d, step.fraction, history)
    forces = assembly.forces[:, : layout.n_equations] @ layout.reduce(way)
    # the forces of the terms all but balance: the error is theirs
    assert np.abs(forces).min() > 1e-3
    assert slope == pytest.approx(forces.sum(), abs=1e-6 * np.abs(forces).max())


def test_the_tangent_is_symmetric_and_its_factor_knows_its_sign(squeezed):
    problem, step, history = squeezed
    n = problem.discretization.layout.n_equations
    assert problem.symmetric

    def factor(shift):
        return problem.evaluate(step.d, step.fraction, history).factorize(True, -shift)

    inverse = factor(0.0).solve(np.eye(n))
    np.testing.assert_allclose(inverse, inverse.T, atol=1e-9 * np.abs(inverse).max())
    lowest = 1.0 / np.linalg.eigvalsh(inverse)[-1]
    assert factor(0.99 * lowest).positive
    assert not factor(1.01 * lowest).positive
