"""Numbers of scenarios as parameters of a seal, and their derivatives."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.distributions import KINDS
from seal_mdao.scenarios.variation import Scenarios, Variation

DESIGN = {"c10": 80.0, "c01": 20.0, "friction": 0.25, "door_radius": 4.0}
VARIATIONS = (
    Variation("friction"), Variation("hardness", "factor", ("c10", "c01")),
    Variation("door_radius", "shift"), Variation("age", "factor", ("c10",)),
)  # fmt: skip
NUMBERS = np.array([[0.3, 1.1, 0.2, 0.9], [0.1, 0.8, -0.1, 1.2]])


def test_values_are_replaced_shifted_and_multiplied_in_order():
    scenarios = Scenarios(VARIATIONS, NUMBERS)
    found = scenarios.values(0, DESIGN)
    assert found["friction"] == 0.3
    assert found["c10"] == 80.0 * 1.1 * 0.9
    assert found["c01"] == 20.0 * 1.1
    assert found["door_radius"] == 4.2
    assert DESIGN["friction"] == 0.25
    assert scenarios.parameters == ("friction", "c10", "c01", "door_radius")


@pytest.mark.parametrize("number", [0, 1])
def test_rates_are_derivatives_of_the_values(number):
    """Linear in every number by itself: central differences are exact to rounding."""
    scenarios = Scenarios(VARIATIONS, NUMBERS)
    by_design, by_number = scenarios.rates(number, DESIGN)
    for row, name in enumerate(DESIGN):
        ends = [scenarios.values(number, DESIGN | {name: DESIGN[name] + h}) for h in (0.5, -0.5)]
        assert by_design[row] == pytest.approx(ends[0][name] - ends[1][name], rel=1e-12, abs=0.0)
        for column in range(4):
            steps = 0.5 * np.eye(4)[column]
            ends = [Scenarios(VARIATIONS, NUMBERS + h).values(number, DESIGN)
                    for h in (steps, -steps)]  # fmt: skip
            slope = ends[0][name] - ends[1][name]
            assert by_number[row, column] == pytest.approx(slope, rel=1e-12, abs=0.0)


def test_scenarios_are_described_by_their_numbers():
    scenarios = Scenarios(VARIATIONS, NUMBERS)
    text = "friction = 0.1, hardness * 0.8, door_radius - 0.1, age * 1.2"
    assert scenarios.described(1) == f"scenario 2 of 2 ({text})"
    no_numbers = np.zeros((2, 0))
    assert Scenarios((), no_numbers).described(0) == "scenario 1 of 2"
    text = "scenario 1 of 2 (boundary offsets of its own)"
    assert Scenarios((), no_numbers, np.ones((2, 25))).described(0) == text


def test_table_of_the_numbers():
    scenarios = Scenarios(VARIATIONS, NUMBERS, np.array([[0.1, -0.4], [0.0, 0.2]]))
    seal = sm.door_seal()
    assert scenarios.table(seal) == {
        "columns": [
            "friction", "hardness (factor)", "door_radius (shift, mm)", "age (factor)",
            "largest boundary offset (mm)",
        ],
        "rows": [[*NUMBERS[0], 0.4], [*NUMBERS[1], 0.2]],
    }  # fmt: skip
    assert Scenarios(VARIATIONS[:1], NUMBERS[:, :1]).table(seal) == {
        "columns": ["friction"], "rows": [[0.3], [0.1]],
    }  # fmt: skip


def test_offsets_are_added_to_those_of_the_design():
    extra = np.arange(50.0).reshape(2, 25) / 100
    scenarios = Scenarios((), np.zeros((2, 0)), extra)
    np.testing.assert_array_equal(scenarios.boundary(1, np.ones(25)), 1.0 + extra[1])
    assert Scenarios(VARIATIONS, NUMBERS).boundary(0, np.ones(3)).tolist() == [1.0] * 3


@pytest.mark.parametrize(
    ("arguments", "match"),
    [
        (
            ((Variation("a"), Variation("a")), np.ones((1, 2))),
            "must have different names, got a, a",
        ),
        (((Variation("a"),), np.ones((2, 2))), r"shape \(S, 1\) .* got \(2, 2\)"),
        (((Variation("a"),), np.ones((0, 1))), "at least one scenario"),
        (((Variation("a"),), [[np.nan]]), "finite"),
        (((Variation("a"),), [[1.0]], np.ones((2, 25))), r"shape \(1, P\)"),
        (((Variation("a"),), [["x"]]), "real numbers"),
    ],
)
def test_what_does_not_fit_is_refused(arguments, match):
    with pytest.raises(ValueError, match=match):
        Scenarios(*arguments)


def test_a_kind_is_one_of_three():
    with pytest.raises(ValueError, match="kind of 'friction'"):
        Variation("friction", "percent")
    assert {Variation("friction", kind).kind for kind in KINDS} == set(KINDS)


def test_a_seal_without_the_parameter_or_with_other_offsets_is_refused():
    with pytest.raises(ValueError, match="unknown parameter 'frixion'"):
        Scenarios((Variation("frixion"),), [[0.3]]).check(sm.door_seal())
    with pytest.raises(ValueError, match="no effect on door_shift, which is zero"):
        Scenarios((Variation("door_shift", "factor"),), [[1.1]]).check(sm.door_seal())
    with pytest.raises(ValueError, match=r"shape \(1, 25\), got \(1, 3\)"):
        Scenarios((), np.zeros((1, 0)), np.zeros((1, 3))).check(sm.door_seal())
