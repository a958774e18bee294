"""Pressure loads of bodies of revolution: volumes, work over closed cycles, tangents, derivatives, and
the limit of a large radius."""

from dataclasses import replace

import numpy as np
import pytest
from air_ring import air_ring, change_of_residual
from fluid_seals import ring
from lines import CENTRAL
from quotients import quotients
from scipy.interpolate import lagrange

import seal_mdao as sm
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.loads.enclosed_volume import coupled_points, enclosed_volume, second_derivatives
from seal_mdao.loads.pressed_sides import INNER, PressedSides
from seal_mdao.measures.reaction import Reaction

AXIS = 20.0
VENTS = {"vent_diameter": 2.0, "vent_spacing": 100.0, "closing_speed": 300.0}
PRESSURE = {"squeeze": 0.6, "close": 4, "steps": 4}
FLUID_NAMES = ("c10", "squeeze", "fluid_pressure", "lid_normal_penalty", "wall_normal_penalty")
TORUS_RADII = (20.0, 1e4)


@pytest.fixture(scope="module", params=["sealed", "vented", "fluid"])
def pressed(request):
    """A body of revolution under every kind of pressure, its parameters and derivatives."""
    if request.param == "fluid":
        seal, names = ring(1000.0, axis=AXIS, **PRESSURE), FLUID_NAMES
        forces = [own for own in seal.standard if isinstance(own, Reaction)]
        seal = replace(seal, standard=tuple(forces))
    else:
        seal = air_ring(axis=AXIS, **VENTS if request.param == "vented" else {})
        names = tuple(seal.scalars)
    result = sm.analyze(seal, keep_factors=True)
    assert result.converged, result.failure
    return result, [
        sm.differentiate(result, names, method=method) for method in ("direct", "adjoint")
    ]


# ---- volumes ----


def egg(axis=0.0, count=30):
    """A polygon with sides of different lengths, its middle at x = ``axis``, shape (count, 2)."""
    angle = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False) ** 1.1
    x = axis + 3.0 * np.cos(angle) + 0.5 * np.cos(2.0 * angle)
    return np.column_stack([x, 2.0 * np.sin(angle)])


def centroid_radius(x):
    """Distance of the centroid of a polygon from the axis, by the first moment of its triangles."""
    a, b = x, np.roll(x, -1, axis=0)
    area = 0.5 * (a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0])
    return (area * (a[:, 0] + b[:, 0]) / 3.0).sum() / area.sum()


@pytest.mark.parametrize("axis", TORUS_RADII)
def test_volume_is_that_of_pappus(axis):
    """Area times the way of its centroid, in m mm^2."""
    x = egg()
    expected = 2e-3 * np.pi * (axis + centroid_radius(x)) * polygon_area(x)[0]
    assert enclosed_volume(egg(axis), True)[0] == pytest.approx(expected, rel=1e-12)


def test_derivatives_of_the_volume(rng):
    """Quotients of fourth order are exact for cubic polynomials."""
    x, way = egg(AXIS), rng.standard_normal((30, 2))
    places, (fine, _) = CENTRAL
    found = [enclosed_volume(x + place * way, True) for place in places]
    gradient = enclosed_volume(x, True)[1]
    slope = fine @ np.array([volume for volume, _ in found])
    assert slope == pytest.approx((gradient * way).sum(), rel=1e-9)
    curved = np.zeros_like(x)
    pairs = coupled_points(len(x), True)
    np.add.at(
        curved,
        pairs[:, 0],
        np.einsum("mij,mj->mi", second_derivatives(x, True), way[pairs[:, 1]]),
    )
    expected = np.tensordot(fine, np.array([own for _, own in found]), 1)
    np.testing.assert_allclose(curved, expected, atol=1e-10 * np.abs(expected).max())


def test_resultant_of_closed_sides():
    """Closed sides have no axial resultant; the radial forces add up to 2 pi times pressure and area."""
    gradient = enclosed_volume(egg(AXIS), True)[1]
    assert abs(gradient[:, 1].sum()) <= 1e-12 * np.abs(gradient[:, 1]).sum()
    assert gradient[:, 0].sum() == pytest.approx(2e-3 * np.pi * polygon_area(egg())[0], rel=1e-10)


ENDS = np.arange(10)[:, None] + np.arange(2)
"""The particles at the ends of ten sides."""


def side_of(first, last):
    """Points of a straight side: its ends and the two Gauss points between them."""
    at = np.array([0.0, INNER, 1.0 - INNER, 1.0])
    return first + at[:, None] * (last - first)


