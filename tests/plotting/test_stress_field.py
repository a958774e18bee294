"""The fields that are drawn between the particles."""

import numpy as np
import pytest

from seal_mdao.plotting import field


@pytest.fixture(scope="module")
def fine(drawn):
    return field.fine_grid(drawn, along=3, across=2)


def test_field_holds_the_particles(drawn, fine):
    at = np.s_[::3, ::2]
    for step in (40, -1):
        coordinates = field.deformed(drawn, fine, step)[at].reshape(-1, 2)
        assert np.allclose(coordinates, drawn.deformed(step), atol=1e-12)
        stress = field.von_mises(drawn, fine, step).reshape(fine.shape)[at].ravel()
        assert np.allclose(stress, drawn.stress_field(step), rtol=1e-10, atol=1e-10)


def test_triangles_tile_the_section(drawn, fine):
    def signed_areas(coordinates):
        a, b, c = (coordinates.reshape(-1, 2)[corner] for corner in fine.triangles.T)
        u, v = b - a, c - a
        return 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])

    undeformed = signed_areas(field.undeformed(drawn, fine))
    assert undeformed.min() > 0.0
    weights = drawn.path.discretization.weights
    assert undeformed.sum() == pytest.approx(weights.sum(), rel=1e-12)
    deformed = signed_areas(field.deformed(drawn, fine))
    assert deformed.min() > 0.0
    assert deformed.sum() == pytest.approx(undeformed.sum(), rel=1e-2)  # nearly incompressible


def test_smooth_between_particles(drawn):
    fine = field.fine_grid(drawn, along=8, across=2)
    outer = field.deformed(drawn, fine)[:, -1]
    steps = np.hypot(*np.diff(outer, axis=0).T)
    assert steps.max() < 0.3
