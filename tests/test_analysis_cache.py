"""Kept analyses are those that would be made, and no more memory is taken than allowed."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis_cache import AnalysisCache, held_bytes
from seal_mdao.dsa.sensitivity import particle_gradient
from seal_mdao.seals.door.door_seal import with_options

SEAL = sm.door_seal(n_steps=21)
OFFSETS = np.linspace(-0.1, 0.1, SEAL.n_offsets)
RADIUS = {"door_radius": 4.1}


def same_bits(one, other):
    return one.reaction.tobytes() == other.reaction.tobytes() and np.array_equal(
        one.deformed(), other.deformed()
    )


def factors(result):
    return [step.factor for step in result.path.steps]


@pytest.fixture(scope="module")
def cache():
    """The nominal seal and one more design, with factors as far as they stay."""
    cache = AnalysisCache()
    cache.analyze(SEAL, keep_factors=True)
    cache.analyze(SEAL, OFFSETS, RADIUS, keep_factors=True)
    return cache


def test_kept_is_what_a_new_one_would_be(cache):
    new, made = sm.analyze(SEAL, OFFSETS, RADIUS), cache.made
    again = cache.analyze(SEAL, OFFSETS, RADIUS)
    assert same_bits(new, again)
    assert np.array_equal(again.boundary_offsets, OFFSETS)
    assert again.measures() == new.measures()
    assert cache.made == made == 2


def test_another_seal_or_radius_is_another_analysis(cache):
    one = AnalysisCache()
    first = one.analyze(SEAL)
    other = one.analyze(with_options(SEAL, friction=0.3))
    assert one.made == 2
    assert not same_bits(first, other)
    assert not same_bits(first, one.analyze(SEAL, None, RADIUS))
    assert one.made == 3


def test_only_the_newest_has_factors_and_the_others_give_the_same_sensitivities(cache):
    nominal = cache.analyze(SEAL)
    assert not any(factors(nominal))
    assert all(factors(cache.analyze(SEAL, OFFSETS, RADIUS)))
    fresh = sm.analyze(SEAL, keep_factors=True)
    found, expected = (
        particle_gradient(result, (), result.measures(("gap_square_sum",)))["particles"]
        for result in (nominal, fresh)
    )
    assert np.array_equal(found["gap_square_sum"], expected["gap_square_sum"])


def test_an_array_that_goes_on_changing_does_not_change_what_was_found_with_it():
    """OpenMDAO gives a component views of its own vectors."""
    cache, particles = AnalysisCache(), SEAL.moved(OFFSETS)
    found = cache.analyze_particles(SEAL, particles)
    particles += SEAL.moved(-2.0 * OFFSETS) - SEAL.nominal_particles
    assert np.array_equal(found.particles, SEAL.moved(OFFSETS))
    assert same_bits(found, sm.analyze(SEAL, OFFSETS))


def pressed(cache, radius):
    """The nominal particles under a door of another radius, alone."""
    cache.analyze_particles(SEAL.with_parameters({"door_radius": radius}), SEAL.nominal_particles)


def test_memory_holds_what_was_looked_at_last():
    room_for_two = 2.5 * held_bytes(sm.analyze(SEAL).path) / 2**30
    cache = AnalysisCache(memory=room_for_two)
    cache.analyze(SEAL)
    for radius in (4.1, 4.0, 4.2, 4.0):  # 4.0 is the nominal one
        pressed(cache, radius)
    assert cache.made == 3
    pressed(cache, 4.1)
    assert cache.made == 4


def test_newest_stays_without_any_memory():
    cache = AnalysisCache(memory=0.0)
    for radius, made in ((4.0, 1), (4.0, 1), (4.1, 2), (4.0, 3)):
        pressed(cache, radius)
        assert cache.made == made


def test_path_that_failed_is_tried_again():
    newton = sm.NewtonOptions(damped_iterations=10)
    cache, seal = AnalysisCache(), with_options(SEAL, friction=0.0, newton=newton)
    for made in (1, 2):
        assert not cache.analyze(seal).converged
        assert cache.made == made
