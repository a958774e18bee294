"""The load path: step refinement, frames of reference, units."""

import numpy as np
import pytest

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.model import door_seal
from seal_mdao.verification.frames import Frame, analyze_in_frame
from seal_mdao.verification.step_refinement import STEPS, refine_steps

FRAMES = {
    "rotated": Frame(angle=0.7),
    "shifted": Frame(shift=(30.0, -50.0)),
    "mirrored": Frame(mirrored=True),
    "metres and pascals": Frame(size=1e-3, stress=1e3),
    "all at once": Frame(2.0, True, (3.0, 4.0), 1e-3, 1e3),
}


def test_accumulated_friction_converges_with_the_steps(figure):
    study = refine_steps("accumulated", (*STEPS, 1600))
    assert np.all(np.diff(study.errors, axis=0) < 0.0)
    for name, order in zip(("Fx", "Fy", "sum of g^2"), study.orders, strict=True):
        figure(f"50 ... 400 steps, accumulated, {name}: order below 1 by", 1.0 - order, 0.0)
    figure("400 steps against 1600: vertical reaction", study.errors[-1, 1], 1e-4)
    figure("400 steps against 1600: sum of g^2", study.errors[-1, 2], 5e-3)


def test_incremental_friction_does_not_converge():
    study = refine_steps("incremental")
    # the changes grow where they should shrink
    assert np.all(np.diff(study.changes[:, 0]) > 0.0)
    assert study.changes[-1, 2] > study.changes[0, 2]
    accumulated = refine_steps("accumulated")
    assert np.all(study.changes[-1] > 10.0 * accumulated.changes[-1])


@pytest.fixture(scope="module")
def model():
    return door_seal(newton=NewtonOptions(tolerance=1e-11))


@pytest.fixture(scope="module")
def original(model):
    return analyze_in_frame(model, Frame())


@pytest.mark.parametrize("name", FRAMES)
def test_results_do_not_depend_on_frame_and_units(figure, model, original, name):
    other = analyze_in_frame(model, FRAMES[name])
    np.testing.assert_array_equal(other.state, original.state)
    size = np.abs(original.reaction).max()
    reaction = np.abs(other.reaction - original.reaction).max() / size
    figure(f"door seal, {name}: reaction over the whole path", reaction, 1e-8)
    shift = np.abs(other.displacement - original.displacement).max()
    figure(f"door seal, {name}: displacements, mm", shift, 1e-9)
    figure(f"door seal, {name}: gaps, mm", np.abs(other.gap - original.gap).max(), 1e-9)
