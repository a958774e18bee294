"""Contact in the middle of the edges between particles."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN
from seal_mdao.export.vtu import point_data
from seal_mdao.measures.boundary_line import ordered_points
from seal_mdao.measures.contact_pressure import ContactWidth
from seal_mdao.report.picture_data import contact_points
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.terms.points import edge_points


@pytest.fixture(scope="module")
def seal():
    return sm.door_seal(
        accuracy="engineering", n_steps=6, newton=sm.NewtonOptions(tolerance=1e-11)
    )  # fmt: skip


@pytest.fixture(scope="module")
def result(seal):
    return sm.analyze(seal, keep_factors=True)


def test_points_lie_half_way_between_the_free_particles(seal):
    term = seal.terms()[1]
    particles, outer = seal.nominal_particles, options_of(seal).grid.free_outer
    np.testing.assert_array_equal(
        term.where.points.anchors, np.column_stack([outer[:-1], outer[1:]])
    )
    np.testing.assert_allclose(
        term.where.points.at(particles), 0.5 * (particles[outer[:-1]] + particles[outer[1:]])
    )
    ends = np.diff(particles[outer], axis=0)
    np.testing.assert_allclose(term.where.lengths(particles), np.hypot(*ends.T))


def test_order_round_a_closed_boundary_is_known():
    ring = edge_points(np.column_stack([np.arange(5), np.roll(np.arange(5), -1)]), 1)
    np.testing.assert_array_equal(ordered_points(ring), [0, 1, 2, 3, 4, 0])
    row = edge_points(np.column_stack([np.arange(4), np.arange(1, 5)]), 1)
    np.testing.assert_array_equal(ordered_points(row), [0, 1, 2, 3])


def test_width_is_that_of_the_touching_stretches(result):
    state, x = result.contact.state, result.term("door").reference
    touching = state != OPEN
    inside = np.hypot(*np.diff(x, axis=0).T)[touching[:-1] & touching[1:]].sum()
    width = float(result.value(ContactWidth("door"))[0])
    assert inside < width < inside + 4.0 * np.hypot(*np.diff(x[:2], axis=0)[0])


def test_pressure_of_particles_is_the_mean_of_the_points_beside(result):
    pytest.importorskip("meshio")
    outer = options_of(result.seal).grid.free_outer
    points = -options_of(result.seal).normal_penalty * np.minimum(result.contact.gap, 0.0)
    found = point_data(result, len(result.path.nominal_steps) - 1)["nominal_pressure_door"]
    np.testing.assert_allclose(found[outer[1:-1]], 0.5 * (points[:-1] + points[1:]), rtol=1e-12)
    assert np.flatnonzero(found).size == np.isin(outer, np.flatnonzero(found)).sum()


def test_pictures_of_the_report_have_the_points_where_they_are(result):
    """In contact at the middle of deformed edges, open ones between contacts there too."""
    points, marks = contact_points(result, -1)
    state, where = result.contact.state, result.term("door").where
    first, last = np.flatnonzero(state != OPEN)[[0, -1]]
    middles = where.points.at(result.deformed())[first : last + 1]
    np.testing.assert_allclose(points, middles, rtol=0.0, atol=0.2)
    followed = result.response("door").x[first : last + 1]
    np.testing.assert_allclose(points, followed, rtol=0.0, atol=1e-12)
    assert len(marks) == len(points)
