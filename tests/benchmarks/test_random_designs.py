"""Random designs complete their paths at any friction, or say why not."""

import pytest
from random_designs import study_designs

import seal_mdao as sm


@pytest.mark.parametrize(
    ("friction", "count"),
    [
        (0.05, 1),
        *(pytest.param(friction, 12, marks=pytest.mark.release) for friction in (0.0, 0.05)),
        pytest.param(0.25, 12, marks=pytest.mark.long),
    ],
)
def test_designs_within_half_a_millimetre_complete(friction, count):
    """The first of them slip round the corner of the door, where damped motion alone fails."""
    study = study_designs(sm.door_seal(friction=friction), count, 0.5, seed=1)
    assert study.failures == {}
    assert study.unstable == ()


def test_script_writes_what_it_found(tmp_path, run_script):
    code, s = run_script("random_designs", tmp_path, "--count", 2, "--friction", 0.25)
    assert code == 0
    assert s["0.25"]["completed"] == 1.0
    assert s["0.25"]["median_s"] > 0.0
