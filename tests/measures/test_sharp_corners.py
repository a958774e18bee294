"""Contact at sharp corners: two points with averages, one for each side; a warning with particles."""

from dataclasses import replace

import numpy as np
import pytest
from quotients import quotients

import seal_mdao as sm
from seal_mdao.accuracy.error_estimate import ComparedPaths
from seal_mdao.equilibrium.discretization import Edge
from seal_mdao.measures.boundary_line import (
    BoundaryLine,
    contact_fractions,
    is_closed,
    ordered_points,
)
from seal_mdao.seals.profiles import arc_length, contacts
from seal_mdao.terms.averaged_points import averaged_points

PENALTY = 1e6
BLOCK = """
{symmetry}
[material.rubber]
shore_a = 60
[section]
spacing = 0.8
{section}
outer = [
  {{ edge = "foot", line = [[0, 0], [4, 0]] }},
  {{ edge = "side", line = [[4, 0], [4, 3]] }},
  {{ edge = "head", line = [[4, 3], [0, 3]] }},
  {{ edge = "middle", line = [[0, 3], [0, 0]] }},
]
[fixed]
edges = ["foot"]
{fixed}
[[profile]]
name = "top"
friction = {friction}
{contact}
contact_points = "{points}"
{shape}
start = [0, {start}]
normal_penalty = 1e6
tangent_penalty = 1e5
stage = [{{ translate = [0, -0.35], steps = 3 }}]
{more}
"""
SYMMETRY = 'symmetry = [{ edges = ["middle"], normal = "x" }]'
ALL = 'contact = ["side", "head"]'
PRESSED = 'contact = ["head"]'
EVERY = "foot", "side", "head", "middle"
FLAT = "line = [[-40, 0], [40, 0]]"
NOSE = "arc = { start = [-6, 4], through = [0, 0], end = [6, 4] }"
PEAK = '[[measure]]\ntype = "peak_pressure"\n'
OTHERS = """[[measure]]
type = "contact_width"
[[measure]]
type = "longest_contact"
[[measure]]
type = "longest_contact"
name = "longest_above"
pressure = 100.0
[[measure]]
type = "pressure_integral"
exponent = 2
reference_pressure = 100.0
[[measure]]
type = "reaction"
"""
LEAK = """[[measure]]
type = "leak_rate"
rms_roughness = 50.0
roll_off_wavelength = 500.0
shortest_wavelength = 1.0
pressure = 10.0
"""
UNEVEN = "edge_spacing = { side = 0.3 }"


def block(folder, contact, points="averages", more=PEAK, **changes):
    """The seal of a block below a plate, with its foot and its left side in planes of symmetry."""
    given = {
        "symmetry": SYMMETRY, "section": "", "fixed": 'directions = ["y"]', "friction": 0.0,
        "shape": FLAT, "start": 3,
    } | changes  # fmt: skip
    path = folder / "block.toml"
    path.write_text(BLOCK.format(contact=contact, points=points, more=more, **given))
    return sm.build_seal(path)


def pressures(result):
    """w_n |g_n| of the points in contact."""
    gap = result.response("top").gap
    return -PENALTY * gap[gap < 0.0]


def warnings_of(result):
    return [own for own in result.warnings if "sharp corner" in own]


@pytest.mark.parametrize("section", ["", UNEVEN], ids=["even", "uneven"])
@pytest.mark.parametrize("contact", ["", ALL], ids=["filled in", "given"])
def test_free_sides_in_the_list_leave_the_pressure_uniform(tmp_path, contact, section):
    """All results are those of a list of the pressed edge alone, with as many iterations."""
    measures = PEAK + OTHERS + LEAK
    result, alone = (
        sm.analyze(block(tmp_path, own, more=measures, section=section))
        for own in (contact, PRESSED)
    )
    found, exact = pressures(result), pressures(alone)
    assert found.size == exact.size == len(contacts(alone.seal)[0].where)
    np.testing.assert_allclose(found, exact.mean(), rtol=1e-10)
    for measure in alone.seal.standard:
        own = float(result.value(measure.name)[0])
        assert own == pytest.approx(float(alone.value(measure.name)[0]), rel=1e-8), measure.name
    one, other = (sum(step.iterations for step in own.path.steps) for own in (result, alone))
    assert one <= 1.1 * other
    assert warnings_of(result) == []


