"""Results of analyses in other processes: pickled with everything that their evaluation needs."""

import pickle

import numpy as np
import pytest
from seal_file.block_files import BLOCK, FIXED

import seal_mdao as sm

PRESSED = (
    BLOCK.format(bulk=2000.0, spacing=1.0)
    + FIXED
    + """[[profile]]
name = "plate"
contact = ["top"]
line = [[-40.0, 4.0], [40.0, 4.0]]
friction = 0.2
stage = [{ translate = [0.1, -0.4], steps = 3 }]
[[fluid]]
edge = ["right", "top"]
from = "start"
pressure = 20.0
[[measure]]
type = "reaction"
profile = "plate"
component = "y"
"""
)


@pytest.mark.parametrize("keep_factors", [False, True])
def test_a_pickled_result_gives_the_same_bits(tmp_path, keep_factors):
    (tmp_path / "seal.toml").write_text(PRESSED)
    seal = sm.build_seal(tmp_path / "seal.toml")
    result = sm.analyze(seal, keep_factors=keep_factors)
    assert result.converged, result.failure
    # the copy as another process receives it
    other = pickle.loads(pickle.dumps(result))
    assert np.array_equal(other.path.reaction("plate"), result.path.reaction("plate"))
    assert other.warnings == result.warnings
    for method in ("direct", "adjoint"):
        ours, theirs = (
            sm.differentiate(own, ["c10", "plate_friction"], method=method)
            for own in (result, other)
        )
        assert ours["reaction"].any()
        assert np.array_equal(ours["reaction"], theirs["reaction"])


@pytest.mark.parametrize("method", ["direct", "adjoint"])
def test_derivatives_with_respect_to_nothing(tmp_path, method):
    """A seal without a design has no inputs: the rows are empty."""
    (tmp_path / "seal.toml").write_text(PRESSED)
    result = sm.analyze(sm.build_seal(tmp_path / "seal.toml"))
    assert sm.differentiate(result, method=method)["reaction"].shape == (1, 0)
