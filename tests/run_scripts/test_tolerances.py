"""seal-mdao study and robust: what they write, and continuing where they were stopped."""

import json
import re
import sqlite3
from contextlib import closing

import numpy as np
import pytest
from coarse_seal import written

import seal_mdao as sm
from seal_mdao.cli import robust as robust_command
from seal_mdao.cli.study import statistics_text
from seal_mdao.drivers.optimizer_driver import INTERRUPTED

QUICK = ("--n-steps", 21, "--depth", 8.0, "--workers", 0)
FRICTION = '[vary.friction]\ndistribution = "uniform"\nlow = 0.2\nhigh = 0.3\n'


@pytest.fixture(scope="module")
def studied(run_script, tmp_path_factory):
    out = tmp_path_factory.mktemp("studied")
    return out, *run_script("study", out, "--samples", 8, *QUICK)


def test_study_of_the_door_seal(studied, assert_drawn):
    out, code, s = studied
    assert code == 0
    assert (s["samples"], s["failed"]) == (8, 0)
    assert_drawn(out, "distributions", "correlations")
    for name in ("gap_square_integral", "reaction[1]", "patch_pressure[0]", "stress_norm"):
        found = s["measures"][name]
        assert found["sampled"]["lowest"] < found["sampled"]["mean"] < found["sampled"]["highest"]
        assert found["first_order"]["std_from_gradient"] > 0.0
        assert sum(found["share_of_first_order_variance"].values()) == pytest.approx(1.0)
        own, line = found["sampled"]["q50"], found["first_order"]["q50"]
        assert found["difference"]["q50"] == pytest.approx(line - own)
        assert all(abs(value) <= 1.0 for value in found["rank_correlation"].values())
    # stress is proportional to the constants: their share is the largest
    shares = s["measures"]["stress_norm"]["share_of_first_order_variance"]
    assert max(shares, key=shares.get) == "hardness"


def test_a_second_start_continues_the_study(studied, run_script, capsys):
    out, _, s = studied
    code, again = run_script("study", out, "--samples", 8, *QUICK)
    assert code == 0
    assert again["measures"] == s["measures"]
    assert "8 of 8 samples are already in" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        run_script("study", out, "--samples", 9, *QUICK)
    assert "another number of samples; continue with the same" in capsys.readouterr().err


def test_a_seal_file_without_tolerances(run_script, tmp_path, capsys):
    file = written(tmp_path)
    for command in ("study", "robust"):
        assert run_script(command, tmp_path / "out", file) == (2, None)
        said = capsys.readouterr().err
        assert "[tolerance] is missing" in said
        assert "--tolerances FILE.toml" in said


def test_tolerances_in_the_seal_file_are_those_of_a_file_of_their_own(run_script, tmp_path):
    """One file is enough; the samples are the same to the last bit."""
    pytest.importorskip("netgen")
    own = tmp_path / "tolerances.toml"
    own.write_text(FRICTION.replace("friction", "door_y").replace("0.2", "-0.1"))
    two, one = written(tmp_path), tmp_path / "one.toml"
    one.write_text(two.read_text() + own.read_text().replace("[vary", "[tolerance.vary"))
    quick = ("--samples", 3, "--workers", 0)
    _, separate = run_script("study", tmp_path / "two", two, "--tolerances", own, *quick)
    code, together = run_script("study", tmp_path / "one", one, *quick)
    assert code == 0
    assert together["measures"] == separate["measures"]
    assert together["measures"]["reaction"]["sampled"]["std"] > 0.0


def test_options_of_the_door_seal_are_not_for_a_seal_file(run_script, tmp_path, capsys):
    file = written(tmp_path)
    for option, value in (("accuracy", "engineering"), ("rays", 116)):
        with pytest.raises(SystemExit):
            run_script("study", tmp_path / "out", file, f"--{option}", value)
        assert f"--{option} is an option of the built-in door seal" in capsys.readouterr().err


def test_study_of_a_seal_file_with_a_profile_that_is_displaced(run_script, tmp_path):
    pytest.importorskip("netgen")
    file, tolerances = written(tmp_path), tmp_path / "tolerances.toml"
    seal = sm.build_seal(sm.read_seal_file(file)).with_placements()
    placed = [name for name in seal.scalars if name.endswith("_x")]
    assert placed
    tolerances.write_text(
        FRICTION.replace("friction", placed[0]).replace("0.2", "-0.1").replace("0.3", "0.1")
    )
    code, s = run_script(
        "study", tmp_path / "out", file, "--tolerances", tolerances, "--samples", 3,
        "--workers", 0,
    )  # fmt: skip
    assert code == 0
    assert s["samples"] == 3


def test_no_sample_is_left_out_because_its_door_begins_inside(run_script, tmp_path):
    """A door that is drawn to touch, and displaced to both sides: half of the samples."""
    pytest.importorskip("netgen")
    file, tolerances = written(tmp_path, {"[0.0, 14.45]": "[0.0, 14.0]"}), tmp_path / "own.toml"
    tolerances.write_text(FRICTION.replace("friction", "door_y").replace("0.2", "-0.3"))
    code, s = run_script(
        "study", tmp_path / "out", file, "--tolerances", tolerances, "--samples", 8,
        "--workers", 0,
    )  # fmt: skip
    assert (code, s["failed"]) == (0, 0)
    force = s["measures"]["reaction"]
    assert force["rank_correlation"]["door_y"] == pytest.approx(-1.0)
    assert force["sampled"]["mean"] == pytest.approx(force["first_order"]["mean"], rel=0.1)


