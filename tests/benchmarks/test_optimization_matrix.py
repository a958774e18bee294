"""optimization_matrix.py: its cases, one small run, continuing after an interruption, its page."""

from functools import partial

import matrix_cases as cases
import matrix_page
import numpy as np
import optimization_matrix
import pytest

from seal_mdao.optimization import OPTIMIZERS
from seal_mdao.seals.door.door_seal import options_of

CHEAP = ("--n-steps", "21")


def test_single_changes_are_each_factor_alone():
    found = cases.single_changes()
    assert found[0] == cases.Case()
    assert found[0].name == "paper"
    assert len(found) == 1 + sum(len(values) - 1 for values in cases.FACTORS.values())
    assert all("," not in case.name for case in found)


def test_combinations_are_new_and_always_the_same():
    found = cases.combinations(20)
    assert found == cases.combinations(20)
    assert found[:5] == cases.combinations(5)
    assert len({*found, *cases.single_changes()}) == 20 + 11


def test_drawn_cases_follow_their_rule_and_are_always_the_same():
    found = cases.drawn_cases()
    assert found == cases.drawn_cases()
    assert len({case.name for case in found}) == cases.DRAWN
    for case in found:
        assert 0.1 <= case.friction <= 0.5
        assert 0.0 <= case.corner_x <= 4.0
        assert case.segments is None or 8 <= case.segments <= 64
        assert set(case.flags) <= set(cases.FLAGS)
        assert case.seal().n_offsets + 1 == case.parameters
        assert np.abs(case.design(case.seal())[0]).max() <= cases.DRAWN_START
    for values in (*zip(*[(c.parameters, c.friction_history) for c in found], strict=True),):
        assert len(set(values)) > 1
    assert {name for case in found for name in case.flags} == set(cases.FLAGS)


def test_seals_and_starts():
    ten = cases.Case(parameters=10, start=2, segments=32, flags=("keep_force",))
    assert ten.name == "parameters 10, segments 32, start 2, keep_force"
    seal = ten.seal(n_steps=21)
    assert options_of(seal).symmetric
    assert (options_of(seal).segments, seal.n_steps) == (32, 21)
    offsets, radius = ten.design(seal)
    again, _ = ten.design(seal)
    np.testing.assert_array_equal(offsets, again)
    assert 0.05 < np.abs(offsets).max() <= 0.2
    assert 0.0 < abs(radius - 4.0) <= 0.2
    assert not cases.Case().design(seal)[0].any()
    assert ten.settings() == {"keep_force": True}


def test_matrix_goes_on_where_it_stopped(tmp_path, run_script):
    name = next(iter(OPTIMIZERS))
    arguments = ("--first", 1, "--optimizers", name, "--page", tmp_path / "page.md", *CHEAP)
    code, summary = run_script("optimization_matrix", tmp_path, *arguments)
    assert code == 0
    (row,) = summary["table"]
    assert summary["runs"] == summary["converged"] == 1
    assert row["cost"] < 0.01
    assert f"gap {row['largest_gap_mm']:.4f} mm" in (tmp_path / "page.md").read_text()
    assert 0.0 <= row["largest_gap_mm"] < 0.1
    assert max(row["violation"], row["optimality"]) <= 1e-3
    assert f"{name} converged in 1 of 1 cases" in (tmp_path / "page.md").read_text()
    # a run of another model, and one that was cut off by a kill, do not count
    record = tmp_path / "runs.jsonl"
    line = record.read_text()
    record.write_text(line + line.replace('"n_steps": 21', '"n_steps": 105') + line[:40] + "\n")
    _, again = run_script("optimization_matrix", tmp_path, *arguments)
    assert again["table"] == [row]
    assert len(record.read_text().splitlines()) == 3


@pytest.mark.long
def test_runs_come_from_the_workers_and_one_that_fails_is_named(monkeypatch):
    """Without friction the nominal seal sways and has no gap to close: the row says so."""
    monkeypatch.setattr(optimization_matrix, "compile_kernels", lambda: None)
    slippery = [cases.Case(friction=0.0, segments=segments) for segments in (None, 32)]
    entries = [(case, next(iter(OPTIMIZERS))) for case in slippery]
    solve = partial(optimization_matrix.solve_case, n_steps=21)
    rows = list(optimization_matrix.finished(solve, entries, 2))
    assert {row["case"] for row in rows} == {case.name for case, _ in entries}
    for row in rows:
        assert row["success"] is None
        assert row["message"].startswith(
            "ValueError: the nominal seal has no gap above 0.001 mm between points"
        )


def made_row(case, optimizer, **changes):
    row = {
        "case": case, "optimizer": optimizer, "success": True, "iterations": 8, "analyses": 10,
        "cost": 2e-5, "violation": 0.0, "optimality": 4e-4, "message": "done",
        "versions": {"scipy": "1.17"},
    }  # fmt: skip
    return row | changes


@pytest.mark.parametrize(
    "changes", [{"success": False}, {"optimality": 2e-3}, {"violation": 2e-3}, {"success": None}]
)
def test_convergence_is_measured_not_believed(changes):
    assert matrix_page.converged(made_row("paper", "A"))
    assert not matrix_page.converged(made_row("paper", "A", **changes))


def test_page_lists_all_cases_and_every_failure():
    drawn = cases.drawn_cases()[0].name
    nothing = dict.fromkeys(("success", "iterations", "analyses", "cost"))
    table = [
        made_row("paper", "A"), made_row("paper", "B", iterations=None, analyses=30),
        made_row(drawn, "A", optimality=5e-3, message="no\nprogress"),
        made_row(drawn, "B", **nothing, message="LoadPathError: cut"),
    ]  # fmt: skip
    text = matrix_page.page(table, {drawn})
    first, second = text.split("## Random cases")
    good = "8 iterations, 10 analyses, 0.0020 %, KKT 4e-04"
    assert f"| paper | {good} | 30 analyses, 0.0020 %, KKT 4e-04 |" in first
    assert "A converged in 1 of 2 cases, with 10 analyses in the median and 10 at most" in first
    assert f"| {drawn} | **failed**: 8 iterations" in second
    assert str(cases.DRAWN_SEED) in second
    assert f"| A | {drawn} | 5.0e-03 | 0.0e+00 | no progress |" in second
    assert f"| B | {drawn} |  |  | LoadPathError: cut |" in second
    assert second.endswith("Made with scipy 1.17.\n")


def test_unknown_optimizer_is_refused(tmp_path, run_script):
    with pytest.raises(SystemExit) as ended:
        run_script("optimization_matrix", tmp_path, "--optimizers", "NEWTON")
    assert ended.value.code == 2
