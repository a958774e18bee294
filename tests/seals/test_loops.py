"""Two profiles at once that turn and open again: energy over closed loops, its derivatives."""

import numpy as np
import pytest
from quotients import quotients
from two_profiles import stored_energy, two_profiles

import seal_mdao as sm

WORKS = ("plate_work", "roll_work")
RELATIVE_STEP = 4e-5
"""Where truncation and rounding leave about as much: some 1e-7 of a derivative."""


def works(result):
    return np.array([result.value(measure)[0] for measure in result.seal.measures(WORKS)])


@pytest.fixture(scope="module")
def rubbed():
    """A closed loop with friction."""
    return sm.analyze(two_profiles(friction=0.3, steps=8), keep_factors=True)


@pytest.mark.parametrize("way", ["loop", "back"])
def test_without_friction_a_loop_leaves_nothing_behind(way):
    """No force, no displacement, no energy, of the largest on the way."""
    result = sm.analyze(two_profiles(0.0, way=way))
    energy, path = stored_energy(result), result.path
    displacement = [np.abs(result.displacement(n)).max() for n in range(result.seal.n_steps)]
    assert energy[-1] <= 1e-8 * energy.max()
    assert displacement[-1] <= 1e-8 * max(displacement)
    for profile in ("plate", "roll"):
        reaction = np.abs(path.reaction(profile))
        assert reaction[-1].max() <= 1e-8 * reaction.max()


def test_both_profiles_turn_press_and_let_go():
    result = sm.analyze(two_profiles(0.0))
    for profile in ("plate", "roll"):
        touching = [own.branch.any() for own in result.path.at_nominal(profile)]
        assert sum(touching) > 5
        assert not touching[-1]
        assert np.ptp(result.term(profile).motion.angles) > 0.05


def test_without_friction_the_way_back_returns_all_work():
    """The rule takes the same forces both ways, so nothing but the solution's tolerance is left."""
    result = sm.analyze(two_profiles(0.0, way="back"))
    assert (np.abs(works(result)) <= 1e-8 * stored_energy(result).max()).all()


@pytest.mark.parametrize("way", ["in", "loop"])
def test_without_friction_work_is_stored_energy(way):
    """But for the trapezoidal rule, whose error goes down with the square of the step: sixteen times
    for a quarter of it; half of that is asked for, since where points touch the force has kinks."""
    errors = []
    for steps in (12, 48):
        result = sm.analyze(two_profiles(0.0, steps, way))
        energy = stored_energy(result)
        errors.append(abs(works(result).sum() - energy[-1]) / energy.max())
    assert errors[1] <= errors[0] / 8
    assert errors[1] <= 1e-3


def test_friction_takes_work(rubbed):
    """Ten times more than the error of the rule, which steps of half the size show."""
    fine = sm.analyze(two_profiles(friction=0.3, steps=16))
    taken, finer = works(rubbed).sum(), works(fine).sum()
    assert stored_energy(rubbed)[-1] <= 1e-8 * stored_energy(rubbed).max()
    assert finer > 10.0 * abs(finer - taken)


@pytest.mark.long
def test_derivatives_of_the_work_of_a_loop(rubbed):
    """With respect to design, materials, penalties, friction, radius and motions."""
    seal, names = rubbed.seal, tuple(rubbed.seal.scalars)
    direct, adjoint = (sm.differentiate(rubbed, names, method=m) for m in ("direct", "adjoint"))
    for column, name in enumerate(direct.parameters):
        size = abs(seal.scalars[name].value) if name in seal.scalars else 0.0
        found = quotients(seal, name, RELATIVE_STEP * (size or 1.0))
        for work in WORKS:
            one, other = direct[work][0, column], adjoint[work][0, column]
            quotient, bound = (float(part[0]) for part in found[work])
            assert abs(one - other) <= 1e-9 * abs(one), (name, work)
            assert abs(quotient - one) <= bound, (name, work)
            assert bound <= 1e-6 * abs(one), (name, work)
