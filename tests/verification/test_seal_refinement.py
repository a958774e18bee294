"""Refinement of the door seal, and the flat door against an independent solution."""

import numpy as np
import pytest

from verification.seal_refinement import LEVELS, corner_level, flat_level
from verification.tolerances import TOLERANCES


def check_level(figure, level):
    name = f"flat door, {level.rays} x {level.layers} particles: "
    force = np.abs(level.reaction_error).max()
    figure(name + "reaction at 2 ... 10 mm", force, TOLERANCES[f"flat_{level.rays}"])
    place = TOLERANCES[f"flat_{level.rays}_mm"]
    figure(name + "outer boundary, mm", level.boundary_error, place)


def test_flat_door_meets_the_finite_element_solution(figure):
    check_level(figure, flat_level(*LEVELS[0]))


@pytest.mark.long
def test_flat_door_converges_to_the_finite_element_solution(figure):
    levels = [flat_level(*level) for level in LEVELS]
    for level in levels:
        check_level(figure, level)
    reaction = np.array([np.abs(level.reaction_error) for level in levels])
    assert np.all(np.diff(reaction, axis=0) < 0.0)
    assert np.all(np.diff([level.boundary_error for level in levels]) < 0.0)


@pytest.mark.long
def test_corner_door_converges_with_the_particles(figure):
    levels = [corner_level(*level) for level in LEVELS]
    reaction = np.array([level.reaction for level in levels])
    change = np.abs(np.diff(reaction, axis=0))
    assert np.all(change[1] < 0.5 * change[0])
    name = "corner door, 116 x 5 to 174 x 7: "
    figure(name + "reaction", change[1, 1] / reaction[2, 1], TOLERANCES["corner_reaction"])
    gap = np.array([[level.max_gap, level.gap_square_integral] for level in levels])
    changes = np.abs(np.diff(gap, axis=0)) / gap[2]
    assert np.all(changes[1] < changes[0])
    figure(name + "maximum gap", changes[1, 0], TOLERANCES["corner_gap"])
    figure(name + "integral of g^2", changes[1, 1], TOLERANCES["corner_integral"])
