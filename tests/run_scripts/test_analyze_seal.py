"""seal-mdao analyze: numbers of the analysis, files that hold them, errors in one line."""

import csv
import json

import meshio
import numpy as np
import pytest
from coarse_seal import OPEN, written
from ring_files import cylinder

import seal_mdao as sm
from seal_mdao import mesh_files
from seal_mdao.report.html_tables import measures

FIGURES = ("section", "deformed_shapes", "load_deflection", "contact_pressure", "contact_width")

LIMITED = {
    'law = "mooney_rivlin"\nc10 = 80.0\nc01 = 20.0': (
        'law = "gent"\nshear_modulus = 200.0\nlimit = 0.05\nstable = [0.99, 1.01]'
    ),
}
"""A rubber that hardly stretches."""


@pytest.fixture(scope="module")
def analysed(run_script, tmp_path_factory):
    """Folder, exit code, summary, and the same analysis made here."""
    out = tmp_path_factory.mktemp("seal")
    path = written(out)
    code, summary = run_script("analyze", out, path)
    return out, code, summary, sm.analyze(sm.build_seal(sm.read_seal_file(path)), keep_factors=True)


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def test_summary_is_the_analysis(analysed):
    _, code, s, result = analysed
    assert code == 0
    assert s["converged"] is True
    assert s["n_particles"] == len(result.particles)
    assert s["newton_iterations"] == result.newton_iterations.tolist()
    assert s["step_cuts"] == result.step_cuts
    table = np.array(s["reaction_N_per_m"]["door"])
    assert table[:, 0].tolist() == [1, 1, 1, 1, 2, 2]
    assert table[:, 1] == pytest.approx([0.3, 0.6, 0.9, 1.2, 0.2, 0.4], abs=1e-12)
    assert table[:, 2:] == pytest.approx(result.path.reaction("door"), rel=1e-9, abs=1e-9)
    gap = result.response("door").gap
    assert s["max_penetration_mm"] == pytest.approx(-gap.min(), rel=1e-9)
    assert s["nominal_peak_pressure_kPa"] == pytest.approx(-1e4 * gap.min(), rel=1e-9)
    term = result.term("door")
    stretch = term.where.lengths(result.deformed()) / term.length
    assert s["true_peak_pressure_kPa"] == pytest.approx((-1e4 * gap / stretch).max(), rel=1e-9)
    assert s["deformed_contact_width_mm"] == pytest.approx(
        s["measures"]["contact_width"]["value"], rel=1e-12
    )
    assert s["largest_gap_mm"] == s["profiles"]["door"]["largest_gap_mm"] == 0.0
    assert s["largest_von_mises_kPa"] == pytest.approx(result.section_stress()[1].max(), rel=1e-9)
    assert s["area_mm2"] == pytest.approx(s["measures"]["section_area"]["value"], rel=1e-12)
    assert 0.5 < s["min_det_F"] < 1.0
    assert s["failure"] is None
    assert s["wall_s"] > 0.0


def test_gradients_by_the_other_method(analysed):
    """The script's adjoint ones against direct ones; both are exact, so rounding is what is left."""
    _, _, s, result = analysed
    names = tuple(result.seal.scalars)
    direct = sm.differentiate(result, names, method="direct")
    assert list(s["measures"]) == ["contact_width", "section_area", "reaction"]
    for name, found in s["measures"].items():
        row = np.ravel(direct[name])
        shape, others = row[:4], row[4:]
        assert found["gradient_norm"] == pytest.approx(np.linalg.norm(shape), rel=1e-7)
        assert list(found["derivatives"]) == list(names)
        assert list(found["derivatives"].values()) == pytest.approx(others, rel=1e-6, abs=1e-12)
    assert s["measures"]["reaction"]["unit"] == "N/m"


def test_the_place_of_the_thinnest_wall_is_told(run_script, tmp_path, capsys):
    """In summary.json, on the console and in the report's table of a design."""
    thin = {
        'type = "contact_width"\nprofile = "door"': 'type = "wall_thickness"',
        "centre = [0.0, 7.0]": "centre = [0.3, 7.0]",
    }
    path = written(tmp_path, thin)
    _, s = run_script("analyze", tmp_path, path)
    found = s["measures"]["wall_thickness"]
    result = sm.analyze(sm.build_seal(path))
    assert found["at_mm"] == pytest.approx(result.measure("wall_thickness").place(result))
    # on the side to which the hole has moved, beyond it
    assert found["at_mm"][0] > 0.3
    assert np.hypot(*np.subtract(found["at_mm"], [0.3, 7.0])) > 4.5
    x, y = found["at_mm"]
    at = f"at x = {x:.3g}, y = {y:.3g} (undeformed coordinates)"
    said = f"wall_thickness = {found['value']:.6g} mm, {at}"
    shown_lines = capsys.readouterr().out
    assert said in shown_lines
    assert "estimated numerical error due to the contact penalties alone: at most " in shown_lines
    shown = measures(result)
    assert shown["wall thickness, at x"] == ("mm", pytest.approx(x))
    assert shown["wall thickness, at y"] == ("mm", pytest.approx(y))
    assert "at_mm" not in s["measures"]["reaction"]


