"""optimize_door_seal.py and `seal-mdao history`: the optimum's numbers, from the run and its record."""

import shutil

import numpy as np
import pytest
from script_runs import CHEAP

from seal_mdao.optimization import OPTIMIZERS

FIGURES = ("cost_history", "constraint_history", "designs")


def test_gap_closes_within_the_limits(optimised, assert_drawn):
    out, code, s = optimised
    assert code == 0
    assert s["success"] is True
    assert s["optimizer"] == next(iter(OPTIMIZERS))
    assert s["objective_ratio"] <= 0.0075
    assert s["max_constraint_violation"] <= 1e-3
    assert s["area_mm2"] <= 110.0 * (1 + 1e-3)
    assert 0 < s["iterations"] <= s["model_evaluations"]
    assert 0.3 < s["reaction_ratio"] < 1.2
    offsets = np.array(s["boundary_offsets"])
    assert offsets.shape == (25,)
    assert np.abs(offsets).max() <= 0.5 + 1e-9
    assert 3.5 <= s["door_radius"] <= 4.5
    history = s["history"]
    assert history[0]["objective_ratio"] == 1.0
    assert history[0]["max_constraint_violation"] == pytest.approx(0.25, abs=0.02)
    assert history[-1]["objective_ratio"] == s["objective_ratio"]
    # Uno takes gradients at some points that it does not accept, too
    assert s["iterations"] < len(history) <= s["model_evaluations"]
    assert (out / "cases.sql").stat().st_size > 0
    assert_drawn(out, *FIGURES)


def test_headline_has_the_largest_gap_anywhere(tmp_path, run_script, capsys):
    """At a depth of 8 mm the cost of Eq. (71) all but vanishes as the opening leaves its points."""
    arguments = ("--depth", 8, *CHEAP)
    code, s = run_script("optimize_door_seal", tmp_path / "sum", *arguments)
    said = capsys.readouterr().out
    gap = s["largest_gap_mm"]
    assert code == 0
    assert s["objective_ratio"] < 1e-3
    assert 0.1 * gap["start"] < gap["end"] < gap["start"]
    assert f"largest gap between the contacts {gap['start']:.4f} -> {gap['end']:.4f} mm" in said
    (text,) = s["warnings"]
    assert "lies outside of the points at which gap_square_sum is evaluated" in text
    assert f"WARNING (last design): {text}" in said
    page = (tmp_path / "sum" / "report.html").read_text(encoding="utf-8")
    assert "the gap region has moved away from these points" in page
    code, s = run_script("optimize_door_seal", tmp_path / "integral", *arguments, "--gap-integral")
    assert code == 0
    assert s["largest_gap_mm"]["end"] < 0.1 * gap["end"]
    assert s["warnings"] == []


def test_nothing_is_analysed_twice(counted_optimisation):
    """Not even the nominal seal, at which the optimiser starts, nor for the figures and the report."""
    (_, _, s), solved = counted_optimisation
    assert len(set(solved)) == len(solved) <= s["model_evaluations"]


def test_history_is_read_back_from_the_recorder_file(optimised, tmp_path, run_script, assert_drawn):
    out, _, expected = optimised
    cases = shutil.copy(out / "cases.sql", tmp_path / "elsewhere.sql")
    code, s = run_script("history", tmp_path / "figures", cases)
    assert code == 0
    for key in ("history", "boundary_offsets", "door_radius", "area_mm2", "reaction_ratio"):
        assert s[key] == expected[key]
    assert_drawn(tmp_path / "figures", *FIGURES)


@pytest.mark.long
def test_run_that_stops_early_is_written_as_far_as_it_went(tmp_path, run_script, assert_drawn):
    arguments = ("--max-iterations", 1, "--keep-force", *CHEAP)
    code, s = run_script("optimize_door_seal", tmp_path, *arguments)
    assert code == 1
    assert s["success"] is False
    assert s["iterations"] == 1
    assert len(s["history"]) == 2
    assert s["keep_force"] is True
    assert_drawn(tmp_path, *FIGURES)


@pytest.mark.parametrize(
    ("script", "arguments"),
    [
        ("optimize_door_seal", ("--optimizer", "guess")),
        ("optimize_door_seal", ("--depth", "2", "--n-steps", "5")),  # nothing opens
        ("history", ("nowhere.sql",)),
        ("history", (__file__,)),
    ],
)
def test_wrong_arguments_end_with_two(script, arguments, tmp_path, run_script):
    with pytest.raises(SystemExit) as ended:
        run_script(script, tmp_path, *arguments)
    assert ended.value.code == 2
