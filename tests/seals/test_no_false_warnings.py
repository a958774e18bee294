"""States that are admissible, of which older versions warned."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.accuracy.force_error import force_error

RUBBER = '[material.rubber]\nlaw = "neo_hookean"\nc10 = 300.0\nbulk_modulus = 1e5\n'
SQUARE = """[section]
material = "rubber"
spacing = 0.9
outer = [
  { edge = "base", line = [[0, 0], [4, 0]] }, { edge = "right", line = [[4, 0], [4, 4]] },
  { edge = "top", line = [[4, 4], [0, 4]] }, { edge = "left", line = [[0, 4], [0, 0]] },
]
"""
HEATED = "[model]\ntemperature = [80]\n" + RUBBER + "expansion = 2e-4\n"
SMOOTH = '[fixed]\nedges = ["base"]\ndirections = ["y"]\n'
HALF = SMOOTH + '[[symmetry]]\nedges = ["left"]\nnormal = "x"\n'
LID = '[[profile]]\nname = "lid"\nfriction = {}\ncontact = ["top"]\nline = [[-30, {}], [30, {}]]\n'


@pytest.fixture
def warnings(tmp_path):
    def analyse(text):
        path = tmp_path / "seal.toml"
        path.write_text(text)
        result = sm.analyze(sm.build_seal(path))
        assert result.converged, result.failure
        return result, " ".join(result.warnings)

    return analyse


def test_free_expansion_is_in_equilibrium(warnings):
    """All forces are rounding errors."""
    lid = LID.format(0.0, 4.5, 4.5) + "stage = [{ translate = [0, -0.1], steps = 2 }]\n"
    result, found = warnings(HEATED + SQUARE + HALF + lid)
    assert "equilibrium" not in found
    assert result.trustworthy


def test_a_seal_that_is_released_has_not_buckled(warnings):
    stages = "stage = [{ translate = [0, -0.3], steps = 3 }, { translate = [0, 0.5], steps = 3 }]\n"
    _, found = warnings(
        RUBBER + SQUARE + '[fixed]\nedges = ["base"]\n' + LID.format(0.2, 4, 4) + stages
    )
    assert "buckled" not in found


def test_steps_of_a_seal_that_is_released_and_leaks(warnings):
    """Its leak rate is infinite with any load steps."""
    stages = "stage = [{ translate = [0, -0.3] }, { translate = [0, 0.5] }]\n"
    leak = """[[measure]]
type = "leak_rate"
rms_roughness = 5.0
roll_off_wavelength = 500.0
shortest_wavelength = 1.0
pressure = 10.0
"""
    text = RUBBER + SQUARE + '[fixed]\nedges = ["base"]\n' + LID.format(0.2, 4, 4) + stages + leak
    result, _ = warnings(text)
    assert np.isinf(result.value(result.measures()[0]))


def test_a_bonded_profile_touches_the_seal(warnings):
    bonded = LID.format(0.2, 4, 4).replace(
        'contact = ["top"]', 'glued = ["top"]\ncontact = ["right"]'
    )
    stage = "stage = [{ translate = [0, -0.2], steps = 2 }]\n"
    _, found = warnings(RUBBER + SQUARE + '[fixed]\nedges = ["base"]\n' + bonded + stage)
    assert "touches the seal" not in found


def test_a_block_that_expands_between_walls_does_not_penetrate_them(warnings):
    """Its displacements are the penetrations alone, far below those of free expansion."""
    walls = "".join(
        f'[[moved]]\nedges = ["{name}"]\ndirections = ["x"]\n' for name in ("left", "right")
    )
    walls = walls.replace('["x"]\n', '["x"]\nstage = [{ steps = 4 }]\n', 1)
    result, found = warnings(HEATED + SQUARE + SMOOTH + walls + LID.format(0.0, 4, 4))
    assert result.response("lid").force.any()
    assert "inside the rigid profile" not in found


def test_a_plane_of_symmetry_is_no_free_surface(warnings):
    """A smooth inclined plate compresses it to 0.62 of its height, and the free side to 0.72."""
    stage = "stage = [{ translate = [0, -1.5], steps = 8 }]\n"
    _, found = warnings(RUBBER + SQUARE + HALF + LID.format(0.0, 1.0, 7.0) + stage)
    assert "free surface" not in found


def test_a_seal_does_not_sink_below_a_base_that_is_moved(warnings):
    """The base carries its plane with it, down and turned."""
    moved = '[[moved]]\nedges = ["base"]\npivot = [2, 0]\n'
    moved += "stage = [{ translate = [0.5, -1.0], rotate = 30, steps = 4 }]\n"
    _, found = warnings(RUBBER + SQUARE + moved)
    assert "sinks" not in found


def test_a_seal_that_sinks_on_a_profile_below_its_base_is_supported(warnings):
    """A lid bends a beam beside its base down to the profile, which is the support there."""
    beam = """[section]
spacing = 0.5
outer = [
  { edge = "base", line = [[0, 0], [4, 0]] }, { edge = "below", line = [[4, 0], [12, 0]] },
  { edge = "right", line = [[12, 0], [12, 2]] }, { edge = "top", line = [[12, 2], [0, 2]] },
  { edge = "left", line = [[0, 2], [0, 0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "roll"
friction = 0.2
contact = ["top"]
circle = { centre = [11, 4.5], radius = 2.5 }
stage = [{ translate = [0, -1.2], steps = 6 }]
"""
    sill = '[[profile]]\nname = "sill"\nfriction = 0.2\ncontact = ["below"]\n'
    _, found = warnings(RUBBER + beam)
    assert "the seal sinks" in found
    result, found = warnings(RUBBER + beam + sill + "line = [[30, -0.8], [-30, -0.8]]\n")
    assert result.response("sill").force.any()
    assert "the seal sinks" not in found


def test_forces_of_rounding_have_no_error(warnings, tmp_path):
    """A seal is moved past a profile that it does not touch."""
    moved = '[[moved]]\nedges = ["base"]\nstage = [{ translate = [0.3, -1.0] }]\n'
    result, found = warnings(RUBBER + SQUARE + moved + LID.format(0.2, 5.3, 5.3))
    assert result.path.reaction("base").any()
    assert "load steps cause" not in found
    error = force_error(sm.read_seal_file(tmp_path / "seal.toml"), result)
    assert error.unknown == "no force acts on a profile or on moved edges"


def test_a_boundary_in_self_contact_that_crosses_nowhere(warnings):
    touching = '[self_contact]\nedges = ["right", "top"]\nfriction = 0.2\n'
    stage = "stage = [{ translate = [0, -0.2], steps = 2 }]\n"
    text = RUBBER + SQUARE + '[fixed]\nedges = ["base"]\n' + touching
    _, found = warnings(text + LID.format(0.2, 4, 4) + stage)
    assert "crosses" not in found
