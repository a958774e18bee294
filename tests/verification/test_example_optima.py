"""The stored optima of the examples are designs with the objectives that the page shows."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.result import frozen_measures
from verification.example_optima import EXAMPLES, NAMES, stored

QUICK = "d_bulb"


def analyses_as_stored(name):
    """The stored design has the objective that is stored beside it."""
    file = sm.read_seal_file(EXAMPLES / f"{name}.toml")
    own, seal = stored()[name], sm.build_seal(file)
    aim = next(m for m in frozen_measures(seal) if m.name == file.optimize.minimize)
    value = sm.analyze(seal, np.array(own["offsets"])).value(aim)[0]
    assert value == pytest.approx(own["after"], rel=1e-6, abs=1e-9 * own["before"])


def test_every_optimum_is_stored():
    assert list(stored()) == NAMES


def test_a_stored_optimum():
    analyses_as_stored(QUICK)


@pytest.mark.long
@pytest.mark.parametrize("name", [name for name in NAMES if name != QUICK])
def test_stored_optima(name):
    analyses_as_stored(name)