def test_each_point_of_a_corner_has_its_side_alone(tmp_path):
    """Their place is that of the particle, half of one side is the tributary length of each."""
    seal = block(tmp_path, ALL)
    (where,), X = (own.where for own in contacts(seal)), seal.nominal_particles
    (first,) = np.flatnonzero(np.diff(where.points.anchors[:, 0]) == 0)
    np.testing.assert_allclose(where.points.at(X)[first : first + 2], [[4.0, 3.0]] * 2, atol=1e-14)
    corner, sides = (
        where.lengths(X)[first : first + 2],
        np.linalg.norm(np.diff(X[where.points.anchors[first - 1 : first + 3, 0]], axis=0), axis=1),
    )
    np.testing.assert_allclose(corner, 0.5 * sides[[0, 2]], rtol=1e-14)
    # 2 % of a side away from the corner
    away = where.moving.at(X)[first : first + 2] - [4.0, 3.0]
    np.testing.assert_allclose(away, [[0.0, -0.02 * sides[0]], [-0.02 * sides[2], 0.0]], atol=1e-14)
    assert where.lengths(X).sum() == pytest.approx(7.0, rel=1e-12)


def test_both_points_of_a_corner_are_at_one_place_of_profiles_and_exports(tmp_path):
    result = sm.analyze(block(tmp_path, ALL))
    s, gap = arc_length(result, "top"), result.response("top").gap
    (first,) = np.flatnonzero(np.diff(s) == 0.0)
    assert gap[first] > 0.0 > gap[first + 1]
    where, n = result.term("top").where, len(result.particles)
    at_corner = where.mean_at_particles(-np.minimum(gap, 0.0), n)[where.points.anchors[first, 0]]
    assert at_corner == -gap[first + 1]


def test_a_closed_boundary_remains_closed():
    """A square whose corners are all sharp, whichever particle comes first."""
    square = np.array(
        [[0, 0], [1, 0], [2, 0], [2, 1], [2, 2], [1, 2], [0, 2], [0, 1]], float
    )  # fmt: skip
    for first in (0, 1):
        ring = np.roll(np.arange(8), -first)
        where = averaged_points(ring, Edge(ring, True).neighbours, square)
        assert len(where) == 12
        assert is_closed(where)
        line = BoundaryLine(where, ordered_points(where), square)
        assert line.length.sum() == 8.0
        assert (line.length == 0.0).sum() == 4
        # derivatives along the zero segments are zero, not undefined
        seeds = np.zeros_like(square)
        line.add_partials(np.ones(12), seeds)
        np.testing.assert_allclose(seeds[0], [-1.0, -1.0], atol=1e-15)
        assert where.lengths(square).sum() == 8.0


def test_a_contact_ends_at_the_corner():
    """One point of a corner presses, the other one is open: the segment between them has no length."""
    found = contact_fractions(
        np.array([0.5, 0.01, -1e-4, -1e-4]), np.array([1.0, 0.0, 1.0]), np.full(4, 400.0), PENALTY
    )
    assert np.isfinite(np.hstack(found)).all()
    assert found.fraction[[0, 2]].tolist() == [0.0, 1.0]


def test_each_point_of_a_corner_has_the_friction_of_its_side(tmp_path):
    seal = block(tmp_path, ALL, friction="{ side = 0.1, head = 0.3 }")
    (contact,) = contacts(seal)
    (first,) = np.flatnonzero(np.diff(contact.where.points.anchors[:, 0]) == 0)
    groups, names = contact.law.friction.groups, contact.law.friction.names
    assert [names[group] for group in groups[first : first + 2]] == ["side", "head"]
    assert (groups[: first + 1] == groups[0]).all()
    assert (groups[first + 1 :] == groups[-1]).all()


