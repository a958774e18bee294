"""seal-mdao optimize: an optimum, stopped and continued, as numbers, pictures and a drawing."""

import csv
import re
from importlib import import_module

import numpy as np
import pytest
from coarse_seal import OPEN, written
from shapely import LinearRing, Point

import seal_mdao as sm
from seal_mdao.seals.file.chosen import chosen_for

FIGURES = ("designs", "start", "optimum")


@pytest.fixture(scope="module")
def stopped(run_script, tmp_path_factory):
    """Folder, exit code and summary of a run that was given too few iterations."""
    out = tmp_path_factory.mktemp("optimised")
    return out, *run_script(
        "optimize", out, written(out, {"[0.0, 14.45]": "[0.0, 14.5]"}), "--max-iterations", 3
    )


@pytest.fixture(scope="module")
def continued(stopped, run_script):
    """The same folder after the run was continued."""
    out, *_ = stopped
    return out, *run_script("optimize", out, out / "seal.toml", "--restart", out / "cases.sql")


def test_run_that_stops_early_is_written_as_far_as_it_went(stopped):
    _, code, s = stopped
    assert code == 1
    assert (s["status"], s["optimizer"], s["iterations"]) == ("not converged", "UNO", 3)
    assert len(s["history"]) == 4


def counts_of(page) -> tuple[int, int]:
    """The iterations in the key figures of a report, and in its table of runs."""
    text = page.read_text(encoding="utf-8")
    figure = re.search(r"<span>iterations</span><strong>(\d+)</strong>", text)
    table = text.split("Runs that wrote the recorder file</caption>")[1].split("</table>")[0]
    cells = re.findall(r"<t[hd][^>]*>(.*?)</t[hd]>", table, re.DOTALL)
    return int(figure[1]), int(cells[len(cells) // 2 + 3])


def test_report_and_command_count_the_same_iterations(tmp_path, run_script):
    """The result of a stopped run is an earlier design, which is no further iteration."""
    _, s = run_script("optimize", tmp_path, written(tmp_path), "--max-iterations", 3)
    assert len(s["history"]) == 5
    assert counts_of(tmp_path / "report.html") == (s["iterations"], s["iterations"]) == (3, 3)


def test_iterations_of_slsqp_are_not_its_evaluations(tmp_path, run_script):
    path = written(tmp_path, {"[0.0, 14.45]": "[0.0, 14.5]"})
    arguments = (path, "--optimizer", "SLSQP", "--max-iterations", 2)
    _, s = run_script("optimize", tmp_path, *arguments)
    assert s["recorded_evaluations"] > 3
    assert counts_of(tmp_path / "report.html") == (s["iterations"], s["iterations"]) == (2, 2)


def test_a_report_has_every_warning_once(stopped):
    out, *_ = stopped
    text = (out / "report.html").read_text(encoding="utf-8")
    found = re.findall(r'<p class="warning">(.*?)</p>', text)
    # the same text may hold for the first and for the last design
    assert sum("Last design" in line and "fewer than 5" in line for line in found) == 1
    assert len(found) == len(set(found))
    assert all("design of" in line for line in found)


def test_continued_run_ends_at_an_optimum(stopped, continued, assert_drawn):
    (_, _, before), (out, code, s) = stopped, continued
    assert code == 0
    assert s["status"] == "converged"
    assert s["reused_evaluations"] >= before["recorded_evaluations"] - 1
    assert s["history"][:3] == before["history"][:3]
    assert s["objective"]["name"] == "section_area"
    assert s["objective"]["end"] < 0.95 * s["objective"]["start"]
    force = s["constraints"]["reaction"]
    assert (force["lower"], force["upper"], force["unit"]) == (15.0, 18.0, "N/m")
    # warnings of the last design, with those of its analysis with new particles
    assert any("fewer than 5" in text for text in s["warnings"])
    assert set(s["on_new_cloud"]) >= {"reaction", "section_area"}
    assert force["end"] == pytest.approx(15.0, rel=1e-3)  # less rubber, less force
    assert s["max_constraint_violation"] <= 1e-3
    assert s["kkt"].pop("sides_of_kink") >= 1
    assert max(s["kkt"].values()) <= 1e-3  # the tolerance of the driver
    assert np.abs(s["boundary_offsets"]).max() <= 0.5 + 1e-9
    assert "<html" in (out / "report.html").read_text(encoding="utf-8")
    assert_drawn(out, *FIGURES)


def test_optimum_is_that_of_the_summary(continued):
    out, _, s = continued
    seal = sm.build_seal(sm.read_seal_file(out / "seal.toml"))
    result = sm.analyze(seal, np.array(s["boundary_offsets"]))
    values = {
        m.name: float(result.value(m)[0]) for m in result.measures(("section_area", "reaction"))
    }
    assert values["section_area"] == pytest.approx(s["objective"]["end"], rel=1e-12)
    assert values["reaction"] == pytest.approx(s["constraints"]["reaction"]["end"], rel=1e-9)


def test_drawing_and_table_are_the_optimum(continued):
    out, _, s = continued
    seal = sm.build_seal(sm.read_seal_file(out / "seal.toml"))
    particles = seal.particles(np.array(s["boundary_offsets"]))
    outline = sm.read_dxf(out / "optimum.dxf")
    assert set(outline.edge_names) == {"base", "seal", "cavity"}
    rings = [LinearRing(contour.polyline(1e-9)[0]) for contour in outline.contours]
    with (out / "optimum.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    for name, edge in seal.body.edges.items():
        own = [row for row in rows if row["edge"] == name]
        places = np.array([[float(row["x_mm"]), float(row["y_mm"])] for row in own])
        assert len(own) == len(edge.particles) + edge.closed
        assert places[: len(edge.particles)] == pytest.approx(particles[edge.particles], abs=1e-9)
        for place in places:
            assert min(ring.distance(Point(place)) for ring in rings) < 1e-6
    (hole,) = outline.contours[1:]
    (nominal,) = sm.read_seal_file(out / "seal.toml").section.outline.contours[1:]
    assert abs(hole.area) > abs(nominal.area)


@pytest.mark.parametrize(
    ("changes", "word"),
    [
        ({"[optimize]\nminimize = \"section_area\"": "", "[[optimize.constraint]]": "[[measure]]",
          'measure = "reaction"\nlower = 15.0\nupper = 18.0': 'type = "reaction"'}, "[optimize]"),
        ({'[[design]]\nedges = ["cavity"]\nparameters = 4\nbound = 0.5': ""}, "[[design]]"),
        ({'minimize = "section_area"': 'minimize = "gap_square_sum"'}, "gap_square_sum"),
    ],
)  # fmt: skip
def test_files_that_ask_for_nothing_take_one_line(changes, word, tmp_path, run_script, capsys):
    code, summary = run_script("optimize", tmp_path, written(tmp_path, changes))
    assert (code, summary) == (2, None)
    (line,) = capsys.readouterr().err.splitlines()
    assert word in line


def test_only_the_same_run_is_continued(stopped, tmp_path, run_script, capsys):
    out, *_ = stopped
    same = {"[0.0, 14.45]": "[0.0, 14.5]"}
    other = written(tmp_path, same | {"upper = 18.0": "upper = 19.0"})
    changed = (
        f"--restart: {other} has changed since {out / 'cases.sql'} was recorded with it "
        "(optimize.constraint.1.upper was 18.0 and is 19.0); restore"
    )
    lip = other.with_name("lip.toml")
    lip.write_text(other.read_text(encoding="utf-8"), encoding="utf-8")
    another = f"was recorded with another seal file, seal.toml, from which {lip} differs (optimize"
    for arguments, word in (
        ((other,), changed), ((lip,), another), ((out / "seal.toml", "--optimizer", "ipopt"), "UNO"),
    ):  # fmt: skip
        with pytest.raises(SystemExit) as ended:
            run_script("optimize", out, *arguments, "--restart", out / "cases.sql")
        assert ended.value.code == 2
        assert word in capsys.readouterr().err
    with pytest.raises(SystemExit):
        run_script("optimize", tmp_path, other, "--restart", tmp_path / "cases.sql")
    assert "is not a file" in capsys.readouterr().err
    with pytest.raises(SystemExit):
        run_script("optimize", out, out / "seal.toml")
    assert "--overwrite" in capsys.readouterr().err


def test_run_is_continued_in_another_folder(stopped, tmp_path, run_script):
    """With the recorder file of the first folder, which stays as it is."""
    out, _, before = stopped
    cases = out / "cases.sql"
    content = cases.read_bytes()
    # comments and the name of the file do not matter
    same = tmp_path / "same.toml"
    same.write_text("# again\n" + (out / "seal.toml").read_text(encoding="utf-8"), encoding="utf-8")
    arguments = (same, "--restart", cases, "--max-iterations", 4)
    _, s = run_script("optimize", tmp_path, *arguments)
    assert s["history"][:3] == before["history"][:3]
    assert s["iterations"] == 4
    assert (tmp_path / "cases.sql").stat().st_size > 0
    assert cases.read_bytes() == content


def test_history_is_drawn_from_the_recorder_file_alone(stopped, tmp_path, run_script, capsys):
    out, *_ = stopped
    code, s = run_script("history", tmp_path, out / "cases.sql")
    assert code == 0
    assert s["objective"]["name"] == "section_area"
    assert len(s["largest_gap_mm"]["door"]) == 2
    for name in ("objective_history", "constraint_history", "designs", "start", "optimum"):
        assert (tmp_path / f"{name}.png").is_file()
    assert "section area: " in capsys.readouterr().out
    with pytest.raises(SystemExit):
        run_script("optimize_door_seal", tmp_path, "--restart", out / "cases.sql")
    assert "does not contain the settings of the built-in door seal" in capsys.readouterr().err


def test_a_continued_run_has_the_load_steps_that_were_chosen(
    tmp_path, run_script, monkeypatch, capsys
):
    """And so has the best design as a file."""
    path = written(tmp_path, OPEN)
    code, s = run_script("optimize", tmp_path, path, "--max-iterations", 1)
    said = capsys.readouterr().out
    assert "load steps, chosen for an estimated numerical error of at most" in said
    # a limit is no failure, but not an optimum either
    assert (code, s["limited"]) == (1, True)
    assert "FAILED" not in said
    assert "UNO stopped after 1 iterations" in said
    assert f"continue with --restart {tmp_path / 'cases.sql'}" in said
    assert not list(tmp_path.glob(".*.lock"))

    def refusing(*_, **__):
        raise AssertionError("load steps are chosen again")

    monkeypatch.setattr("seal_mdao.seals.file.build.choose", refusing)
    cases = tmp_path / "cases.sql"
    _, s = run_script("optimize", tmp_path, path, "--restart", cases, "--max-iterations", 2)
    assert s["iterations"] == 2
    best = sm.build_seal(sm.read_seal_file(tmp_path / "optimum.toml"))
    offsets = np.array(s["boundary_offsets"])
    monkeypatch.undo()
    file = sm.read_seal_file(path)
    nominal = sm.build_seal(file)
    assert chosen_for(file, best) == chosen_for(file, nominal)
    (reaction,) = nominal.measures(("reaction",))
    assert sm.analyze(best).value(reaction) == pytest.approx(
        sm.analyze(nominal, offsets).value(reaction), rel=1e-6
    )


@pytest.mark.long
def test_optimum_is_written_where_no_new_cloud_fits_it(tmp_path, run_script, monkeypatch, capsys):
    def refusing(*_, **__):
        raise sm.SealFileError("optimum.toml: the sides of the boundary near")

    import_module("seal_mdao.cli.optimize")
    monkeypatch.setattr("seal_mdao.cli.optimize.on_new_cloud", refusing)
    run_script("optimize", tmp_path, written(tmp_path), "--max-iterations", 1)
    said = capsys.readouterr().out
    assert (
        "optimum.toml, optimum.dxf, optimum.vtu (not verified with new particles: optimum" in said
    )
    assert sm.analyze(sm.build_seal(sm.read_seal_file(tmp_path / "optimum.toml"))).converged