@pytest.mark.parametrize("axisymmetric", [False, True])
def test_forces_of_linear_weights_are_integrated_exactly(rng, axisymmetric):
    """One side: integrands of degree 9 against ten Gauss points; in a body of revolution up to the part
    with a potential, which is the same for both ends."""
    x = rng.uniform(1.0, 2.0, (4, 2))
    s, weight = np.polynomial.legendre.leggauss(10)
    s, weight = 0.5 + 0.5 * s, 0.5 * weight
    shapes = [lagrange([0.0, INNER, 1.0 - INNER, 1.0], own) for own in np.eye(4)]
    slopes = np.array([own.deriv()(s) for own in shapes])
    shapes = np.array([own(s) for own in shapes])
    place, along = shapes.T @ x, slopes.T @ x
    inward = np.column_stack([-along[:, 1], along[:, 0]])
    forces = PressedSides(ENDS[:1], True, axisymmetric).forces(x)
    around = 2e-3 * np.pi * place[:, 0] if axisymmetric else 1.0
    exact = [(shapes * weight * line * around) @ inward for line in (1.0 - s, s)]
    first, last = (own - expected for own, expected in zip(forces, exact, strict=True))
    size = np.abs(exact).max()
    np.testing.assert_allclose(first, last, atol=1e-13 * size)
    if not axisymmetric:
        np.testing.assert_allclose(first, 0.0, atol=1e-13 * size)


@pytest.mark.parametrize("axisymmetric", [False, True])
def test_forces_on_a_straight_side_are_those_of_the_consistent_integration(axisymmetric):
    """At the Gauss points the pressure on half of the side, at the ends nothing."""
    x = side_of(first := np.array([1.0, 3.0]), last := np.array([2.5, 3.4]))
    force = PressedSides(ENDS[:1], True, axisymmetric).forces(x).sum(axis=0)
    inward = np.array([first[1] - last[1], last[0] - first[0]])
    expected = 0.5 * np.outer([0.0, 1.0, 1.0, 0.0], inward)
    if axisymmetric:
        expected *= 2e-3 * np.pi * x[:, :1]
    np.testing.assert_allclose(force, expected, atol=1e-14 * np.abs(expected).max())


@pytest.mark.parametrize("weighted_by", [ENDS[:3], np.array([[0, 1], [1, 1], [2, 3]])])
@pytest.mark.parametrize("axisymmetric", [False, True])
def test_tangents_of_sides_are_the_derivatives_of_their_forces(rng, axisymmetric, weighted_by):
    """Quotients of fourth order are exact for quadratic polynomials; also with a side of constant
    weight."""
    sides, size = PressedSides(weighted_by, False, axisymmetric), rng.uniform(0.5, 1.0, 4)
    x, way = rng.uniform(1.0, 2.0, (10, 2)), rng.standard_normal((10, 2))
    places, (fine, _) = CENTRAL
    found = [np.tensordot(size, sides.forces(x + place * way), 1) for place in places]
    pairs, tangents = sides.tangents(x, size)
    turned = np.zeros_like(x)
    np.add.at(turned, pairs[:, 0], np.einsum("mij,mj->mi", tangents, way[pairs[:, 1]]))
    expected = np.tensordot(fine, np.array(found), 1)
    np.testing.assert_allclose(turned, expected, atol=1e-11 * np.abs(expected).max())


# ---- work ----


def work(force, states):
    """Integrate the forces along straight lines through the states and back to the first, and the sum
    of the absolute work."""
    nodes, weights = np.polynomial.legendre.leggauss(20)
    total = size = 0.0
    for first, last in zip(states, [*states[1:], states[0]], strict=True):
        way = last - first
        own = [np.sum(force(first + 0.5 * (1.0 + node) * way) * way) for node in nodes]
        total, size = total + 0.5 * weights @ own, size + 0.5 * weights @ np.abs(own)
    return total, size


def test_a_fluid_does_no_work_over_a_closed_cycle(rng):
    """On an edge whose ends do not move; in between the forces derive from the volume."""
    x = np.column_stack([AXIS + 3.0 * np.cos(t := np.linspace(0.0, 2.0, 31)), 3.0 * np.sin(t)])
    states = [x + 0.2 * rng.standard_normal(x.shape) for _ in range(4)]
    for one in states:
        one[[0, -1]] = x[[0, -1]]
    sides = PressedSides(ENDS, True, True)
    total, size = work(lambda own: sides.forces(own).sum(axis=0), states)
    assert abs(total) <= 1e-10 * size


