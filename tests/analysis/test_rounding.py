"""The bound of the rounding error of a residual covers displacements much larger than the particles'
distance."""

import numpy as np
import pytest
from bodies import CONSTANTS, square

import seal_mdao as sm
from seal_mdao.analysis.problem import PathProblem
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
