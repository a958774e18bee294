"""seal-mdao fit: its files, Treloar's data, one line for bad ones."""

import csv
import tomllib
from pathlib import Path

import numpy as np
import pytest

import seal_mdao
from seal_mdao.calibration.law_fit import fit
from seal_mdao.calibration.loading_modes import MODES, nominal_stress
from seal_mdao.calibration.treloar import treloar_tests
from seal_mdao.materials.yeoh import Yeoh

TRELOAR = Path(seal_mdao.__file__).parent / "calibration" / "treloar.csv"
HEAD = "mode,stretch,stress_kPa\n"


@pytest.fixture
def fit_script(run_script, tmp_path):
    """Run the script on a file or on a text; returns exit code, summary and folder."""

    def run(data, *arguments):
        if not isinstance(data, Path):
            path = tmp_path / "tests.csv"
            path.write_text(data)
            data = path
        code, summary = run_script("fit", tmp_path / "out", data, *arguments)
        return code, summary, tmp_path / "out"

    return run


def test_yeoh_on_treloars_data(fit_script, assert_drawn, capsys):
    code, summary, out = fit_script(TRELOAR, "--law", "yeoh")
    assert code == 0
    expected = fit("yeoh", treloar_tests())
    assert summary["constants"] == pytest.approx(expected.law.constants, rel=1e-12)
    assert summary["errors"]["uniaxial"]["r2"] > 0.99
    assert summary["errors"]["all"]["readings"] == 53
    assert summary["stable"] is True
    assert summary["stability"]["planar"]["to"] == pytest.approx(4.96**1.1, rel=1e-12)
    text = (out / "material.toml").read_text()
    table = tomllib.loads(text)["material"]["rubber"]
    assert table["law"] == "yeoh"
    assert table["c10"] == pytest.approx(expected.law.c10, rel=1e-7)
    assert text in capsys.readouterr().out  # ready to be copied
    assert_drawn(out, "fit")


