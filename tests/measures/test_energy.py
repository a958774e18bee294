"""Strain energy: its derivatives, with several materials and imposed displacements."""

from dataclasses import replace

import numpy as np
import pytest
from pressed_block import pressed_block
from quotients import quotients

import seal_mdao as sm
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.work import StrainEnergy
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.region import Region

SOFT, HARD = np.arange(12), np.arange(12, 24)
RELATIVE_STEP = 1e-4


@pytest.fixture(scope="module")
def seal():
    """The pressed block of rubber below and another law above, its base pulled sideways."""
    block = pressed_block()
    body = ElasticBody(
        (
            Region(sm.Ogden((60.0, -10.0), (2.5, -2.0), 20_000.0), SOFT, "low_"),
            Region(sm.Gent(220.0, 20.0, 15_000.0), HARD, "high_"),
        )
    )
    pull, tilt = np.zeros((9, 36, 2)), np.zeros((9, 36, 2))
    grows = np.linspace(0.0, 1.0, 9)[:, None]
    pull[:, :9, 0], tilt[:, :9, 1] = grows, grows * block.nominal_particles[:9, 0]
    prescribed = ImposedDisplacements(
        0.05 * pull + 0.02 * tilt, ("pull", "tilt"), np.array([pull, tilt])
    )
    return replace(
        block,
        definitions=(body, *block.definitions[1:]),
        imposed_displacements=prescribed,
        standard=(StrainEnergy(), Reaction("roll")),
    )


@pytest.fixture(scope="module")
def result(seal):
    return sm.analyze(seal, keep_factors=True)


@pytest.fixture(scope="module")
def tables(seal, result):
    names = tuple(seal.scalars)
    return [sm.differentiate(result, names, method=method) for method in ("direct", "adjoint")]


def test_direct_and_adjoint_agree(tables):
    direct, adjoint = (table["strain_energy"] for table in tables)
    size = np.abs(direct)
    # what is added up for a parameter may cancel: the largest derivative is the scale of rounding
    assert (np.abs(direct - adjoint) <= 1e-9 * size + 1e-14 * size.max()).all()


@pytest.mark.long
def test_central_differences_agree(seal, tables):
    for column, name in enumerate(tables[0].parameters):
        size = abs(seal.scalars[name].value) if name in seal.scalars else 0.0
        quotient, bound = quotients(seal, name, RELATIVE_STEP * (size or 1.0))["strain_energy"]
        for table in tables:
            exact = table["strain_energy"][0, column]
            assert abs(quotient[0] - exact) <= bound[0], name
            assert bound[0] <= 1e-6 * abs(exact), name


def test_both_measures_at_once_are_each_alone(result):
    """Seeds of several measures stay apart."""
    names = ("low_mu_1", "roll_b", "tilt")
    for method in ("direct", "adjoint"):
        both = sm.differentiate(result, names, method=method)
        for measure in (StrainEnergy(), Reaction("roll")):
            alone = sm.differentiate(result, names, (measure,), method)[measure.name]
            size = np.abs(alone).max()
            np.testing.assert_allclose(both[measure.name], alone, rtol=0.0, atol=1e-12 * size)
