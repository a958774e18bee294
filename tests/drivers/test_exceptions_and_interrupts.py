"""Exceptions other than AnalysisError, and Ctrl-C."""

from __future__ import annotations

import signal
import threading

import numpy as np
import openmdao
import pytest
from driver_models import constrained_problem, d_rosenbrock, plane_problem, quadratic, rosenbrock
from packaging.version import Version

from seal_mdao.drivers.interrupt import SAME, InterruptGuard


class SpecialError(Exception):
    """An exception that no optimizer knows."""


def _raise_at(number, error):
    def hook(x, call):
        if call == number:
            raise error

    return hook


@pytest.mark.parametrize("call", [1, 2, 5])
@pytest.mark.parametrize("where", ["hook", "partials_hook"])
def test_other_exceptions_are_raised_unchanged(make_driver, where, call):
    error = SpecialError("wrong unit")
    hooks = {where: _raise_at(call, error)}
    driver = make_driver()
    prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock, **hooks)
    with pytest.raises(SpecialError, match=r"wrong unit$") as caught:
        prob.run_driver()
    if Version(openmdao.__version__) >= Version("3.44"):  # before, OpenMDAO itself made a new one
        assert caught.value is error
    assert driver.result.exit_status == "Ended by an exception"
    assert not driver.result.success
    assert "hook" in [entry.name for entry in caught.traceback]
    comp = prob.model.plane
    assert (comp.calls if where == "hook" else comp.partials_calls) == call


def test_run_after_an_exception(make_driver):
    hook = _raise_at(3, SpecialError())
    prob = plane_problem(make_driver(), (-1.2, 1), rosenbrock, d_rosenbrock, hook=hook)
    with pytest.raises(SpecialError):
        prob.run_driver()
    prob.set_val("x", np.array([-1.2, 1.0]))
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.get_val("x") == pytest.approx([1.0, 1.0], abs=1e-3)


def _interrupt_with_exception(x):
    raise KeyboardInterrupt


def _interrupt_with_signal(x):
    signal.raise_signal(signal.SIGINT)


@pytest.mark.parametrize("interrupt", [_interrupt_with_exception, _interrupt_with_signal])
@pytest.mark.parametrize("where", ["hook", "partials_hook"])
def test_ctrl_c_keeps_the_best_point(make_driver, interrupt, where):
    handler = signal.getsignal(signal.SIGINT)

    def hook(x, call):
        if call == 8:
            interrupt(x)

    driver = make_driver()
    prob = plane_problem(driver, (-1.2, 1), rosenbrock, d_rosenbrock, **{where: hook})
    result = prob.run_driver()
    comp = prob.model.plane
    assert not result.success
    assert "Ctrl-C" in result.exit_status
    assert "best feasible design found is the result" in result.exit_status
    assert prob.get_val("f")[0] == min(rosenbrock(x) for x in comp.visited)
    assert prob.get_val("f")[0] < rosenbrock([-1.2, 1])
    assert (comp.calls if where == "hook" else comp.partials_calls) <= 10
    assert signal.getsignal(signal.SIGINT) is handler


def test_ctrl_c_prefers_a_feasible_point(make_driver):
    """Later points may have lower objectives, but only feasible ones are kept."""
    hook = _raise_at(6, KeyboardInterrupt())
    prob = constrained_problem(make_driver(), (6, 6), "x[0] + x[1]**2", 20.0, hook=hook)
    result = prob.run_driver()
    feasible = [x for x in prob.model.plane.visited if x[0] + x[1] ** 2 >= 20.0 * (1 - 1e-6)]
    assert "best feasible design" in result.exit_status
    assert prob.get_val("f")[0] == min(quadratic(x) for x in feasible)


def test_ctrl_c_before_any_feasible_point(make_driver):
    hook = _raise_at(2, KeyboardInterrupt())
    prob = constrained_problem(make_driver(), (6, 6), "x[0] + x[1]**2", 500.0, hook=hook)
    result = prob.run_driver()
    assert "no feasible design was found" in result.exit_status
    assert prob.get_val("x").tolist() == [6.0, 6.0]


def test_ctrl_c_at_the_start_is_passed_on(make_driver):
    prob = plane_problem(make_driver(), (5, 5), hook=_raise_at(1, KeyboardInterrupt()))
    with pytest.raises(KeyboardInterrupt):
        prob.run_driver()


def test_run_outside_the_main_thread(make_driver):
    prob = plane_problem(make_driver(), (5, 5))
    results = []
    thread = threading.Thread(target=lambda: results.append(prob.run_driver()))
    thread.start()
    thread.join()
    assert results[0].success


def test_guard_interrupts_a_running_model():
    finished = []

    def run(guard):
        with guard.running():
            signal.raise_signal(signal.SIGINT)
            finished.append(True)

    with InterruptGuard() as guard:
        with pytest.raises(KeyboardInterrupt):
            run(guard)
        assert guard.requested
    assert not finished


def test_guard_between_runs_only_notes_the_wish():
    with InterruptGuard() as guard:
        signal.raise_signal(signal.SIGINT)
        assert guard.requested
        with pytest.raises(KeyboardInterrupt), guard.running():
            pytest.fail("the model must not run after a request to stop")


def test_guard_lets_a_later_ctrl_c_through(monkeypatch):
    now = [10.0]
    monkeypatch.setattr("seal_mdao.drivers.interrupt.time.monotonic", lambda: now[0])
    with InterruptGuard():
        signal.raise_signal(signal.SIGINT)
        now[0] += SAME + 0.1
        with pytest.raises(KeyboardInterrupt):
            signal.raise_signal(signal.SIGINT)


def test_signals_at_once_are_one_ctrl_c():
    """A group of processes gets several; the code of an optimiser must not be left by an exception."""
    with InterruptGuard() as guard:
        for _ in range(3):
            signal.raise_signal(signal.SIGINT)
        assert guard.requested
        with pytest.raises(KeyboardInterrupt), guard.running():
            pytest.fail("the model must not run after a request to stop")


def test_signals_at_once_are_one_ctrl_c_after_the_optimisation_too(monkeypatch):
    """The best design is written after it."""
    slept = []

    def sleep(seconds):
        slept.append(seconds)
        signal.raise_signal(signal.SIGINT)

    monkeypatch.setattr("seal_mdao.drivers.interrupt.time.sleep", sleep)
    with InterruptGuard():
        signal.raise_signal(signal.SIGINT)
    assert 0.0 < slept[0] <= SAME


def test_guard_restores_the_handler():
    handler = signal.getsignal(signal.SIGINT)
    with InterruptGuard():
        assert signal.getsignal(signal.SIGINT) is not handler
    assert signal.getsignal(signal.SIGINT) is handler
