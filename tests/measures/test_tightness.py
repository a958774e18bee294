"""Integral of a power of the contact pressure, and the longest part of a contact above a pressure."""

from dataclasses import replace

import numpy as np
import pytest
from quotients import quotients

import seal_mdao as sm
from seal_mdao.measures.boundary_line import BoundaryLine
from seal_mdao.measures.contact_integral import PressureCentre, PressureIntegral
from seal_mdao.measures.contact_pressure import ContactWidth, PointPressures
from seal_mdao.measures.longest_contact import LongestContact, fractions_above, longest_part

TIGHT = sm.NewtonOptions(tolerance=1e-12)
INTEGRAL = PressureIntegral("door", 1.5, 20.0)
LONGEST = LongestContact("door", name="longest")
ABOVE = LongestContact("door", 15.0, name="above")
CENTRE = PressureCentre("door", name="centre")
PEAK = PressureCentre("door", "y", 6.0, name="peak")
MEASURES = INTEGRAL, LONGEST, ABOVE, CENTRE, PEAK
NAMES = ("depth", "door_radius", "friction", "normal_penalty", "c10")
SEALS = {
    "particles": sm.door_seal(n_steps=20, newton=TIGHT),
    "edges": sm.door_seal("engineering", n_steps=8, newton=TIGHT),
}


@pytest.fixture(scope="module", params=SEALS)
def result(request):
    seal = SEALS[request.param]
    seal = replace(seal, standard=(*seal.standard, *MEASURES))
    offsets = np.random.default_rng(3).uniform(-0.05, 0.05, seal.n_offsets)
    return sm.analyze(seal, offsets, keep_factors=True)


def value(result, measure):
    return float(result.value(measure)[0])


def points(result):
    """True pressures, and deformed lengths of the contact points."""
    found = PointPressures(result, "door", nominal=False)
    return found.value, found.length


# ---- values ----


def test_integral_is_that_of_the_points(result):
    pressure, length = points(result)
    assert value(result, INTEGRAL) == pytest.approx(
        ((pressure / 20.0) ** 1.5 * length).sum(), rel=1e-13
    )


def test_integral_of_the_pressure_is_the_normal_force(result):
    """int p ds = sum w_n |g| L, of which friction is no part."""
    response, term = result.response("door"), result.term("door")
    force = (1e4 * np.maximum(-response.gap, 0.0) * term.length).sum()
    assert term.law.normal_penalty == 1e4
    assert value(result, PressureIntegral("door", 1.0, 5.0)) == pytest.approx(
        force / 5.0, rel=1e-12
    )


def test_longest_part_of_the_contact(result):
    """The door seal has two patches: the longer one, not the width of both."""
    width, longest = value(result, ContactWidth("door")), value(result, LONGEST)
    assert 0.5 * width < longest < 0.95 * width
    assert 0.0 < value(result, ABOVE) < longest
    pressure, _ = points(result)
    assert value(result, LongestContact("door", 1.01 * pressure.max())) == 0.0


def test_longest_part_above_a_pressure(result):
    """Against samples of the pressure that is linear between the deformed contact points and the ends
    of the contact, where it is zero."""
    (pressure, _), term = points(result), result.term("door")
    x = term.where.points.at(result.deformed())
    line = BoundaryLine(term.where, np.arange(len(x)), result.deformed())
    fraction = ContactWidth("door").ends(result, line).fraction
    along = np.append(0.0, np.cumsum(line.length))
    inside = np.flatnonzero((fraction > 0.0) & (fraction < 1.0))
    assert inside.size == 4
    first = pressure[inside] > 0.0
    away = np.where(first, fraction[inside], 1.0 - fraction[inside])
    end = along[inside] + away * line.length[inside]
    place, value_there = np.append(along, end), np.append(pressure, np.zeros(4))
    order = place.argsort()
    fine = np.linspace(0.0, along[-1], 400_001)
    above = np.interp(fine, place[order], value_there[order]) > 15.0
    ends = np.flatnonzero(np.diff(above))
    assert not above[[0, -1]].any()
    longest = np.diff(fine[ends])[::2].max()
    assert value(result, ABOVE) == pytest.approx(longest, abs=2.5 * fine[1])


def test_a_higher_limit_gives_no_longer_part(result):
    """From the limit 0 on, where the part is a contact region with the ends of the contact width."""
    limits = (0.0, 1e-9, 0.3, 1.0, 3.0, 8.0, 15.0, 20.0)
    longest = [value(result, LongestContact("door", own)) for own in limits]
    assert longest[1] == pytest.approx(longest[0], rel=1e-9)
    assert (np.diff(longest[1:]) < 0.0).all()


