"""The Python code of the pages runs as it stands."""

import re
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from cord_files import cord
from openmdao.utils.assert_utils import assert_check_totals

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of

PYTHON = re.compile(r"```python\n(.*?)```", re.DOTALL)
RUN = {
    "accuracy_at_a_glance.md",
    "start_openmdao.md",
    "reference/api.md",
    "extend.md",
    "guide_report.md",
    "howto/cluster.md",
    "material_tests.md",
    "openmdao.md",
    "tolerances.md",
}
"""Pages with Python blocks, each of which a test below runs."""


def test_no_page_has_code_that_is_not_run(docs, pages):
    found = {
        path.relative_to(docs).as_posix() for path, text in pages.items() if PYTHON.search(text)
    }
    assert found == RUN


@pytest.fixture
def run_page(docs, tmp_path, monkeypatch):
    """Run the Python blocks of a page, each by itself or one after the other; returns their names."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_REPORTS", "0")

    def run(page, together=False):
        text = (docs / page).read_text(encoding="utf-8")
        found = []
        for code in PYTHON.findall(text):
            found.append(found[-1] if together and found else {})
            exec(compile(code, page, "exec"), found[-1])
        return found

    return run


def test_quick_start(run_page, capsys):
    """The optimisation closes the gap within its limits; the models are as described."""
    script, others = run_page("start_openmdao.md")
    problem, start = script["prob"], script["start"]
    ratio = problem.get_val("gap_square_sum")[0] / start.gap_square_sum
    assert ratio < 0.0075
    assert np.all(problem.get_val("von_mises") <= 1.01 * (0.8 * start.von_mises).clip(100.0))
    assert problem.get_val("area")[0] <= 110.0
    printed = re.search(r"squared gaps: (\S+) % of its start", capsys.readouterr().out)
    assert float(printed[1]) == pytest.approx(100 * ratio, rel=0.06)
    assert options_of(others["flat"]).door == "flat"
    assert others["fine"].nominal_particles.shape == (116 * 5, 2)
    assert options_of(others["paper"]).segments == 32


def test_analysis_without_openmdao(run_page, capsys):
    (names,) = run_page("reference/api.md")
    square, by_friction = map(float, capsys.readouterr().out.split())
    assert square == names["result"].gap_square_sum
    assert names["rates"].parameters[-1] == "friction"
    assert by_friction == names["rates"].gap_square_sum[-1] < 0.0


def test_error_bars(run_page, tmp_path):
    cord(tmp_path).rename(tmp_path / "seal.toml")
    (names,) = run_page("accuracy_at_a_glance.md")
    found = names["estimates"]["reaction"]
    assert found.bar >= abs(found.particles) > 0.0


def test_fit_of_a_rubber(run_page, capsys):
    names, relaxing, cyclic = run_page("material_tests.md")
    found, printed = names["found"], capsys.readouterr().out
    assert f"{found.errors['uniaxial'].rms_kPa}" in printed
    assert printed.count("stable from") == 3
    # a power law: 2 % of ln t, 4.5 % a decade
    relaxation = relaxing["relaxation"]
    assert str(relaxation.tau) in printed
    assert relaxation.fall_at_end == pytest.approx(1.0 - 10.0**-0.02, rel=0.1)
    # one amplitude; stresses of r = 2, m = 30 kPa and c10 = 200 kPa, rounded to 1 kPa
    soft = cyclic["soft"]
    assert str(soft.softening) in printed
    expected = {"softening_r": 2.0, "softening_m": 30.0, "softening_beta": 0.0}
    assert soft.softening.constants == pytest.approx(expected, rel=0.02)
    assert soft.law.c10 == pytest.approx(200.0, rel=0.01)


def test_scenarios_in_a_model(run_page, capsys):
    (names,) = run_page("tolerances.md")
    values = names["prob"].get_val("gap_square_integral_scenarios")
    assert values.shape == (4, 1)
    assert f"{names['prob'].get_val('gap_square_integral_mean')}" in capsys.readouterr().out
    assert names["prob"].get_val("gap_square_integral_mean")[0] == pytest.approx(values.mean())


def test_extensions(run_page, docs, tmp_path, capsys):
    """The page shows the tested files; alone and in OpenMDAO they give the same derivatives, and a seal
    file names them."""
    shutil.copy(docs.parent / "tests" / "extension" / "block.toml", tmp_path)
    text = (docs / "extend.md").read_text(encoding="utf-8")
    shown = [docs / path for path in re.findall(r"{literalinclude} (\S+)", text)]
    assert {path.stem for path in shown} == {
        "arruda_boyce", "block", "directional", "elastic_foundation", "ellipse", "highest_point",
        "pressed_block", "pressure_dependent",
    }  # fmt: skip
    assert all(path.is_file() for path in shown)
    named, alone, openmdao = run_page("extend.md")
    slopes = dict(zip(alone["rates"].parameters, alone["rates"].highest_point[0], strict=True))
    assert len(capsys.readouterr().out.splitlines()) == len(slopes) + len(named["rates"].parameters)
    assert abs(named["rates"].reaction[0, -2]) > 0.1  # roll_reference
    totals = openmdao["totals"]
    size = max(abs(slope) for slope in slopes.values())
    assert abs(totals["highest_point", "roll_a"][0, 0] - slopes["roll_a"]) <= 1e-9 * size


@pytest.mark.filterwarnings("ignore:.*'door' (already exists|is already active)")
def test_report_and_restart(run_page, tmp_path):
    """The page's own file is continued where its first run ended."""
    names, _ = run_page("guide_report.md", together=True)
    first, again = names["prob"].driver, names["again"].driver
    assert first.result.iter_count == 2
    assert again.reused_evaluations >= 2  # all but the start, which is analysed again
    assert again.result.iter_count == 4
    assert not (tmp_path / "cases.sql").exists()


