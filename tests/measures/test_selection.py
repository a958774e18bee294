"""Where the measures are taken: local maxima, opened points, frozen for all designs of a model."""

import numpy as np
import pytest
from round_tip import PRESSED_TIP
from verification.contact_profiles import stored

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.measures.contact_pressure import fall_beside_peak, points_around_peak
from seal_mdao.measures.selection import (
    boundary_peaks,
    contact_patches,
    local_maxima,
    open_points,
)
from seal_mdao.seals.door.door_seal import STANDARD, options_of
from seal_mdao.seals.profiles import contact_counts, profile_histories
from seal_mdao.seals.result import analyze_particles


def test_local_maxima_of_an_open_row_leave_out_its_ends():
    values = np.array([5.0, 1.0, 3.0, 2.0, 2.5, 2.5, 0.0, 4.0])
    np.testing.assert_array_equal(local_maxima(values, periodic=False), [2])


def test_local_maxima_of_a_closed_row_go_round():
    values = np.array([5.0, 1.0, 3.0, 2.0, 4.0])
    np.testing.assert_array_equal(local_maxima(values, periodic=True), [0, 2])
    shifted = np.roll(values, 2)
    np.testing.assert_array_equal(local_maxima(shifted, periodic=True), [2, 4])


def test_stress_points_are_the_largest_maxima_of_all_rows_largest_first(rng):
    stress = np.zeros(40)
    stress[:20], stress[20:] = np.tile([1.0, 2.0], 10), np.tile([1.0, 3.0], 10)
    stress[[3, 25, 9]] += [4.0, 7.0, 2.0]
    rows = [(np.arange(20), False), (np.arange(20, 40), True)]
    found = boundary_peaks(rows, stress, 5)
    np.testing.assert_array_equal(found[:3], [25, 3, 9])
    assert np.all(np.diff(stress[found]) <= 0.0)
    assert np.all(found[3:] >= 20)


def test_stress_points_fall_back_on_other_boundary_values():
    stress = np.arange(10.0)
    found = boundary_peaks([(np.arange(10), False)], stress, 3)
    np.testing.assert_array_equal(found, [9, 8, 7])


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        ([OPEN, STICK, OPEN, OPEN, SLIP, OPEN], [2, 3]),
        ([OPEN, OPEN, OPEN], []),
        ([STICK, STICK], []),
        ([OPEN, SLIP, OPEN], []),
        ([STICK, OPEN, STICK, OPEN, STICK], [1, 3]),
    ],
)
def test_opened_points_lie_between_the_first_and_the_last_in_contact(state, expected):
    np.testing.assert_array_equal(open_points(np.array(state)), expected)


@pytest.mark.parametrize(
    ("state", "expected"),
    [
        ([STICK, OPEN, OPEN, OPEN, SLIP, OPEN], [5]),
        ([OPEN, STICK, OPEN, SLIP, OPEN, OPEN], [2]),
        ([SLIP, OPEN, SLIP, OPEN, OPEN, STICK], [1]),
        ([OPEN, STICK, OPEN, OPEN], []),
        ([OPEN, OPEN, OPEN], []),
        ([STICK, STICK], []),
    ],
)
def test_on_a_closed_boundary_the_longest_open_part_is_outside(state, expected):
    np.testing.assert_array_equal(open_points(np.array(state), closed=True), expected)


@pytest.mark.parametrize(
    ("state", "closed", "expected"),
    [
        ("-+-", False, ["012"]),
        ("---", True, ["012"]),
        ("-+---+-", False, ["012", "3456"]),
        ("+-+--+", False, ["0", "123", "45"]),
        # a region across the first point of a closed boundary is one region
        ("++---+", True, ["012345"]),
        ("+--+----+", True, ["67801", "2345"]),
        ("-+-+---", True, ["601", "2345"]),
    ],
)
def test_every_contact_region_has_its_patch(state, closed, expected):
    """Of points in contact (+) and open ones (-); their numbers as digits."""
    states = np.array([STICK if sign == "+" else OPEN for sign in state])
    found = contact_patches(states, closed)
    assert ["".join(map(str, own)) for own in found] == expected


