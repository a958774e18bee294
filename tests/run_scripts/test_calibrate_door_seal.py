"""calibrate_door_seal.py: constants and friction come back from the force."""

import numpy as np
import pytest


@pytest.fixture(scope="module")
def calibrated(run_script, tmp_path_factory):
    out = tmp_path_factory.mktemp("calibrated")
    arguments = ("--depth", 8, "--steps", 14, "--noise", 0.01)
    return out, *run_script("calibrate_door_seal", out, *arguments)


def test_constants_come_back(calibrated, assert_drawn):
    """Within three standard deviations of what the data tell; that is 1 % and less of c10."""
    out, code, summary = calibrated
    assert code == 0
    assert summary["optimum_found"] is True
    for entry in summary["constants"].values():
        assert abs(entry["found"] - entry["true"]) < 3.0 * entry["deviation"]
        assert abs(entry["start"] - entry["true"]) > 10.0 * entry["deviation"]
    assert summary["constants"]["c10"]["deviation"] < 0.01 * 92.0
    # chi squared of 27 readings less two constants: mean 0.93, standard deviation 0.26
    assert summary["misfit_per_reading"] == pytest.approx(0.93, abs=3 * 0.26)
    assert_drawn(out, "calibration")


def test_c10_and_c01_are_hardly_told_apart(calibrated):
    """In plane strain I1 = I2 where the volume is kept: J of their difference nearly vanishes."""
    *_, summary = calibrated
    alone, both = summary["constants"]["c10"]["deviation"], summary["with_c01"]["c10"]
    assert both > 50.0 * alone
    assert summary["singular_values_with_c01"][-1] < 1e-2 * summary["singular_values"][0]


def test_force_of_the_way_back_is_lower(calibrated):
    """Friction takes work: what comes back is less than what went in."""
    *_, summary = calibrated
    travel, _, force = np.array(summary["reading_mm_N_per_m"]).T
    top = int(np.argmax(travel)) + 1
    way_in = np.trapezoid(force[:top], travel[:top])
    way_out = -np.trapezoid(force[top - 1 :], travel[top - 1 :])
    assert 0.0 < way_in - way_out < 0.1 * way_in


def test_noise_must_be_positive(run_script, tmp_path, capsys):
    with pytest.raises(SystemExit) as ended:
        run_script("calibrate_door_seal", tmp_path, "--noise", 0)
    assert ended.value.code == 2
    assert "--noise: 0.0 is not a positive number" in capsys.readouterr().err


def test_gradient_of_the_force(calibrated):
    """Totals of every reading against central differences, closing and opening."""
    import calibrate_door_seal as script  # the fixture has put its folder on the path

    bench = script.Bench(6.0, 12)
    measured = np.zeros(bench.travel.size)
    prob = script.problem(bench, measured, 1.0)
    prob.run_model()
    names = (*script.UNKNOWNS, "c01")
    totals = prob.compute_totals(of=["force"], wrt=list(names))
    for name in names:
        value = prob.get_val(name)[0]
        step = 1e-4 * value
        ends = [bench.readings({**script.START, name: value + way * step}) for way in (1, -1)]
        quotient = (ends[0] - ends[1]) / (2 * step)
        exact = totals["force", name].ravel()
        # the square of the step, and rounding of forces of some 40 N/m over it
        rounding = 1e-12 * 40.0 / step
        assert np.abs(quotient - exact).max() <= 1e-5 * np.abs(exact).max() + rounding
