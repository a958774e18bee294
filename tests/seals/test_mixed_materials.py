"""Checks of dense rubber beside foam: each material has its own thresholds."""

from dataclasses import replace

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals import checks, creases, local_states
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.structure.particle_stress import particle_stress

BLOCK = """
[material.foam]
sponge = "2A3"
[material.rubber]
shore_a = 60
[section]
material = "foam"
spacing = 0.5
outer = [
  { edge = "base", line = [[0, 0], [3, 0], [6, 0]] },
  { edge = "right", line = [[6, 0], [6, 4]] },
  { edge = "top", line = [[6, 4], [3, 4], [0, 4]] },
  { edge = "left", line = [[0, 4], [0, 0]] },
]
[[section.region]]
material = "rubber"
at = [1, 1]
line = [[3, 0], [3, 4]]
[fixed]
edges = ["base"]
directions = ["y"]
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{ translate = [0, -0.4], steps = 2 }]
[[moved]]
edges = ["HELD"]
directions = ["x"]
"""
"""Rubber on the left and foam on the right, compressed to 0.9 of their height between smooth plates."""


def compressed(folder, held):
    """The block with the displacement along x of one side prescribed."""
    path = folder / "block.toml"
    path.write_text(BLOCK.replace("HELD", held))
    result = sm.analyze(sm.build_seal(path))
    assert result.converged
    return result


@pytest.fixture(scope="module")
def block(tmp_path_factory):
    """The block with a free side of rubber."""
    return compressed(tmp_path_factory.mktemp("block"), "right")


def again(result):
    """The same result without the cached findings."""
    return replace(result, path=replace(result.path))


def test_rubber_beside_foam_forms_creases(block, monkeypatch):
    """At its own free side, of which the stretch is 0.9."""
    for limit, folded in ((0.89, False), (0.91, True)):
        monkeypatch.setattr(creases, "CREASES", limit)
        text = creases.creases(EvaluationPoints(block.path))
        assert bool(text) == folded
    assert "compressed to 0.9 of its length at x = 0, y = " in text


def test_foam_beside_rubber_forms_none(tmp_path, monkeypatch):
    monkeypatch.setattr(creases, "CREASES", 0.95)
    foam_side = compressed(tmp_path, "left")
    assert not creases.creases(EvaluationPoints(foam_side.path))


@pytest.mark.parametrize(
    ("limits", "name", "impossible"),
    [
        ({"SHALLOW_VOLUME": 0.95}, "", False),
        ({"SHALLOW_VOLUME": 1.1}, "rubber", False),
        ({"SHALLOW_VOLUME": 1.1, "NO_VOLUME": 1.1}, "rubber", True),
        ({"SOLID_VOLUME": 0.95}, "foam", False),
    ],
)
def test_volume_is_compared_with_the_threshold_of_its_own_material(
    block, monkeypatch, limits, name, impossible
):
    """det F of the foam is 0.9, that of the rubber 1."""
    for limit, value in limits.items():
        monkeypatch.setattr(checks, limit, value)
    found = [own for own in checks.findings(again(block).path) if "det F" in own.text]
    assert bool(found) == bool(name)
    assert all(own.text.startswith(f"material {name!r} is compressed") for own in found)
    assert all(own.impossible == impossible for own in found)


def test_stress_is_compared_with_the_modulus_of_its_own_material(block, monkeypatch):
    """A stress of 110 moduli of the foam at one point in it, 12 of those of the rubber."""
    structure = block.path.problem.term("structure")
    foam = structure.definition.regions[0].material.shear_modulus
    stress = particle_stress(block.path, np.arange(len(structure.sample_regions)))
    peak = np.flatnonzero(structure.sample_regions == 0)[7]
    high = np.where(np.arange(len(stress.value)) == peak, 110.0 * foam, stress.value)
    monkeypatch.setattr(local_states, "particle_stress", lambda *_: stress._replace(value=high))
    (own,) = local_states.meaningless_states(EvaluationPoints(block.path))
    assert "kPa, 110 times the shear modulus, at x = " in own[0]
    # the points around it are those of the foam, also beside the rubber
    assert f"but only {np.median(stress.value[structure.sample_regions == 0]):.3g} kPa" in own[0]
