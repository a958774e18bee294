"""Refinement of the door seal, and the flat door against an independent solution."""

import numpy as np

from seal_mdao.verification.seal_refinement import LEVELS, corner_level, flat_door_error


def test_flat_door_meets_the_finite_element_curve(figure):
    errors = [
        np.abs(flat_door_error(*level, n_steps=n)).max()
        for level, n in zip(LEVELS, (105, 105, 42), strict=True)
    ]
    figure("flat door, 174 particles: reaction at 2 ... 10 mm", errors[0], 0.03)
    figure("flat door, 116 x 5 particles: reaction at 2 ... 10 mm", errors[1], 0.01)
    figure("flat door, 174 x 7 particles: reaction at 2 ... 10 mm", errors[2], 0.005)


def test_corner_door_converges_with_the_particles(figure):
    levels = [corner_level(*level) for level in LEVELS]
    reaction = np.array([level.reaction for level in levels])
    change = np.abs(np.diff(reaction, axis=0))
    assert change[1, 1] < 0.5 * change[0, 1]
    assert change[1, 0] < 0.5 * change[0, 0]
    figure("corner door, 116 x 5 to 174 x 7: reaction", change[1, 1] / reaction[2, 1], 5e-3)
    gap = np.array([[level.max_gap, level.gap_square_integral] for level in levels])
    last = np.abs(gap[1] / gap[2] - 1.0)
    figure("corner door, 116 x 5 to 174 x 7: maximum gap", last[0], 0.02)
    figure("corner door, 116 x 5 to 174 x 7: integral of g^2", last[1], 0.05)
