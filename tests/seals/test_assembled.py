"""Parameters of assembled seals."""

from dataclasses import replace

import numpy as np
import pytest
from pressed_block import pressed_block

import seal_mdao as sm


@pytest.fixture(scope="module")
def seal():
    return pressed_block()


@pytest.mark.parametrize("name", ["depth", "modulus", "roll_a", "roll_friction"])
def test_a_changed_parameter_is_known_and_makes_another_seal(seal, name):
    """Those of a motion too, which count from its waypoints."""
    value = seal.scalars[name].value + 0.01
    moved = seal.with_parameters({name: value})
    assert moved.scalars[name].value == value
    assert moved.key != seal.key
    assert moved.with_parameters({name: value}).key == moved.key
    assert moved.with_parameters({name: seal.scalars[name].value}).key == seal.key


def test_a_kept_analysis_is_not_taken_for_another_motion(seal):
    cache = sm.AnalysisCache()
    reaction = seal.measures(("reaction",))[0]
    shallow, deep = (cache.analyze(seal, parameters={"depth": depth}) for depth in (0.0, 0.05))
    assert cache.made == 2
    assert deep.value(reaction)[1] > 1.02 * shallow.value(reaction)[1]


def test_parameters_are_values_not_changes(seal):
    """Set twice, a parameter is what it was set to last."""
    twice = seal.with_parameters({"depth": 0.3}).with_parameters({"depth": 0.05})
    once = seal.with_parameters({"depth": 0.05})
    for one, other in zip(once.terms(), twice.terms(), strict=True):
        if one.label == "roll":
            assert np.array_equal(one.motion.positions, other.motion.positions)


def test_what_no_seal_can_be_is_refused(seal):
    with pytest.raises(ValueError, match="modulus of ArrudaBoyce must be a number above 0"):
        seal.with_parameters({"modulus": -1.0})
    with pytest.raises(ValueError, match="the seal has no parameter 'breadth'"):
        seal.with_parameters({"breadth": 1.0})


@pytest.mark.parametrize(
    ("name", "value"),
    [("n_steps", 0), ("n_steps", "many"), ("newton", "fast"), ("body", None),
     ("nominal_particles", "drawn"), ("nominal_particles", None),
     ("design_velocity", [[1.0], [1.0, 2.0]])],
)  # fmt: skip
def test_wrong_part_is_named(seal, name, value):
    with pytest.raises(ValueError, match=name):
        replace(seal, **{name: value})


@pytest.mark.parametrize(
    ("name", "value"), [("normal_penalty", 0.0), ("tangent_penalty", np.nan), ("friction", "dry")]
)
def test_wrong_number_of_a_contact_law_is_named(seal, name, value):
    with pytest.raises(ValueError, match=f"{name} of 'roll'|roll_{name} must be"):
        seal.with_parameters({f"roll_{name}": value}).terms()


def test_with_other_load_steps_it_is_the_same_seal(seal):
    """Places of the roll at the old ends of steps; its parameters are what they were."""
    ends = [1.0, 2.5, 5.0, 5.5, 8.0]
    other = seal.with_parameters({"depth": 0.05}).with_ends(ends)
    assert (other.n_steps, other.scalars) == (5, seal.with_parameters({"depth": 0.05}).scalars)
    one, two = (
        next(t.motion for t in own.terms() if t.label == "roll")
        for own in (seal.with_parameters({"depth": 0.05}), other)
    )
    for number, end in enumerate(ends, 1):
        np.testing.assert_allclose(two.coordinates(number), one.coordinates(end), atol=1e-14)
    result = sm.analyze(other)
    assert result.converged
    assert len(result.path.nominal_steps) == 5
    with pytest.raises(ValueError, match="the fractions of a motion at which load steps end"):
        seal.with_ends([4.0, 8.0])