def test_ends_that_go_round_do_work(rng):
    """So the check above can fail: the pressure ends within the boundary."""
    x = egg(AXIS, 40)[:31]
    states = [x + 0.2 * rng.standard_normal(x.shape) for _ in range(4)]
    sides = PressedSides(ENDS, True, True)
    total, size = work(lambda own: sides.forces(own).sum(axis=0), states)
    assert abs(total) > 1e-4 * size


def test_sealed_air_does_no_work_over_a_closed_cycle(rng):
    term = sm.analyze(air_ring(axis=AXIS, depth=0.05, shear=0.0)).term("air")
    x = term.reference
    states = [x + 0.1 * rng.standard_normal(x.shape) for _ in range(4)]
    responses = [term.respond(one, 1.0, None) for one in states]
    total, size = work(lambda own: term.respond(own, 1.0, None).force, states)
    assert abs(total) <= 1e-10 * size
    # one side of the cycle is the difference of the potential
    way, (nodes, weights) = states[1] - states[0], np.polynomial.legendre.leggauss(20)
    along = [
        np.sum(term.respond(states[0] + 0.5 * (1.0 + node) * way, 1.0, None).force * way)
        for node in nodes
    ]
    difference = term.potential(None, responses[1]) - term.potential(None, responses[0])
    assert 0.5 * weights @ along == pytest.approx(difference, rel=1e-9)


# ---- tangent and derivatives ----


def test_the_tangent_is_the_derivative_of_the_residual(pressed, rng):
    factor, along, quotient = change_of_residual(pressed[0], rng)
    np.testing.assert_allclose(factor.solve(quotient), along, rtol=0.0, atol=1e-6)


def test_direct_and_adjoint_agree(pressed):
    result, (direct, adjoint) = pressed
    for measure in result.seal.standard:
        own = np.atleast_2d(direct[measure.name])
        size = np.abs(own).max(axis=1, keepdims=True)
        assert (np.abs(own - np.atleast_2d(adjoint[measure.name])) <= 1e-10 * size).all()


def test_derivatives_against_central_differences(pressed):
    """Of forces and pressures in every design and parameter, within the quotients' own error."""
    result, (table, _) = pressed
    seal, checked = result.seal, 0
    for column, name in enumerate(table.parameters):
        value = abs(seal.scalars[name].value) if name in seal.scalars else 0.0
        for measure, (quotient, bound) in quotients(seal, name, 1e-4 * (value or 1.0)).items():
            exact = np.atleast_2d(table[measure])[:, column]
            assert (np.abs(quotient - exact) <= bound).all(), (name, measure)
            size = np.abs(np.atleast_2d(table[measure])).max()
            checked += bound.max() <= 1e-4 * max(np.abs(exact).max(), 1e-6 * size)
    assert checked >= len(table.parameters)


# ---- a large radius ----


def differences(value, radii=(1e3, 1e4)):
    """Differences between forces per circumference and those of plane strain, and their slopes."""
    plane = value(None, 1.0)
    far, farther = (np.abs(value(axis, 2e-3 * np.pi * axis) - plane) for axis in radii)
    assert (farther < 1e-3 * np.abs(plane).max()).all()
    return np.log10(far / farther)


@pytest.mark.parametrize("vents", [{}, VENTS])
def test_air_tends_to_plane_strain(vents):
    """The pressure, and the force per length of circumference, with errors that fall like 1 / R."""

    def value(axis, around):
        result = sm.analyze(air_ring(axis=axis, **vents))
        pressure, volume = result.response("air").outputs[0]
        return np.array([*result.value(Reaction("plate")) / around, pressure, volume / around])

    np.testing.assert_allclose(differences(value), 1.0, atol=0.05)


def test_a_fluid_tends_to_plane_strain():
    def value(axis, around):
        result = sm.analyze(ring(1000.0, axis=axis, **PRESSURE))
        return np.array([result.value(Reaction(name))[i] for name, i in FORCES]) / around

    FORCES = (("lid", 0), ("lid", 1), ("wall", 0))
    np.testing.assert_allclose(differences(value), 1.0, atol=0.05)


def test_vents_of_a_ring_are_those_on_the_circle_of_its_centroid():
    """A rigid ring of any radius loses the air of a straight strip."""
    left = []
    for axis in (None, 10.0, 100.0):
        term = sm.analyze(air_ring(axis=axis, depth=0.05, shear=0.0, **VENTS)).term("air")
        # from 1.2 times the density outside
        before = term.no_history()._replace(mass=1.2)
        left.append(term.respond(term.reference, 1.0, before).history.mass)
    assert left[0] < 1.199
    np.testing.assert_allclose(left[1:], left[0], rtol=1e-12)
