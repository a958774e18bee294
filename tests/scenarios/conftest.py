"""A small seal in a few scenarios."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.scenarios.task import SealTask
from seal_mdao.seals.result import frozen_measures


def small_seal():
    """Short, with large steps; its middle opens."""
    return sm.door_seal(
        depth=7.0, n_steps=16, start=10.03, newton=sm.NewtonOptions(tolerance=1e-11)
    )


def some_scenarios(count=4, seed=5):
    """Friction, hardness, corner radius, shift of the door and boundaries that vary."""
    rng = np.random.default_rng(seed)
    variations = (
        sm.Variation("friction"), sm.Variation("hardness", "factor", ("c10", "c01")),
        sm.Variation("door_radius", "shift"), sm.Variation("door_shift"),
    )  # fmt: skip
    numbers = rng.uniform([0.2, 0.9, -0.1, -0.3], [0.3, 1.1, 0.1, 0.3], (count, 4))
    return sm.Scenarios(variations, numbers, rng.normal(0.0, 0.03, (count, 25)))


MEASURES = ("gap_square_integral", "reaction", "patch_pressure")


@pytest.fixture(scope="session")
def seal():
    return small_seal()


@pytest.fixture(scope="session")
def scenarios():
    return some_scenarios()


@pytest.fixture(scope="session")
def task(seal, scenarios):
    names = tuple(dict.fromkeys((*seal.inputs, *scenarios.parameters)))
    return SealTask(seal, frozen_measures(seal, MEASURES), names, derivatives=True)


@pytest.fixture(scope="session")
def design(seal, task):
    """Scalar parameters of the design."""
    return {name: seal.scalars[name].value for name in task.parameters}
