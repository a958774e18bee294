"""A free surface that is compressed beyond the onset of creases is reported."""

import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from ring_files import cylinder
from seal_file.block_files import read, text, with_model

import seal_mdao as sm
from seal_mdao.analysis.path_result import Status
from seal_mdao.cli.examples import examples_folder
from seal_mdao.seals import creases
from seal_mdao.seals.evaluation_points import EvaluationPoints

MOVED_Y = """
[fixed]
edges = ["base"]
directions = ["y"]
[[moved]]
edges = ["top"]
directions = ["y"]
stage = [{ translate = [0, -0.4], steps = 2 }]
[[moved]]
edges = ["left"]
directions = ["x"]
"""


def analysed(name):
    return sm.analyze(sm.build_seal(examples_folder() / f"{name}.toml"))


@pytest.fixture(scope="module")
def d_bulb():
    return analysed("d_bulb")


def test_creases_in_the_inner_corner_of_a_bulb_are_reported(d_bulb):
    """Beside the cavity, where its straight sides become the arc; quadratic bases fold there."""
    (text,) = (text for text in d_bulb.warnings if "forms creases" in text)
    stretch, x, y = map(
        float, re.search(r"to (\S+) of .* x = (\S+), y = (\S+) \(und", text).groups()
    )
    assert stretch == pytest.approx(0.545, abs=0.01)
    assert abs(abs(x) - 3.4) < 0.1
    assert 8.5 < y < 10.0
    assert d_bulb.trustworthy


def test_bulb_that_bends_less_has_no_creases():
    """Its most compressed side has a stretch of 0.81."""
    assert not creases.creases(EvaluationPoints(analysed("sealed_bulb").path))


def test_sides_between_supports_along_one_axis_are_no_free_surface():
    """Of the sides of four particles: one in a plane of symmetry, one that ends in it, and one between
    two planes."""
    fixed = np.array([[True, False], [True, False], [False, False], [False, True]])
    body = SimpleNamespace(fixed=fixed)
    samples = SimpleNamespace(path=SimpleNamespace(discretization=SimpleNamespace(body=body)))
    held = creases._held(samples, np.array([[0, 1], [1, 2], [0, 3]]))
    assert held.tolist() == [True, False, False]


@pytest.mark.parametrize(("height", "folded"), [(0.6, False), (0.54, True)])
def test_a_cylinder_forms_creases_below_its_own_stretch(tmp_path, height, folded):
    """Between smooth plates h = l^(-1/2), so that creases begin at l = 0.647^(4/3) = 0.56."""
    given = cylinder(travel=2.0 * (1.0 - height)).replace("steps = 4", "steps = 8")
    given = given.replace("bulk_modulus = 2e3", "bulk_modulus = 2e4")
    result = sm.analyze(sm.build_seal(read(tmp_path, given)))
    assert result.converged, result.failure
    said = creases.creases(EvaluationPoints(result.path))
    assert bool(said) == folded
    # the finite bulk modulus takes a little of h
    assert not folded or re.search(r"below 0\.5[56] rubber", said)


@pytest.mark.parametrize(
    ("keys", "model", "limit"),
    [
        ("", "", 0.647),
        ("", 'kinematics = "generalised_plane_strain"\naxial_stretch = 1.2', 0.647 / np.sqrt(1.2)),
        ("swelling = 1.2\n", "", 0.647 * np.sqrt(1.2)),
    ],
)
def test_growth_and_axial_stretch_change_the_limit(tmp_path, monkeypatch, keys, model, limit):
    """l / theta below 0.647 / (h / theta)^(1/2); the free side of a block is compressed to 0.9."""
    given = text(MOVED_Y, spacing=1.0).replace("c10 = 80.0\n", f"c10 = 80.0\n{keys}")
    result = sm.analyze(sm.build_seal(read(tmp_path, with_model(given, model) if model else given)))
    assert result.converged, result.failure
    for factor, folded in ((1.01, True), (0.99, False)):
        monkeypatch.setattr(creases, "CREASES", factor * 0.9 * 0.647 / limit)
        assert bool(creases.creases(EvaluationPoints(result.path))) == folded


def ended(result, steps):
    """The result of a path that ends early after a number of steps."""
    path = replace(
        result.path,
        steps=result.path.steps[:steps],
        status=Status.NOT_CONVERGED,
        failure="load step",
    )
    return replace(result, path=path)


def test_creases_are_the_cause_of_a_path_that_ends_in_them(d_bulb):
    """As that of the same section with finer particles does, whatever its load steps are."""
    failure = ended(d_bulb, len(d_bulb.path.steps)).failure
    words = r"the last converged load step the free surface is compressed to (\S+) of its"
    assert float(re.search(words, failure)[1]) == pytest.approx(0.545, abs=0.01)
    assert failure.endswith("use a larger radius at this point, or less travel")
    assert "more load steps" not in failure


@pytest.mark.parametrize("steps", [0, 5])
def test_a_path_that_ends_before_creases_has_other_advice(d_bulb, steps):
    failure = ended(d_bulb, steps).failure
    assert "creases" not in failure
    assert "Use more load steps" in failure


def test_surface_in_contact_forms_no_creases(d_bulb, monkeypatch):
    """The sides under the door touch it, those of the cavity do not."""
    samples = EvaluationPoints(d_bulb.path)
    chains = samples.chains
    touching = creases._touching(samples, chains, np.full(len(chains), 0.1))
    height = samples.places[chains[:, 2], 1]
    assert touching.any()
    assert height[touching].min() > 9.9
    monkeypatch.setattr(creases, "_touching", lambda *_: np.ones(len(chains), bool))
    assert not creases.creases(samples)
