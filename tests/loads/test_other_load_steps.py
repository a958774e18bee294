"""Loads whose load steps end elsewhere: at every place of the path they are what they were."""

import numpy as np
import pytest
from fluid_seals import gasket

from seal_mdao.loads.dead_load import DeadLoad
from seal_mdao.loads.imposed import ImposedDisplacements
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.terms.points import fixed_points
from seal_mdao.terms.ramp import at_fraction

ENDS = (0.5, 1.0, 1.25, 3.0)
"""In the three nominal steps of the loads; the second one goes into a longer step."""


def test_a_dead_load_grows_as_before():
    point = fixed_points(PointSet(np.array([[0]]), np.array([[1.0]]), 1), 1.0)
    load = DeadLoad("pull", point, np.array([1.0, 2.0]), np.array([0.0, 1.0, 0.5, 0.0]))
    other = load.with_ends(ENDS)
    assert other.ramp.tolist() == [0.0, 0.5, 1.0, 0.875, 0.0]
    assert other.with_ends((2.0, 4.0)).ramp.tolist() == [0.0, 1.0, 0.0]


@pytest.mark.parametrize("names", [(), ("a", "b")])
def test_imposed_displacements_and_their_rates_are_as_before(rng, names):
    values, rates = rng.uniform(size=(4, 5, 2)), rng.uniform(size=(len(names), 4, 5, 2))
    imposed = ImposedDisplacements(values, names, rates)
    other = imposed.with_ends(ENDS)
    for number, end in enumerate((0.0, *ENDS)):
        np.testing.assert_array_equal(other.values[number], imposed.at(end))
        np.testing.assert_array_equal(
            other.linearization(float(number)), imposed.linearization(end).reshape(10, len(names))
        )


def test_a_fluid_and_the_profiles_that_hold_it_go_on_together():
    seal = gasket(10.0, close=1, steps=1)
    other = seal.with_ends((0.5, 1.0, 1.25, 2.0))
    lid, fluid = (next(t for t in other.terms() if t.label == name) for name in ("lid", "fluid"))
    assert fluid.ramp.tolist() == [0.0, 0.0, 0.0, 0.25, 1.0]
    (held_back,) = fluid.contacts
    for fraction in (0.0, 0.4, 2.0, 3.7):
        places = (own.motion.coordinates(fraction) for own in (lid, held_back))
        np.testing.assert_array_equal(*places)
    assert at_fraction(fluid.ramp, 2.5) == 0.125