@pytest.mark.long
@pytest.mark.filterwarnings("ignore:.*Inefficient choice of derivative mode")
def test_own_openmdao_model(run_page):
    names = run_page("openmdao.md", together=True)[-1]
    for comp in names["checked"].values():
        for block in comp.values():
            worst = np.abs(block["J_fwd"] - block["J_fd"]).max()
            assert worst <= 1e-5 * max(1e-3, np.abs(block["J_fd"]).max())
    checks = names["totals_in_metres"] | names["totals_in_mm"]
    assert set(checks) == {("cost", "bulge"), ("cost", "wave"), ("cost", "door_radius")}
    assert_check_totals(checks, atol=0.0, rtol=1e-4)
    # what the model has is what the numerics give for the same design
    seal, prob = names["seal"], names["prob"]
    offsets = 1e3 * prob.get_val("waves.offsets", units="m")
    result = sm.analyze(seal, offsets, {"door_radius": 0.16 * 25.4})
    assert prob.get_val("seal.gap_square_sum")[0] == pytest.approx(result.gap_square_sum, rel=1e-9)
    cost = 50 * result.area / 100 + 2 * result.reaction[-1, 1] / 1000
    assert prob.get_val("cost")[0] == pytest.approx(cost, rel=1e-12)
    slopes = names["by_mode"]
    for other in ("rev", "auto"):
        np.testing.assert_allclose(slopes[other], slopes["fwd"], rtol=1e-9)
    exact = sm.differentiate(sm.analyze(seal, offsets)).reaction[:, : seal.n_offsets]
    count = options_of(seal).splines.outer_parameters
    bulge = 1e3 * exact[:, :count] @ np.sin(np.linspace(0.0, np.pi, count))
    by_complex_step = names["by_complex_step"]["reaction", "bulge"][:, 0]
    np.testing.assert_allclose(by_complex_step, bulge, rtol=1e-9, atol=1e-9 * np.abs(bulge).max())
    sharp, blunt = (sm.analyze(seal, None, {"door_radius": r}) for r in (3.5, 4.5))
    assert names["twin"].get_val("gaps")[0] == pytest.approx(
        sharp.gap_square_sum + blunt.gap_square_sum, rel=1e-9
    )
    assert names["coloring"].total_solves() == 1
    assert [case.name[-1] for case in names["good"]] == ["0", "2"]
    best = min(case["gap_square_sum"].item() for case in names["good"])
    assert names["doe"].get_val("gap_square_sum").item() == names["best"]["gap_square_sum"] == best
    lower, slope = names["lower"], names["of_position"]["reaction", "plate_y"].item()
    force = sm.analyze(names["bulb"]).reaction[-1, 1]
    assert lower.get_val("reaction")[0] > force
    assert slope < 0.0
    assert all(Path(name).stat().st_size > 10_000 for name in ("section.png", "force.png"))
    # a thicker wall has more rubber and a larger force; a hole that moves has nearly the same rubber
    of_hole, bulb = names["of_hole"], names["bulb"]
    thicker, lift = (of_hole["area", name][0, 0] for name in ("thicker", "lift"))
    assert abs(lift) < 0.1 * thicker
    assert of_hole["reaction", "thicker"][0, 0] > 0.0
    offsets = names["hole"].get_val("shape.offsets", units="mm")
    assert names["hole"].get_val("area")[0] == pytest.approx(bulb.area(offsets)[0], rel=1e-12)
    forces = names["forces"][:, 0]
    assert forces.shape == (2,)
    assert forces[1] > forces[0]  # the plate comes 0.2 mm nearer
    assert forces.max() <= names["highest"][0] < 1.01 * forces.max()
    assert names["fit"].get_val("c10")[0] == pytest.approx(90.0, rel=1e-5)
    assert names["fit"].get_val("friction")[0] == pytest.approx(0.3, rel=1e-5)
    nominal = sm.differentiate(sm.analyze(seal), ("door_radius",)).gap_square_sum[-1]
    through = names["through"]["gap_square_sum", "door_radius"][0, 0]
    assert through == pytest.approx(nominal, rel=1e-9)


def test_results_of_a_process_pool(docs, tmp_path):
    """Processes import the script: it runs as a file, and prints the forces of three seals."""
    (code,) = PYTHON.findall((docs / "howto" / "cluster.md").read_text(encoding="utf-8"))
    (tmp_path / "pool.py").write_text(code, encoding="utf-8")
    done = subprocess.run(
        [sys.executable, "pool.py"], cwd=tmp_path, capture_output=True, text=True, check=True
    )
    forces = [np.fromstring(line.strip("[]"), sep=" ") for line in done.stdout.splitlines()]
    assert forces[1] == pytest.approx(sm.analyze(sm.door_seal()).path.reaction("door")[-1])
    assert len({tuple(force) for force in forces}) == 3