def test_failed_samples_are_reported_with_what_they_do(run_script, tmp_path, capsys):
    """A friction below zero cannot be analysed."""
    tolerances = tmp_path / "own.toml"
    tolerances.write_text(FRICTION.replace("0.2", "-0.1"))
    code, s = run_script(
        "study", tmp_path / "out", "--tolerances", tolerances, "--samples", 8, *QUICK
    )
    assert code == 1
    assert (s["failed"], s["share_failed"]) == (2, 0.25)
    printed = capsys.readouterr().out
    assert "2 of 8 samples (25.00%) failed and are excluded from these statistics" in printed
    with closing(sqlite3.connect(tmp_path / "out" / "samples.sqlite")) as samples:
        friction = np.array(samples.execute("SELECT friction FROM samples").fetchall())[:, 0]
    missed = friction[friction >= 0.0].mean() - friction.mean()
    assert missed > 0.03
    for name, found in s["measures"].items():
        # linear in friction: slope = std / (width / sqrt(12))
        slope = found["first_order"]["std_from_gradient"] / (0.4 / np.sqrt(12.0))
        change = found["effect_of_failures"]["mean"]
        assert abs(change) == pytest.approx(slope * missed, rel=1e-6)
        assert f"changes the mean of {name} by {change:+.3g}, its std by" in printed


def test_ctrl_c_in_the_optimisation_begins_no_samples(run_script, tmp_path, monkeypatch, capsys):
    """The same command continues later; a design half done is not sampled."""
    nominal = tmp_path / "nominal.json"
    nominal.write_text(json.dumps({"boundary_offsets": [0.0] * 25, "door_radius": 4.0}))
    ended = {"success": False, "message": f"{INTERRUPTED}the best point is kept"}
    monkeypatch.setattr(robust_command, "optimize", lambda problem: ended)
    monkeypatch.setattr(robust_command, "read_optimization", lambda cases: pytest.fail("continues"))
    quick = ("--nominal", nominal, "--scenarios", 3, "--samples", 6, *QUICK)
    assert run_script("robust", tmp_path / "out", *quick) == (130, None)
    assert "interrupted" in capsys.readouterr().err


@pytest.fixture(scope="module")
def robust(run_script, tmp_path_factory):
    out = tmp_path_factory.mktemp("robust")
    nominal = out / "nominal.json"
    nominal.write_text(json.dumps({"boundary_offsets": [0.0] * 25, "door_radius": 4.0}))
    arguments = ("--nominal", nominal, "--scenarios", 3, "--samples", 6, *QUICK)
    code, s = run_script("robust", out, "--max-iterations", 2, *arguments)
    return out, code, s, arguments


@pytest.mark.long
def test_robust_optimum_on_fresh_samples(robust, assert_drawn):
    """Two iterations leave the gap of the nominal seal, which stands for the nominal optimum here,
    smaller on all cars."""
    out, code, s, _ = robust
    assert code == 1
    nominal, best = (s["compared"][f"{name} optimum"] for name in ("nominal", "robust"))
    assert nominal["samples"] == best["samples"] == 6
    ratio = best["gap_square_integral"]["q95"] / nominal["gap_square_integral"]["q95"]
    assert s["ratio_of_95_percent_gaps"] == pytest.approx(ratio)
    assert ratio < 1.0
    assert 0.0 <= best["share_in_reaction_band"] <= 1.0
    assert np.shape(s["boundary_offsets"]) == (25,)
    assert_drawn(out, "comparison")


@pytest.mark.long
def test_the_report_has_the_table_and_the_figure(robust):
    out, _, s, _ = robust
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "On 6 new samples of all tolerances" in page
    assert page.count("data:image/png;base64,") == 1
    row = re.search(r"95 % of the samples are below</th><td>(.*?)</td>", page)[1]
    own = s["compared"]["nominal optimum"]["gap_square_integral"]["q95"]
    assert row.startswith(f"{own:.3g}"[:4])
    shapes = json.loads(re.search(r'id="report-data">(.*?)</script>', page, re.DOTALL)[1])["shapes"]
    assert shapes is not None


@pytest.mark.long
def test_robust_run_goes_on(robust, run_script, capsys):
    out, _, s, arguments = robust
    cases = out / "cases.sql"
    arguments = ("--restart", cases, *arguments)
    code, again = run_script("robust", out, "--max-iterations", 2, *arguments)
    assert code == 1
    assert again["reused_evaluations"] > 0
    assert again["compared"] == s["compared"]
    assert again["boundary_offsets"] == s["boundary_offsets"]
    with pytest.raises(SystemExit):
        run_script("robust", out, "--band", 0.2, *arguments)
    assert "recorded in the optimisation of another problem" in capsys.readouterr().err
    # the same folder: continued without --restart
    code, again = run_script("robust", out, "--max-iterations", 2, *arguments[2:])
    assert "continuing" in capsys.readouterr().out
    assert again["compared"] == s["compared"]


def test_a_measure_that_nothing_varies_is_printed_as_such():
    spread = {"mean": 63.659, "std": 2.2e-14, "q05": 63.659, "q95": 63.659, "lowest": 63.659}
    found = {"unit": "mm**2", "sampled": spread, "first_order": spread, "infinite_samples": 0}
    assert statistics_text(found) == "63.66 mm**2 in all samples"
    assert statistics_text({**found, "unit": None}) == "63.66 in all samples"
    varied = {**found, "unit": None, "sampled": spread | {"std": 0.5}}
    assert statistics_text(varied).startswith("mean 63.66, std 0.5, 5 to 95 % 63.66 to 63.66")
    some = statistics_text({**varied, "infinite_samples": 3})
    assert some.startswith("infinite in 3 samples (no contact): mean 63.66, std 0.5")
    nowhere = {**found, "sampled": spread | {"lowest": np.inf}, "infinite_samples": 9}
    assert statistics_text(nowhere) == "infinite in all samples (no contact)"
