"""The bound of the rounding error of a residual covers displacements much larger than the particles'
distance."""

import numpy as np
import pytest
from bodies import CONSTANTS, square

import seal_mdao as sm
from seal_mdao.analysis.increment import Increment
from seal_mdao.analysis.newton import newton
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.structure.elastic_body import elastic_body

RUBBER = sm.MooneyRivlin(*CONSTANTS)


@pytest.mark.parametrize("shift", [0.0, 1.0, 1e3, 1e6])
def test_a_body_that_is_displaced_as_a_whole_is_in_equilibrium_to_rounding(rng, shift):
    disc = square(rng, n=12, fixed="nothing")
    problem = PathProblem(disc, (elastic_body(RUBBER),))
    d = shift * np.tile([0.8, -0.6], (len(disc.particles), 1))
    found = problem.evaluate(d, 0.0, (None,))
    assert found.noise
    if shift >= 1e3:
        # displacements over the distance of the particles, not strains of order one
        assert not found.rounding
    # a strain of 1e-6 is no rounding
    strained = d + 1e-6 * disc.particles
    assert not problem.evaluate(strained, 0.0, (None,)).noise


@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_iterations_end_where_rounding_alone_is_left(rng, shift):
    """The rim is strained and displaced as a whole; iterations begin beside the solution."""
    disc = square(rng, n=12)
    slope = np.array([[0.12, 0.05], [-0.05, -0.08]])
    field = disc.particles @ slope.T + shift * np.array([0.8, -0.6])
    imposed = ImposedDisplacements(np.array([0.0, 1.0])[:, None, None] * field)
    problem = PathProblem(disc, (elastic_body(RUBBER),), imposed)
    beside = field + 1e-3 * rng.uniform(-1.0, 1.0, field.shape) * ~disc.body.fixed
    options = sm.NewtonOptions(1e-15, max_iterations=30)
    found = newton(Increment(problem, 1.0, problem.no_history(), options), beside)
    assert found.status is Status.CONVERGED
    # in as many iterations as Newton's method needs to reach rounding, and one more
    assert len(found.residuals) < 10
    # strains are known to the rounding of displacements over the distance of particles
    np.testing.assert_allclose(found.d, field, rtol=0.0, atol=1e-12 * max(1.0, shift))