@pytest.mark.parametrize("weighting", ["relative", "absolute"])
def test_a_reading_with_a_shifted_decimal_point_is_shown(fit_script, capsys, weighting):
    """One of thirty readings of a known rubber, with errors as the weighting supposes, is ten times too
    large."""
    law, rng = Yeoh(60.0, -1.0, 0.1), np.random.default_rng(2)
    stretch = np.linspace(1.05, 2.0, 30)
    stress = nominal_stress(law, MODES["uniaxial"], stretch)
    error = rng.normal(size=stretch.size)
    stress += 0.01 * stress * error if weighting == "relative" else error
    clean, wrong = stress.copy(), 17
    stress[wrong] *= 10.0

    def csv_of(values):
        rows = zip(stretch.tolist(), values.tolist(), strict=True)
        return HEAD + "\n".join(f"uniaxial,{x!r},{y!r}" for x, y in rows)

    arguments = ("--law", "yeoh", "--weighting", weighting, "--allow-unstable")
    code, summary, out = fit_script(csv_of(stress), *arguments)
    assert code == 0
    worst = max(summary["outliers"], key=lambda row: row["score"])
    assert worst["stretch"] == stretch[wrong]
    assert f"OUTLIER: uniaxial at stretch {stretch[wrong]:.4g}: " in capsys.readouterr().out
    with (out / "residuals.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 30
    assert [float(row["measured_kPa"]) for row in rows] == stress.tolist()
    assert [row["outlier"] for row in rows].count("True") == len(summary["outliers"])
    for row in rows:
        difference = float(row["computed_kPa"]) - float(row["measured_kPa"])
        assert float(row["difference_kPa"]) == difference
    code, summary, _ = fit_script(csv_of(clean), *arguments)
    assert (code, summary["outliers"]) == (0, [])
    assert "OUTLIER" not in capsys.readouterr().out


def test_foam_with_lateral_stretch(fit_script, assert_drawn):
    rows = ["mode,stretch,stress_kPa,lateral_stretch"]
    for stretch in (0.5, 0.6, 0.7, 0.8, 0.9, 1.1):
        # mu = 50, alpha = 4, nu = 0.25: b = 1/2, J = stretch^(1/2)
        stress = 2 * 50 / 4 * (stretch**4 - stretch**-1.0) / stretch
        rows.append(f"uniaxial,{stretch},{stress:.10g},{stretch**-0.25:.12g}")
    code, summary, out = fit_script("\n".join(rows), "--law", "hyperfoam", "--name", "sponge")
    assert code == 0
    expected = {"mu_1": 50.0, "alpha_1": 4.0, "nu_1": 0.25}
    assert summary["constants"] == pytest.approx(expected, rel=1e-6)
    read = tomllib.loads((out / "material.toml").read_text())["material"]["sponge"]
    assert read["nu"] == pytest.approx([0.25], rel=1e-6)
    assert_drawn(out, "fit")


STRONG_SOFTENING = HEAD + "".join(
    f"uniaxial,{s},{p}\n" for s, p in ((1.1, 55), (1.3, 110), (1.6, 100), (1.9, 60), (2.2, 10))
)
BAD = {
    "negative stretch": (
        HEAD + "uniaxial,-1.2,3\n",
        "line 2, column stretch: -1.2 is not positive",
    ),
    "NaN": (HEAD + "uniaxial,1.2,nan\n", "line 2, column stress_kPa: nan"),
    "unknown mode": (HEAD + "shear,1.2,3\n", "line 2, column mode: unknown mode 'shear'"),
    "empty": ("", "the file is empty"),
    "wrong type": (HEAD + "uniaxial,1.2,much\n", "column stress_kPa: 'much' is not a number"),
    "too few": (HEAD + "uniaxial,1.2,30\n", "1 readings are too few for the 3 constants of yeoh"),
    "unstable": (
        STRONG_SOFTENING,
        "yeoh with the best-fit constants describes a material that is not stable: uniaxial",
    ),
}


@pytest.mark.parametrize(("text", "expected"), BAD.values(), ids=BAD)
def test_bad_file_gets_one_line(fit_script, text, expected, capsys):
    code, summary, _ = fit_script(text, "--law", "yeoh")
    assert code == 2
    assert summary is None
    (line,) = capsys.readouterr().err.splitlines()
    assert expected in line


def test_unstable_constants_where_they_are_wanted(fit_script):
    code, summary, out = fit_script(STRONG_SOFTENING, "--law", "yeoh", "--allow-unstable")
    assert code == 0
    assert summary["stable"] is False
    assert "# NOT STABLE" in (out / "material.toml").read_text()


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--law", "rubber"), "invalid choice: 'rubber'"),
        ((), "--law is missing; name the law to fit, one of "),
        (("--law", "yeoh", "--tau", "1"), "--tau is for relaxation tests (column time_s), but "),
        (("--law", "yeoh", "--ramp", "1"), "--ramp is for relaxation tests (column time_s), but "),
        (("--law", "yeoh", "--terms", "2"), "--terms is for ogden and hyperfoam"),
        (("--law", "hyperfoam"), "only to tests with the column lateral_stretch"),
        (("--law", "yeoh", "--name", "a b"), "got 'a b'"),
        (("--law", "yeoh", "--stretches", "8", "9"), "no reading has a stretch between 8 and 9"),
    ],
)
def test_wrong_arguments(fit_script, arguments, expected, capsys):
    try:
        code, *_ = fit_script(TRELOAR, *arguments)
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    assert expected in capsys.readouterr().err.splitlines()[-1]


def test_stresses_in_another_unit_are_reported(fit_script, capsys):
    """In MPa instead of kPa the modulus is a thousand times too small for rubber."""
    stretch = np.linspace(1.1, 2.0, 10)
    stress = nominal_stress(Yeoh(300.0, 0.0, 0.0), MODES["uniaxial"], stretch) / 1000.0
    lines = [
        f"uniaxial,{x!r},{y!r}" for x, y in zip(stretch.tolist(), stress.tolist(), strict=True)
    ]
    code, summary, _ = fit_script(HEAD + "\n".join(lines), "--law", "neo_hookean")
    assert code == 0
    (warning,) = summary["warnings"]
    assert "an initial shear modulus of 0.6 kPa, smaller than that of rubber" in warning
    assert f"WARNING: {warning}" in capsys.readouterr().out
