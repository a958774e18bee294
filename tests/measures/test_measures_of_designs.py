"""True pressures and widths, gaps of the design, the largest stress, forces in any direction."""

import numpy as np
import pytest
from quotients import quotients

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.contact_pressure import ContactPressure, ContactWidth, PeakPressure
from seal_mdao.measures.gap import GapSquareIntegral, LargestGap, OpenGapSquareSum, open_between
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.stress import LargestVonMises

TIGHT = sm.NewtonOptions(tolerance=1e-12)
MEASURES = (
    PeakPressure("door"), PeakPressure("door", nominal=True, name="nominal_peak"),
    ContactPressure("door"), ContactWidth("door"),
    ContactWidth("door", nominal=True, name="nominal_width"), OpenGapSquareSum("door"),
    GapSquareIntegral("door"), LargestGap("door"), LargestVonMises(),
    Reaction("door", (3.1, 7.0), direction=(0.3, -1.0), name="slanted"),
    Reaction("door", (3.1,), direction="travel", length=100.0, name="against"),
)  # fmt: skip
NAMES = ("depth", "door_radius", "friction", "normal_penalty", "c10", "door_angle")
SEALS = {
    "particles": sm.door_seal(n_steps=20, newton=TIGHT),
    "edges": sm.door_seal("engineering", n_steps=8, newton=TIGHT),
}


@pytest.fixture(scope="module", params=SEALS)
def result(request):
    seal = SEALS[request.param]
    offsets = np.random.default_rng(3).uniform(-0.05, 0.05, seal.n_offsets)
    return sm.analyze(seal, offsets, keep_factors=True)


def value(result, measure):
    return float(result.value(measure)[0])


def test_direct_and_adjoint_agree(result):
    direct, adjoint = (
        sm.differentiate(result, NAMES, MEASURES, way) for way in ("direct", "adjoint")
    )
    for measure in MEASURES:
        one, other = (np.atleast_2d(found[measure.name]) for found in (direct, adjoint))
        size = np.abs(one).max(axis=1, keepdims=True)
        assert size.min() > 0.0, measure.name
        assert (np.abs(one - other) <= 1e-10 * size).all(), measure.name


@pytest.mark.parametrize("name", ["boundary_offsets[5]", *NAMES])
def test_central_differences(result, name):
    """To 1e-6 of the derivative, or of the value over the size of the parameter."""
    seal, names = result.seal, (name,) if name in NAMES else ()
    rates = sm.differentiate(result, names, MEASURES, "adjoint")
    column = rates.parameters.index(name)
    size = abs(seal.scalars[name].value) if names else 1.0
    step = 1e-5 * max(size, 0.1)
    measures = result.measures(MEASURES)
    found = quotients(seal, name, step, measures=measures, start=result.boundary_offsets)
    for measure in measures:
        quotient, own = found[measure.name][0], np.atleast_2d(rates[measure.name])[:, column]
        scale = np.abs(own).max() + np.abs(result.value(measure)).max() / max(size, 0.1)
        assert np.abs(quotient - own).max() <= 1e-6 * scale, measure.name


def test_true_pressures_and_deformed_lengths_balance_the_force(result):
    """Pressure times deformed length is the normal force, as nominal pressure times undeformed one."""
    term, gap = result.term("door"), result.response("door").gap
    nominal = term.law.normal_penalty * np.maximum(-gap, 0.0)
    deformed = term.where.lengths(result.deformed())
    true = nominal * term.length / deformed
    for point in np.flatnonzero(nominal):
        patch = ContactPressure("door", ((int(point),),))
        assert value(result, patch) == pytest.approx(true[point], rel=1e-12)
    compressed = deformed[nominal > 0.0] / term.length[nominal > 0.0]
    assert compressed.min() < 0.99
    assert true @ deformed == pytest.approx(nominal @ term.length, rel=1e-12)


