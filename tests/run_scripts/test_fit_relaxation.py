"""seal-mdao fit of relaxation tests: its files, its table, one line for wrong files and options."""

import csv
import tomllib

import numpy as np
import pytest

from seal_mdao.seals.file.viscoelastic_table import ViscoelasticTable

TIME = np.geomspace(0.5, 1e4, 40)
G, TAU = np.array([0.2, 0.1]), np.array([5.0, 600.0])
HEAD = "time_s,stress_kPa,temperature_degC\n"


def force(time):
    return 400.0 * (1.0 - (1.0 - np.exp(-time[:, None] / TAU)) @ G)


def rows_at(degrees, energy=80.0):
    """Readings at one temperature, with Arrhenius' shift from 23 degrees."""
    away = 1.0 / (degrees + 273.15) - 1.0 / 296.15
    a = np.exp(energy / 8.31446261815324e-3 * away)
    pairs = zip(TIME.tolist(), force(TIME / a).tolist(), strict=True)
    return "".join(f"{t!r},{f!r},{degrees}\n" for t, f in pairs)


@pytest.fixture
def fit_text(run_script, tmp_path):
    """Run the command on a text; returns exit code, summary and folder."""

    def run(text, *arguments):
        path = tmp_path / "relaxation.csv"
        path.write_text(text, encoding="utf-8")
        code, summary = run_script("fit", tmp_path / "out", path, *arguments)
        return code, summary, tmp_path / "out"

    return run


