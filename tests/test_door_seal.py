"""The door-seal example as a whole: what the analysis must show."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.contact.friction import OPEN

# independent finite element solution of the flat door with friction 0.25: door travel, mm, and
# vertical reaction, N/m
FLAT_TRAVEL = (2.0, 4.0, 6.0, 8.0, 10.0)
FLAT_REACTION = np.array([13.674875, 24.233102, 35.704187, 49.517427, 64.567162])
# the same solution at 10 mm: undeformed and deformed points of the outer boundary, mm
FLAT_BOUNDARY = np.array(
    [
        [3.2009, -9.5000, 3.2009, -9.5000],
        [4.0844, -8.8284, 4.0013, -9.1886],
        [4.9266, -8.1881, 4.8407, -8.9905],
        [5.7492, -7.5629, 5.7176, -8.9601],
        [6.5331, -6.8970, 6.6487, -8.9983],
        [7.2405, -6.1502, 7.6298, -8.9977],
        [7.8630, -5.3313, 8.6561, -8.9043],
        [8.3934, -4.4499, 9.7078, -8.6566],
        [8.8253, -3.5163, 10.7383, -8.1937],
        [9.1537, -2.5415, 11.6658, -7.4717],
        [9.3749, -1.5369, 12.3775, -6.4890],
        [9.4861, -0.5143, 12.7565, -5.3101],
        [9.4861, 0.5143, 12.7291, -4.0644],
        [9.3749, 1.5369, 12.3019, -2.9058],
        [9.1537, 2.5415, 11.5586, -1.9551],
        [8.8253, 3.5163, 10.6174, -1.2652],
        [8.3934, 4.4499, 9.5866, -0.8265],
        [7.8630, 5.3313, 8.5415, -0.5916],
        [7.2405, 6.1502, 7.5227, -0.5025],
        [6.5331, 6.8970, 6.5428, -0.5000],
        [5.7492, 7.5629, 5.5865, -0.5000],
        [4.8978, 8.1401, 4.6450, -0.5000],
        [3.9889, 8.6220, 3.7107, -0.5000],
        [3.0334, 9.0027, 2.7816, -0.5000],
        [2.0422, 9.2779, 1.8541, -0.5000],
        [1.0271, 9.4443, 0.9270, -0.5000],
        [0.0000, 9.5000, -0.0000, -0.5001],
        [-1.0271, 9.4443, -0.9270, -0.5000],
        [-2.0422, 9.2779, -1.8541, -0.5000],
        [-3.0334, 9.0027, -2.7816, -0.5000],
        [-3.9889, 8.6220, -3.7107, -0.5000],
        [-4.8978, 8.1401, -4.6450, -0.5000],
        [-5.7492, 7.5629, -5.5865, -0.5000],
        [-6.5331, 6.8970, -6.5428, -0.5000],
        [-7.2405, 6.1502, -7.5227, -0.5025],
        [-7.8630, 5.3313, -8.5415, -0.5916],
        [-8.3934, 4.4499, -9.5866, -0.8265],
        [-8.8253, 3.5163, -10.6174, -1.2652],
        [-9.1537, 2.5415, -11.5586, -1.9551],
        [-9.3749, 1.5369, -12.3019, -2.9058],
        [-9.4861, 0.5143, -12.7291, -4.0644],
        [-9.4861, -0.5143, -12.7565, -5.3101],
        [-9.3749, -1.5369, -12.3775, -6.4890],
        [-9.1537, -2.5415, -11.6658, -7.4717],
        [-8.8253, -3.5163, -10.7383, -8.1937],
        [-8.3934, -4.4499, -9.7078, -8.6566],
        [-7.8630, -5.3313, -8.6561, -8.9043],
        [-7.2405, -6.1502, -7.6298, -8.9977],
        [-6.5331, -6.8970, -6.6487, -8.9983],
        [-5.7492, -7.5629, -5.7176, -8.9601],
        [-4.9266, -8.1881, -4.8407, -8.9905],
        [-4.0844, -8.8284, -4.0013, -9.1886],
        [-3.2009, -9.5000, -3.2009, -9.5000],
    ]
)


def reaction_at(result, travel):
    """Vertical reaction after the given door travels."""
    return np.interp(travel, result.door_travel, result.reaction[:, 1])


@pytest.fixture(scope="module")
def corner():
    return sm.analyze(sm.door_seal())


@pytest.fixture(scope="module")
def flat_door():
    return sm.analyze(sm.door_seal(door="flat"))


def test_drawn_seal_converges_without_a_cut(corner):
    assert corner.converged
    assert corner.step_cuts == 0
    assert len(corner.newton_iterations) == 105
    assert 230 <= corner.newton_iterations.sum() <= 280


def test_flat_door_reaction_is_near_the_finite_element_solution(flat_door):
    error = reaction_at(flat_door, FLAT_TRAVEL) / FLAT_REACTION - 1.0
    assert np.abs(error).max() <= 0.03


def test_refined_flat_door_reaction_is_nearer():
    fine = sm.analyze(sm.door_seal(door="flat", rays=116, layers=5))
    error = reaction_at(fine, FLAT_TRAVEL) / FLAT_REACTION - 1.0
    assert np.abs(error).max() <= 0.01


def test_flat_door_boundary_is_within_a_tenth_of_a_millimetre(flat_door):
    outer = flat_door.model.grid.free_outer
    before, after = flat_door.particles[outer], flat_door.deformed()[outer]
    angle = np.arctan2(before[:, 0], -before[:, 1]) % (2 * np.pi)
    drawn, deformed = FLAT_BOUNDARY[:, :2], FLAT_BOUNDARY[:, 2:]
    known = np.arctan2(drawn[:, 0], -drawn[:, 1]) % (2 * np.pi)
    order = np.argsort(known)
    away = [np.interp(angle, known[order], deformed[order, c]) - after[:, c] for c in (0, 1)]
    assert np.hypot(*away).max() <= 0.1


def test_contact_grows_and_then_splits_in_two(corner):
    """Figure 4: one patch that grows up to about 5.5 mm, then the middle opens."""
    patches, width = [], []
    for step in corner.path.nominal_steps:
        touching = step.after.state != OPEN
        patches.append(int(touching[0]) + int(np.sum(np.diff(touching.astype(int)) == 1)))
        width.append(int(touching.sum()))
    travel = corner.door_travel
    assert set(np.array(patches)[(travel > 0.05) & (travel < 5.0)]) == {1}
    assert patches[-1] == 2
    early = np.array(width)[(travel > 0.05) & (travel < 5.0)]
    assert (np.diff(early) >= 0).all()
    assert early[-1] >= 5
    assert len(corner.points.gap) == 7
    assert corner.gap.max() == pytest.approx(0.12, abs=0.005)
    assert corner.gap_square_sum == pytest.approx(0.05, abs=0.005)
    assert corner.von_mises.max() == pytest.approx(170.0, abs=3.0)


def horizontal_reactions(history):
    steps = (105, 210, 420)
    return np.array(
        [
            sm.analyze(sm.door_seal(friction_history=history, n_steps=n)).reaction[-1, 0]
            for n in steps
        ]
    )


def test_accumulated_slip_settles_with_the_steps_and_incremental_creeps():
    settled, creeping = (
        np.abs(np.diff(horizontal_reactions(h))) for h in ("accumulated", "incremental")
    )
    assert settled[1] < 0.7 * settled[0]
    assert creeping[1] > settled[1]
