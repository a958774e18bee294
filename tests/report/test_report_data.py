"""What the report shows is what was recorded and what the analyses give."""

import base64
import json
import re
import shutil
import sqlite3

import numpy as np
import openmdao.api as om
import pytest
from penalty_warnings import further_warnings

import seal_mdao as sm
from seal_mdao.measures.selection import open_points
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.report import html_tables as tables
from seal_mdao.report.page import status
from seal_mdao.report.picture_data import FULL, Pictures, evenly_spread
from seal_mdao.report.write import DESIGNS, write_report
from seal_mdao.seals.profiles import contact_counts, contacts, nominal_pressure, true_pressure


def unpacked(text, *shape):
    return np.frombuffer(base64.b64decode(text), "<i2").reshape(shape)


def cells(html):
    """Rows of the tables in HTML as lists of text."""
    rows = re.findall(r"<tr>(.*?)</tr>", html)
    return [re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", row) for row in rows]


@pytest.fixture(scope="module")
def history(seal_page):
    return read_optimization(seal_page.cases)


@pytest.fixture(scope="module")
def ends(history):
    return [sm.analyze(history.seal, *history.design_at(index)) for index in (0, -1)]


def test_history_is_that_of_the_recorder_file(seal_page, history):
    shown = seal_page.data["history"]
    assert shown["objective"]["values"] == history.objective.tolist()
    assert shown["objective"]["unit"] == "mm²"
    assert shown["violation"] == history.max_violation.tolist()
    labels = [c["label"] for c in shown["constraints"]]
    assert labels == ["area of the section", *(f"stress {k}" for k in range(1, 8)),
                      "reaction"]  # fmt: skip
    area = shown["constraints"][0]
    assert (area["lower"], area["upper"], area["unit"]) == (None, 110.0, "mm²")
    assert area["use"] == pytest.approx(np.array(area["values"]) / 110.0)
    outer, inner, radius = shown["design"]
    offsets = history.design["boundary_offsets"]
    assert np.array_equal(np.array(outer["values"]), offsets[:, :14].T)
    assert np.array_equal(np.array(inner["values"]), offsets[:, 14:].T)
    assert (outer["lower"], outer["upper"]) == (-0.5, 0.5)
    assert (radius["lower"], radius["upper"], radius["unit"]) == (3.5, 4.5, "mm")


def test_frames_are_the_deformed_sections(seal_page, ends):
    shapes = seal_page.data["shapes"]
    for path, result in zip(shapes["paths"], ends, strict=True):
        # a watched point is a particle: its stress and its place are those of the analysis
        watched = result.measure("von_mises").points
        for step in (10, 20):
            frame = path["frames"][step]
            points = unpacked(frame["points"], -1, 3)
            for beside, particle in zip(shapes["watched"], watched, strict=True):
                x, y, stress = points[beside[1]]
                place = np.array([x, y]) * shapes["length"]
                assert place == pytest.approx(result.deformed(step)[particle], abs=1e-3)
                exact = result.stress_field(step)[particle]
                assert stress * shapes["scales"][0]["top"] / FULL == pytest.approx(exact, abs=0.02)
            assert np.abs(points).max() <= FULL
            check_contact(shapes, frame, result.path.at_nominal("door")[step])
            (pose,) = frame["poses"]
            assert pose == pytest.approx([0.0, 9.5 - result.travel[step], 1.0, 0.0], abs=1e-6)
        (curves,) = path["curves"]
        assert curves["words"] == "travel (mm)"
        assert curves["along"] == pytest.approx(result.travel, abs=1e-6)
        assert np.array(curves["reaction"]) == pytest.approx(result.reaction, abs=1e-4)
        assert path["captions"] == [result.caption(step) for step in range(21)]
        assert path["completed"] is True


def check_contact(shapes, frame, answer):
    """The dots are the points that touch, and those that are open between them."""
    opened = open_points(answer.state)
    shown = np.union1d(np.flatnonzero(answer.state), opened)
    dots = unpacked(frame["touching"], -1, 2) * shapes["length"]
    assert dots == pytest.approx(answer.x[shown], abs=1e-3)
    marks = ["3" if k in opened else str(answer.state[k]) for k in shown]
    assert list(frame["marks"]) == marks


def test_pressure_carries_the_vertical_force(ends):
    """On the flat of the door pressure times tributary length is the normal force."""
    for result in ends:
        end, lengths = result.contact, result.term("door").length
        (door,) = contacts(result.seal)
        carried = nominal_pressure(door, end) * lengths
        deformed = door.where.lengths(result.deformed())
        assert true_pressure(result, door) * deformed == pytest.approx(carried, rel=1e-12)
        normal = np.abs(end.force).max(axis=1)
        flat = np.flatnonzero((carried > 0.0) & (end.x[:, 0] < 1.5))
        assert flat.size
        # friction adds a horizontal part of at most a quarter
        assert carried[flat] == pytest.approx(normal[flat], rel=1e-6)
        assert np.all(carried[end.state == 0] == 0.0)


def test_pictures_name_seal_and_material(seal_page):
    assert seal_page.data["shapes"]["caption"].startswith("door seal: rubber (Mooney-Rivlin) | 20")


def test_all_pictures_share_one_scale(seal_page, ends):
    shapes = seal_page.data["shapes"]
    peaks = [max(frame["peak"] for frame in path["frames"]) for path in shapes["paths"]]
    (scale,) = shapes["scales"]
    assert max(peaks) <= scale["top"] < 1.25 * max(peaks)
    assert peaks[0] >= ends[0].stress_field().max() - 0.01
    assert (scale["name"], set(shapes["regions"])) == ("", {0})
    assert shapes["numbers"] == list(range(len(seal_page.data["history"]["objective"]["values"])))
    assert len(shapes["designs"]) == len(shapes["numbers"])


def test_refined_seal_has_pictures_of_the_same_size():
    coarse, fine = (
        sm.analyze(sm.door_seal(depth=1.0, n_steps=2, rays=58 * k, layers=2 * k + 1))
        for k in (1, 2)
    )
    data = [Pictures(result, result, [result]).as_data() for result in (coarse, fine)]
    assert len(data[0]["quads"]) == len(data[1]["quads"]) == 116 * 4
    for shapes, result in zip(data, (coarse, fine), strict=True):
        (design,) = shapes["designs"]
        assert len(unpacked(design["frame"]["points"], -1, 3)) == 116 * 5
        assert [len(loop) for loop in shapes["loops"]] == [116, 116]
        boundary = unpacked(design["boundary"], -1, 2) * shapes["length"]
        radius = np.unique(np.hypot(*boundary.T).round(1))
        assert (radius[0], radius[-1]) == (7.5, 10.0)  # the hole, the corners of the base
        check_contact(shapes, design["frame"], result.contact)


def test_table_of_limits(history):
    rows = cells(tables.limits_table(history))
    first, area, stress, *_, reaction = rows[1:]
    assert first[0] == "sum of squared gaps (mm²)"
    assert first[1] == f"{history.objective[0]:.4g}"
    assert area[::3] == ["area of the section (mm²)", "≤ 110"]
    assert stress[-1] in ("satisfied", "violated")
    assert reaction[0] == "reaction (N/m)"
    assert " to " in reaction[3]
    violated = [row[0] for row in rows[1:] if row[-1] == "violated"]
    expected = [c.name for c in history.constraints if c.violation()[-1] > 1e-3]
    assert len(violated) == len(expected)


def test_table_of_measures(history, ends):
    rows = {
        row[0]: row[1:] for row in cells(tables.analysis_table(*ends, history.seals[0].measures))
    }
    start, end = ends
    assert rows["sum of squared gaps"] == rows["the same, as recorded"]
    assert rows["vertical force on the profile"][1] == f"{end.reaction[-1, 1]:.4g}"
    assert rows["contact points in contact"][0] == str(contact_counts(start.contact)["contact"])
    assert rows["patches in contact"][0] == "2"
    assert rows["largest gap between contacts"][0] == f"{start.gap.max():.4g}"
    assert rows["area of the section"][0] == "109"


@pytest.mark.parametrize(
    ("value", "text"),
    [(0.0, "0"), (109.0, "109"), (-4.9, "−4.9"), (1234567.0, "1.235\u00a0·\u00a010⁶"),
     (6.958e-7, "6.958\u00a0·\u00a010⁻⁷"), (float("nan"), "–"), (None, "–"), (7, "7")],
)  # fmt: skip
def test_numbers_for_reading(value, text):
    assert tables.number(value) == text


def test_patches():
    for touching, closed, count in (
        ([0, 0], False, 0), ([0, 0], True, 0), ([1, 1, 0, 1], False, 2), ([0, 1, 1, 0], True, 1),
        ([1, 1, 0, 1], True, 1), ([1, 0, 1, 0], True, 2), ([1, 1], True, 1), ([1, 1], False, 1),
    ):  # fmt: skip
        assert tables.patches(np.array(touching, bool), closed) == count


def test_end_of_the_run_is_told_as_it_was(seal_page, tmp_path):
    path = shutil.copy(seal_page.cases, tmp_path / "cases.sql")

    def told(change):
        connection = sqlite3.connect(path)
        with connection:
            connection.execute(change)
        connection.close()
        return status(read_optimization(path))

    kind, word, text = told("UPDATE run_log SET success=0, message='Iteration limit reached'")
    assert (kind, word) == ("stopped", "Not converged")
    assert text.startswith("Iteration limit reached.")
    violated = read_optimization(path).max_violation[-1] > 1e-3
    kind, word, text = told("UPDATE run_log SET success=1")
    assert word == ("Not converged" if violated else "Converged")
    kind, word, text = told("UPDATE run_log SET ended=''")
    assert (kind, word) == ("stopped", "Cut off")
    assert "recorded analyses" in text
    kind, word, text = told("DROP TABLE run_log")
    assert (kind, word) == ("unknown", "End not recorded")
    assert "does not say how the optimisation ended. " in text
    assert text.endswith(("satisfied.", "%."))


def test_cut_off_run_ends_with_its_last_major_iteration(seal_page, tmp_path):
    path = shutil.copy(seal_page.cases, tmp_path / "cases.sql")
    connection = sqlite3.connect(path)
    with connection:
        connection.execute("UPDATE run_log SET ended=''")
        last = connection.execute("SELECT MAX(counter) FROM driver_iterations").fetchone()[0]
        connection.execute("DELETE FROM driver_derivatives WHERE counter=?", (last,))
    connection.close()
    cut, whole = read_optimization(path), read_optimization(seal_page.cases)
    assert cut.cut_off
    assert not whole.cut_off
    assert np.array_equal(cut.objective, whole.objective[:-1])
    text = write_report(path).read_text(encoding="utf-8")
    assert "Cut off" in text


def test_settings_and_versions_are_on_the_page(seal_page):
    rows = {row[0]: row[-1] for row in cells(seal_page.text)}
    assert rows["friction"] == "0.25"
    assert rows["n_steps"] == "21"
    assert rows["material: c10"] == "80.0"
    assert rows["problem: keep_force"] == "True"
    assert rows["maxiter"] == "3"
    assert rows["version of seal_mdao"] == sm.__version__


def test_changed_seal_is_pointed_out(seal_page, tmp_path):
    """The recorded cost is not that of the designs analysed again."""
    assert not further_warnings(seal_page.text)
    path = shutil.copy(seal_page.cases, tmp_path / "cases.sql")
    connection = sqlite3.connect(path)
    with connection:
        query = "SELECT id, outputs FROM driver_iterations"
        for row, text in connection.execute(query).fetchall():
            values = json.loads(text)
            values["contact.gap_square_sum"][0] *= 1.001
            update = "UPDATE driver_iterations SET outputs=? WHERE id=?"
            connection.execute(update, (json.dumps(values), row))
    connection.close()
    assert 'class="warning"' in write_report(path).read_text(encoding="utf-8")


def test_many_points_are_thinned_evenly():
    assert evenly_spread(1, DESIGNS).tolist() == [0]
    assert evenly_spread(DESIGNS, DESIGNS).tolist() == list(range(DESIGNS))
    chosen = evenly_spread(201, DESIGNS)
    assert len(chosen) == DESIGNS
    assert (chosen[0], chosen[-1]) == (0, 200)
    assert set(np.diff(chosen)) <= {5, 6}


def test_other_problem_has_histories_only(other_page):
    assert other_page.path.parent.name == "new"
    assert other_page.data["shapes"] is None
    assert [c["label"] for c in other_page.data["history"]["constraints"]] == ["</script><b>&"]
    assert "<b>&</" not in other_page.text
    assert other_page.text.count("</script>") == 2


def test_file_that_is_no_record(tmp_path):
    (tmp_path / "text.sql").write_text("text")
    with pytest.raises(ValueError, match="not a file of an OpenMDAO recorder"):
        write_report(tmp_path / "text.sql")
    problem = om.Problem(reports=None, work_dir=tmp_path)
    problem.add_recorder(om.SqliteRecorder(tmp_path / "empty.sql"))
    problem.setup()
    problem.run_model()
    problem.cleanup()
    with pytest.raises(ValueError, match="contains no driver iterations"):
        write_report(tmp_path / "empty.sql")
