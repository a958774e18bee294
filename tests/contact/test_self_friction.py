"""Forces of self-contact and their derivatives at given kinematics, against central differences."""

import numpy as np
import pytest

from seal_mdao.contact import friction
from seal_mdao.contact.boundary_curve import N_PLACES, Kinematics
from seal_mdao.contact.friction import OPEN, SLIP, STICK, ContactLaw
from seal_mdao.contact.self_friction import (
    FIRST,
    LENGTH,
    NORMAL_PENALTY,
    SIZE_0,
    Before,
    forces,
    linearized,
    resultants,
    touch,
)

LAW = ContactLaw(1000.0, 100.0, 0.3, True)
LENGTHS = np.array([0.5, 0.7, 0.6, 0.4, 0.8, 0.3])


@pytest.fixture
def points(rng):
    """Points that stick, slip, are open, and stick or slip after they were open."""
    gap = np.array([-0.02, -0.01, 0.03, -0.015, -0.02, -0.01])
    m, by_places = len(gap), rng.standard_normal((2, len(gap), N_PLACES))
    second = rng.standard_normal((2, m, N_PLACES, N_PLACES))
    now = Kinematics(
        gap, np.zeros(m), np.ones(m), by_places[0], by_places[1], np.zeros((m, N_PLACES)), *second
    )
    before = Before(
        np.array([STICK, SLIP, STICK, OPEN, STICK, OPEN]),
        np.array([0.01, 0.2, 0.01, 0.02, -0.3, -0.2]),
        np.array([1.2, 0.8, 1.0, 0.9, 1.1, 1.3]),
        np.array([0.005, 0.01, 0.0, 0.01, -0.01, 0.02]),
    )
    found = touch(LAW, now, before)
    assert found.state.tolist() == [STICK, SLIP, OPEN, STICK, SLIP, SLIP]
    return now, before, found


def quotient(function, h=1e-6):
    """Difference of fourth order."""
    values = [function(step * h) for step in (-2, -1, 1, 2)]
    return np.tensordot([1.0, -8.0, 8.0, -1.0], values, axes=1) / (12.0 * h)


def test_resultants_are_the_forces_along_gap_and_slip(points):
    now, before, found = points
    (normal, tangential), _ = (part.T for part in resultants(LAW, now.gap, before, found, LENGTHS))
    exact = forces(LAW, now, before.size, found.tau, LENGTHS)
    exact[found.state == OPEN] = 0.0
    both = normal[:, None] * now.gap_1 + tangential[:, None] * now.xi_1
    np.testing.assert_allclose(both, exact, rtol=1e-13)
    # |T| = mu |N| |t0| of the points that slip
    slips = found.state == SLIP
    limit = LAW.friction * np.abs(normal) * before.size
    np.testing.assert_allclose(np.abs(tangential)[slips], limit[slips], rtol=1e-13)


def test_slopes_of_the_resultants(points):
    now, before, found = points
    _, slopes = resultants(LAW, now.gap, before, found, LENGTHS)

    def moved(by_gap, by_slip):
        own = now._replace(gap=now.gap + by_gap)
        earlier = before._replace(change=before.change + by_slip)
        again = touch(LAW, own, earlier)
        assert np.array_equal(again.state, found.state)
        return resultants(LAW, own.gap, earlier, again, LENGTHS)[0]

    sampled = [quotient(lambda h: moved(h, 0.0)), quotient(lambda h: moved(0.0, h))]
    np.testing.assert_allclose(slopes, np.stack(sampled, axis=2), rtol=1e-8, atol=1e-6)


@pytest.mark.parametrize("name", ["xi_0", "size_0", "length", "normal_penalty"])
def test_derivatives_of_the_forces(points, name):
    now, before, found = points
    column = {
        "xi_0": FIRST + friction.XI_0, "size_0": SIZE_0, "length": LENGTH,
        "normal_penalty": NORMAL_PENALTY,
    }[name]  # fmt: skip
    exact = linearized(LAW, now, before, found, LENGTHS)[:, :N_PLACES, column]
    closed = found.state != OPEN

    def moved(h):
        law, earlier, length = LAW, before, LENGTHS
        if name == "xi_0":
            earlier = before._replace(change=before.change - h)
        elif name == "size_0":
            earlier = before._replace(size=before.size + h)
        elif name == "length":
            length = LENGTHS + h
        else:
            law = LAW._replace(normal_penalty=LAW.normal_penalty + 1e3 * h)
        again = touch(law, now, earlier)
        assert np.array_equal(again.state, found.state)
        return closed[:, None] * forces(law, now, earlier.size, again.tau, length)

    scale = 1e3 if name == "normal_penalty" else 1.0
    sampled = quotient(moved) / scale
    np.testing.assert_allclose(exact, sampled, rtol=1e-8, atol=1e-8 * np.abs(sampled).max())
