"""What is too large is refused at once with both numbers, and the estimate is of the right size."""

import resource
import time

import pytest

import seal_mdao as sm
from seal_mdao.analysis import cost
from seal_mdao.kept_analyses import held_bytes


@pytest.mark.parametrize("changes", [{"n_steps": 10**8}, {"n_steps": 10**9, "rays": 116}])
def test_more_than_the_machine_has_is_refused_with_both_numbers(changes):
    begun = time.monotonic()
    with pytest.raises(sm.TooLargeError, match=r"\d GiB, and this machine has [\d.]+ GiB"):
        sm.analyze(sm.door_seal(**changes))
    assert time.monotonic() - begun < 10.0
    assert resource.getrusage(resource.RUSAGE_SELF).ru_maxrss < 2 * 2**20


def test_small_machine_refuses_what_a_large_one_takes(monkeypatch):
    seal = sm.door_seal(layers=20, n_steps=2)
    assert sm.estimate(seal).memory < cost.machine_memory()
    monkeypatch.setattr(cost, "machine_memory", lambda: 0.1)
    with pytest.raises(sm.TooLargeError, match=r"this machine has 0\.1 GiB"):
        sm.analyze(seal)


def test_estimate_of_what_is_held(drawn):
    """The arrays that stay, between a fifth and all of the estimate, which has the factors too."""
    memory = sm.estimate(drawn.seal).memory * 2**30
    assert 0.2 * memory < held_bytes(drawn.path) < 3.0 * memory


@pytest.mark.parametrize("changes", [{"layers": 6}, {"rays": 116}, {"support": 6.0}])
def test_finer_clouds_cost_more(changes):
    fine, drawn = sm.estimate(sm.door_seal(**changes)), sm.estimate(sm.door_seal())
    assert fine.seconds > 1.3 * drawn.seconds
    assert fine.memory > 1.3 * drawn.memory


def test_estimate_takes_moments():
    seal = sm.door_seal()
    sm.estimate(seal)
    begun = time.process_time()
    sm.estimate(seal)
    assert time.process_time() - begun < 0.01
