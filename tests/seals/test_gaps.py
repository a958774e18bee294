"""The largest gap between the contacts, and measures that do not look there."""

import pytest

import seal_mdao as sm
from seal_mdao.measures.gap import Gap, GapSquareIntegral, GapSquareSum, OpenGapSquareSum
from seal_mdao.measures.selection import open_points
from seal_mdao.measures.stress import StressNorm
from seal_mdao.seals.gaps import (
    gaps_unmeasured_by,
    largest_gap,
    largest_gaps,
    unmeasured_gaps,
)


def test_largest_gap_of_the_nominal_seal(nominal):
    opened, gap = open_points(nominal.contact.state), nominal.contact.gap
    found = largest_gap(nominal, "door")
    assert found.size == gap[opened].max()
    assert gap[found.point] == found.size
    assert found.place == pytest.approx(nominal.term("door").reference[found.point])
    assert largest_gaps(nominal) == {"door": found.size}


def test_no_gap_without_contact_on_both_sides():
    result = sm.analyze(sm.door_seal(depth=1.0, n_steps=3))
    found = largest_gap(result, "door")
    assert (found.size, found.place) == (0.0, ())
    assert unmeasured_gaps(result, (GapSquareSum(Gap("door", ())),)) == ()


def test_gaps_beside_the_measured_points_are_reported(nominal):
    worst = largest_gap(nominal, "door").point
    others = tuple(p for p in open_points(nominal.contact.state).tolist() if p != worst)
    measures = (
        GapSquareSum(Gap("door", others)), Gap("door", others), Gap("door", (worst,)),
        GapSquareIntegral("door"), OpenGapSquareSum("door"), StressNorm(),
    )  # fmt: skip
    first, second = unmeasured_gaps(nominal, measures)
    assert "outside of the points at which gap_square_sum is evaluated" in first
    assert "gap is evaluated" in second
    assert f"{nominal.contact.gap[list(others)].max():.3g} mm:" in first


def test_the_seals_own_measures_by_name(nominal):
    worst = largest_gap(nominal, "door").point
    others = tuple(p for p in nominal.measure("gap").points if p != worst)
    fewer = nominal.at((GapSquareSum(Gap("door", others)),))
    assert gaps_unmeasured_by(nominal, "gap_square_sum") == ()
    (text,) = gaps_unmeasured_by(fewer, "gap_square_sum")
    assert "the gap region has moved away from these points" in text
    assert gaps_unmeasured_by(fewer, "gap_square_integral") == ()
    assert gaps_unmeasured_by(fewer, "mean_of_something") == ()
