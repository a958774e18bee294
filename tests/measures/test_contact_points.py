"""Contact that is not at particles: derivatives of all measures."""

import numpy as np
import pytest
from quotients import quotients

import seal_mdao as sm
from seal_mdao.measures.contact_pressure import ContactWidth
from seal_mdao.measures.work import ProfileWork
from seal_mdao.seals.door.door_seal import FURTHER, STANDARD

NAMES = tuple(measure.name for measure in (*STANDARD, *FURTHER))
MORE = ContactWidth("door"), ProfileWork("door")


@pytest.fixture(scope="module", params=["edges", "averages"])
def seal(request):
    return sm.door_seal(
        accuracy="engineering", contact_points=request.param, n_steps=6,
        newton=sm.NewtonOptions(tolerance=1e-11),
    )  # fmt: skip


@pytest.fixture(scope="module")
def result(seal):
    return sm.analyze(seal, keep_factors=True)


def test_direct_and_adjoint_agree(result):
    names = "door_radius", "friction", "normal_penalty", "c10", "depth", "door_angle"
    found = [
        sm.differentiate(result, names, (*NAMES, *MORE), method) for method in ("direct", "adjoint")
    ]
    for name in (*NAMES, *(measure.name for measure in MORE)):
        one, other = (np.atleast_2d(values[name]) for values in found)
        size = np.abs(one).max(axis=0)
        assert size.max() > 0.0, name
        assert np.all(np.abs(one - other) <= 1e-9 * size + 1e-12 * size.max()), name


@pytest.mark.parametrize("name", ["boundary_offsets[7]", "friction", "depth"])
def test_derivatives_are_those_of_the_path(seal, result, name):
    parameters = (name,) if name in seal.scalars else ("friction",)
    direct = sm.differentiate(result, parameters, method="direct")
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(seal, name, 2e-5).items():
        one = np.atleast_2d(direct[measure])[:, column]
        assert np.all(np.abs(one - quotient) <= bound), measure
        assert bound.max() <= 1e-3 * np.abs(one).max(), measure
