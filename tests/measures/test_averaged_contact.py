"""Contact at particles that move as the mean of their edges."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of


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