def test_several_temperatures(fit_text, assert_drawn, capsys):
    text = HEAD + "".join(map(rows_at, (0, 23, 60)))
    code, summary, out = fit_text(text, "--name", "skin", "--moduli", "instantaneous")
    assert code == 0
    assert summary["g"] == pytest.approx(G.tolist(), rel=1e-6)
    assert summary["tau_s"] == pytest.approx(TAU.tolist(), rel=1e-6)
    assert summary["long_term_fraction"] == pytest.approx(0.7, rel=1e-7)
    assert summary["readings"] == {"0 °C": 40, "23 °C": 40, "60 °C": 40}
    assert summary["reference_degC"] == 23.0
    expected = {"activation_energy": pytest.approx(80.0, rel=1e-6), "reference": 23.0}
    assert summary["shift"] == {"arrhenius": expected}
    assert summary["log10_factors"]["23"] == {"value": 0.0, "standard_error": 0.0}
    assert {"g_1", "ln_tau_2", "activation_energy"} <= summary["standard_errors"].keys()
    assert [own["terms"] for own in summary["terms_tried"]] == [0, 1, 2, 3, 4]
    text = (out / "viscoelastic.toml").read_text()
    table = tomllib.loads(text)["material"]["skin"]["viscoelastic"]
    assert table["g"] == pytest.approx(G.tolist(), rel=1e-6)
    assert table["moduli"] == "instantaneous"
    assert table["arrhenius"] == expected
    # a seal file takes it as it is
    series = ViscoelasticTable(**table).made()
    assert series.g == tuple(table["g"])
    assert series.shift.activation_energy == pytest.approx(80.0, rel=1e-6)
    said = capsys.readouterr().out
    assert text in said  # ready to be copied
    assert "arrhenius: activation_energy 80" in said
    assert_drawn(out, "fit")
    with (out / "residuals.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 120
    # a reading at 60 degrees is one of a longer time at 23 degrees
    hot = next(row for row in rows if row["curve"] == "60 °C")
    assert float(hot["reduced_time_s"]) > 10.0 * float(hot["time_s"])
    for row in rows:
        difference = float(row["computed"]) - float(row["measured"])
        assert float(row["difference"]) == pytest.approx(difference, abs=1e-15)


def test_a_power_law_determines_the_shift_where_forces_are_shared(fit_text, capsys):
    """80 kJ/mol of readings with scatter, in curves of one specimen; a warning without its name."""
    rng, rows = np.random.default_rng(3), []
    for degrees in (23, 50, 80):
        away = 1.0 / (degrees + 273.15) - 1.0 / 296.15
        reduced = TIME / np.exp(80.0 / 8.31446261815324e-3 * away)
        ratio = (1.0 + reduced) ** -0.027 * (1.0 + 2e-3 * rng.normal(size=40))
        pairs = zip(TIME.tolist(), ratio.tolist(), strict=True)
        rows += [f"{t!r},{f!r},{degrees},one" for t, f in pairs]
    head = "time_s,ratio,temperature_degC"
    _, summary, _ = fit_text("\n".join([f"{head},test", *rows]), "--shift", "arrhenius")
    energy = summary["shift"]["arrhenius"]["activation_energy"]
    assert energy == pytest.approx(80.0, rel=0.05)
    assert "the curve of every temperature has its own force scale" not in capsys.readouterr().out
    unnamed = [row.removesuffix(",one") for row in rows]
    fit_text("\n".join([head, *unnamed]), "--shift", "arrhenius")
    assert (
        "WARNING: the curve of every temperature has its own force scale" in capsys.readouterr().out
    )


def test_one_temperature_with_given_times_and_a_ramp(fit_text, assert_drawn, capsys):
    """The ramp shifts the readings: times count from its start."""
    rows = "0,0\n" + "".join(
        f"{t!r},{f!r}\n" for t, f in zip((TIME + 1.0).tolist(), force(TIME).tolist(), strict=True)
    )
    arguments = ("--ramp", "1", "--tau", "5", "600", "--terms", "3")
    with pytest.raises(SystemExit):
        fit_text("time_s,force_N\n" + rows, *arguments)
    assert "exclude each other; give one of them" in capsys.readouterr().err
    code, summary, out = fit_text("time_s,force_N\n" + rows, *arguments[:-2])
    assert code == 0
    assert summary["unused_readings"] == 1
    assert summary["ramp_s"] == 1.0
    # parts that have relaxed to phi = (1 - exp(-z))/z, z = 1 s/tau, at the end of the ramp
    parts = G / (-np.expm1(-1.0 / TAU) * TAU)
    assert summary["g"] == pytest.approx((parts / (0.7 + parts.sum())).tolist(), rel=1e-9)
    said = capsys.readouterr().out
    assert "1 readings before the end of the loading ramp are left out" in said
    assert "5 s  given" in said
    assert "reference" not in (out / "viscoelastic.toml").read_text()
    assert_drawn(out, "fit")


def test_a_wrong_shift_function_is_reported(fit_text, capsys):
    """One curve of five was taken at another temperature than its label says."""
    text = HEAD + "".join(map(rows_at, (0, 23, 40, 60)))
    text += rows_at(50).replace(",50\n", ",80\n")
    code, summary, _ = fit_text(text, "--shift", "arrhenius")
    assert code == 0
    assert summary["rms_of_largest_force"] > 10.0 * summary["rms_without_shift_function"]
    assert (
        "the law arrhenius does not describe the shift of the relaxation times"
        in capsys.readouterr().out
    )


BAD = {
    "word": (HEAD + "1,much,23\n", "line 2, column stress_kPa: 'much' is not a number"),
    "NaN": (HEAD + "1,nan,23\n", "line 2, column stress_kPa: nan"),
    "too few": ("time_s,ratio\n1,1\n2,0.9\n", "2 different times are too few"),
    "rises": ("time_s,ratio\n1,0.5\n2,0.6\n3,0.7\n4,0.8\n", "the test shows no stress relaxation"),
    "no force": ("time_s,stretch\n1,1.5\n", "there is no column 'stress_kPa' or 'force_N' or 'ratio'"),
}  # fmt: skip


@pytest.mark.parametrize(("text", "expected"), BAD.values(), ids=BAD)
def test_bad_file_gets_one_line(fit_text, text, expected, capsys):
    code, summary, _ = fit_text(text)
    assert code == 2
    assert summary is None
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line
    assert "relaxation.csv" in line


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--law", "yeoh"), "--law is for tests of stress over stretch (column stretch), but "),
        (("--bulk-modulus", "8e4"), "--bulk-modulus is for tests of stress over stretch"),
        (("--shift", "wlf"), "shift wlf can be fitted only to tests at 3 or more temperatures, "),
        (
            ("--reference", "40"),
            "the reference temperature of a relaxation fit must be one of the tested temperatures "
            "(23), got 40",
        ),
        (("--ramp", "-1"), "ramp must be a number of at least 0"),
        (("--tau", "-5"), "tau must be 1 to 12 positive numbers"),
        (("--terms", "13"), "terms must be an integer of at least 1 and at most 12"),
        (("--name", "a b"), "got 'a b'"),
        (("--moduli", "initial"), "invalid choice: 'initial'"),
    ],
)
def test_wrong_arguments(fit_text, arguments, expected, capsys):
    with pytest.raises(SystemExit) as ended:
        fit_text(HEAD + rows_at(23), *arguments)
    assert ended.value.code == 2
    assert expected in capsys.readouterr().err.splitlines()[-1]