DESIGN = """
[[design]]
edges = ["side"]
parameters = 4
bound = 0.3
[[design]]
edges = ["head"]
parameters = 4
bound = 0.3
"""
PARAMETERS = {
    "boundary_offsets[1]": 2e-4, "boundary_offsets[3]": 2e-4, "boundary_offsets[4]": 2e-4,
    "top_friction": 1e-4, "top_normal_penalty": 1e2,
}  # fmt: skip


@pytest.fixture(scope="module")
def sheared(tmp_path_factory):
    """A bonded block below a rough plate, which the shape of both sides of its corner changes."""
    seal = block(
        tmp_path_factory.mktemp("sheared"), ALL, more=PEAK + OTHERS + LEAK + DESIGN, fixed="",
        friction=0.2, start=3.05,
    )  # fmt: skip
    return sm.analyze(replace(seal, newton=sm.NewtonOptions(tolerance=1e-12)), keep_factors=True)


@pytest.fixture(scope="module")
def derivatives(sheared):
    names = [name for name in PARAMETERS if name in sheared.seal.scalars]
    return [
        sm.differentiate(sheared, names, sheared.seal.standard, method)
        for method in ("direct", "adjoint")
    ]


def test_direct_and_adjoint_derivatives_agree(sheared, derivatives):
    for measure in sheared.seal.standard:
        one, other = (np.atleast_2d(found[measure.name]) for found in derivatives)
        np.testing.assert_allclose(one, other, rtol=0.0, atol=1e-11 * np.abs(one).max())


@pytest.mark.parametrize("name", PARAMETERS)
def test_derivatives_are_those_of_the_path(sheared, derivatives, name):
    direct, _ = derivatives
    column = direct.parameters.index(name)
    for measure, (quotient, bound) in quotients(sheared.seal, name, PARAMETERS[name]).items():
        found = np.atleast_2d(direct[measure])[:, column]
        assert np.all(np.abs(found - quotient) <= bound), measure
        # a bound that says something
        assert bound.max() <= 1e-4 * np.abs(found).max(), measure


def test_error_estimate_begins_as_near_as_that_of_the_pressed_side(tmp_path):
    """The finer body of the estimate begins with the gaps of the coarse one; a uniform pressure has no
    error."""
    iterations = []
    for contact in (ALL, PRESSED):
        result = sm.analyze(block(tmp_path, contact))
        file = sm.read_seal_file(tmp_path / "block.toml")
        paths = ComparedPaths(file, result, None)
        iterations.append([step.iterations for step in paths.fine.path.steps])
        peak = float(result.value("peak_pressure")[0])
        finer = float(paths.fine.value("peak_pressure")[0])
        assert finer == pytest.approx(peak, rel=1e-8)
    assert sum(iterations[0]) <= 1.1 * sum(iterations[1]), iterations


# ---- contact at particles ----


@pytest.mark.parametrize("contact", ["", ALL], ids=["filled in", "given"])
def test_a_corner_particle_with_a_free_side_in_the_list_is_reported(tmp_path, contact):
    """The pressure of the block is uniform; the contact point at its corner has another."""
    result = sm.analyze(block(tmp_path, contact, "particles"))
    (warning,) = warnings_of(result)
    assert (
        "'top' presses on a sharp corner of the section, at x = 4, y = 3 (undeformed coordinates)"
        in warning
    )
    found = pressures(result)
    assert found.max() > 1.1 * found.mean()
    assert found.min() < 0.5 * found.mean()


@pytest.mark.parametrize(
    ("points", "more"), [("edges", PEAK), ("particles", "")], ids=["midpoints", "no pressure"]
)
def test_no_warning_without_a_corner_point_or_a_pressure(tmp_path, points, more):
    more = more or '[[measure]]\ntype = "reaction"\n'
    assert warnings_of(sm.analyze(block(tmp_path, ALL, points, more))) == []


def test_a_corner_that_is_not_pressed_is_no_fault(tmp_path):
    result = sm.analyze(block(tmp_path, ALL, "particles", shape=NOSE))
    assert warnings_of(result) == []
    assert (result.response("top").gap < 0.0).any()
