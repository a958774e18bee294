"""Contact at particles that move as the mean of their edges."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.terms.averaged_points import averaged_points


@pytest.fixture(scope="module")
def seal():
    return sm.door_seal(
        accuracy="engineering", contact_points="averages", n_steps=6,
        newton=sm.NewtonOptions(tolerance=1e-11),
    )  # fmt: skip


@pytest.fixture(scope="module")
def result(seal):
    return sm.analyze(seal, keep_factors=True)


def test_there_is_a_point_at_every_free_particle(seal):
    where, particles = seal.terms()[1].where, seal.nominal_particles
    outer = options_of(seal).grid.free_outer
    np.testing.assert_array_equal(where.points.anchors[:, 0], outer)
    # edges of one length: the means of a ring are its particles
    away = np.hypot(*(where.moving.at(particles) - particles[outer]).T)
    assert away[6:-6].max() < 1e-3 * where.lengths(particles).min()


def test_the_work_of_a_profile_that_turns_is_refused(result):
    with pytest.raises(ValueError, match="between particles"):
        result.term("door").where.at_particles  # noqa: B018


@pytest.mark.parametrize("mirrored", [False, True])
def test_rounding_of_the_particles_does_not_decide_on_the_curvature_of_an_arc(mirrored):
    """All edges of an arc have the same length and bend: the points are those of the arc elsewhere."""
    angle = np.linspace(0.2, 2.9, 24)
    arc = 3.0 * np.column_stack([np.cos(angle), np.sin(angle)])
    number = np.arange(24)
    neighbours = np.column_stack([np.maximum(number - 1, 0), np.minimum(number + 1, 23)])
    here = averaged_points(number, neighbours, arc).averages.gauss
    elsewhere = arc * [-1.0 if mirrored else 1.0, 1.0] + [7.3, -3.1]
    there = averaged_points(number, neighbours, elsewhere).averages.gauss
    np.testing.assert_array_equal(here.anchors, there.anchors)
    np.testing.assert_allclose(here.weights, there.weights, rtol=0.0, atol=1e-12)
    # between two edges of the arc, both ends give half of the curvature
    inner = here.weights[20]
    assert inner[2] == pytest.approx(inner[3], rel=1e-12)


@pytest.mark.parametrize("share", [0.0, 0.3], ids=["even", "uneven"])
def test_the_mean_of_a_round_boundary_at_the_axis_is_its_particle(share):
    """The next ones lie on the sphere up to the fourth power of the spacing."""
    radius, away = 3.0, []
    for count in (12, 24):
        number, step = np.arange(count), np.ones(count - 1)
        step[1::2] += share
        angle = np.append(0.0, np.cumsum(step))
        # from the edge of the dome to the axis
        angle = 1.5 * angle[::-1] / angle[-1]
        arc = radius * np.column_stack([np.sin(angle), np.cos(angle)])
        arc[-1] = 0.0, radius
        neighbours = np.column_stack([np.maximum(number - 1, 0), np.minimum(number + 1, count - 1)])
        means = averaged_points(number, neighbours, arc, axisymmetric=True).averages.at(arc)
        np.testing.assert_allclose(means[-1], arc[-1], rtol=0.0, atol=1e-15)
        away.append(np.abs(np.hypot(*means[-5:-1].T) - radius).max())
    assert away[0] < 2e-3
    assert away[1] < away[0] / 4.0