def test_points_of_the_drawn_seal(nominal, drawn_model):
    """Seven stresses at boundary particles that are local maxima, gaps where the middle opens."""
    (stresses,), (gaps,) = nominal.measures(("von_mises",)), nominal.measures(("gap",))
    grid, gaps = options_of(drawn_model).grid, np.array(gaps.points)
    assert len(stresses.points) == 7
    outer, inner = grid.free_outer, grid.particle(np.arange(58), 0)
    stress = nominal.stress_field()
    for particle in stresses.points:
        row = inner if particle in inner else outer
        place = int(np.flatnonzero(row == particle)[0])
        assert stress[particle] > stress[row[place - 1]]
        assert stress[particle] > stress[row[(place + 1) % len(row)]]
    assert np.all(np.diff(stress[list(stresses.points)]) < 0.0)
    assert np.all(np.diff(gaps) == 1)
    assert np.all(nominal.contact.gap[gaps] > 0.0)
    assert nominal.contact.gap[gaps[0] - 1] < 0.0
    assert nominal.contact.gap[gaps[-1] + 1] < 0.0


def test_points_are_frozen_for_all_designs_of_a_model(nominal, random_design):
    assert random_design.measures() == nominal.measures()
    gaps = list(nominal.measure("gap").points)
    np.testing.assert_array_equal(random_design.gap, random_design.contact.gap[gaps])
    stresses = list(nominal.measure("von_mises").points)
    np.testing.assert_array_equal(random_design.von_mises, random_design.stress_field()[stresses])


def test_gap_square_sum_is_the_sum_of_the_squares(nominal, random_design):
    for result in (nominal, random_design):
        assert result.gap_square_sum == pytest.approx(np.sum(result.gap**2), rel=1e-15)


def test_drawn_seal_measures_are_of_the_expected_size(nominal):
    """Peak stress about 170 kPa, gap sum about 0.05 mm^2, 62 N/m would be 6.2 N per 100 mm."""
    assert nominal.von_mises[0] == pytest.approx(170.0, rel=0.03)
    assert nominal.gap_square_sum == pytest.approx(0.05, rel=0.1)
    assert nominal.gap.max() == pytest.approx(0.12, rel=0.05)
    assert len(nominal.gap) == 7
    assert nominal.max_penetration == pytest.approx(2.6e-3, rel=0.1)
    assert nominal.area == pytest.approx(108.971, abs=5e-4)


def test_contact_grows_then_opens_in_the_middle(nominal):
    """One patch until about half way; at the end two with open points between."""
    states = np.array([response.state for response in nominal.path.at_nominal("door")])
    patches = [np.sum(np.diff((state != OPEN).astype(int)) == 1) for state in states]
    travel = nominal.travel
    splits = travel[np.flatnonzero(np.array(patches) >= 2)[0]]
    assert 4.0 < splits < 7.0
    assert patches[-1] == 2
    assert set(patches[5:40]) == {1}


def test_contact_counts_add_up(nominal):
    counts = contact_counts(nominal.contact)
    assert counts["contact"] == counts["stick"] + counts["slip"]
    assert counts["contact"] == np.sum(nominal.contact.gap < 0.0)


def test_places_of_a_nominal_seal_that_fails_are_refused():
    newton = sm.NewtonOptions(max_iterations=2, max_cuts=0, damped_iterations=0)
    result = sm.analyze(sm.door_seal(newton=newton))
    with pytest.raises(
        sm.LoadPathError, match=r"measures 'von_mises', 'gap'.*this analysis failed"
    ):
        result.measures()


def test_area_is_that_between_the_splines_alone(nominal):
    model = sm.door_seal(depth=0.5, n_steps=10)
    bare = analyze_particles(model, model.nominal_particles)
    with pytest.raises(ValueError, match="weights"):
        _ = bare.area
    cells = bare.path.discretization.weights.sum()
    # of polygons in arcs of 2 pi / 58, which lack the square of that over six
    assert cells == pytest.approx(nominal.area, rel=(2 * np.pi / 58) ** 2 / 6)


