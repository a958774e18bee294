"""Pictures of a section of two rubbers have a colour scale for each."""

import numpy as np
import pytest
from test_report_data import unpacked

import seal_mdao as sm
from seal_mdao.plotting.field import fine_grid
from seal_mdao.report.picture_data import FULL, Pictures

TEXT = """
[material.soft]
shore_a = 40
[material.stiff]
shore_a = 70
[section]
material = "soft"
spacing = 1.0
region = [{ material = "stiff", at = [1.0, 0.5], line = [[0.0, 2.0], [6.0, 2.0]] }]
outer = [
  { edge = "base", line = [[0.0, 0.0], [6.0, 0.0]] },
  { edge = "right", line = [[6.0, 0.0], [6.0, 2.0], [6.0, 4.0]] },
  { edge = "top", line = [[6.0, 4.0], [0.0, 4.0]] },
  { edge = "left", line = [[0.0, 4.0], [0.0, 2.0], [0.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
friction = 0.2
normal_penalty = 1e4
tangent_penalty = 1e2
contact = ["top"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 4.0]
stage = [{ translate = [0.0, -0.2], steps = 2 }]
"""


@pytest.fixture(scope="module")
def result(tmp_path_factory):
    path = tmp_path_factory.mktemp("block") / "block.toml"
    path.write_text(TEXT)
    return sm.analyze(sm.build_seal(path))


def test_every_rubber_has_its_colours_and_the_end_of_its_scale(result):
    data = Pictures(result, result, [result]).as_data()
    soft, stiff = data["scales"]
    assert (soft["name"], stiff["name"]) == ("soft", "stiff")
    assert soft["colours"] != stiff["colours"]
    assert soft["top"] < stiff["top"]
    packed = data["paths"][0]["frames"][-1]["points"]
    points, regions = unpacked(packed, -1, 3), np.array(data["regions"])
    tops = np.array([soft["top"], stiff["top"]])
    fine = fine_grid(result, round(np.sqrt(600 / len(result.seal.body.cells))))
    np.testing.assert_allclose(points[:, 2] * tops[regions] / FULL, fine.von_mises(), atol=0.05)
