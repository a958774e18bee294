"""The paper's door as a spline, |t| != 1: reaction to the accuracy of the fit, exact gradients."""

import numpy as np
import pytest
from quotients import quotients
from spline_door import under_corner, under_spline

import seal_mdao as sm
from seal_mdao.geometry.curve import curve_point

NAMES = ("door_radius", "depth", "friction", "c10")
RELATIVE_STEP = 3e-5
LEAST_CERTAINTY = 1e-4
"""As of the door seal's own quotients: less certain ones show nothing."""


@pytest.fixture(scope="module")
def corner():
    """The line-arc-line door."""
    return sm.analyze(under_corner(), keep_factors=True)


def deviation(shape):
    """Largest distance of the spline from the corner that it goes through."""
    profile, centre = shape.profile(), np.array([shape.side - shape.door_radius, shape.door_radius])
    worst = 0.0
    for piece, (start, length) in enumerate(zip(profile.start, profile.length, strict=True)):
        for share in np.linspace(0.0, 1.0, 9):
            # into the quarter of the corner: the flat and the side are the arc's tangents
            x = np.array(curve_point(profile, piece, start + share * length)[0]) - centre
            x *= [x[0] > 0.0, x[1] < 0.0]
            worst = max(worst, abs(np.hypot(*x) - shape.door_radius))
    return worst


def test_natural_coordinate_is_not_the_arc_length():
    shape = under_spline(17).definitions[1].shape
    speed = [np.hypot(*curve_point(shape.profile(), p, p + 0.5)[1]) for p in range(48)]
    assert max(speed) < 0.9


def test_reaction_is_that_of_the_corner_to_the_accuracy_of_the_fit(corner):
    """A gap that changes by the deviation changes the force by no more than closing the door by as
    much does, twice that for pulling one point up and the next one down."""
    reaction = corner.seal.standard[0]
    exact = corner.value(reaction)
    by_depth = sm.differentiate(corner, ("depth",)).reaction[:, -1]
    for count in (5, 9, 17, 33):
        seal = under_spline(count)
        found = sm.analyze(seal).value(reaction)
        bound = 2.0 * np.hypot(*by_depth) * deviation(seal.definitions[1].shape)
        assert np.hypot(*(found - exact)) <= bound
    assert bound <= 1e-4 * np.hypot(*exact)


@pytest.fixture(scope="module")
def splined():
    return sm.analyze(under_spline(17), keep_factors=True)


@pytest.fixture(scope="module")
def tables(splined):
    return [sm.differentiate(splined, NAMES, method=method) for method in ("direct", "adjoint")]


def test_direct_and_adjoint_agree(tables):
    direct, adjoint = (table.reaction for table in tables)
    size = np.abs(direct).max(axis=0)
    assert (np.abs(direct - adjoint) <= 1e-9 * size).all()


@pytest.mark.parametrize(
    "name",
    ["boundary_offsets[0]", "friction"]
    + [pytest.param(n, marks=pytest.mark.long) for n in NAMES if n != "friction"],
)
def test_gradients_are_exact(splined, tables, name):
    seal, column = splined.seal, tables[0].parameters.index(name)
    size = abs(seal.scalars[name].value) if name in seal.scalars else 0.0
    quotient, bound = quotients(seal, name, RELATIVE_STEP * (size or 1.0))["reaction"]
    for table in tables:
        exact = table.reaction[:, column]
        assert (np.abs(quotient - exact) <= bound).all()
        assert bound.max() <= LEAST_CERTAINTY * np.abs(exact).max()
