"""Lines of progress where there is no terminal."""

from types import SimpleNamespace

import pytest

from seal_mdao import progress

DONE, FAILED = SimpleNamespace(failure=""), SimpleNamespace(failure="inverted")


@pytest.fixture
def clock(monkeypatch):
    """A clock that a test moves."""
    own = SimpleNamespace(now=100.0)
    monkeypatch.setattr(progress.time, "monotonic", lambda: own.now)
    monkeypatch.setattr(progress, "hidden", lambda: True)
    return own


def test_samples_done_and_time_left(clock, capsys):
    """Three of ten in sixty seconds: seven more take 140 s; those of an earlier run count as done."""
    with progress.SampleProgress(14, "study", finished=4) as samples:
        for number in range(3):
            clock.now += 20.0
            samples(number, FAILED if number == 1 else DONE)
    lines = capsys.readouterr().err.splitlines()
    assert lines[0] == "study: 5 of 14 samples, 3.0 min left"
    assert lines[-1] == "study: 7 of 14 samples, 1 failed, 2.3 min left"


def test_a_line_every_ten_seconds(clock, capsys):
    with progress.SampleProgress(100, "study") as samples:
        for number in range(50):
            clock.now += 1.0
            samples(number, DONE)
    assert len(capsys.readouterr().err.splitlines()) == 5


def test_the_next_evaluation_begins_anew(clock, capsys):
    with progress.SampleProgress(2, "robust optimisation") as samples:
        for number in range(4):
            clock.now += 20.0
            samples(number % 2, FAILED if number == 1 else DONE)
    lines = capsys.readouterr().err.splitlines()
    assert lines[1] == "robust optimisation: 2 of 2 samples, 1 failed, 0.0 min left"
    assert lines[2] == "robust optimisation, evaluation 2: 1 of 2 samples"
    assert lines[3] == "robust optimisation, evaluation 2: 2 of 2 samples, 0.0 min left"
