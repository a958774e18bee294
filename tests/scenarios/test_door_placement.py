"""A door that is not where the drawing says: shift and angle as parameters of the door seal."""

from functools import partial

import numpy as np
import pytest
from lines import check, slopes
from verification.differences import perturbed

import seal_mdao as sm
from seal_mdao.geometry.motion import Stage, staged_motion

STEPS = {"door_shift": 1e-5, "door_angle": 1e-4}
"""mm and degrees: both move the contact points by about as much."""


@pytest.fixture(scope="module")
def misplaced():
    """On a shorter path with larger steps, factors kept."""
    seal = sm.door_seal(
        depth=7.0, n_steps=40, start=10.03, newton=sm.NewtonOptions(tolerance=1e-11),
        door_shift=0.31, door_angle=1.03,
    )  # fmt: skip
    return sm.analyze(seal, keep_factors=True)


@pytest.mark.parametrize("name", STEPS)
def test_derivatives_in_the_place_of_the_door(misplaced, name):
    found = slopes(misplaced, partial(perturbed, misplaced, name), STEPS[name])
    check(found, sm.differentiate(misplaced, (name,)), np.eye(26)[25])


def test_placed_everywhere_along_the_path():
    motion = staged_motion(
        [Stage(3, (0.0, -2.0), rates={"depth": (0.0, -1.0, 0.0)}), Stage(2, rotate=9.0)], (1.0, 4.0)
    ).with_placement(x="aside", angle="tilt")
    assert motion.names == ("depth", "aside", "tilt")
    moved = motion.moved({"aside": 0.5, "tilt": 2.0})
    for fraction in (0.0, 1.4, 3.0, 4.2, 5.0):
        change = moved.coordinates(fraction) - motion.coordinates(fraction)
        np.testing.assert_allclose(change, [0.5, 0.0, np.deg2rad(2.0)], atol=1e-15)
        np.testing.assert_allclose(motion.rates_at(fraction)[1], [1.0, 0.0, 0.0], atol=1e-15)


def test_a_shifted_flat_door_is_the_same_door():
    """Its flat has no end near the seal, so nothing but rounding changes."""
    at, aside = (
        sm.analyze(sm.door_seal(door="flat", depth=2.0, n_steps=10, door_shift=shift))
        for shift in (0.0, 5.0)
    )
    np.testing.assert_allclose(aside.reaction, at.reaction, rtol=0.0, atol=1e-8)


@pytest.mark.parametrize(("name", "value"), [("door_shift", 51.0), ("door_angle", np.nan)])
def test_places_out_of_bounds_are_refused_by_name(name, value):
    with pytest.raises(ValueError, match=name):
        sm.door_seal(**{name: value})
