"""Load-deflection curves as targets and bands of an optimisation."""

import numpy as np
import pytest
from seal_file import coarse_bulb

import seal_mdao as sm
from seal_mdao.cli.subcommands import main
from seal_mdao.file_optimization import file_task, force_targets, problem_settings
from seal_mdao.measures.load_deflection import LoadDeflectionError
from seal_mdao.measures.reaction import Reaction
from seal_mdao.optimization import RunOptions

BULB = coarse_bulb.BULB.read_text(encoding="utf-8")
SMALL = coarse_bulb.COARSE | {
    "steps = 60": "steps = 6", "parameters = 12": "parameters = 4",
    'type = "contact_width"\nprofile = "door"': 'type = "reaction"\nname = "curve"\ntravel = [0.8, 1.1]',
}  # fmt: skip
TARGET = """[[measure]]
type = "load_deflection_error"
name = "fit"
travel = [0.6, 0.8, 1.1]
value = [2.0, 5.0, 9.0]
weight = [1.0, 0.5, 2.0]
[optimize]
minimize = "fit"
[[optimize.constraint]]
measure = "curve"
lower = [0.5, 4.0]
upper = [3.0, 20.0]
"""


def written(folder, target=TARGET):
    text = coarse_bulb.changed(BULB[: BULB.index("[optimize]")], SMALL)
    path = folder / "seal.toml"
    path.write_text(text + target, encoding="utf-8")
    return path


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    """The file, and its seal analysed at offsets."""
    pytest.importorskip("netgen")
    file = sm.read_seal_file(written(tmp_path_factory.mktemp("target")))
    seal = sm.build_seal(file)
    offsets = np.random.default_rng(1).uniform(-0.05, 0.05, seal.n_offsets)
    return file, seal, offsets, sm.analyze(seal, offsets, keep_factors=True)


def test_the_value_is_the_weighted_sum_of_relative_differences(pressed):
    *_, result = pressed
    force = result.value(Reaction("door", (0.6, 0.8, 1.1), (1,)))
    expected = np.array([1.0, 0.5, 2.0]) @ (force / [2.0, 5.0, 9.0] - 1.0) ** 2
    assert result.value(result.measure("fit"))[0] == pytest.approx(expected, rel=1e-13)


def test_direct_and_adjoint_agree_and_are_the_quotients(pressed):
    _, seal, offsets, result = pressed
    direct, adjoint = (sm.differentiate(result, method=m)["fit"] for m in ("direct", "adjoint"))
    size = np.abs(direct).max()
    np.testing.assert_allclose(direct, adjoint, rtol=0.0, atol=1e-9 * size)
    # fourth-order quotients of two steps along one direction
    way = np.random.default_rng(2).uniform(-1.0, 1.0, seal.n_offsets)
    exact, errors = (direct[..., : seal.n_offsets] @ way).item(), []
    for step in (1e-4, 5e-5):
        sides = [
            sm.analyze(seal, offsets + k * step * way).value(result.measure("fit"))[0]
            for k in (-2, -1, 1, 2)
        ]
        quotient = np.array([1.0, -8.0, 8.0, -1.0]) @ sides / (12.0 * step)
        errors.append(abs(quotient / exact - 1.0))
    assert max(errors) < 1e-6


def test_bands_are_limits_of_every_value_with_a_scale_each(pressed):
    file, seal, _, _ = pressed
    (limit,) = file_task(file, RunOptions().analyze(seal)).limits
    np.testing.assert_array_equal(limit.lower, [0.5, 4.0])
    np.testing.assert_array_equal(limit.upper, [3.0, 20.0])
    np.testing.assert_array_equal(limit.ref, [3.0, 20.0])
    fit, band = force_targets(file, seal)
    np.testing.assert_array_equal(fit.target, [2.0, 5.0, 9.0])
    np.testing.assert_array_equal(band.lower, [0.5, 4.0])


def test_curves_of_the_figure_go_through_the_values(pressed):
    *_, result = pressed
    curve = Reaction("door", (0.7, 0.9, 1.1), direction="travel", length=50.0)
    assert np.interp(curve.travels, *curve.curve(result)) == pytest.approx(
        result.value(curve), rel=1e-9
    )


