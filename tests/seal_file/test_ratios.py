"""Measures that are ratios: not a number where the denominator is zero, with the reason."""

import numpy as np
import pytest
from block_files import FIXED, LID, seal_of

import seal_mdao as sm

LATE = LID.replace("4.02", "4.3").replace(
    "stage = [{ translate = [0, -0.5], steps = 3 }]",
    "stage = [{ translate = [0, -0.2], steps = 1 }, { translate = [0, -0.3], steps = 2 }]",
)
"""A lid that touches the block in its second stage."""
RATIOS = {
    "retained_force": ("stage = [1, 2]", "the force at the earlier stage or time is 0"),
    "compression_set": ("at = [0, 0]", "has not moved at the end of stage 1"),
}


@pytest.mark.parametrize("name", RATIOS)
def test_a_ratio_to_zero_is_no_number(tmp_path, name):
    key, why = RATIOS[name]
    seal = seal_of(tmp_path, FIXED, LATE, f'[[measure]]\ntype = "{name}"\n{key}\n')
    result = sm.analyze(seal)
    assert np.isnan(result.value(name)).all()
    assert any(why in text for text in result.warnings)
    # an optimisation may go on with a shorter step
    with pytest.raises(sm.LoadPathError, match=why):
        result.admissible_values(result.measures((name,)))
