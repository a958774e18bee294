"""Samples whose profile would begin inside of the seal are analysed, not left out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import FIXED, LID, seal_of

import seal_mdao as sm
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.eigenmodes import nearest_mode
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.scenarios.task import SealTask
from seal_mdao.seals.clear_start import with_clear_starts
from seal_mdao.seals.door.door_seal import with_options
from seal_mdao.seals.seal import Seal

BLOCK = """
[material.rubber]
law = "neo_hookean"
c10 = 100.0
bulk_modulus = 2e4
[section]
material = "rubber"
spacing = 1.0
outer = [
  { edge = "base", line = [[-4.0, 0.0], [4.0, 0.0]] },
  { edge = "right", line = [[4.0, 0.0], [4.0, 3.0]] },
  { edge = "top", arc = { start = [4.0, 3.0], through = [0.0, 5.0], end = [-4.0, 3.0] } },
  { edge = "left", line = [[-4.0, 3.0], [-4.0, 0.0]] },
]
[fixed]
edges = ["base"]
[[profile]]
name = "plate"
normal_penalty = 1e4
tangent_penalty = 1e2
friction = 0.2
contact = ["top"]
line = [[-40.0, 0.0], [40.0, 0.0]]
start = [0.0, 5.0]
stage = [%s]
[[measure]]
type = "reaction"
profile = "plate"
component = "y"
"""
DOWN = "{ translate = [0.0, -0.6], steps = 12 }"


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    pytest.importorskip("netgen")
    folder = tmp_path_factory.mktemp("block")

    def make(stages=DOWN, start=5.0) -> Seal:
        text = BLOCK.replace("start = [0.0, 5.0]", f"start = [0.0, {start}]")
        (folder / "seal.toml").write_text(text % stages)
        return sm.build_seal(folder / "seal.toml").with_placements()

    return make


def outcome(seal, offset=0.0, derivatives=False):
    task = SealTask(seal, seal.standard, ("plate_y",), "direct", derivatives)
    found = task.run(np.zeros(0), np.array([offset]))
    assert not found.failure, found.failure
    return found


@pytest.mark.parametrize("offset", [-0.05, -0.35])
def test_a_plate_that_begins_inside_gives_the_force_of_one_that_comes_from_afar(made, offset):
    """They differ by the first load step alone, which is longer: friction depends on the path."""
    near = outcome(made(), offset).values[0]
    far = outcome(made("{ translate = [0.0, -1.0], steps = 60 }", 5.4), offset).values[0]
    assert far > 10.0
    assert near == pytest.approx(far, rel=5e-3)


def test_a_plate_that_is_clear_keeps_its_bits(made):
    seal = made()
    for offset in (0.0, 0.2):
        own = seal.with_parameters({"plate_y": offset})
        assert with_clear_starts(own, own.particles()) is own


def test_derivatives_of_a_sample_that_backs_off(made):
    """Where the plate begins is the same for samples next to each other."""
    seal, h = made(), 1e-5
    slope = outcome(seal, -0.35, derivatives=True).gradient[0, -1]
    up, down = (outcome(seal, -0.35 + step).values[0] for step in (h, -h))
    assert slope == pytest.approx((up - down) / (2.0 * h), rel=1e-5)


@pytest.mark.parametrize(
    ("travel", "way"),
    [
        ((0.0, -1.0), (0.0, 1.0)),  # against its travel
        ((0.3, -1.0), (-0.3, 1.0)),
        ((0.0, 0.0), (0.0, 1.0)),  # stands still, turns, slides: along the normal
        ((2.0, 0.0), (0.0, 1.0)),
        ((0.0, 1.0), None),  # leads away from the body
    ],
)
def test_where_profiles_back_off_to(made, travel, way):
    seal = made()
    body, contact = seal.definitions[0], seal.definitions[1]
    motion = staged_motion([Stage(3, travel, 1.0)], start=(0.0, 4.8))
    inside = RigidContact(
        "plate", contact.where, contact.shape, motion, ContactLaw(1e4, 1e2, 0.2, True)
    )
    own = replace(seal, definitions=(body, inside), n_steps=3)
    found = with_clear_starts(own, own.particles())
    if way is None:
        assert found is own
        return
    clearance = found.definitions[1].motion.clearance
    assert np.abs(clearance / np.hypot(*clearance) - way / np.hypot(*way)).max() < 1e-3
    assert 0.2 < clearance[1] < 0.3
    pose = found.definitions[1].motion.pose(0.0)
    assert pose.position[1] > 5.0
    later = [own.definitions[1].motion.pose(k).position for k in (1, 2, 3)]
    again = [found.definitions[1].motion.pose(k).position for k in (1, 2, 3)]
    assert np.array_equal(later, again)


def test_the_door_of_the_door_seal_backs_off():
    seal = sm.door_seal(start=10.01, clearance=0.0, depth=2.0, n_steps=6)
    swollen = np.full(seal.n_offsets, 0.1)
    task = SealTask(seal, seal.measures(("reaction",)), ())
    found = task.run(swollen, np.zeros(0))
    assert not found.failure
    roomy = SealTask(with_options(seal, clearance=0.6), task.measures, ()).run(swollen, np.zeros(0))
    assert found.values == pytest.approx(roomy.values, rel=1e-3)


def test_means_that_begin_inside_with_their_particles_are_refused(tmp_path, monkeypatch):
    """By 1e-4 mm in a spacing of 1 mm, within which means of a curved edge may lie beside it."""
    lid = LID.replace("friction = 0.3", 'friction = 0.3\ncontact_points = "averages"')
    seal = seal_of(tmp_path, FIXED, lid).with_placements()
    words = r"overlaps the rigid profile 'lid' by 0\.0001 mm .* the parameters lid_x and lid_y\)"
    monkeypatch.setattr(type(seal), "clear_designs", False)
    with pytest.raises(sm.GeometryError, match=words):
        sm.analyze(seal, parameters={"lid_y": -0.0201})
    assert sm.analyze(seal, parameters={"lid_y": -0.0199}).converged


@pytest.mark.parametrize("symmetric", [True, False])
def test_mode_of_a_factor_without_numbers_is_none(symmetric):
    """The path fails with a message; ARPACK alone would end the analysis."""
    factor = SimpleNamespace(solve=lambda b: np.full_like(b, np.nan))
    value, mode = nearest_mode(factor, 30, symmetric)
    assert np.isnan(value)
    assert np.isnan(mode).all()


TOP = '[[design]]\nedges = ["top"]\nparameters = 3\nbound = 0.5\n'


def test_a_design_that_grows_into_a_profile_begins_farther_back(tmp_path):
    """An edge that nearly touches at the start moves by 0.1 mm; a nominal seal inside is refused."""
    smooth = LID.replace("friction = 0.3", "friction = 0.0")
    seal = seal_of(tmp_path, FIXED, smooth, TOP)
    grown = np.full(seal.n_offsets, 0.1)
    result = sm.analyze(seal, grown, keep_factors=True)
    assert result.converged
    clearance = result.seal.definitions[1].motion.clearance
    assert clearance[1] >= 0.08
    assert seal.definitions[1].motion.clearance == pytest.approx((0.0, 0.0))
    # the same force as with a lid that begins farther away and ends at the same place
    higher = smooth.replace("4.02]", "4.22]").replace("-0.5], steps = 3", "-0.7], steps = 4")
    other = sm.analyze(seal_of(tmp_path, FIXED, higher, TOP), grown)
    assert result.reaction[-1] == pytest.approx(other.reaction[-1], rel=1e-6, abs=1e-6)
    # the derivatives are those of this path
    gradient = sm.differentiate(result, (), method="adjoint")["reaction"].ravel()
    step = 1e-4
    for place in range(seal.n_offsets):
        ends = [
            sm.analyze(seal, grown + sign * step * np.eye(seal.n_offsets)[place]).reaction[-1, 1]
            for sign in (1.0, -1.0)
        ]
        assert gradient[place] == pytest.approx((ends[0] - ends[1]) / (2.0 * step), rel=1e-5)


@pytest.mark.filterwarnings("ignore:.*the result is not trustworthy")
def test_a_profile_placed_inside_begins_farther_back(tmp_path):
    """In an analysis, in both groups, and with the derivatives of this path."""
    seal, lowest = seal_of(tmp_path, FIXED, LID, TOP), -0.3
    higher = LID.replace("4.02]", "4.22]").replace("-0.5], steps = 3", "-1.0], steps = 6")
    result = sm.analyze(seal.with_placements(), parameters={"lid_y": lowest})
    assert result.seal.definitions[1].motion.clearance[1] >= 0.28
    far = sm.analyze(seal_of(tmp_path, FIXED, higher, TOP))
    assert result.reaction[-1, 1] == pytest.approx(far.reaction[-1, 1], rel=0.01)
    # the group gives the seal the parameter that it lacks; a cached result has the other start
    cache = sm.AnalysisCache()
    alone = om.Problem(sm.SealGroup(seal=seal, parameters=("lid_y",), cache=cache), reports=None)
    alone.setup()
    alone.set_val("lid_y", lowest)
    alone.run_model()
    assert alone.get_val("reaction") == pytest.approx(result.reaction[-1, 1], rel=1e-15)
    settings = seal.with_placements().settings()
    assert alone.model.options["seal_settings"] == [settings]
    again = cache.analyze(seal.with_placements(), parameters={"lid_y": lowest})
    assert cache.made == 1 + seal.standard[0].selects_points
    assert again.seal.definitions[1].motion.clearance[1] >= 0.28
    shifted = sm.Scenarios((sm.Variation("lid_y", "shift"),), np.array([[0.0], [lowest]]))
    many = om.Problem(sm.ScenarioGroup(seal=seal, scenarios=shifted, workers=0), reports=None)
    many.setup()
    many.run_model()
    assert many.get_val("reaction_scenarios")[1].tobytes() == alone.get_val("reaction").tobytes()
    slope = alone.compute_totals(["reaction"], ["lid_y"], return_format="array").item()
    h = 1e-5
    up, down = (
        sm.analyze(seal.with_placements(), parameters={"lid_y": lowest + own}).reaction[-1, 1]
        for own in (h, -h)
    )
    assert slope == pytest.approx((up - down) / (2.0 * h), rel=1e-5)
    # names that no placement has are refused as before
    wrong = om.Problem(sm.SealGroup(seal=seal, parameters=("lid_z",)), reports=None)
    with pytest.raises(ValueError, match=r"unknown parameter 'lid_z'.*, lid_y"):
        wrong.setup()
