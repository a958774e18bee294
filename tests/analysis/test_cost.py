"""What is too large or too long is refused at once with its numbers, what is long is announced, and
the estimate of the memory is of the right size."""

import re
import tracemalloc

import numpy as np
import pytest

import seal_mdao as sm
from seal_mdao.analysis import cost
from seal_mdao.analysis_cache import held_bytes


@pytest.mark.parametrize("changes", [{"n_steps": 10**8}, {"n_steps": 10**9, "rays": 116}])
def test_more_than_the_machine_has_is_refused_with_both_numbers(changes):
    # what the first estimate imports is not counted
    sm.estimate(sm.door_seal(n_steps=2))
    tracemalloc.start()
    try:
        with pytest.raises(sm.TooLargeError, match=r"\d GiB, and this machine has [\d.]+ GiB"):
            sm.analyze(sm.door_seal(**changes))
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    # a byte for each load step would be more
    assert peak < 5e7


def test_small_machine_refuses_what_a_large_one_takes(monkeypatch):
    seal = sm.door_seal(layers=20, n_steps=2)
    assert sm.estimate(seal).memory < cost.machine_memory()
    monkeypatch.setattr(cost, "machine_memory", lambda: 0.1)
    with pytest.raises(sm.TooLargeError, match=r"this machine has 0\.1 GiB"):
        sm.analyze(seal)


def test_days_are_refused_with_what_allows_them(monkeypatch):
    """A million load steps fit into the memory of a large machine."""
    monkeypatch.setattr(cost, "machine_memory", lambda: 1e6)
    seal = sm.door_seal(rays=580, layers=11, n_steps=10**6)
    with pytest.raises(
        sm.TooLargeError, match=r"[\d.]+ days, more than the limit of 24 h; .*" + cost.HOURS
    ):
        sm.analyze(seal)
    hours = sm.estimate(seal).seconds / 3600.0
    monkeypatch.setenv(cost.HOURS, str(1.01 * hours))
    cost.require_means(sm.estimate(seal), seal.body, seal.n_steps)
    monkeypatch.setenv(cost.HOURS, str(0.99 * hours))
    with pytest.raises(sm.TooLargeError, match=cost.HOURS):
        sm.analyze(seal)


@pytest.mark.parametrize("text", ["long", "0", "-1", "nan"])
def test_limit_that_is_no_number_of_hours_is_named(monkeypatch, text):
    monkeypatch.setenv(cost.HOURS, text)
    with pytest.raises(ValueError, match=cost.HOURS):
        sm.analyze(sm.door_seal(depth=0.5, n_steps=2))


def test_long_analysis_is_announced_once(monkeypatch, capsys):
    """With what it takes, before its first step; the designs after the first one are silent."""
    monkeypatch.setattr(cost, "ENTRY_SECONDS", 1e-3)
    seal, said = sm.door_seal(depth=0.5, n_steps=2), []
    assert 60.0 < sm.estimate(seal).seconds < 7200.0
    sm.analyze(seal, callback=lambda step: said.append(capsys.readouterr().err))
    assert re.match(
        r"seal_mdao: an analysis of 174 particles in 2 load steps will take about [\d.]+ min and "
        r"[\d.]+ GiB; Ctrl-C ends it\n", said[0],
    )  # fmt: skip
    sm.analyze(seal, callback=lambda step: said.append(capsys.readouterr().err))
    assert said[1:] == ["", "", ""]


def test_short_analysis_is_not_announced(capsys):
    sm.analyze(sm.door_seal(depth=0.5, n_steps=2))
    assert "will take" not in capsys.readouterr().err


@pytest.mark.parametrize(
    ("seconds", "words"),
    [
        (0.123, "0.12 s"),
        (9.6, "9.6 s"),
        (59.7, "60 s"),
        (150.0, "2.5 min"),
        (7080.0, "118 min"),
        (1e4, "2.78 h"),
        (1e6, "11.6 days"),
        (3.6e6, "1000 h"),
        (3.6e6 + 2407.0, "1000 h"),
        (3.2e8, "10.1 years"),
        (6.048e5, "7 days"),
    ],
)
def test_duration_in_words(seconds, words):
    assert cost.duration(seconds) == words


def test_estimate_of_what_is_held(nominal):
    """The arrays that stay, between a fifth and all of the estimate, which has the factors too."""
    memory = sm.estimate(nominal.seal).memory * 2**30
    assert 0.2 * memory < held_bytes(nominal.path) < 3.0 * memory


def test_self_contact_costs_more_for_every_load_step(nominal):
    plain, touching = (
        [cost.analysis_cost(nominal.seal.body, nominal.particles, n, own).seconds for n in (0, 10)]
        for own in (False, True)
    )
    assert touching[0] == plain[0]
    assert np.diff(touching) == pytest.approx(cost.SELF_CONTACT * np.diff(plain))


def test_estimate_in_other_load_steps(nominal):
    seal = nominal.seal
    assert sm.estimate(seal, seal.n_steps) == sm.estimate(seal)
    first, second, third = (sm.estimate(seal, n).seconds for n in (0, 10, 20))
    assert 0.0 < first < second
    assert third - second == pytest.approx(second - first)


@pytest.mark.parametrize("changes", [{"layers": 6}, {"rays": 116}, {"support": 6.0}])
def test_finer_clouds_cost_more(changes):
    fine, nominal = sm.estimate(sm.door_seal(**changes)), sm.estimate(sm.door_seal())
    assert fine.seconds > 1.3 * nominal.seconds
    assert fine.memory > 1.3 * nominal.memory