def test_figures_are_drawn(analysed, assert_drawn):
    assert_drawn(analysed[0], *FIGURES)


def test_curves_are_in_the_tables(analysed):
    out, _, s, result = analysed
    curve = rows(out / "curve_door.csv")
    table = np.array(s["reaction_N_per_m"]["door"])
    assert [float(row["Fy_N_per_m"]) for row in curve] == pytest.approx(table[:, 3], rel=1e-9)
    assert [float(row["Fy_N_per_100mm"]) for row in curve] == pytest.approx(
        0.1 * table[:, 3], rel=1e-9
    )
    assert [float(row["y_mm"]) for row in curve] == pytest.approx(
        [14.15, 13.85, 13.55, 13.25, 13.45, 13.65]
    )
    for column in ("true_peak_pressure_kPa", "deformed_contact_width_mm"):
        assert float(curve[-1][column]) == pytest.approx(s[column], rel=1e-9)
    for column in ("peak_pressure_kPa", "contact_width_mm"):
        assert float(curve[-1][column]) == pytest.approx(s[f"nominal_{column}"], rel=1e-9)
    last = [row for row in rows(out / "contact_door.csv") if row["step"] == "6"]
    answer = result.response("door")
    assert [float(row["gap_mm"]) for row in last] == pytest.approx(answer.gap, rel=1e-9)
    touching = [row["state"] != "open" for row in last]
    assert touching == (answer.state != 0).tolist()
    for column in ("true_pressure_kPa", "pressure_kPa"):
        assert [float(row[column]) > 0.0 for row in last] == touching
    assert max(float(row["true_pressure_kPa"]) for row in last) == pytest.approx(
        s["true_peak_pressure_kPa"], rel=1e-9
    )


def test_paraview_series_holds_the_fields(analysed):
    out, _, _, result = analysed
    series = json.loads((out / "vtu" / "steps.vtu.series").read_text())
    assert [entry["time"] for entry in series["files"]] == list(range(7))
    last = meshio.read(out / "vtu" / series["files"][-1]["name"])
    assert last.points[:, :2] == pytest.approx(result.particles)
    assert last.point_data["displacement"][:, :2] == pytest.approx(result.displacement())
    assert last.point_data["von_mises"] == pytest.approx(result.stress_field())
    assert last.point_data["nominal_pressure_door"].max() == pytest.approx(
        -1e4 * result.response("door").gap.min()
    )
    term = result.term("door")
    carried = last.point_data["pressure_door"][term.where.points.anchors[:, 0]]
    normal = last.point_data["nominal_pressure_door"][term.where.points.anchors[:, 0]] * term.length
    assert carried * term.where.lengths(result.deformed()) == pytest.approx(normal, rel=1e-9)
    cells = {block.type: block.data for block in last.cells}
    assert sum(map(len, cells.values())) == len(result.seal.body.cells)
    first = meshio.read(out / "vtu" / series["files"][0]["name"])
    assert set(first.point_data) == set(last.point_data)
    assert not first.point_data["displacement"].any()


def test_triangles_repeat_a_corner_anywhere():
    cells = np.array([[0, 1, 2, 3], [4, 4, 5, 6], [7, 8, 8, 9], [10, 11, 12, 10]])
    found = mesh_files.cell_blocks(cells)
    blocks = {kind: corners for kind, corners, _ in found}
    assert blocks["quad"].tolist() == [[0, 1, 2, 3]]
    assert [sorted(row) for row in blocks["triangle"].tolist()] == [
        [4, 5, 6],
        [7, 8, 9],
        [10, 11, 12],
    ]
    assert [numbers.tolist() for *_, numbers in found] == [[0], [1, 2, 3]]


def test_without_meshio(tmp_path, run_script, monkeypatch, capsys):
    def missing(name):
        raise ImportError(name)

    monkeypatch.setattr(mesh_files, "import_module", missing)
    path = written(tmp_path, {"steps = 4": "steps = 1", "-1.2": "-0.2", "steps = 2": "steps = 1"})
    code, _ = run_script("analyze", tmp_path / "asked", path, "--vtu")
    assert code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "seal_mdao[vtk]" in line
    code, s = run_script("analyze", tmp_path / "left_out", path)
    assert code == 0
    assert "seal_mdao[vtk]" in capsys.readouterr().out
    assert s["true_peak_pressure_kPa"] == 0.0  # it has not been touched


