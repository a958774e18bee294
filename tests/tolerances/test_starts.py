"""Samples whose profile would begin inside of the seal are analysed, not left out."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import openmdao.api as om
import pytest
from seal_file.block_files import FIXED, LID, seal_of

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.eigenmodes import nearest_mode
from seal_mdao.geometry.motion import Stage, staged_motion
from seal_mdao.plotting.several_seals import force_against_travel
from seal_mdao.scenarios.task import SealTask
from seal_mdao.seals.clear_start import with_clear_starts
from seal_mdao.seals.door.door_seal import with_options
from seal_mdao.seals.seal import Seal
from seal_mdao.studio import pictures

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
        ((2.0, 0.1), (0.0, 1.0)),  # slides, and leads away a little
        ((0.0, 1.0), (0.0, 1.0)),  # leads away from the body
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
    moved = found.definitions[1].motion
    farthest = moved.retraction[-1]
    assert np.abs(farthest / np.hypot(*farthest) - way / np.hypot(*way)).max() < 1e-3
    assert 0.2 < farthest[1] < 0.3
    assert moved.pose(moved.begins_at).position[1] > 5.0
    later = [own.definitions[1].motion.pose(k).position for k in (0, 1, 2, 3)]
    again = [moved.pose(k).position for k in (0, 1, 2, 3)]
    assert np.array_equal(later, again)


def test_a_plate_that_begins_inside_and_is_lifted(made):
    """It presses as deep as one that has come from afar, and its force falls to zero."""
    lifted = sm.analyze(made("{ translate = [0.0, 0.6], steps = 6 }"), parameters={"plate_y": -0.3})
    pressed = sm.analyze(made("{ translate = [0.0, -0.6], steps = 12 }"))
    initial = lifted.path.initial_force("plate")
    assert initial == pytest.approx(pressed.reaction[5], rel=5e-3, abs=0.5)
    assert np.all(np.diff([initial[1], *lifted.reaction[:, 1]]) <= 0.0)
    assert lifted.reaction[-1].tolist() == [0.0, 0.0]


@pytest.mark.parametrize("travel", [-0.2, 0.2])
def test_a_pin_in_the_middle_of_a_wall_is_refused(tmp_path, travel):
    """It is clear of the upper face 0.5 mm farther down, but lies in the rubber there."""
    given = BLOCK % f"{{ translate = [0.0, {travel}], steps = 2 }}"
    given = given.replace(
        "line = [[-40.0, 0.0], [40.0, 0.0]]", "circle = { centre = [0.0, 0.0], radius = 2.0 }"
    )
    for start, inside in ((6.5, False), (3.5, True)):
        own = given.replace("start = [0.0, 5.0]", f"interference = 9.0\nstart = [0.0, {start}]")
        (tmp_path / "seal.toml").write_text(own)
        seal = sm.build_seal(tmp_path / "seal.toml")
        if inside:
            with pytest.raises(sm.GeometryError, match="overlaps the rigid profile 'plate'"):
                sm.analyze(seal)
        else:
            assert len(sm.analyze(seal).path.preliminary) > 4


def test_the_estimate_of_the_computing_time_contains_preliminary_increments(made):
    seal = made()
    placed = seal.with_retractions({"plate": [(0.0, 0.1), (0.0, 0.2), (0.0, 0.3)]})
    assert sm.estimate(placed) == sm.estimate(seal, seal.n_steps + 3)
    assert sm.estimate(placed).seconds > sm.estimate(seal).seconds


def test_a_preliminary_increment_that_fails(made):
    """More load steps would not help; a path that fails later is not meant."""
    seal = made()
    few = replace(seal, newton=sm.NewtonOptions(max_iterations=1, max_cuts=0, damped_iterations=0))
    early = sm.analyze(few, parameters={"plate_y": -0.3})
    assert early.failure.count("0 of 12 load steps converged") == 1
    assert "This is a preliminary increment before the first load step" in early.failure
    assert "more load steps" not in early.failure
    assert "Use more load steps" in sm.analyze(few).failure


OBLIQUE = "{ translate = [0.6, -1.0], steps = 10 }"
MORE = """[[measure]]
type = "reaction"
name = "early"
profile = "plate"
component = "x"
travel = 0.05
[[measure]]
type = "profile_work"
profile = "plate"
[[design]]
edges = ["top"]
parameters = 3
bound = 1.0
"""
WALL = """[[profile]]
name = "wall"
normal_penalty = 1e4
tangent_penalty = 1e2
friction = 0.2
contact = ["right"]
line = [[4.0, 20.0], [4.0, -20.0]]
start = [0.01, 0.0]
stage = [{ steps = 10 }]
"""
RISING = """[[moved]]
name = "foot"
edges = ["base"]
stage = [{ translate = [0.0, 0.1], steps = 10 }]
"""
RELAXING = "viscoelastic = { g = [0.3], tau = [1.0] }\n"


def positions(seal, values) -> dict:
    """Numbers of positions by which profiles back off, by label."""
    own = seal.with_parameters(values)
    terms = with_clear_starts(own, own.particles()).definitions
    found = {term.label: len(term.motion.retraction) for term in terms if hasattr(term, "motion")}
    return {label: count for label, count in found.items() if count}


def borders(seal, label, name, low, high, others) -> tuple:
    """Values of a parameter beside each other, between which a profile needs one more position."""

    def count(value):
        return positions(seal, {**others, name: value}).get(label, 0)

    fewer = count(high)
    assert count(low) == fewer + 1
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if count(middle) > fewer else (middle, high)
    return low, high


def values_of(seal, parameters):
    result = sm.analyze(seal, parameters=parameters)
    assert result.converged
    assert len(result.path.nominal_steps) == len(result.travel) == seal.n_steps
    measured = [result.value(measure) for measure in seal.measures()]
    return np.concatenate([result.reaction.ravel(), *measured])


CROSSINGS = {
    "first touch": ("plate", "plate_y", -0.05, 0.0, {}),
    "second": ("plate", "plate_y", -0.09, -0.02, {}),
    "sixth": ("plate", "plate_y", -0.30, -0.24, {}),
    "plate before a wall": ("plate", "plate_y", -0.09, -0.02, {"wall_x": -0.15}),
    "wall": ("wall", "wall_x", -0.05, 0.0, {"plate_y": -0.1}),
    "wall, third": ("wall", "wall_x", -0.15, -0.09, {"plate_y": -0.02}),
}


@pytest.mark.parametrize("name", CROSSINGS)
def test_results_are_continuous_where_a_profile_has_to_back_off_farther(tmp_path, name):
    """Under friction, with one and with two profiles that overlap, in all load steps."""
    label, parameter, low, high, others = CROSSINGS[name]
    given = BLOCK % OBLIQUE + MORE
    if "wall_x" in (parameter, *others):
        given += WALL
    (tmp_path / "seal.toml").write_text(given)
    seal = sm.build_seal(tmp_path / "seal.toml").with_placements()
    below, above = borders(seal, label, parameter, low, high, others)
    one, other = (values_of(seal, {**others, parameter: own}) for own in (below, above))
    assert np.abs(one).max() > 10.0
    # 1e-9 mm apart: the stiffness is below 1e5 N/m/mm
    np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-4)


def test_positions_are_the_same_for_designs_of_every_size(tmp_path):
    """Also where the power of two changes: 0.5 % of the diagonal is 2^-4.5 mm for the nominal block."""
    height = float(np.sqrt((2.0**-4.5 / 0.005) ** 2 - 8.0**2))
    given = BLOCK % OBLIQUE + MORE
    for old, new in (("3.0]", height - 2.0), ("5.0]", height)):
        given = given.replace(old, f"{new!r}]")
    (tmp_path / "seal.toml").write_text(given)
    seal = sm.build_seal(tmp_path / "seal.toml").with_placements()
    placed = {"plate_y": -0.26}
    smaller, larger = (
        sm.analyze(seal, np.full(seal.n_offsets, offset), parameters=placed)
        for offset in (-1e-8, 1e-8)
    )
    assert len(smaller.path.preliminary) == len(larger.path.preliminary) > 4
    for measure in seal.measures():
        one, other = (result.value(measure) for result in (smaller, larger))
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-3)


@pytest.mark.parametrize("model", ["", RELAXING])
def test_preliminary_increments_without_contact_leave_the_bits(tmp_path, model):
    """Also of rubber that relaxes and of edges that move."""
    given = (BLOCK % OBLIQUE + MORE).replace('[fixed]\nedges = ["base"]\n', RISING)
    if model:
        given = given.replace("[section]", f"{model}[section]")
        given = given.replace(OBLIQUE, OBLIQUE.replace(" }", ", duration = 2.0 }"))
    (tmp_path / "seal.toml").write_text(given)
    seal = sm.build_seal(tmp_path / "seal.toml").with_placements()
    seal = seal.with_parameters({"foot_x": 0.1})
    farther = seal.with_retractions({"plate": [(-0.1, 0.2), (-0.2, 0.4)]})
    one, other = sm.analyze(seal), sm.analyze(farther)
    assert len(other.path.preliminary) == 2
    for own, again in zip(one.path.nominal_steps, other.path.nominal_steps, strict=True):
        assert np.array_equal(own.d, again.d)
    for measure in seal.measures():
        assert np.array_equal(one.value(measure), other.value(measure))


def test_preliminary_increments_are_no_load_steps(tmp_path):
    (tmp_path / "seal.toml").write_text(BLOCK % OBLIQUE + MORE + WALL)
    seal = sm.build_seal(tmp_path / "seal.toml").with_placements()
    placed = {"plate_y": -0.2, "wall_x": -0.1}
    assert positions(seal, placed) == {"plate": 4, "wall": 2}
    reported = []
    result = sm.analyze(seal, parameters=placed, callback=reported.append)
    assert [step.nominal for step in reported] == list(range(10))
    assert [step.fraction for step in result.path.preliminary] == [-3.0, -2.0, -1.0, 0.0]
    assert (result.path.start.fraction, result.step_cuts) == (-4.0, 0)
    assert len(result.newton_iterations) == len(result.reaction) == len(result.travel) == 10
    # work along all increments; the force at a travel within the first load step
    term, steps = result.term("plate"), result.path.steps
    poses = [term.motion.coordinates(own.fraction)[:2] for own in (result.path.start, *steps)]
    forces = [np.zeros(2), *(own.total for own in result.path.responses("plate"))]
    pairs = zip(forces[:-1], forces[1:], np.diff(poses, axis=0), strict=True)
    work = sum(-0.5 * (one + other) @ travel for one, other, travel in pairs)
    assert result.profile_work == pytest.approx(work, rel=1e-12)
    share = 0.05 / result.travel[0]
    early = (1.0 - share) * forces[4] + share * forces[5]
    assert result.early == pytest.approx(early[0], rel=1e-12)
    # the wall waits for the plate
    wall = result.path.responses("wall")
    assert [bool(own.branch.any()) for own in wall[:4]] == [False, False, True, True]
    # a clearance that was chosen lengthens the first load step as before
    own = seal.with_clearances({"plate": (-0.3, 0.5)})
    assert sm.analyze(own, parameters={"plate_y": -0.2}).path.preliminary == []


def test_curves_begin_with_the_force_after_the_preliminary_increments(made):
    """Contact widths and pressures, which are not known there, begin at the end of the first step."""
    result = sm.analyze(made(), parameters={"plate_y": -0.35})
    initial = result.path.initial_force("plate")
    assert 0.0 < initial[1] < result.path.reaction("plate")[0, 1]
    axes = plotting.load_deflection(result).axes[0]
    begun = {
        line.get_label(): line.get_ydata()[0] for line in axes.lines if len(line.get_xdata()) > 3
    }
    assert begun["vertical"] == initial[1]
    assert begun["horizontal"] == initial[0]
    travel, force, _, _ = force_against_travel(result)
    assert (travel[0], force[0]) == (0.0, pytest.approx(initial[1], rel=1e-12))
    assert pictures.curves(result)[0]["initial"] == initial.tolist()
    width = plotting.contact_width(result).axes[0].lines[0].get_ydata()
    assert np.isnan(width[0])
    assert (width[1:] > 0.0).all()
    # nothing is in contact where the plate begins clear of the body
    clear = sm.analyze(made())
    assert not clear.path.initial_force("plate").any()
    assert plotting.contact_width(clear).axes[0].lines[0].get_ydata()[0] == 0.0


ROLLER = """[[profile]]
name = "plate"
normal_penalty = 1e4
tangent_penalty = 1e2
friction = 0.2
contact = ["top"]
circle = { centre = [0.0, 0.0], radius = 1.5 }
start = [0.9, 6.46]
[[moved]]
name = "foot"
edges = ["base"]
stage = [{ translate = [0.1, 0.4], steps = 4 }]
"""


@pytest.mark.parametrize("still", [False, True])
def test_derivatives_with_preliminary_increments(tmp_path, still):
    """Those of the path with them, of measures in the first load step and of the work, too; also of a
    roller that stands still and backs off along its normal."""
    text = BLOCK % OBLIQUE + MORE
    if still:
        plate = text[text.index("[[profile]]") : text.index("[[measure]]")]
        text = text.replace(plate, ROLLER).replace('[fixed]\nedges = ["base"]\n', "")
        text = text.replace("travel = 0.05\n", "")
    (tmp_path / "seal.toml").write_text(text)
    seal = sm.build_seal(tmp_path / "seal.toml").with_placements()
    grown, placed = np.array([0.21, 0.22, 0.24]), {"plate_y": -0.02, "plate_x": 0.03}
    result = sm.analyze(seal, grown, parameters=placed, keep_factors=True)
    assert len(result.path.preliminary) > 2
    direct, adjoint = (
        sm.differentiate(result, ("plate_x", "plate_y"), method=method)
        for method in ("direct", "adjoint")
    )
    h = 1e-6
    for measure in seal.measures():
        own = np.atleast_2d(direct[measure.name])
        slopes = []
        for column in range(len(grown) + 2):
            ends = []
            for sign in (1.0, -1.0):
                x = np.array([*grown, placed["plate_x"], placed["plate_y"]])
                x[column] += sign * h
                moved = sm.analyze(seal, x[:3], parameters={"plate_x": x[3], "plate_y": x[4]})
                ends.append(moved.value(measure))
            slopes.append((ends[0] - ends[1]) / (2.0 * h))
        size = np.abs(own).max()
        assert np.abs(own - np.atleast_2d(adjoint[measure.name])).max() < 1e-11 * size
        assert np.abs(own - np.transpose(slopes)).max() < 1e-6 * size


def test_a_parameter_that_turns_the_travel_does_not_turn_the_preliminary_increments(made):
    seal = made()
    body, contact = seal.definitions[:2]
    stage = Stage(10, (0.6, -1.0), rates={"slide": (1.0, 0.0, 0.0)})
    law = ContactLaw(1e4, 1e2, 0.2, True)
    motion = staged_motion([stage], start=(0.0, 4.8))
    inside = RigidContact("plate", contact.where, contact.shape, motion, law)
    own = replace(seal, definitions=(body, inside), n_steps=10)
    result = sm.analyze(own, parameters={"slide": 0.1}, keep_factors=True)
    assert len(result.path.preliminary) > 3
    slope = sm.differentiate(result, ("slide",), method="adjoint")["reaction"][..., -1]
    h = 1e-6
    up, down = (sm.analyze(own, parameters={"slide": 0.1 + step}).reaction[-1] for step in (h, -h))
    assert np.ravel(slope) == pytest.approx((up[1] - down[1]) / (2.0 * h), rel=1e-6)


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
    assert result.seal.definitions[1].motion.retraction[-1, 1] >= 0.08
    assert seal.definitions[1].motion.retraction.shape == (0, 2)
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
    assert result.seal.definitions[1].motion.retraction[-1, 1] >= 0.28
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
    assert again.seal.definitions[1].motion.retraction[-1, 1] >= 0.28
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