def paths_followed(monkeypatch):
    """What ``solve_path`` is called for from now on."""
    from seal_mdao.seals import result

    followed, solve = [], result.solve_path
    monkeypatch.setattr(result, "solve_path", lambda *a: followed.append(a[0]) or solve(*a))
    return followed


def test_one_design_is_analysed_and_the_nominal_seal_once_when_places_are_asked_for(monkeypatch):
    model, offsets = sm.door_seal(depth=0.5, n_steps=10, friction=0.21), np.full(25, 0.01)
    followed = paths_followed(monkeypatch)
    first, second = (sm.analyze(model, scale * offsets) for scale in (1.0, 2.0))
    assert len(followed) == 2
    for result in (first, second, first):
        assert result.von_mises.shape == (7,)
        assert result.gap_square_sum >= 0.0
        assert len(followed) == 3


def test_the_nominal_seal_chooses_the_places_itself(monkeypatch):
    nominal = sm.analyze(sm.door_seal(depth=0.5, n_steps=10, friction=0.22))
    followed = paths_followed(monkeypatch)
    assert len(nominal.measure("von_mises").points) == 7
    assert not followed


def test_places_of_another_seal_are_taken_as_given(monkeypatch, nominal):
    offsets = np.full(25, 0.01)
    result = sm.analyze(sm.door_seal(depth=0.5, n_steps=10, friction=0.23), offsets)
    followed = paths_followed(monkeypatch)
    moved = result.at(nominal.measures())
    assert moved.measures() == nominal.measures()
    assert moved.measures((STANDARD[0],)) == nominal.measures(("von_mises",))
    stresses = list(nominal.measure("von_mises").points)
    np.testing.assert_array_equal(moved.von_mises, result.stress_field()[stresses])
    assert not followed


def test_what_is_no_measure_is_no_attribute(nominal):
    with pytest.raises(AttributeError, match=r"no 'gap_sum'.*von_mises"):
        _ = nominal.gap_sum


MEASURES = """[[measure]]
type = "peak_pressure"
[[measure]]
type = "contact_width"
"""


@pytest.mark.parametrize(
    ("finer", "count", "warning"),
    [
        ("edge_spacing = { tip = 0.04 }", 3, "is computed from only 3 adjacent points in contact"),
        ("", 1, "is not resolved: at the peak only 1 point is in contact"),
    ],
)
def test_the_peak_between_few_points_is_reported(tmp_path, finer, count, warning):
    """By Hertz, with the force on the plate: as exact as the warning says, or wrong by a factor."""
    path = tmp_path / "lip.toml"
    path.write_text(PRESSED_TIP.format(section=f"spacing = 0.3\n{finer}") + MEASURES)
    result = sm.analyze(sm.build_seal(path))
    assert len(points_around_peak(result.response("plate").gap, closed=False)) == count
    *others, found = result.warnings
    assert warning in found
    # a single point penetrates by more than 1 % of the largest displacement
    assert ["inside the rigid profile" in text for text in others] == [True] * (count == 1)
    # p = sqrt(F E / (1 - nu^2) / (pi R)) of an incompressible tip with E = 6 C10
    stiffness = 6.0 * result.seal.materials["rubber"].c10 / 0.75
    exact = np.sqrt(result.reaction[-1, 1] * stiffness / (np.pi * 0.5))
    if count == 1:
        assert result.peak_pressure[0] < 0.5 * exact
    else:
        assert result.peak_pressure[0] == pytest.approx(exact, rel=0.1)


@pytest.mark.parametrize(
    ("finer", "reported"), [("edge_spacing = { tip = 0.04 }", False), ("", True)]
)
def test_a_width_of_one_point_is_reported(tmp_path, finer, reported):
    """By Hertz, with the force on the plate: exact to a fifth, or wrong by a factor."""
    path = tmp_path / "lip.toml"
    width = MEASURES.replace('[[measure]]\ntype = "peak_pressure"\n', "")
    path.write_text(PRESSED_TIP.format(section=f"spacing = 0.3\n{finer}") + width)
    result = sm.analyze(sm.build_seal(path))
    own = "the contact width on 'plate' is not resolved: where the pressure is highest only 1 point is"
    assert [text.startswith(own) for text in result.warnings if "resolved" in text] == [
        True
    ] * reported
    # 2 a = 4 [F R (1 - nu^2) / (pi E)]^(1/2) of an incompressible tip with E = 6 C10
    compliance = 0.75 / (6.0 * result.seal.materials["rubber"].c10)
    exact = 4.0 * np.sqrt(result.reaction[-1, 1] * 0.5 * compliance / np.pi)
    assert (abs(result.contact_width[0] / exact - 1.0) > 0.2) == reported