def test_path_that_fails_is_written_as_far_as_it_went(tmp_path, run_script, assert_drawn, capsys):
    path = written(tmp_path, {"[0.0, -1.2]": "[0.0, -14.2]"})
    code, s = run_script("analyze", tmp_path, path, "--no-vtu")
    assert code == 1
    assert s["converged"] is False
    assert "could not be completed" in s["failure"]
    assert 0 < s["n_steps"] < 6
    assert len(s["reaction_N_per_m"]["door"]) == s["n_steps"]
    assert s["measures"] == {"contact_width": None, "section_area": None, "reaction": None}
    assert s["true_peak_pressure_kPa"] is None
    assert "NOT CONVERGED" in capsys.readouterr().out
    assert not (tmp_path / "vtu").exists()
    assert_drawn(tmp_path, *FIGURES)


def test_load_steps_are_chosen_where_the_file_gives_none(tmp_path, run_script, capsys):
    path = written(tmp_path, OPEN)
    code, s = run_script("analyze", tmp_path, path, "--no-vtu")
    assert code == 0
    said = capsys.readouterr().out
    assert (
        f"{s['n_steps']} load steps, chosen for an estimated numerical error of at most 0.50%"
        in said
    )
    seal = sm.build_seal(sm.read_seal_file(path))
    assert s["n_steps"] == seal.n_steps
    result = sm.analyze(seal)
    assert s["reaction_N_per_m"]["door"][-1][2:] == pytest.approx(
        result.path.reaction("door")[-1], rel=1e-9
    )


def test_a_rubber_at_its_limit_is_drawn(tmp_path, run_script, assert_drawn):
    """Between quadrature points, where no equation keeps it below, it has no stress: status 1."""
    changes = OPEN | LIMITED | {"[0.0, -1.2]": "[0.0, -6.0]"}
    code, s = run_script("analyze", tmp_path, written(tmp_path, changes), "--no-vtu")
    assert (code, s["converged"], s["trustworthy"]) == (1, True, False)
    assert_drawn(tmp_path, *FIGURES)


def test_a_path_on_which_no_load_steps_are_found_is_written_as_far_as_it_went(
    tmp_path, run_script, assert_drawn, capsys, monkeypatch
):
    monkeypatch.setattr("seal_mdao.seals.steps_and_penalties.MOST", 1)
    changes = OPEN | LIMITED | {"[0.0, -1.2]": "[0.0, -9.0]"}
    code, s = run_script("analyze", tmp_path, written(tmp_path, changes), "--no-vtu")
    assert code == 1
    assert s["converged"] is False
    assert 0 < s["n_steps"] < 10
    assert "could not be completed" in s["failure"]
    assert "NOT CONVERGED" in capsys.readouterr().out
    assert_drawn(tmp_path, *FIGURES)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"friction = 0.25": "friction = -1.0"}, ("friction = -1.0", "[[profile]] 1")),
        ({"radius = 4.5": "radius = 9.5"}, ("cavity",)),
        ({"start = [0.0, 14.45]": "start = [0.0, 12.5]"}, ("inside", "door")),
        ({'contact = ["seal"]': 'contact = ["sael"]'}, ("did you mean 'seal'",)),
    ],
)
def test_bad_files_take_one_line(changes, words, tmp_path, run_script, capsys):
    code, summary = run_script("analyze", tmp_path, written(tmp_path, changes))
    assert (code, summary) == (2, None)
    (line,) = capsys.readouterr().err.splitlines()
    assert str(tmp_path / "seal.toml") in line
    assert all(word in line for word in words)


def test_file_that_is_not_there(tmp_path, run_script, capsys):
    code, _ = run_script("analyze", tmp_path, tmp_path / "nowhere.toml")
    assert code == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "there is no such file" in line


def test_input_file_of_abaqus(tmp_path, run_script, capsys):
    path = written(tmp_path, {"[fixed]": "[[cavity]]\nhole = 1\n[fixed]"})
    code, _ = run_script("analyze", tmp_path / "out", path, "--abaqus", "--no-vtu")
    assert code == 0
    said = capsys.readouterr().out
    assert "WARNING: not exported to seal.inp: [[cavity]] of hole 1: trapped air" in said
    text = (tmp_path / "out" / "seal.inp").read_text()
    assert text.count("*STEP, NAME=STAGE_") == 2
    # as many increments as load steps
    assert "*STATIC\n0.25, 1." in text
    assert "(mm, kPa; forces in N/m)" in said
    (tmp_path / "ring.toml").write_text(cylinder())
    assert run_script("analyze", tmp_path, tmp_path / "ring.toml", "--abaqus", "--no-vtu")[0] == 0
    assert "(mm, kPa; forces in mN)" in capsys.readouterr().out


def test_a_law_that_abaqus_does_not_have_is_refused_before_the_analysis(
    tmp_path, run_script, monkeypatch, capsys
):
    path = written(tmp_path, LIMITED)
    monkeypatch.setattr(sm, "analyze", lambda *a, **k: pytest.fail("analysed"))
    assert run_script("analyze", tmp_path / "out", path, "--abaqus") == (2, None)
    assert (
        "[material.rubber]: the material law Gent has no counterpart in Abaqus"
        in capsys.readouterr().err
    )
