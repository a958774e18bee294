"""analyze_door_seal.py: numbers of its summary, figures, wrong arguments."""

import json
import subprocess
import sys

import numpy as np
import pytest
from script_runs import CHEAP, SCRIPTS

from seal_mdao.analysis.newton import NewtonOptions

FIGURES = ("deformed_shapes", "reaction", "gap_profile")


def test_drawn_seal_as_a_user_runs_it(tmp_path, assert_drawn):
    command = [sys.executable, SCRIPTS / "analyze_door_seal.py", "--out", tmp_path]
    ended = subprocess.run(command, capture_output=True, text=True, check=True)
    # no progress bar, for this is no terminal; kernels may have to be compiled
    assert all("compiling" in line for line in ended.stderr.splitlines())
    assert 3 <= len(ended.stdout.splitlines()) <= 8
    s = json.loads((tmp_path / "summary.json").read_text())
    assert s["converged"] is True
    assert (s["n_particles"], s["n_steps"], s["step_cuts"]) == (174, 105, 0)
    assert len(s["newton_iterations"]) == 105
    assert 230 < sum(s["newton_iterations"]) < 280
    assert s["area_mm2"] == pytest.approx(108.971, abs=1e-3)
    reaction = np.array(s["reaction_N_per_m"])
    assert reaction.shape == (105, 3)
    assert reaction[-1, 0] == pytest.approx(10.0, abs=1e-12)
    assert np.all(reaction[reaction[:, 0] < 0.0, 1:] == 0.0)
    assert reaction[-1, 2] == pytest.approx(56.4, rel=0.02)
    assert s["n_open_points"] == 7
    assert s["max_gap_mm"] == pytest.approx(0.12, abs=0.01)
    assert s["gap_square_sum_mm2"] == pytest.approx(0.052, rel=0.05)
    assert 0.0 < s["max_penetration_mm"] < 5e-3
    assert len(s["von_mises_kPa"]) == 7
    assert s["von_mises_kPa"] == sorted(s["von_mises_kPa"], reverse=True)
    assert s["n_stick"] + s["n_slip"] == s["n_contact"]
    assert s["wall_s"] > 0.0
    assert_drawn(tmp_path, *FIGURES)


def test_flat_door_keeps_the_symmetry(tmp_path, run_script, assert_drawn):
    code, s = run_script("analyze_door_seal", tmp_path, "--flat-door", *CHEAP)
    assert code == 0
    reaction = np.array(s["reaction_N_per_m"])
    assert np.abs(reaction[:, 1]).max() < 1e-6 * reaction[-1, 2]
    assert_drawn(tmp_path, *FIGURES)


def test_accuracy_decides_what_no_option_says(tmp_path, run_script, assert_drawn):
    """Four layers and 20 steps; the contact is between particles."""
    code, s = run_script("analyze_door_seal", tmp_path, "--accuracy", "engineering")
    assert code == 0
    assert (s["n_particles"], s["n_steps"]) == (4 * 58, 20)
    # 57.4 N/m is what refinement in all directions converges to
    assert np.array(s["reaction_N_per_m"])[-1, 2] == pytest.approx(57.4, rel=5e-3)
    assert s["max_gap_mm"] == pytest.approx(0.1196, abs=0.001)
    assert_drawn(tmp_path, *FIGURES)
    one = tmp_path / "one"
    code, s = run_script(
        "analyze_door_seal", one, "--accuracy", "engineering", "--layers", 5, "--depth", 1
    )
    assert code == 0
    assert (s["n_particles"], s["n_steps"]) == (5 * 58, 20)


def test_options_reach_the_model(tmp_path, run_script):
    arguments = (
        "--depth",
        2,
        "--n-steps",
        5,
        "--friction",
        0.4,
        "--friction-history",
        "incremental",
    )
    more = ("--corner-x", 4, "--segments", 32, "--door-radius", 4.2)
    code, s = run_script("analyze_door_seal", tmp_path, *arguments, *more)
    assert code == 0
    assert s["n_steps"] == 5
    assert s["reaction_N_per_m"][-1][0] == pytest.approx(2.0, abs=1e-12)
    assert s["n_open_points"] == 0
    assert s["max_gap_mm"] == 0.0


def test_path_that_is_not_completed_is_written_as_far_as_it_went(
    tmp_path, run_script, assert_drawn, monkeypatch
):
    """Without friction, and without the damped motion that leads to where the seal has swayed."""
    # dataclass defaults: tolerance, iterations, cuts, damped iterations, branch
    monkeypatch.setattr(NewtonOptions.__init__, "__defaults__", (1e-10, 15, 8, 0, "stable"))
    code, s = run_script("analyze_door_seal", tmp_path, "--friction", 0, *CHEAP)
    assert code == 1
    assert s["converged"] is False
    assert 0 < s["n_steps"] < 21
    assert len(s["reaction_N_per_m"]) == len(s["newton_iterations"]) == s["n_steps"]
    assert s["gap_square_sum_mm2"] is None
    assert_drawn(tmp_path, *FIGURES)


def test_design_of_an_optimisation(tmp_path, run_script, optimised):
    out, _, expected = optimised
    design = ("--design", out / "summary.json")
    code, s = run_script("analyze_door_seal", tmp_path, *design, *CHEAP)
    assert code == 0
    assert s["area_mm2"] == pytest.approx(expected["area_mm2"], rel=1e-12)
    assert s["von_mises_kPa"] == pytest.approx(expected["von_mises_kPa"], rel=1e-12)


@pytest.mark.parametrize(
    "arguments",
    [
        ("--friction", "-1"),
        ("--rays", "60"),
        ("--door", "round"),
        ("--support", "0.4"),
        ("--door-radius", "-1"),
        ("--design", "nowhere.json"),
        ("--out", "/dev/null/folder"),
        ("--n-steps", "many"),
    ],
)
def test_wrong_arguments_end_with_two_and_one_line(arguments, tmp_path, run_script, capsys):
    with pytest.raises(SystemExit) as ended:
        run_script("analyze_door_seal", tmp_path, *CHEAP, *arguments)
    assert ended.value.code == 2
    (message,) = capsys.readouterr().err.splitlines()
    assert "error:" in message
