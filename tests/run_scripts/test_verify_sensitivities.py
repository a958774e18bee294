"""verify_sensitivities.py: agreement of finite differences and analytic values, and its figures."""

import csv

import numpy as np
import pytest
from script_runs import CHEAP
from verification.estimates import fitted, plateau

FEW_STEPS = ("--steps", "1e-4", "3e-5", "1e-5", "--repeats", "1")
N_MEASURES = 18


@pytest.mark.long
def test_random_design(tmp_path, run_script, assert_drawn):
    chosen = ("--seed", 1, "--amplitude", 0.1, "--parameters", 20, 25)
    code, s = run_script("verify_sensitivities", tmp_path, *CHEAP, *FEW_STEPS, *chosen)
    assert code == 0
    assert len(s["table"]) == s["n_entries"] == 2 * N_MEASURES
    assert s["worst_relative_error"] < 1e-4
    assert s["worst_relative_error_gap_square_sum"] < 1e-6
    judged = [row for row in s["table"] if row["same_contact_sequence"]]
    assert len(judged) == s["n_entries_same_contact_sequence"] > 0
    for row in judged:
        if row["analytic"]:
            assert row["ratio_percent"] == pytest.approx(100 * row["fd"] / row["analytic"])
    area = {row["parameter"]: row for row in s["table"] if row["measure"] == "area"}
    assert area["door_radius"]["analytic"] == area["door_radius"]["fd"] == 0.0
    assert 0.0 < s["sensitivity_over_analysis_time"] < 2.0
    assert_drawn(tmp_path, "sensitivity_errors", "step_study")
    with (tmp_path / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["fd"]) for row in rows] == [row["fd"] for row in s["table"]]


@pytest.mark.long
def test_parameter_that_moves_the_first_touch_is_verified_from_one_side(tmp_path, run_script):
    arguments = ("--parameters", 5, *CHEAP, *FEW_STEPS)
    code, s = run_script("verify_sensitivities", tmp_path, *arguments)
    assert code == 0
    assert s["n_one_sided_parameters"] == 1
    assert {row["scheme"] for row in s["table"]} == {"backward"}
    assert all(row["same_contact_sequence"] for row in s["table"])
    assert s["worst_relative_error"] < 1e-4


def test_estimates_of_known_derivatives():
    rng = np.random.default_rng(3)
    noise = np.array([1e-13])

    def function(x):  # second derivative jumps at zero, as stresses at the nominal seal do
        return np.exp(x) + 4.0 * x * abs(x) + noise[0] * rng.standard_normal()

    steps = np.array([1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6])
    quotient = np.array([[(function(h) - function(-h)) / (2 * h)] for h in steps])
    estimate = plateau(quotient, steps, noise / np.sqrt(2))
    assert abs(quotient[2, 0] - 1.0) > 1e-4
    assert abs(estimate.value[0] - 1.0) < 3e-8
    assert abs(estimate.value[0] - 1.0) < 10 * estimate.uncertainty[0]
    changes = np.linspace(0.0, -1e-5, 40)
    values = np.array([[function(x)] for x in changes])
    line = fitted(changes, values, noise)
    assert abs(line.value[0] - 1.0) < 5 * line.uncertainty[0] < 1e-6
