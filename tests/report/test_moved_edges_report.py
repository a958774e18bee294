"""Report of a seal without profiles, whose edges are moved."""

import json
import re

import numpy as np
import pytest

from seal_mdao.cli.subcommands import main

FILE = """
[material.rubber]
law = "mooney_rivlin"
c10 = 200.0
c01 = 50.0
bulk_modulus = 250000.0
[section]
material = "rubber"
spacing = 2.5
outer = [
  { edge = "base", line = [[-6.0, 0.0], [6.0, 0.0]] },
  { edge = "right", line = [[6.0, 0.0], [6.0, 6.0]] },
  { edge = "top", line = [[6.0, 6.0], [-6.0, 6.0]] },
  { edge = "left", line = [[-6.0, 6.0], [-6.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[moved]]
edges = ["top"]
stage = [{ translate = [0.0, -0.6], steps = 3 }]
[[design]]
edges = ["right", "left"]
parameters = 4
bound = 0.2
[[measure]]
type = "reaction"
edges = ["top"]
component = "y"
[optimize]
minimize = "section_area"
[[optimize.constraint]]
measure = "reaction"
lower = 100.0
"""


@pytest.fixture(scope="module")
def out(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pad")
    (folder / "pad.toml").write_text(FILE, encoding="utf-8")
    arguments = ["optimize", str(folder / "pad.toml"), "--max-iterations", "2"]
    main([*arguments, "--out", str(folder / "out")])
    return folder / "out"


def test_the_force_on_moved_edges_is_in_the_data(out):
    text = (out / "report.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="report-data">(.*?)</script>', text, re.DOTALL)[1])
    start = data["shapes"]["paths"][0]
    (curves,) = start["curves"]
    assert (curves["name"], curves["arc"], curves["words"]) == ("top", [], "travel (mm)")
    assert curves["along"] == pytest.approx([0.2, 0.4, 0.6])
    force = np.array(curves["reaction"])[:, 1]
    assert (np.diff(force) > 100.0).all()


def test_the_page_shows_the_force_and_no_charts_of_contact(out, browser):
    browser.get((out / "report.html").as_uri())
    hidden = {
        name: browser.execute_script(
            "return document.getElementById(arguments[0]).closest('[hidden]') !== null", name
        )
        for name in ("profile", "pressure", "gap", "reaction")
    }
    assert hidden == {"profile": True, "pressure": True, "gap": True, "reaction": False}
    assert "N/m" in browser.execute_script(
        "return document.getElementById('start-text').textContent"
    )
    assert browser.get_log("browser") == []
