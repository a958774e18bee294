"""optimization_matrix.py: its cases, one small run, and going on after an interruption."""

import json
import sys

import numpy as np
import pytest
from script_runs import CHEAP, SCRIPTS


@pytest.fixture(scope="module")
def cases():
    sys.path.insert(0, str(SCRIPTS))
    import _matrix_cases

    yield _matrix_cases
    sys.path.remove(str(SCRIPTS))


def test_single_changes_are_each_factor_alone(cases):
    found = cases.single_changes()
    assert found[0] == cases.Case()
    assert found[0].name == "paper"
    assert len(found) == 1 + sum(len(values) - 1 for values in cases.FACTORS.values())
    assert all("," not in case.name for case in found)


def test_combinations_are_new_and_always_the_same(cases):
    found = cases.combinations(20)
    assert found == cases.combinations(20)
    assert found[:5] == cases.combinations(5)
    assert len({*found, *cases.single_changes()}) == 20 + 11


def test_models_and_starts(cases):
    ten = cases.Case(parameters=10, start=2, segments=32)
    model = ten.model(n_steps=21)
    assert model.n_offsets + 1 == 10
    assert (model.segments, model.n_steps) == (32, 21)
    offsets, radius = ten.design(model)
    again, _ = ten.design(model)
    np.testing.assert_array_equal(offsets, again)
    assert 0.05 < np.abs(offsets).max() <= 0.2
    assert 0.0 < abs(radius - 4.0) <= 0.2
    assert not cases.Case().design(model)[0].any()


def test_matrix_goes_on_where_it_stopped(tmp_path, run_script):
    arguments = ("--first", 2, "--optimizers", "SLSQP", *CHEAP)
    code, summary = run_script("optimization_matrix", tmp_path, *arguments)
    assert code == 0
    assert summary["runs"] == summary["converged"] == 2
    assert summary["worst"]["iterations"] == max(row["iterations"] for row in summary["table"])
    for row in summary["table"]:
        assert row["cost"] < 0.01
        assert row["violation"] <= 1e-3
    text = (tmp_path / "matrix.md").read_text()
    assert "paper" in text
    assert "corner_x 0.0" in text
    # as if it had been killed while the second run was written
    record = tmp_path / "runs.jsonl"
    lines = record.read_text().splitlines()
    record.write_text(lines[0] + "\n" + lines[1][:40] + "\n")
    code, again = run_script("optimization_matrix", tmp_path, *arguments)
    assert code == 0
    assert len(record.read_text().splitlines()) == 3
    kept = json.loads(lines[0])
    assert kept in again["table"]


def test_unknown_optimizer_is_refused(tmp_path, run_script):
    with pytest.raises(SystemExit) as ended:
        run_script("optimization_matrix", tmp_path, "--optimizers", "NEWTON")
    assert ended.value.code == 2
