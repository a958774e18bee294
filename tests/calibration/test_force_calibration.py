"""Constants of a seal come back from its force over time or travel, with their standard errors."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest
from PIL import Image
from relaxing_files import written
from seal_file.block_files import FIXED, LID
from seal_file.block_files import text as block

import seal_mdao as sm
from seal_mdao.cli.subcommands import main
from seal_mdao.force_calibration import FACTOR, calibrate_force
from seal_mdao.measures.reaction import Reaction

TIMES = tuple(np.geomspace(0.1, 20.5, 14).tolist())
FORCE = Reaction("lid", direction=(0.0, 1.0), times=TIMES, name="force")
TRUE = {"c10": 91.0, "g_1": 0.24, "tau_2": 60.0}


@pytest.fixture(scope="module")
def seal(tmp_path_factory):
    return sm.build_seal(written(tmp_path_factory.mktemp("block")))


def pressed(folder, stages, friction):
    """File and seal of an elastic block under a lid."""
    lid = re.sub(r"(?m)^stage = .*$", stages, LID)
    file = folder / "elastic.toml"
    text = block(FIXED, re.sub(r"(?m)^friction = .*$", f"friction = {friction}", lid))
    file.write_text(text, encoding="utf-8")
    return file, sm.build_seal(file)


@pytest.fixture(scope="module")
def exact(seal):
    return sm.analyze(seal, parameters=TRUE).value(FORCE)


def test_constants_come_back(seal, exact):
    """The sum of squares ends by quadratic steps: relative errors are those of the forces."""
    told = []
    found = calibrate_force(seal, FORCE, exact, TRUE, lambda count, rms: told.append((count, rms)))
    assert found.converged
    np.testing.assert_allclose(found.values, list(TRUE.values()), rtol=1e-6)
    np.testing.assert_allclose(found.start, [seal.scalars[name].value for name in TRUE])
    np.testing.assert_allclose(found.after, exact, rtol=1e-8)
    assert np.all(found.standard_errors < 1e-5 * found.values)
    assert [count for count, _ in told] == list(range(1, found.analyses + 1))
    assert told[0][1] == pytest.approx(
        np.sqrt(np.mean((found.before - exact) ** 2)) / found.largest, rel=1e-12
    )


def test_standard_errors_are_those_of_repeated_tests(seal):
    """The scatter of what 30 tests with noise of 1 % find: within three of its standard deviations."""
    names = "c10", "tau_2"
    exact, found = sm.analyze(seal).value(FORCE), []
    for seed in range(30):
        noise = 0.01 * exact.max() * np.random.default_rng(seed).normal(size=exact.size)
        found.append(calibrate_force(seal, FORCE, exact + noise, names))
    scatter = np.std([own.values for own in found], axis=0, ddof=1)
    errors = np.sqrt(np.mean([own.standard_errors**2 for own in found], axis=0))
    np.testing.assert_allclose(scatter, errors, rtol=3.0 / np.sqrt(2 * 29))


def test_what_the_readings_do_not_tell(seal, exact):
    """In plane strain I1 = I2 where the volume is kept: c10 and c01 are hardly told apart."""
    noise = 0.01 * exact.max() * np.random.default_rng(1).normal(size=exact.size)
    found = calibrate_force(seal, FORCE, exact + noise, ("c10", "c01"))
    assert found.correlation[0, 1] < -0.99
    assert found.standard_errors[0] > 0.5 * found.values[0]


def test_friction_that_never_slips_is_undetermined(tmp_path):
    """All readings are of points in stick: no force depends on friction."""
    _, seal = pressed(tmp_path, "stage = [{ translate = [0, -0.1], steps = 4 }]", friction=2.0)
    force = Reaction("lid", (0.02, 0.04, 0.06, 0.08, 0.1), (1,), name="force")
    exact = sm.analyze(seal, parameters={"c10": 90.0}).value(force)
    found = calibrate_force(seal, force, exact, ("c10", "lid_friction"))
    assert np.isinf(found.standard_errors).tolist() == [False, True]
    assert found.values[0] == pytest.approx(90.0, rel=1e-6)


def test_trials_that_the_seal_refuses_are_shortened(seal):
    """The force grows without limit as g_1 + g_2 = 1 is approached, and steps go beyond."""
    wanted, refused = sm.analyze(seal, parameters={"g_1": 0.78}).value(FORCE), []

    def progress(_, rms):
        refused.append(not np.isfinite(rms))

    found = calibrate_force(seal, FORCE, wanted, ("g_1",), progress)
    assert any(refused)
    assert found.values[0] == pytest.approx(0.78, rel=1e-6)


def test_parameters_at_their_bounds_are_named(seal, exact):
    found = calibrate_force(seal, FORCE, 100.0 * exact, ("c10",))
    assert found.at_bounds == ("c10",)
    assert found.values[0] == pytest.approx(80.0 * FACTOR, rel=1e-5)


@pytest.mark.parametrize(
    ("measured", "names", "said"),
    [
        (np.ones(3), ("c10",), "must be 14 finite numbers"),
        (np.zeros(14), ("c10",), "not all zero"),
        (np.full(14, np.nan), ("c10",), "must be 14 finite numbers"),
        (np.ones(14), ("c11",), "no parameter 'c11'; its parameters are c10"),
        (np.ones(14), ("c10", "c10"), "none twice; got c10, c10"),
        (np.ones(14), (), "at least one name, and none twice; got none"),
        (np.ones(14), ("expansion",), "expansion starts at zero"),
    ],
)
def test_what_cannot_be_calibrated(seal, measured, names, said):
    with pytest.raises(ValueError, match=said):
        calibrate_force(seal, FORCE, measured, names)


def test_as_many_readings_as_parameters_are_refused(seal):
    few = replace(FORCE, times=TIMES[:2])
    with pytest.raises(ValueError, match="2 readings are too few for 2 parameters"):
        calibrate_force(seal, few, np.ones(2), ("c10", "g_1"))


# ---- the command ----


def data(folder, head, rows):
    path = folder / "force.csv"
    lines = [",".join(map(repr, row)) for row in np.asarray(rows, float).tolist()]
    path.write_text("\n".join([head, *lines]) + "\n", encoding="utf-8")
    return path


def test_the_command_over_time(tmp_path, exact, capsys):
    path = data(tmp_path, "time_s,force_N_per_m", np.column_stack([TIMES, exact]))
    given = ["calibrate", str(written(tmp_path)), str(path), "--find", "c10", "g_1", "tau_2"]
    assert main([*given, "--out", str(tmp_path)]) == 0
    said = capsys.readouterr().out
    assert "14 readings" in said
    assert "WARNING" not in said
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    found = {name: own["value"] for name, own in summary["parameters"].items()}
    assert found == pytest.approx(TRUE, rel=1e-6)
    assert summary["parameters"]["tau_2"]["unit"] == "s"
    table = np.genfromtxt(tmp_path / "readings.csv", delimiter=",", names=True)
    np.testing.assert_allclose(table["calibrated_N_per_m"], exact, rtol=1e-8)
    with Image.open(tmp_path / "calibration.png") as picture:
        assert len(np.unique(np.asarray(picture.convert("L")))) > 50


def test_the_command_over_the_travel_of_closing_and_opening(tmp_path):
    """The travel increases on the way back too, from which friction comes, and the force is positive."""
    ways = "stage = [{ translate = [0, -0.5], steps = 6 }, { translate = [0, 0.4], steps = 6 }]"
    file, seal = pressed(tmp_path, ways, friction=0.3)
    true = {"c10": 95.0, "lid_friction": 0.2}
    travels = np.linspace(0.1, 0.85, 12)
    force = Reaction("lid", tuple(travels.tolist()), (1,), name="force")
    exact = sm.analyze(seal, parameters=true).value(force)
    assert exact.min() > 0.0
    path = data(tmp_path, "travel_mm,force_N_per_m", np.column_stack([travels, exact]))
    out = ["--out", str(tmp_path), "--quiet"]
    assert main(["calibrate", str(file), str(path), "--find", "c10", "friction", *out]) == 0
    summary = json.loads((tmp_path / "summary.json").read_text(encoding="utf-8"))
    found = {name: own["value"] for name, own in summary["parameters"].items()}
    assert found == pytest.approx(true, rel=1e-5)


@pytest.mark.parametrize(
    ("head", "rows", "given", "said"),
    [
        ("time_s,force_N", [[1, 2]], (), "there is no column 'force_N_per_m'"),
        (
            "time_s,force_N_per_m",
            [[1, 2], [60, 2]],
            (),
            "time = 60 s is beyond the end of the analysis at 20.5 s",
        ),
        (
            # the gap of 0.02 mm at the start is part of the travel
            "travel_mm,force_N_per_m",
            [[1, 2]],
            (),
            "a travel of 1 mm, but lid moves only 0.5 mm from its start",
        ),
        ("time_s,force_N_per_m", [[1, 2], [1, 3]], (), "line 3, column time_s: 1 is not above 1"),
        ("time_s,force_N_per_m", [[0, 2]], (), "line 2, column time_s: 0 must be above 0"),
        (
            "time_s,force_N_per_m",
            [[1, np.inf]],
            (),
            "column force_N_per_m: the value is not finite",
        ),
        (
            "time_s,force_N_per_m",
            [[1, 2]],
            ("--profile", "wall"),
            "'wall' is not a moving profile",
        ),
        ("time_s,force_N_per_m", [[1, 2]], (), "1 readings are too few for 1 parameters"),
    ],
)
def test_wrong_use_is_one_line(head, rows, given, said, tmp_path, capsys):
    path = data(tmp_path, head, rows)
    command = ["calibrate", str(written(tmp_path)), str(path), "--find", "c10", *given]
    with pytest.raises(SystemExit) as ended:
        main([*command, "--out", str(tmp_path / "out")])
    assert ended.value.code == 2
    assert said in capsys.readouterr().err


def test_a_wrong_name_lists_the_parameters(tmp_path, capsys):
    path = data(tmp_path, "time_s,force_N_per_m", [[1, 2], [2, 3]])
    with pytest.raises(SystemExit) as ended:
        main(
            [
                "calibrate",
                str(written(tmp_path)),
                str(path),
                "--find",
                "frction",
                "--out",
                str(tmp_path),
            ]
        )
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert "no parameter 'frction' (did you mean 'friction'?)" in said
    assert "lid_friction" in said
