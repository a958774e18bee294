"""Load-deflection curves on the console: computed forces, before derivatives and figures."""

import re
from dataclasses import replace
from importlib import import_module

import numpy as np
import pytest

from seal_mdao.analysis.path_result import Status
from seal_mdao.cli.force_table import BAR, MOST_ROWS, force_lines


def rows(lines):
    """Numbers of the lines that have three, and the lengths of their bars."""
    found = [re.fullmatch(r" *(\S+) +(\S+) +(\S+) *(#*)", line) for line in lines]
    return np.array([[*map(float, row.groups()[:3]), len(row[4])] for row in found if row])


def test_rows_are_the_forces_of_the_path(nominal):
    lines = force_lines(nominal)
    assert "door, stage 1: travel (mm), horizontal and vertical force (N/m)" in lines[0]
    table = rows(lines)
    assert len(table) == MOST_ROWS == len(lines) - 1
    for travel, across, up, _ in table:
        step = int(np.abs(nominal.travel - travel).argmin())
        assert nominal.travel[step] == pytest.approx(travel, abs=6e-4)
        assert nominal.reaction[step] == pytest.approx([across, up], abs=6e-3)
    # the last load step is the last row, and bars are proportional to the force
    assert table[-1, 0] == pytest.approx(nominal.travel[-1], abs=6e-4)
    size = np.hypot(table[:, 1], table[:, 2])
    largest = np.hypot(*nominal.reaction.T).max()
    assert table[:, 3] == pytest.approx(BAR * size / largest, abs=0.51)


def test_a_path_that_stopped_has_the_rows_up_to_there(nominal):
    done = len(nominal.path.nominal_steps) // 2
    part = replace(nominal.path, steps=nominal.path.steps[:done], status=Status.NOT_CONVERGED)
    stopped = replace(nominal, path=part)
    last = len(stopped.path.nominal_steps) - 1
    assert rows(force_lines(stopped))[-1, 0] == pytest.approx(nominal.travel[last], abs=6e-4)


def test_forces_are_on_the_screen_before_derivatives_and_figures(
    nominal, tmp_path, monkeypatch, capsys
):
    analyze = import_module("seal_mdao.cli.analyze")

    class StoppedError(Exception):
        pass

    def stop(result):
        assert "door, stage 1" in capsys.readouterr().out
        raise StoppedError

    monkeypatch.setattr(analyze, "file_of", lambda path: None)
    monkeypatch.setattr(analyze, "analyzed", lambda file, report: (file, nominal, 0.0))
    monkeypatch.setattr(analyze, "summarize", stop)
    made = analyze.arguments_parser().parse_args(["seal.toml", "--out", str(tmp_path)])
    with pytest.raises(StoppedError):
        analyze.main(made)
