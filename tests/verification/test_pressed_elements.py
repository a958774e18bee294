"""The independent elements of the door seal: their limit, and that of the other finite element code."""

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.seals.door.door_seal import options_of
from verification.flat_door_reference import REACTION
from verification.pressed_elements import CORNER, FLAT, GAP, PressedElements

LIMITS = {"flat": FLAT, "corner": CORNER}


def elements(door, across, around, **changes):
    return PressedElements(sm.door_seal(door=door, **changes), across, around)


def test_ring_closes_and_has_the_area_of_the_section(figure):
    """Biquadratic maps of the circles: the error of the area falls with the fourth power."""
    section = options_of(sm.door_seal()).section
    half = section.base_angle
    outside = 4.0 * np.tan(half) + 2.0 * np.pi - 4.0 * half  # base, two flanks, circle
    exact = 0.5 * section.outer_radius**2 * outside - np.pi * section.inner_radius**2
    errors = [abs(elements("flat", 2, n).mesh.weights.sum() / exact - 1.0) for n in (58, 116)]
    figure("elements of the door seal: area", errors[0], 1e-6)
    assert errors[1] < errors[0] / 10.0


def test_coarse_elements_are_within_a_quarter_percent(figure):
    found = elements("flat", 2, 58, n_steps=42).press()
    assert np.abs(found.reaction[:, 0]).max() < 1e-6 * found.reaction[-1, 1]  # mirror symmetry
    error = np.abs(found.curve / FLAT - 1.0).max()
    figure("flat door, 2 x 58 elements: reaction from their limit", error, 2.5e-3)


def test_tangent_is_that_of_the_residual(figure, rng):
    """With the pressures that belong to the displacements, and points that stick, slip and are open."""
    pressed = elements("corner", 2, 58, n_steps=21)
    pressed.press()
    pose = pressed.options.motion.pose(20.9)
    m, n = len(pressed.mesh.connectivity), pressed.n_nodes
    start = 1e-3 * rng.standard_normal((n, 2))
    along = np.zeros(2 * n)
    along[pressed.free] = rng.standard_normal(pressed.free.size)

    def at(u):
        shift = pressed.system(u, np.zeros((m, 3)), pose, pressed.no_direction())[2][0]
        return pressed.system(u, -shift, pose, pressed.no_direction())[:2]

    u = pressed.end + start
    tangent = at(u)[1] @ along[pressed.free]
    step = 1e-6
    moved = [at(u + sign * step * along.reshape(n, 2))[0][pressed.free] for sign in (1.0, -1.0)]
    slope = (moved[0] - moved[1]) / (2.0 * step)
    error = np.abs(slope - tangent).max() / np.abs(slope).max()
    figure("elements of the door seal: tangent", error, 1e-7)


@pytest.mark.release
@pytest.mark.parametrize("door", LIMITS)
def test_finer_elements_meet_the_limit(door, figure):
    found = elements(door, 4, 116).press()
    error = np.abs(found.curve / LIMITS[door] - 1.0).max()
    figure(f"{door} door, 4 x 116 elements: reaction from their limit", error, 1e-3)
    if door == "corner":
        figure(
            "corner door, 4 x 116 elements: largest gap", abs(found.largest_gap / GAP - 1.0), 5e-3
        )


def test_limit_is_that_of_the_other_code(figure):
    """Which has rigid contact in place of the penalties, and 8 x 232 elements."""
    figure("flat door: two finite element codes", np.abs(FLAT / REACTION[:, 1] - 1.0).max(), 3e-3)
