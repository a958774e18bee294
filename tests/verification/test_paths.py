"""The load path: step refinement, frames of reference, units."""

import numpy as np
import pytest

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.seals.door.door_seal import door_seal
from verification.frames import Frame, analyze_in_frame
from verification.step_refinement import STEPS, refine_steps
from verification.tolerances import TOLERANCES

FRAMES = {
    "rotated": Frame(angle=0.7),
    "shifted": Frame(shift=(30.0, -50.0)),
    "mirrored": Frame(mirrored=True),
    "metres and pascals": Frame(size=1e-3, stress=1e3),
    "all at once": Frame(2.0, True, (3.0, 4.0), 1e-3, 1e3),
}


def test_accumulated_friction_settles_with_the_steps_and_incremental_does_not():
    accumulated, incremental = (
        refine_steps(h, (50, 100, 200)) for h in ("accumulated", "incremental")
    )
    assert np.all(accumulated.changes[1] < 0.7 * accumulated.changes[0])
    # the changes grow where they should shrink
    assert np.all(incremental.changes[1] > incremental.changes[0])
    assert np.all(incremental.changes[1] > 10.0 * accumulated.changes[1])


@pytest.mark.long
def test_accumulated_friction_converges_with_the_first_order(figure):
    study = refine_steps("accumulated", (*STEPS, 1600))
    assert np.all(np.diff(study.errors, axis=0) < 0.0)
    # what an error of exactly first order shows against 1600 steps
    assert 1.0 < study.first_order < 1.15
    for name, order in zip(("Fx", "Fy", "sum of g^2"), study.orders, strict=True):
        below = study.first_order - order
        figure(f"50 ... 400 steps, accumulated, {name}: order below the first by", below, 0.0)
    _, reaction, gap = study.errors[-1]
    figure("400 steps against 1600: vertical reaction", reaction, TOLERANCES["steps_reaction"])
    figure("400 steps against 1600: sum of g^2", gap, TOLERANCES["steps_gap"])


@pytest.fixture(scope="module")
def model():
    """No particle touches exactly at the end of a step, where rounding would choose its state."""
    newton = NewtonOptions(tolerance=1e-11)
    return door_seal(depth=7.0, n_steps=40, start=10.03, newton=newton)


@pytest.fixture(scope="module")
def original(model):
    return analyze_in_frame(model, Frame())


@pytest.mark.parametrize("name", FRAMES)
def test_results_do_not_depend_on_frame_and_units(figure, model, original, name):
    other = analyze_in_frame(model, FRAMES[name])
    np.testing.assert_array_equal(other.state, original.state)
    size = np.abs(original.reaction).max()
    reaction = np.abs(other.reaction - original.reaction).max() / size
    tolerance = TOLERANCES["frames_reaction"]
    figure(f"door seal, {name}: reaction over the whole path", reaction, tolerance)
    for quantity in ("displacement", "gap"):
        away = np.abs(getattr(other, quantity) - getattr(original, quantity)).max()
        figure(f"door seal, {name}: {quantity}, mm", away, TOLERANCES["frames_mm"])
