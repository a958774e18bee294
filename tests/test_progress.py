"""Lines of progress where there is no terminal."""

import time
from dataclasses import replace
from types import SimpleNamespace

import pytest

import seal_mdao as sm
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


def test_a_line_every_interval_while_one_call_goes_on(monkeypatch, capsys):
    monkeypatch.setattr(progress, "INTERVAL", 0.02)
    with progress.Waiting("placing particles"):
        time.sleep(0.3)
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) >= 3
    assert set(lines) == {"placing particles: 0 s ..."}
    # nothing comes afterwards
    time.sleep(0.06)
    assert capsys.readouterr().err == ""


def test_work_that_is_quick_or_has_no_standard_error_has_no_lines(monkeypatch, capsys):
    with progress.Waiting("placing particles"):
        pass
    assert capsys.readouterr().err == ""
    monkeypatch.setattr(progress, "INTERVAL", 0.01)
    monkeypatch.setattr(progress.sys, "stderr", None)
    with progress.Waiting("placing particles"):
        time.sleep(0.05)


def test_lines_before_the_first_load_step(monkeypatch, capsys):
    monkeypatch.setattr(progress, "INTERVAL", 0.02)
    with progress.LoadStepProgress(None, "analysis") as bar:
        time.sleep(0.2)
        bar(SimpleNamespace(nominal=0))
        said = capsys.readouterr().err
        time.sleep(0.06)
        after = capsys.readouterr().err
    assert "analysis: computing shape functions: 0 s ..." in said
    assert "shape functions" not in after


def test_time_left_of_a_choice_is_that_of_the_paths_before(clock, capsys):
    """12 load steps took 30 s, so 24 take 60 s; 36 took 84 s, so two paths of 48 take 224 s."""
    with progress.LoadStepProgress(None, "choosing load steps") as bar:
        clock.now += 5.0
        bar.begin_analysis(1, 2, 12)
        clock.now += 30.0
        bar.begin_analysis(2, 2, 24)
        clock.now += 54.0
        bar.begin_analysis(3, 4, 48)
    assert capsys.readouterr().err.splitlines() == [
        "choosing load steps, 1 of 2 ...",
        "choosing load steps, 2 of 2, about 60 s left ...",
        "choosing load steps, 3 of 4, about 3.73 min left ...",
    ]


def test_time_left_of_an_analysis_is_measured_where_its_steps_are_halved(clock, capsys):
    """The step after the first one takes 10 s, so the last eight take 80 s; 110 s for 1.5 steps make
    550 s for 7.5. The second analysis is measured by itself."""
    with progress.LoadStepProgress(SimpleNamespace(n_steps=10), "analysis") as bar:
        clock.now += 50.0
        bar(SimpleNamespace(nominal=0))
        clock.now += 10.0
        bar(SimpleNamespace(nominal=1))
        clock.now += 100.0
        bar.halved(2.5)
        clock.now += 100.0
        bar(SimpleNamespace(nominal=9))
        # not yet that of any analysis that has completed a step
        clock.now += 50.0
        bar.halved(0.5)
        bar(SimpleNamespace(nominal=0))
        clock.now += 50.0
        bar(SimpleNamespace(nominal=5))
    assert capsys.readouterr().err.splitlines() == [
        "analysis 1: load step 1 of 10",
        "analysis 1: load step 2 of 10, about 80 s left",
        "analysis 1: load step 3 of 10, about 550 s left",
        "analysis 1: load step 10 of 10, about 0 s left",
        "analysis 2: load step 1 of 10",
        "analysis 2: load step 6 of 10, about 40 s left",
    ]


def test_time_left_of_a_choice_grows_while_its_steps_are_halved(clock, capsys):
    """36 + 1.5 load steps in 120 s leave 10.5 of the second path and 12 of another one."""
    with progress.LoadStepProgress(None, "choosing load steps") as bar:
        bar.begin_analysis(1, 2, 36)
        clock.now += 15.0
        bar(SimpleNamespace(nominal=35))
        clock.now += 5.0
        bar.begin_analysis(2, 3, 12)
        bar(SimpleNamespace(nominal=0))
        clock.now += 100.0
        bar.halved(1.5)
    assert capsys.readouterr().err.splitlines() == [
        "choosing load steps, 1 of 2 ...",
        "choosing load steps 1 of 2: load step 36 of 36, about 15 s left",
        "choosing load steps, 2 of 3, about 13 s left ...",
        "choosing load steps 2 of 3: load step 2 of 12, about 72 s left",
    ]


def test_an_analysis_after_a_choice_has_load_steps_of_its_own(clock, capsys):
    """The choice of penalties thins the load steps to two; the analysis that follows has all of them."""
    with progress.LoadStepProgress(None, "spacing 0.5 mm") as bar:
        bar.begin_analysis(1, 2, 2)
        bar(SimpleNamespace(nominal=0))
        bar(SimpleNamespace(nominal=1))
        bar(SimpleNamespace(nominal=0))
        clock.now += 20.0
        bar(SimpleNamespace(nominal=5))
    assert capsys.readouterr().err.splitlines() == [
        "spacing 0.5 mm, 1 of 2 ...",
        "spacing 0.5 mm 2: load step 6",
    ]


def test_load_steps_that_are_halved_are_reported():
    """With how far the path has come; the callback has no other method."""
    seen = []

    class Callback:
        def __call__(self, step):
            seen.append(step.nominal)

        def halved(self, fraction):
            seen.append(("halved", fraction))

    seal = sm.door_seal(depth=6.0, n_steps=2)
    result = sm.analyze(
        replace(seal, newton=sm.NewtonOptions(max_iterations=6)), callback=Callback()
    )
    halved = [own for own in seen if isinstance(own, tuple)]
    assert len(halved) == result.path.step_cuts > 0
    assert [own for own in seen if not isinstance(own, tuple)] == [0, 1]
    assert all(0.0 <= own[1] < 2.0 for own in halved)


def test_faults_of_the_first_results_are_printed_once(capsys):
    crosses = "the boundary crosses itself near x = {}, y = 2 by 1 mm"
    with progress.LoadStepProgress(None, "choosing load steps") as bar:
        bar.faults([crosses.format(1)])
        # the same fault at a place nearby, in the next analysis, and another one
        bar.faults([crosses.format(1.1), "material is inverted"])
    said = capsys.readouterr().err
    assert said.count("the boundary crosses itself") == 1
    assert "choosing load steps, first results: material is inverted" in said