def test_a_curve_in_a_file_is_the_one_in_the_table(tmp_path):
    (tmp_path / "cld.csv").write_text("# target\nforce,travel_mm\n2,0.6\n5,0.8\n9,1.1\n")
    inside = "travel = [0.6, 0.8, 1.1]\nvalue = [2.0, 5.0, 9.0]\n"
    path = written(tmp_path, TARGET.replace(inside, 'data = "cld.csv"\n'))
    file = sm.read_seal_file(path)
    own = next(m for m in file.measures if m.name == "fit")
    assert own.measure(None) == LoadDeflectionError(
        Reaction("door", (0.6, 0.8, 1.1), (1,)), (2.0, 5.0, 9.0), (1.0, 0.5, 2.0)
    )
    # a changed curve is another problem, which is not continued
    before = problem_settings(file)
    (tmp_path / "cld.csv").write_text("force,travel_mm\n2,0.6\n5,0.8\n8,1.1\n")
    assert problem_settings(file) != before


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "value = [2.0, 5.0, 9.0]\n", "",
            r"\[\[measure\]\] 2: the target curve is missing",
        ),
        ("[2.0, 5.0, 9.0]", "[2.0, 5.0]", "value has 2 numbers, but travel has 3"),
        ("[2.0, 5.0, 9.0]", "[2.0, 0.0, 9.0]", "value contains a target force of 0"),
        ("[1.0, 0.5, 2.0]", "[1.0, 0.5]", "weight has 2 numbers, but travel has 3"),
        ("[1.0, 0.5, 2.0]", "[0.0, 0.0, 0.0]", "all weights of the target forces are zero; at least"),
        ("[1.0, 0.5, 2.0]", "[1.0, -0.5, 2.0]", "weight = .*numbers of at least 0"),
        ("0.8, 1.1]", "0.8, 3.1]", "travel = 3.1, but the total travel of the profile 'door' is "
        "only 1.6"),
        ("weight =", 'data = "cld.csv"\nweight =', "the target curve is given twice, by data and by"),
        ("upper = [3.0, 20.0]", "upper = [3.0, 20.0, 1.0]", "2 numbers, but the upper limits"),
        ("upper = [3.0, 20.0]", "upper = [3.0, 2.0]", "the lower limit lower = 4 is above the "
        "upper limit upper = 2"),
        (
            'measure = "curve"', 'measure = "fit"',
            r"constraint\]\] 1: lower has 2 numbers, but the measure 'fit' has 1 value$",
        ),
    ],
)  # fmt: skip
def test_what_is_wrong_is_told_before_any_analysis(tmp_path, old, new, message):
    assert old in TARGET
    with pytest.raises(sm.SealFileError, match=message):
        sm.read_seal_file(written(tmp_path, TARGET.replace(old, new)))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (None, "cld.csv: cannot be read: No such file"),
        ("travel,force\n1,2\n", "the first line of a target curve must name the columns"),
        ("travel_mm,force\n", "0 readings"),
        ("travel_mm,force\n1;2\n", "line 2: the line of a target curve must have two numbers"),
        ("travel_mm,force\n1,nan\n", "line 2: the line of a target curve must have two numbers"),
        ("travel_mm,force\n1,1_0\n", "line 2: the line of a target curve must have two numbers"),
    ],
)
def test_wrong_files_of_targets_are_refused(tmp_path, content, message):
    if content is not None:
        (tmp_path / "cld.csv").write_text(content)
    inside = "travel = [0.6, 0.8, 1.1]\nvalue = [2.0, 5.0, 9.0]\nweight = [1.0, 0.5, 2.0]\n"
    with pytest.raises(sm.SealFileError, match=message):
        sm.read_seal_file(written(tmp_path, TARGET.replace(inside, 'data = "cld.csv"\n')))


def test_the_optimum_has_its_targets_in_figure_report_and_file(tmp_path):
    for library in ("netgen", "ezdxf", "meshio", "tomli_w"):
        pytest.importorskip(library)
    (tmp_path / "cld.csv").write_text("travel_mm,force\n0.6,2\n0.8,5\n1.1,9\n")
    inside = "travel = [0.6, 0.8, 1.1]\nvalue = [2.0, 5.0, 9.0]\nweight = [1.0, 0.5, 2.0]\n"
    path, out = written(tmp_path, TARGET.replace(inside, 'data = "cld.csv"\n')), tmp_path / "out"
    main(["optimize", str(path), "--max-iterations", "3", "--out", str(out), "--quiet"])
    assert (out / "force_targets.png").is_file()
    assert '<h2 id="targets-title">' in (out / "report.html").read_text(encoding="utf-8")
    best = sm.read_seal_file(out / "optimum.toml")
    assert [m.value for m in best.measures if m.name == "fit"] == [(2.0, 5.0, 9.0)]