@pytest.mark.parametrize(
    ("gap", "closed", "points"),
    [
        ([0.1, -0.1, -0.3, 0.2, -0.1, -0.1, -0.1], False, [1, 2]),
        ([-0.1, -0.3, 0.0, 0.1, -0.1, -0.2], True, [4, 5, 0, 1]),
        ([-0.1, -0.3, 0.0, 0.1, -0.1, -0.2], False, [0, 1]),
        ([-0.1, -0.2, -0.1], True, [0, 1, 2]),
        ([-0.1, -0.2, -0.1], False, [0, 1, 2]),
        ([0.1, 0.0], False, []),
    ],
)
def test_points_around_the_highest_pressure(gap, closed, points):
    assert points_around_peak(np.array(gap), closed).tolist() == points


PUNCH = """
symmetry = [{ edges = ["middle"], normal = "x" }]
[material.rubber]
law = "mooney_rivlin"
c10 = 80.0
c01 = 20.0
bulk_modulus = 80000.0
[section]
material = "rubber"
SPACING
outer = [
  { edge = "middle", line = [[0.0, 6.0], [0.0, 0.0]] },
  { edge = "sole", line = [[0.0, 0.0], [3.0, 0.0]] },
  { edge = "sole", arc = { start = [3.0, 0.0], through = [3.6, 0.2], end = [4.0, 1.0] } },
  { edge = "side", line = [[4.0, 1.0], [4.0, 6.0]] },
  { edge = "bond", line = [[4.0, 6.0], [0.0, 6.0]] },
]
[fixed]
edges = ["bond"]
[[profile]]
name = "plane"
friction = 0.2
contact = ["sole"]
line = [[20.0, 0.0], [-20.0, 0.0]]
stage = [{ translate = [0.0, 0.3] }]
"""


@pytest.mark.parametrize(
    ("finer", "reported", "error"),
    [
        ("", True, (-0.2, -0.1)),
        pytest.param("edge_spacing = { sole = 0.1 }", False, (-0.02, 0.02), marks=pytest.mark.long),
    ],
)
def test_a_peak_on_a_short_length_is_reported(tmp_path, finer, reported, error):
    """A flat punch whose rounded corners have just come into contact, against finite elements."""
    path = tmp_path / "punch.toml"
    path.write_text(PUNCH.replace("SPACING", f"spacing = 0.4\n{finer}") + MEASURES)
    result = sm.analyze(sm.build_seal(path))
    texts = [text for text in result.warnings if "peak pressure on 'plane' is concentrated" in text]
    assert ["near x = 3," in text for text in texts] == [True] * reported
    (history,) = profile_histories(result)
    assert error[0] < history.nominal_peak[-1] / stored("rounded_punch").peak[0] - 1.0 < error[1]


@pytest.mark.parametrize(
    ("gap", "closed", "fall"),
    [
        ([0.1, -0.1, -0.4, -0.3, 0.1], False, 0.5),
        # open points and the ends of an open boundary are not beside the peak
        ([0.1, -0.4, -0.3, 0.1], False, 0.25),
        ([-0.4, -0.3, 0.1], False, 0.25),
        ([-0.4, -0.3, 0.1, -0.1], True, 0.5),
        ([-0.2, -0.2, -0.2], False, 0.0),
    ],
)
def test_fall_beside_the_highest_pressure(gap, closed, fall):
    gap = np.array(gap)
    found = fall_beside_peak(gap, points_around_peak(gap, closed))
    assert found == pytest.approx(fall, abs=1e-15)
