"""The short scripts run as they stand; the tests cut their optimisations after one iteration."""

import runpy
from functools import partial

import numpy as np
import pytest
from script_runs import SCRIPTS

import seal_mdao as sm


@pytest.fixture
def run_short(tmp_path, monkeypatch):
    """Run a script in a folder of its own; returns its problem and what it printed."""

    def run(name, capsys):
        monkeypatch.chdir(tmp_path)
        monkeypatch.setattr(sm, "UnoDriver", partial(sm.UnoDriver, maxiter=1))
        found = runpy.run_path(str(SCRIPTS / f"{name}.py"), run_name="__main__")
        return found, capsys.readouterr().out

    return run


@pytest.mark.parametrize("name", ["own_section", "several_load_cases"])
def test_they_are_short_and_take_no_arguments(name):
    text = (SCRIPTS / f"{name}.py").read_text(encoding="utf-8")
    assert len(text.splitlines()) <= 50
    assert "argparse" not in text
    assert "seal_mdao.cli" not in text


def test_own_section_gets_smaller(run_short, capsys):
    pytest.importorskip("netgen")
    found, said = run_short("own_section", capsys)
    prob, seal = found["prob"], found["seal"]
    result = sm.analyze(seal, prob.get_val("boundary_offsets"))
    assert prob.get_val("area")[0] == pytest.approx(result.area, rel=1e-9)
    assert prob.get_val("area")[0] < 0.995 * seal.area(np.zeros(seal.n_offsets))[0]
    assert f"force on the lid {prob.get_val('reaction')[0]:.0f} N/m" in said


def test_several_load_cases_are_analysed_and_improved(run_short, capsys):
    found, said = run_short("several_load_cases", capsys)
    prob, start = found["prob"], found["start"]
    forces = prob.get_val("reaction_scenarios")
    assert forces.shape == (3, 2)
    assert prob.get_val("reaction_highest")[1] == pytest.approx(forces[:, 1].max(), rel=1e-6)
    assert prob.get_val("gap_square_sum_mean")[0] < start.gap_square_sum
    assert said.count("friction 0.") == 3