def test_deformed_width_is_that_of_the_deformed_line(result):
    term, state = result.term("door"), result.response("door").state
    places = term.where.points.at(result.deformed())
    pieces = np.hypot(*np.diff(places, axis=0).T)
    touching = state != OPEN
    inside = pieces[touching[:-1] & touching[1:]].sum()
    width, nominal = (value(result, m) for m in MEASURES[3:5])
    assert inside < width < inside + 4.0 * pieces.max()
    assert width != pytest.approx(nominal, rel=1e-3)


def test_gaps_are_those_of_the_design(result):
    """The nominal seal opens at other points, or as many, and its measure looks nowhere else."""
    points, gap = open_between(result, "door"), result.response("door").gap
    assert gap[points].max() > 0.0
    own = tuple(np.flatnonzero(result.response("door").state != OPEN)[[0, -1]].tolist())
    total = value(result, OpenGapSquareSum("door", own))
    assert total == pytest.approx(gap[points] @ gap[points], rel=1e-14)
    largest = value(result, LargestGap("door", own))
    assert gap[points].max() <= largest <= len(points) ** (1 / 40) * gap[points].max()


def test_an_opening_beside_the_nominal_one_is_measured():
    """Where a design opens elsewhere the sum of Eq. (71) sees nothing of it."""
    seal = SEALS["particles"]
    nominal = sm.analyze(seal)
    offsets = np.zeros(seal.n_offsets)
    offsets[7:10] = (-0.25, -0.35, -0.25)
    moved = sm.analyze(seal, offsets)
    measured, opened = nominal.measure("gap").points, open_between(moved, "door")
    outside = np.setdiff1d(opened, measured)
    assert outside.size
    assert value(moved, MEASURES[5].frozen(nominal)) >= (moved.contact.gap[outside] ** 2).sum()


@pytest.mark.parametrize("measure", [OpenGapSquareSum, GapSquareIntegral, LargestGap])
def test_a_contact_that_lifts_off_does_not_lower_a_measure_of_gaps(result, measure):
    """The design has no contact before the gap region; the nominal seal has."""
    state, gap = result.response("door").state, result.response("door").gap
    first, last = np.flatnonzero(state != OPEN)[[0, -1]]
    nominal = measure("door", (int(first) - 3, int(last)))
    beside = gap[first - 3 : first]
    assert (beside > 0.0).all()
    found = value(result, nominal)
    assert found > value(result, measure("door", (int(first), int(last))))
    if measure is OpenGapSquareSum:
        own = open_between(result, "door")
        assert found == pytest.approx(beside @ beside + gap[own] @ gap[own], rel=1e-14)
    if measure is LargestGap:
        assert found >= beside.max()


@pytest.mark.parametrize("excess", [0.02, 0.05, 0.3])
def test_bound_of_the_largest_stress(result, excess):
    largest = result.section_stress()[1].max()
    assert largest >= result.stress_field().max()
    found = value(result, LargestVonMises(excess))
    assert largest <= found <= (1.0 + excess) * largest


def test_forces_in_a_direction(result):
    horizontal, vertical = result.value(Reaction("door", (3.1,)))
    against, slanted = result.value(MEASURES[-1])[0], result.value(MEASURES[-2])[0]
    # the door comes straight down
    assert against == pytest.approx(0.1 * vertical, rel=1e-12)
    assert slanted == pytest.approx((0.3 * horizontal - vertical) / np.hypot(0.3, 1.0), rel=1e-12)
    assert (MEASURES[-1].units, MEASURES[-2].units) == ("N", "N/m")


@pytest.mark.parametrize(("wrong", "words"), [
    ({"direction": (0.0, 0.0)}, "must be two numbers that are not both zero"),
    ({"direction": "up"}, "or 'travel', got 'up'"),
    ({"length": 0.0}, "length of 'reaction' must be a number"),
])  # fmt: skip
def test_wrong_directions_and_lengths(wrong, words):
    with pytest.raises(ValueError, match=words):
        Reaction("door", **wrong)


@pytest.mark.parametrize("excess", [0.0, -0.1, 2.0, float("nan")])
def test_wrong_excess(excess):
    with pytest.raises(ValueError, match="excess of 'largest_von_mises' must be"):
        LargestVonMises(excess)
