"""A term given by its law alone: columns by complex steps, history and outputs of its own."""

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pytest
from elastic_foundation import ElasticFoundation
from pressed_block import pressed_block
from quotients import quotients

import seal_mdao as sm
from seal_mdao.measures.measure import Measure
from seal_mdao.terms.point_law import PointLaw
from seal_mdao.terms.points import MaterialPoints


@dataclass(frozen=True, eq=False)
class FadingFoundation(PointLaw):
    """Springs that yield: force k l (u - h) (1 + |u|^2) with h+ = h + rate (u - h), output |u - h|^2."""

    label: str
    where: MaterialPoints
    stiffness: float
    rate: float
    parameters: ClassVar = {"stiffness": "kPa/mm", "rate": None}
    history_size = 2
    output_names = ("stretch",)

    def evaluate(self, given, fraction):
        moved, theta = given.x - given.reference, given.parameters
        stretched = moved - given.history
        stiffer = 1.0 + (moved * moved).sum(axis=1, keepdims=True)
        force = theta.stiffness * given.measure * stiffer * stretched
        square = (stretched * stretched).sum(axis=1, keepdims=True)
        return force, given.history + theta.rate * stretched, square


@dataclass(frozen=True)
class Stretch(Measure):
    """Sum of the output of all points."""

    name = "stretch"

    def evaluate(self, result, partials):
        partials.output("springs", "stretch")[:] += 1.0
        return result.response("springs").outputs.sum()


@dataclass(frozen=True, eq=False)
class DenseFoundation(ElasticFoundation):
    """The same springs with the block of derivatives given."""

    def linearize(self, given, fraction):
        pulled, out = given.x - given.reference, np.zeros((len(given.x), 2, 6))
        stiffness = given.parameters.stiffness * given.measure
        out[:, :, 2] = given.parameters.stiffness * pulled  # by the length
        out[:, :, 3] = given.measure * pulled  # by the stiffness
        out[:, :, :2] = stiffness[..., None] * np.eye(2)  # by x, and by X
        out[:, :, 4:] = -out[:, :, :2]
        return out


def with_springs(springs):
    seal = pressed_block()
    body, where = seal.definitions[0], seal.definitions[1].where
    terms = body, springs(where), seal.definitions[2]
    return replace(seal, definitions=terms, standard=(*seal.standard, Stretch()))


@pytest.fixture(scope="module")
def fading():
    return with_springs(lambda where: FadingFoundation("springs", where, 300.0, 0.3))


NAMES = ("springs_stiffness", "springs_rate", "links", "depth")


@pytest.fixture(scope="module")
def tables(fading):
    result = sm.analyze(fading, keep_factors=True)
    assert result.converged
    return [sm.differentiate(result, NAMES, method=method) for method in ("direct", "adjoint")]


def test_a_law_with_history_and_outputs_by_both_methods(fading, tables):
    direct, adjoint = tables
    for measure in fading.standard:
        size = np.abs(direct[measure.name]).max()
        assert np.abs(direct[measure.name] - adjoint[measure.name]).max() <= 1e-11 * size


@pytest.mark.parametrize("name", ["boundary_offsets[1]", "springs_stiffness", "springs_rate"])
def test_a_law_with_history_against_central_differences(fading, tables, name):
    column = tables[0].parameters.index(name)
    size = fading.scalars[name].value if name in fading.scalars else 1.0
    for measure, (quotient, bound) in quotients(fading, name, 1e-4 * size).items():
        exact = np.atleast_2d(tables[1][measure])[:, column]
        assert np.abs(exact).max() > 0.0, measure
        assert (np.abs(quotient - exact) <= bound).all(), measure
        assert bound.max() <= 1e-6 * np.abs(exact).max(), measure


def test_columns_by_complex_steps_are_those_given_as_a_block():
    found = []
    for springs in (ElasticFoundation, DenseFoundation):
        seal = with_springs(lambda where, springs=springs: springs("springs", where, 300.0))
        seal = replace(seal, standard=seal.standard[:-1])
        result = sm.analyze(seal, keep_factors=True)
        assert type(result.term("springs").definition) is springs
        found.append(sm.differentiate(result, NAMES[:1], method="adjoint"))
    for measure, expected in found[1].rows.items():
        size = np.abs(expected).max()
        np.testing.assert_allclose(found[0][measure], expected, rtol=0.0, atol=1e-12 * size)


def test_an_iteration_takes_complex_steps_in_the_deformed_coordinates_alone():
    steps = []

    class Counted(FadingFoundation):
        def evaluate(self, given, fraction):
            steps.append(np.iscomplexobj(given.x))
            return super().evaluate(given, fraction)

    result = sm.analyze(with_springs(lambda where: Counted("springs", where, 300.0, 0.3)))
    assert result.converged
    assert steps.count(True) == 2 * steps.count(False) > 0
    # the tangent is the first columns of the linearisation, bit for bit
    term, end = result.term("springs"), result.end
    response = end.responses[term.index]
    given = term._inputs(response.x, end.before[term.index], np.arange(len(response.x)))
    block = term.definition.linearize(given, end.fraction)
    assert np.array_equal(response.tangent, block[:, :2, :2])
