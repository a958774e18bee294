"""The door-seal example as a whole: what the analysis must show."""

import numpy as np
import pytest

from seal_mdao.contact.friction import OPEN


def test_drawn_seal_converges_without_a_cut(nominal):
    assert nominal.converged
    assert nominal.step_cuts == 0
    assert len(nominal.newton_iterations) == 105
    # two and a half a step with the predictor; Newton without it needs over ten
    assert 230 <= nominal.newton_iterations.sum() <= 280
    # the door is still in the air: nothing to solve
    assert not nominal.newton_iterations[:4].any()


def test_contact_grows_and_then_splits_in_two(nominal):
    """Figure 4: one patch that grows up to about 5.5 mm, then the middle opens."""
    patches, width = [], []
    for door in nominal.path.at_nominal("door"):
        touching = door.state != OPEN
        patches.append(int(touching[0]) + int(np.sum(np.diff(touching.astype(int)) == 1)))
        width.append(int(touching.sum()))
    travel = nominal.travel
    assert set(np.array(patches)[(travel > 0.05) & (travel < 5.0)]) == {1}
    assert patches[-1] == 2
    early = np.array(width)[(travel > 0.05) & (travel < 5.0)]
    assert (np.diff(early) >= 0).all()
    assert early[-1] >= 5
    assert len(nominal.measure("gap").points) == 7
    assert nominal.gap.max() == pytest.approx(0.12, abs=0.005)
    assert nominal.gap_square_sum == pytest.approx(0.05, abs=0.005)
    assert nominal.von_mises.max() == pytest.approx(170.0, abs=3.0)
