"""The stored optima of the examples are designs with the objectives that the page shows."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.result import frozen_measures
from verification.example_optima import BLIND, NAMES, optimized_file, stored

# the long tests of the examples optimise the others again, and compare with what is stored
ANALYSED = ["d_bulb", pytest.param(BLIND, marks=pytest.mark.long)]


def test_every_optimum_is_stored():
    assert list(stored()) == NAMES


@pytest.mark.parametrize("name", ANALYSED)
def test_stored_optima(name):
    """The stored design has the objective that is stored beside it."""
    file = optimized_file(name)
    own, seal = stored()[name], sm.build_seal(file)
    aim = next(m for m in frozen_measures(seal) if m.name == file.optimize.minimize)
    value = sm.analyze(seal, np.array(own["offsets"])).value(aim)[0]
    assert value == pytest.approx(own["after"], rel=1e-6, abs=1e-9 * own["before"])
