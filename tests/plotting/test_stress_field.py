"""The fields that are drawn between the particles."""

import numpy as np
import pytest

from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.plotting import field


@pytest.fixture(scope="module")
def fine(nominal):
    return field.fine_grid(nominal, 3)


def at_particles(nominal, fine):
    """Which points of the fine grid are particles, and which ones."""
    alone = np.flatnonzero(fine.points.weights.max(axis=1) == 1.0)
    heaviest = fine.points.weights[alone].argmax(axis=1)
    return alone, fine.points.anchors[alone, heaviest]


def test_field_holds_the_particles(nominal, fine):
    points, particles = at_particles(nominal, fine)
    assert np.array_equal(np.sort(particles), np.arange(len(nominal.particles)))
    for step in (40, -1):
        coordinates = fine.deformed(step)[points]
        assert np.allclose(coordinates, nominal.deformed(step)[particles], atol=1e-12)
        stress = fine.von_mises(step)[points]
        assert np.allclose(stress, nominal.stress_field(step)[particles], rtol=1e-10, atol=1e-10)


def test_loops_go_round_the_section_once(nominal, fine):
    areas = [polygon_area(fine.undeformed()[loop])[0] for loop in fine.loops]
    assert len(areas) == 2
    assert max(areas) > 0.0 > min(areas)  # the hole clockwise
    assert sum(areas) == pytest.approx(nominal.path.discretization.weights.sum(), rel=1e-12)


def test_triangles_tile_the_section(nominal, fine):
    def signed_areas(coordinates):
        a, b, c = (coordinates.reshape(-1, 2)[corner] for corner in fine.triangles.T)
        u, v = b - a, c - a
        return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    undeformed = signed_areas(fine.undeformed())
    assert undeformed.min() > 0.0
    weights = nominal.path.discretization.weights
    assert undeformed.sum() == pytest.approx(weights.sum(), rel=1e-12)
    deformed = signed_areas(fine.deformed())
    assert deformed.min() > 0.0
    assert deformed.sum() == pytest.approx(undeformed.sum(), rel=1e-2)  # nearly incompressible


def test_smooth_between_particles(nominal):
    fine = field.fine_grid(nominal, 8)
    places = fine.deformed()
    outer = max((places[loop] for loop in fine.loops), key=len)
    steps = np.hypot(*np.diff(outer, axis=0).T)
    assert steps.max() < 0.3
