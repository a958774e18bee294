"""The Python code of the pages runs as it stands."""

import re

import numpy as np
import pytest


@pytest.fixture
def run_page(docs, tmp_path, monkeypatch):
    """Run the Python blocks of a page, each by itself; returns their names."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("OPENMDAO_REPORTS", "0")

    def run(page):
        text = (docs / page).read_text(encoding="utf-8")
        found = []
        for code in re.findall(r"```python\n(.*?)```", text, re.DOTALL):
            found.append({})
            exec(compile(code, page, "exec"), found[-1])
        return found

    return run


def test_quick_start(run_page, capsys):
    """The optimisation closes the gap within its limits; the models are as described."""
    script, others = run_page("quickstart.md")
    problem, start = script["prob"], script["start"]
    ratio = problem.get_val("gap_square_sum")[0] / start.gap_square_sum
    assert ratio < 0.0075
    assert np.all(problem.get_val("von_mises") <= 1.01 * (0.8 * start.von_mises).clip(100.0))
    assert problem.get_val("area")[0] <= 110.0
    printed = re.search(r"squared gaps: (\S+) % of its start", capsys.readouterr().out)
    assert float(printed[1]) == pytest.approx(100 * ratio, rel=0.06)
    assert others["flat"].door == "flat"
    assert others["fine"].drawn_particles.shape == (116 * 5, 2)
    assert others["paper"].segments == 32


def test_analysis_without_openmdao(run_page, capsys):
    (names,) = run_page("reference/api.md")
    square, by_friction = map(float, capsys.readouterr().out.split())
    assert square == names["result"].gap_square_sum
    assert names["rates"].parameters[-1] == "friction"
    assert by_friction == names["rates"].gap_square_sum[-1] < 0.0


def test_fit_of_a_rubber(run_page, capsys):
    (names,) = run_page("material_tests.md")
    found, printed = names["found"], capsys.readouterr().out
    assert f"{found.errors['uniaxial'].rms_kPa}" in printed
    assert printed.count("stable from") == 3


def test_extensions(run_page, docs, capsys):
    """The page shows the tested files; alone and in OpenMDAO they give the same derivatives."""
    text = (docs / "extend.md").read_text(encoding="utf-8")
    shown = [docs / path for path in re.findall(r"{literalinclude} (\S+)", text)]
    assert {path.stem for path in shown} == {
        "arruda_boyce", "elastic_foundation", "ellipse", "highest_point", "pressed_block",
    }  # fmt: skip
    assert all(path.is_file() for path in shown)
    alone, openmdao = run_page("extend.md")
    slopes = dict(zip(alone["rates"].parameters, alone["rates"].highest_point[0], strict=True))
    assert len(capsys.readouterr().out.splitlines()) == len(slopes)
    totals = openmdao["totals"]
    size = max(abs(slope) for slope in slopes.values())
    assert abs(totals["highest_point", "roll_a"][0, 0] - slopes["roll_a"]) <= 1e-9 * size
