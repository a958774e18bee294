"""Forces over time: what is drawn, its axes, the column of the CSV, seals without times."""

import csv

import numpy as np
import pytest
from block_files import FIXED, LID, exact_seal, text

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.analyze import summarize
from seal_mdao.export.csv_tables import write_curves
from seal_mdao.report.page import ShownSeal
from seal_mdao.report.write import time_section

SERIES = "\n[material.rubber.viscoelastic]\ng = [0.3, 0.2]\ntau = [1.0, 100.0]\n[section]\n"
STAGES = """
stage = [
  { translate = [0, -0.5], steps = 3, duration = 0.5 }, { steps = 3, duration = 1e3 },
  { translate = [0, 0.1], steps = 2, duration = 2.0 },
]
"""
PLAIN = text(FIXED, LID)
RELAXING = PLAIN.replace("\n[section]\n", SERIES).replace(
    "\nstage = [{ translate = [0, -0.5], steps = 3 }]\n", STAGES
)


@pytest.fixture(scope="module")
def relaxed(tmp_path_factory):
    return sm.analyze(exact_seal(tmp_path_factory.mktemp("relaxing"), RELAXING))


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    return sm.analyze(exact_seal(tmp_path_factory.mktemp("plain"), PLAIN))


def column(result, folder, name):
    (path,) = write_curves(result, folder)
    with path.open(newline="") as file:
        rows = list(csv.DictReader(file))
    return [float(row[name]) for row in rows] if name in rows[0] else None


def test_forces_are_drawn_at_their_times(relaxed):
    times = relaxed.seal.terms()[0].environment.time.at(np.arange(9))
    first, second = plotting.force_over_time(relaxed).axes
    # the load after the dwell begins a panel, with its own time
    for axes, steps, begin in ((first, slice(0, 6), 0.0), (second, slice(6, 8), times[6])):
        drawn = {line.get_label(): line for line in axes.lines}
        for number, name in enumerate(("horizontal", "vertical")):
            np.testing.assert_array_equal(drawn[name].get_ydata(), relaxed.reaction[steps, number])
            np.testing.assert_array_equal(drawn[name].get_xdata(), times[1:][steps] - begin)
        assert axes.get_xscale() == "log"
    ratio = 100.0 * relaxed.reaction[5, 1] / relaxed.reaction[2, 1]
    assert any(f"({ratio:.0f} %)" in own.get_text() for own in first.texts)
    assert "stage 2\n1000 s" in [own.get_text() for own in first.texts]


def test_dwells_have_their_duration_in_the_load_deflection_curve(relaxed, plain):
    axes = plotting.load_deflection(relaxed).axes[0]
    (label,) = [own for own in axes.texts if own.get_gid() == "dwell"]
    assert label.get_text() == "1000 s"
    assert label.xy == pytest.approx((0.5, relaxed.reaction[[2, 5], 1].mean()))
    assert not [own for own in plotting.load_deflection(plain).axes[0].texts if own.get_gid()]


def test_times_are_in_the_table_and_in_captions(relaxed, tmp_path):
    times = relaxed.seal.terms()[0].environment.time.at(np.arange(1, 9))
    np.testing.assert_allclose(column(relaxed, tmp_path, "time_s"), times, rtol=1e-11)
    assert relaxed.caption(5) == "stage 2, at rest, after 1000 s"


def test_stage_times_are_in_the_summary(relaxed, plain):
    rows = summarize(relaxed)["stage_times"]
    assert [row["duration_s"] for row in rows] == pytest.approx([0.5, 1e3, 2.0], rel=1e-12)
    assert [row["end_s"] for row in rows] == pytest.approx([0.5, 1000.5, 1002.5], rel=1e-12)
    assert [row["dwell"] for row in rows] == [False, True, False]
    assert rows[1]["duration"] == "1000 s"
    assert "stage_times" not in summarize(plain)


def test_the_report_has_a_section_of_seals_with_times(relaxed, plain):
    class Recorded:
        name = "lid seal"

    section = time_section(0, ShownSeal(Recorded, [relaxed]))
    assert 'alt="Force over time: lid seal"' in section
    assert time_section(0, ShownSeal(Recorded, [plain])) == ""


def test_nothing_changes_without_times(plain, tmp_path):
    assert column(plain, tmp_path, "time_s") is None
    assert "after" not in plain.caption(2)
    with pytest.raises(ValueError, match="no stage has a duration"):
        plotting.force_over_time(plain)
