"""seal-mdao fit of cyclic tests: its files, its tables in a seal file, one line for wrong files."""

import csv

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.calibration.cycles import SoftenedLaw
from seal_mdao.calibration.data import ModeData
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.materials.yeoh import Yeoh
from seal_mdao.seals.file.softening_table import softening_of

LAW = SoftenedLaw(Yeoh(150.0, -8.0, 2.0), OgdenRoxburgh(1.8, 12.0, 0.15))
HEAD = "mode,stretch,stress_kPa\n"
BLOCK = """
[section]
material = "skin"
spacing = 1.5
outer = [
  { edge = "base", line = [[0, 0], [4, 0]] }, { edge = "right", line = [[4, 0], [4, 5]] },
  { edge = "top", line = [[4, 5], [0, 5]] }, { edge = "left", line = [[0, 5], [0, 0]] },
]
[[symmetry]]
edges = ["base"]
normal = "y"
[[symmetry]]
edges = ["left"]
normal = "x"
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{ translate = [0, 1] }]
"""


def cycles(*tops, scatter=0.0):
    """Rows of a uniaxial test that stretches to every one of ``tops`` and returns."""
    ends = [own for top in tops for own in ((1.0, top), (top, 1.0))]
    stretch = np.concatenate([np.linspace(*own, 10)[1:] for own in ends])
    stress = LAW.response(MODES["uniaxial"], ModeData(stretch, stretch, None, 1)).stress
    stress *= 1.0 + scatter * np.random.default_rng(4).normal(size=stress.size)
    pairs = zip(stretch.tolist(), stress.tolist(), strict=True)
    return HEAD + "".join(f"uniaxial,{s!r},{p!r}\n" for s, p in pairs)


@pytest.fixture
def fit_text(run_script, tmp_path):
    """Run the command on a text; returns exit code, summary and folder."""

    def run(text, *arguments):
        path = tmp_path / "cycles.csv"
        path.write_text(text, encoding="utf-8")
        code, summary = run_script("fit", tmp_path / "out", path, "--law", "yeoh", *arguments)
        return code, summary, tmp_path / "out"

    return run


def test_three_cycles(fit_text, assert_drawn, capsys):
    code, summary, out = fit_text(cycles(1.3, 1.6, 2.0, scatter=0.01), "--name", "skin")
    assert code == 0
    errors = summary["standard_errors"]
    assert list(errors) == ["c10", "c20", "c30", "softening_r", "softening_m", "softening_beta"]
    found = {"softening_" + name: own for name, own in summary["softening"].items()}
    found |= summary["constants"]
    for name, error in errors.items():
        assert abs(found[name] - LAW.constants[name]) < 3.0 * error
    assert summary["unloadings"] == {"uniaxial": 3}
    assert summary["readings"] == {"uniaxial": 51}
    assert 0.005 < summary["errors"]["all"]["rms_relative"] < 0.015
    # a seal file takes the tables as they are
    text = (out / "material.toml").read_text()
    path = out / "block.toml"
    path.write_text(text + BLOCK)
    file = sm.read_seal_file(path)
    sm.build_seal(file)
    law, softening = file.materials["skin"], softening_of(file, "skin")
    assert {**law.constants, **softening.constants} == pytest.approx(found, rel=1e-7)
    said = capsys.readouterr().out
    assert text in said  # ready to be copied
    assert "cyclic test (unloadings: 3 in uniaxial): softening is fitted, too" in said
    assert_drawn(out, "fit")
    with (out / "residuals.csv").open(newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    # in the order of the test: up to 1.3 and down again
    stretch = [float(row["stretch"]) for row in rows]
    assert stretch[8] == max(stretch[:17]) == 1.3
    away = [float(row["difference_kPa"]) for row in rows]
    assert np.sqrt(np.mean(np.square(away))) == pytest.approx(summary["errors"]["all"]["rms_kPa"])


def test_one_amplitude(fit_text, capsys):
    code, summary, out = fit_text(cycles(1.8, 1.8))
    assert code == 0
    assert summary["softening"]["beta"] == 0.0
    assert summary["softening"]["r"] == pytest.approx(1.8, rel=1e-6)
    text = (out / "material.toml").read_text()
    assert "# a single amplitude determines only m + beta W_max, so beta is set to 0\n" in text
    assert "beta = 0.0\n" in text


def test_other_modes_are_drawn_beside(fit_text, assert_drawn):
    stretch = np.linspace(1.1, 1.9, 9)
    stress = LAW.response(MODES["planar"], ModeData(stretch, stretch)).stress
    pairs = zip(stretch.tolist(), stress.tolist(), strict=True)
    rows = "".join(f"planar,{s!r},{p!r}\n" for s, p in pairs)
    code, summary, out = fit_text(cycles(1.4, 1.9) + rows, "--weighting", "absolute")
    assert code == 0
    assert summary["unloadings"] == {"uniaxial": 2, "planar": 0}
    assert summary["softening"]["beta"] == pytest.approx(0.15, rel=1e-6)
    assert_drawn(out, "fit")


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (("--stretches", "1.1", "1.5"), "cycles.csv: this is a cyclic test (unloadings: 3 in"),
        (
            ("--law", "hyperfoam", "--nu", "0.2"),
            "nearly incompressible laws only, not for hyperfoam",
        ),
    ],
)
def test_wrong_arguments(fit_text, arguments, expected, capsys):
    try:
        code, *_ = fit_text(cycles(1.3, 1.6, 2.0), *arguments)
    except SystemExit as ended:
        code = ended.code
    assert code == 2
    assert expected in capsys.readouterr().err.splitlines()[-1]


def test_unloading_without_softening(fit_text, capsys):
    """The stress of the way back is that of the loading."""
    rows = cycles(1.8).splitlines(keepends=True)
    code, summary, _ = fit_text("".join([*rows[:10], *rows[8:0:-1]]))
    assert (code, summary) == (2, None)
    (line,) = capsys.readouterr().err.splitlines()
    assert "cycles.csv: the constant r of the Mullins softening is not determined" in line


def test_a_seal_file_refuses_cycles_as_data(fit_text, tmp_path):
    """``data`` of a material fits a law without softening."""
    path = tmp_path / "block.toml"
    (tmp_path / "cycles.csv").write_text(cycles(1.3, 1.8))
    path.write_text('[material.skin]\nlaw = "yeoh"\ndata = "cycles.csv"\n' + BLOCK)
    with pytest.raises(ValueError, match=r"this is a cyclic test \(unloadings: 2 in uniaxial"):
        sm.build_seal(path)
