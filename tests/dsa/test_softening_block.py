"""The block of ``block`` whose harder rubber softens: energy, force and tangent, and the derivatives in
the program of the profile, its shape and imposed displacements."""

from dataclasses import replace

import numpy as np
import pytest
from block import block_seal
from quotients import quotients

import seal_mdao as sm
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.materials.viscoelastic import PronySeries
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.stress import VonMises
from seal_mdao.measures.work import ProfileWork, StrainEnergy
from seal_mdao.structure.environment import Environment
from seal_mdao.terms.ramp import ramp_of_stages

PARAMETERS = {"depth": 1e-4, "tilt": 1e-3, "boundary_offsets[0]": 1e-4, "boundary_offsets[1]": 1e-4}


@pytest.fixture(scope="module")
def seal():
    elastic = block_seal()
    body, roll, pull = elastic.definitions
    hard, soft = body.regions
    body = replace(body, regions=(hard._replace(softening=OgdenRoxburgh(1.8, 3.0, 0.2)), soft))
    # pressed, moved back, and pressed further
    stages = [
        Stage(4, (0.0, -0.6), rates={"depth": (0.0, -1.0, 0.0)}),
        Stage(3, (0.0, 0.4), rates={"back": (0.0, 1.0, 0.0)}),
        Stage(7, (0.2, -0.6), 10.0, rates={"further": (0.0, -1.0, 0.0)}),
    ]
    roll = replace(roll, motion=staged_motion(stages, start=(0.2, 3.05), pivot=(0.3, 0.1)))
    newton = sm.NewtonOptions(tolerance=1e-12)
    return replace(elastic, definitions=(body, roll, pull), newton=newton)


@pytest.fixture(scope="module")
def result(seal):
    found = sm.analyze(seal, keep_factors=True)
    found.require_converged()
    return found


MEASURES = (Reaction("roll"), VonMises(count=2), ProfileWork("roll"))


@pytest.mark.parametrize("number", [2, 6, 10, 13])
def test_energy_force_and_tangent(result, number):
    """Differences of the energy of a step and of its force, on the primary branch, below it, mixed."""
    step, term = result.path.steps[number], result.term("structure")
    response, rng = step.responses[term.index], np.random.default_rng(3)
    du, h = rng.normal(size=step.d.shape), 1e-6

    def force(d):
        return term.forces(d, step.fraction, response.before)

    ends = [step.d + s * h * du for s in (1, -1)]
    quotient = np.subtract(*(term.potential(d, response) for d in ends)) / (2.0 * h)
    assert (force(step.d) * du).sum() == pytest.approx(quotient, rel=1e-6)
    found = np.zeros((step.d.size + 1, 1))
    every = term.discretization.layout.every_component.equations
    term.linearization(step).add_change(np.ascontiguousarray(du[..., None]), every, found)
    quotient = (force(ends[0]) - force(ends[1])).ravel() / (2.0 * h)
    np.testing.assert_allclose(
        found[:-1, 0], quotient, rtol=0.0, atol=1e-6 * np.abs(quotient).max()
    )
    # of the points of the rubber that softens
    hard = term.by_cell(response.below)[term.definition.regions[0].at].mean()
    low, high = {2: (0.0, 0.0), 6: (1.0, 1.0), 10: (0.1, 0.9), 13: (0.1, 0.9)}[number]
    assert low <= hard <= high


def test_derivatives(seal, result):
    names = tuple(seal.scalars)
    direct, adjoint = (
        sm.differentiate(result, names, MEASURES, method) for method in ("direct", "adjoint")
    )
    for measure in MEASURES:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-10 * np.abs(one).max())
    for parameter, step in PARAMETERS.items():
        column = direct.parameters.index(parameter)
        for measure, (quotient, bound) in quotients(
            seal, parameter, step, measures=MEASURES
        ).items():
            one = np.atleast_2d(direct[measure])[:, column]
            at = f"{measure} by {parameter}"
            assert np.all(np.abs(one - quotient) <= bound), (at, one, quotient, bound)
            assert bound.max() <= 1e-4 * max(np.abs(one).max(), np.abs(quotient).max(), 1e-2), at


FOAM = sm.Hyperfoam((60.0,), (3.0,), (0.2,))
STRETCHED = Environment(axial_stretch=ramp_of_stages(1.0, [1.02], [14]))


@pytest.mark.parametrize(
    ("region", "environment", "words"),
    [({"material": FOAM}, None, "Hyperfoam is compressible"),
     ({"prony": PronySeries((0.2,), (1.0,))}, None, "Mullins softening and viscoelasticity cannot be"),
     ({}, STRETCHED, "softening cannot be combined with an axial stretch")],
)  # fmt: skip
def test_bodies_whose_softening_is_not_known_are_refused(seal, region, environment, words):
    body, *others = seal.definitions
    hard, soft = body.regions
    body = replace(body, regions=(hard._replace(**region), soft), environment=environment)
    with pytest.raises(ValueError, match=words):
        sm.analyze(replace(seal, definitions=(body, *others)))


def test_the_stored_energy_is_not_known(result):
    with pytest.raises(ValueError, match="the strain energy of rubber with Mullins softening"):
        result.value(StrainEnergy())
