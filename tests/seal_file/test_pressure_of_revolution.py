"""Seal files of bodies of revolution with fluids and cavities."""

from pathlib import Path

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.errors import SealFileError

DISC = """
[model]
kinematics = "axisymmetric"
[material.rubber]
law = "mooney_rivlin"
c10 = 500.0
c01 = 125.0
bulk_modulus = 400000.0
[section]
material = "rubber"
spacing = 0.5
outer = [
  { edge = "base", line = [[0, 0], [6, 0]] }, { edge = "right", line = [[6, 0], [6, 4]] },
  { edge = "top", line = [[6, 4], [0, 4]] }, { edge = "axis", line = [[0, 4], [0, 0]] },
]
[[section.hole]]
edge = "hole"
circle = { centre = [3.0, 2.0], radius = 1.0 }
[fixed]
edges = ["base"]
[[profile]]
name = "lid"
friction = 0.1
contact = ["right", "top"]
line = [[-9, 0], [9, 0]]
start = [0, 4]
normal_penalty = 1e4
tangent_penalty = 1e3
stage = [{ translate = [0, -0.2], steps = 2 }, { steps = 2 }]
[[cavity]]
hole = 1
[[fluid]]
edge = "EDGE"
from = "start"
pressure = 50.0
"""


def read(tmp_path, edge) -> sm.SealFile:
    path = Path(tmp_path) / "disc.toml"
    path.write_text(DISC.replace("EDGE", edge), encoding="utf-8")
    return sm.read_seal_file(path)


def test_a_disc_with_a_cavity_under_a_fluid(tmp_path):
    """Air in a hole and a fluid around the disc at once."""
    result = sm.analyze(sm.build_seal(read(tmp_path, "right")))
    assert result.converged, result.failure
    pressure, volume = result.response("air").outputs[0]
    # 2 pi R A of a circle of 1 mm at R = 3, in m mm^2
    assert pressure > 1.0
    assert 0.8 < volume / (6e-3 * np.pi**2) < 1.0


def test_a_fluid_on_the_axis_is_refused(tmp_path):
    with pytest.raises(
        SealFileError,
        match=r"\[\[fluid\]\] 1: edge contains the edge 'axis', which lies on the axis",
    ):
        read(tmp_path, "axis")
