"""seal-mdao robust with a seal file: optimisation, comparison and report as of the door seal."""

import json
import re
import sqlite3

import numpy as np
import pytest
from coarse_seal import written

TOLERANCES = """
[vary.door_friction]
distribution = "uniform"
low = 0.15
high = 0.35
[vary.door_x]
distribution = "normal"
mean = 0.0
std = 0.1
[boundary]
std = 0.02
length = 6.0
"""


@pytest.fixture(scope="module")
def robust(run_script, tmp_path_factory):
    folder = tmp_path_factory.mktemp("robust")
    (folder / "tolerances.toml").write_text(TOLERANCES)
    arguments = (
        written(folder), "--tolerances", folder / "tolerances.toml", "--scenarios", 2,
        "--samples", 4, "--max-iterations", 2, "--workers", 1,
    )  # fmt: skip
    out = folder / "out"
    code, s = run_script("robust", out, *arguments)
    return out, code, s, arguments


def test_robust_optimum_of_a_seal_file_on_fresh_samples(robust, assert_drawn):
    out, _, s, _ = robust
    nominal, best = (s["compared"][f"{name} optimum"] for name in ("nominal", "robust"))
    assert nominal["samples"] == best["samples"] == 4
    assert best["section_area"]["std"] > 0.0  # boundaries scatter
    assert 0.0 <= best["share_reaction_1"] <= 1.0
    assert s["limits"] == [["reaction", 15.0, 18.0]]
    assert np.shape(s["boundary_offsets"]) == np.shape(s["nominal"]["boundary_offsets"]) == (4,)
    assert_drawn(out, "comparison")


def test_report_shows_the_robust_design_of_a_seal_file(robust):
    out, _, _, _ = robust
    page = (out / "report.html").read_text(encoding="utf-8")
    assert "On 4 new samples of all tolerances" in page
    assert "reaction at least 15 and at most 18" in page
    shapes = json.loads(re.search(r'id="report-data">(.*?)</script>', page, re.DOTALL)[1])["shapes"]
    assert [own["name"] for own in shapes["paths"][1]["curves"]] == ["door"]


def test_robust_run_of_a_seal_file_goes_on_in_another_folder(robust, run_script, tmp_path):
    out, _, s, arguments = robust
    _, again = run_script("robust", tmp_path, "--restart", out / "cases.sql", *arguments)
    assert not (tmp_path / "nominal.sql").exists()
    assert again["reused_evaluations"] > 0
    assert again["boundary_offsets"] == s["boundary_offsets"]
    assert again["compared"] == s["compared"]


def test_a_continued_run_has_the_best_of_all_recorded_designs(robust, run_script, tmp_path):
    """In the same folder, whose samples are those of another optimum."""
    own = list(robust[3])
    limit = own.index("--max-iterations") + 1
    ended = []
    for count in (1, 4, 1):
        own[limit] = count
        code, s = run_script("robust", tmp_path, *own)
        assert code in (0, 1)
        samples = sqlite3.connect(tmp_path / "robust.sqlite")
        (label,) = samples.execute("SELECT value FROM study WHERE key = 'design'").fetchone()
        samples.close()
        end = s["history"][-1]
        assert end["max_constraint_violation"] < 1e-5
        ended.append((label, end["objective_ratio"]))
    assert ended[0][0] != ended[1][0]
    # a lower limit does not lose the better designs of the run before
    assert ended[2][1] < ended[0][1]
    assert ended[2][1] == pytest.approx(ended[1][1], rel=1e-5)


def test_options_of_the_door_seal_are_refused(robust, run_script, tmp_path, capsys):
    with pytest.raises(SystemExit):
        run_script("robust", tmp_path, *robust[3], "--depth", 3.0)
    assert "--depth is an option of the built-in door seal" in capsys.readouterr().err