def test_ends_on_a_linear_pressure():
    """p = 30 - 10 s and a limit of 12.5: the end lies at s = 1.75."""
    excess = 30.0 - 10.0 * np.arange(4.0) - 12.5
    fraction, by_first, by_second = fractions_above(excess)
    assert fraction == pytest.approx([1.0, 0.75, 0.0])
    assert fractions_above(excess[::-1])[0] == pytest.approx([0.0, 0.75, 1.0])
    for turned in (1, -1):
        _, by_first, by_second = fractions_above(excess[::turned])
        for end, found in enumerate((by_first, by_second)):
            for at in range(3):
                step = np.where(np.arange(4) == at + end, 1e-6, 0.0)
                up, down = (fractions_above(excess[::turned] + s * step)[0] for s in (1, -1))
                assert (up - down)[at] / 2e-6 == pytest.approx(found[at], abs=1e-8)


def test_a_part_may_pass_the_end_of_a_closed_boundary():
    above = np.array([True, False, True, True, False, False, True, True])
    length = np.array([0.5, 0.4, 1.0, 0.3, 0.0, 0.6, 1.0])
    # 1.7 open, 2.1 over the seam
    assert longest_part(above, length, closed=False).tolist() == [0, 1, 1, 1, 0, 0, 0]
    assert longest_part(above, length, closed=True).tolist() == [1, 0, 0, 0, 0, 1, 1]
    assert longest_part(np.ones(8, bool), length, closed=True).all()
    assert not longest_part(np.zeros(8, bool), 0.0 * length, closed=True).any()


def test_centre_of_the_pressure(result):
    """The moment of the normal forces of the points about it is zero; a large power is at the peak."""
    pressure, length = points(result)
    x = result.term("door").where.points.at(result.deformed())
    moment = pressure * length @ (x[:, 0] - value(result, CENTRE))
    assert abs(moment) < 1e-12 * (pressure * length).sum()
    y = value(result, PressureCentre("door", "y", 1000.0))
    assert y == pytest.approx(x[pressure.argmax(), 1], abs=1e-3)


def test_without_contact_there_is_no_centre():
    seal = SEALS["particles"]
    opened = sm.analyze(seal, np.full(seal.n_offsets, -0.3), {"depth": 0.1})
    assert np.isnan(value(opened, CENTRE))
    assert "is not in contact with the seal" in CENTRE.missing(opened)


# ---- derivatives ----


def test_direct_and_adjoint_agree(result):
    direct, adjoint = (
        sm.differentiate(result, NAMES, MEASURES, way) for way in ("direct", "adjoint")
    )
    for measure in MEASURES:
        one, other = direct[measure.name][0], adjoint[measure.name][0]
        assert np.abs(one - other).max() <= 1e-9 * np.abs(one).max(), measure
        assert (one[-len(NAMES) :] != 0.0).all()


@pytest.mark.parametrize("name", ["boundary_offsets[5]", "boundary_offsets[18]", *NAMES])
def test_central_differences(result, name):
    """Within their own bound of error, which is small beside the derivative."""
    names = () if name.startswith("boundary") else (name,)
    rates = sm.differentiate(result, names, MEASURES, "adjoint")
    size = abs(result.seal.scalars[name].value) if names else 1.0
    found = quotients(
        result.seal, name, 1e-5 * max(size, 0.1), measures=MEASURES, start=result.boundary_offsets
    )
    for measure in MEASURES:
        own = rates[measure.name][0, rates.parameters.index(name)]
        quotient, bound = found[measure.name]
        assert abs(quotient[0] - own) <= bound[0] + 1e-9 * abs(own), measure
        assert bound[0] <= 1e-4 * (abs(own) + abs(value(result, measure)) / max(size, 0.1)), measure


def test_step_study_of_the_squeeze(result):
    """Errors of central differences in the closing depth fall with the square of the step."""
    seal, offsets = result.seal, result.boundary_offsets
    rates = sm.differentiate(result, ("depth",), MEASURES)
    start = seal.scalars["depth"].value
    errors = {measure.name: [] for measure in MEASURES}
    for step in (4e-3, 2e-3, 1e-3):
        above, below = (
            sm.analyze(seal, offsets, {"depth": start + sign * step}) for sign in (1.0, -1.0)
        )
        for m in MEASURES:
            quotient = (value(above, m) - value(below, m)) / (2.0 * step)
            errors[m.name].append(abs(quotient - rates[m.name][0, -1]))
    for name, own in errors.items():
        assert own[1] == pytest.approx(own[0] / 4.0, rel=0.05), name
        assert own[2] == pytest.approx(own[1] / 4.0, rel=0.05), name


@pytest.mark.parametrize(
    ("made", "match"),
    [
        (lambda: PressureIntegral("door", 0.5, 1.0), "exponent"),
        (lambda: PressureIntegral("door", 1.5, 0.0), "reference_pressure"),
        (lambda: LongestContact("door", -1.0), "pressure"),
        (lambda: PressureCentre("door", "z"), "axis"),
        (lambda: PressureCentre("door", "x", 0.9), "exponent"),
    ],
)
def test_invalid_numbers_are_refused(made, match):
    with pytest.raises(ValueError, match=match):
        made()
