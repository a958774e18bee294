"""Workers that die, Ctrl-C, a parent that is killed: nothing hangs, nothing is lost."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor
from contextlib import suppress
from threading import Thread

import numpy as np
import psutil
import pytest

from seal_mdao.scenarios.evaluate import evaluate, points_of
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import AHEAD, DIED, Point, run_scenarios
from seal_mdao.scenarios.task import Outcome

OFFSETS = np.zeros(25)


class Deadly:
    """A task whose point 3 kills its process, always or until a file is there."""

    count = 1
    others = 0.1
    """Seconds for others to be on their way."""

    def __init__(self, mark=None):
        self.mark = mark

    def run(self, offsets, parameters):
        deadly = parameters[0] == 3.0
        if deadly and self.mark is not None and os.path.exists(self.mark):
            deadly = False
        elif deadly and self.mark is not None:
            open(self.mark, "w").close()
        if deadly:
            time.sleep(self.others)
            os.kill(os.getpid(), signal.SIGKILL)
        return Outcome(10.0 * parameters, None, "", 0.0)


def points(count):
    return [Point(i, OFFSETS, np.array([float(i)])) for i in range(count)]


def test_a_worker_that_dies_is_replaced_and_its_scenario_repeated(tmp_path):
    with Processes(2) as workers:
        found = dict(run_scenarios(Deadly(tmp_path / "died"), points(9), workers))
    assert sorted(found) == list(range(9))
    assert all(outcome.values[0] == 10.0 * i for i, outcome in found.items())


def test_a_scenario_that_kills_every_worker_fails_alone_though_nothing_else_has_finished():
    with Processes(1) as workers:
        found = dict(run_scenarios(Deadly(), points(5)[3:], workers))
    assert found[3].failure == DIED
    assert found[4].values[0] == 40.0


# concurrent.futures walks its table of processes while a new one is entered: the thread that cleans up
# after a broken pool may end with "dictionary changed size during iteration", when all calls have failed
@pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
def test_workers_that_are_killed_while_they_start_are_replaced():
    """Before they have imported anything."""
    with Processes(2) as workers:
        running = run_scenarios(Instant(), points(6), workers)
        killer = Thread(target=kill_first_workers)
        killer.start()
        found = dict(running)
        killer.join()
    assert sorted(found) == list(range(6))
    assert not any(outcome.failure for outcome in found.values())


def kill_first_workers():
    """Kill the first worker that there is."""
    for _ in range(1000):
        found = workers_of(os.getpid())
        if found:
            found[0].kill()
            return
        time.sleep(0.005)


def test_a_scenario_that_kills_every_worker_fails_alone():
    with Processes(2) as workers:
        found = dict(run_scenarios(Deadly(), points(9), workers))
        again = dict(run_scenarios(Deadly(), points(2), workers))
    assert [i for i, outcome in sorted(found.items()) if outcome.failure] == [3]
    assert found[3].failure == DIED
    assert np.isnan(found[3].values).all()
    assert all(found[i].values[0] == 10.0 * i for i in range(9) if i != 3)
    assert len(again) == 2


HEAVY = """
from test_killed_workers import Heavy, points
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import run_scenarios

if __name__ == "__main__":
    with Processes(2) as workers:
        for number in range(3):
            found = dict(run_scenarios(Heavy(number), points(9), workers))
            print(*[i for i, outcome in found.items() if outcome.failure])
"""


class Heavy(Deadly):
    """More than a pipe takes at once."""

    others = 0.0

    def __init__(self, number):
        super().__init__()
        self.ballast = bytes([number]) * 4_000_000


def test_a_worker_that_dies_while_a_large_task_is_sent_holds_nobody_up(tmp_path):
    """In Python before 3.12 whoever writes into a full pipe would wait for ever."""
    done = run_script(tmp_path, HEAVY)
    assert done.returncode == 0, done.stderr
    assert done.stdout.split() == ["3", "3", "3"]


def run_script(tmp_path, script):
    path = tmp_path / "script.py"
    path.write_text(script)
    folders = os.pathsep.join([os.path.dirname(__file__), os.getcwd()])
    return subprocess.run(
        [sys.executable, path], env=os.environ | {"PYTHONPATH": folders}, text=True,
        capture_output=True, check=False, timeout=60,
    )  # fmt: skip


def workers_of(process):
    """Spawned worker processes of a process, without the resource tracker."""
    found = []
    for child in psutil.Process(process).children():
        with suppress(psutil.NoSuchProcess):  # ended meanwhile
            if "spawn_main" in " ".join(child.cmdline()):
                found.append(child)
    return found


@pytest.mark.long
def test_sigkill_of_a_worker_at_random_moments_changes_no_bit(task, scenarios, design):
    expected = evaluate(task, scenarios, OFFSETS, design)
    points = points_of(scenarios, OFFSETS, design) * 2
    with Processes(2) as workers:
        evaluate(task, scenarios, OFFSETS, design, workers)  # they have started
        for moment in np.random.default_rng(0).uniform(0.0, 1.0, 4):
            before = workers_of(os.getpid())
            code = f"import os, time; time.sleep({moment}); os.kill({before[0].pid}, 9)"
            killer = subprocess.Popen([sys.executable, "-c", code])
            found = list(run_scenarios(task, points, workers))
            killer.wait()
            assert sorted(number for number, _ in found) == sorted([*range(len(scenarios))] * 2)
            for number, outcome in found:
                np.testing.assert_array_equal(outcome.values, expected.values[number])
            found = list(run_scenarios(task, points[:1], workers))  # also after it died idle
            np.testing.assert_array_equal(found[0][1].values, expected.values[0])
            assert not before[0].is_running()


SCRIPT = """
import sys, time
from test_killed_workers import Slow, points
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import run_scenarios

if __name__ == "__main__":
    workers = Processes(2)
    for number, _ in run_scenarios(Slow(), points(1000), workers):
        print(number, flush=True)
"""


class Slow:
    """A task of a tenth of a second."""

    count = 1

    def run(self, offsets, parameters):
        time.sleep(0.1)
        return Outcome(parameters, None, "", 0.1)


def started(tmp_path, script, preparation):
    """A script in a process of its own that has given its first two results."""
    path = tmp_path / "script.py"
    path.write_text(script)
    folders = os.pathsep.join([os.path.dirname(__file__), os.getcwd()])
    process = subprocess.Popen(
        [sys.executable, path], env=os.environ | {"PYTHONPATH": folders}, text=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=preparation,
    )  # fmt: skip
    for _ in range(2):
        assert process.stdout.readline().strip().isdigit(), process.stderr.read()
    return process


@pytest.mark.parametrize(
    "ending", [pytest.param(signal.SIGINT, marks=pytest.mark.long), signal.SIGKILL]
)
def test_all_workers_end_with_the_script(tmp_path, ending, hear_ctrl_c):
    """Ctrl-C, and a kill that leaves no time for anything."""
    process = started(tmp_path, SCRIPT, hear_ctrl_c)
    workers = workers_of(process.pid)
    assert len(workers) == 2
    process.send_signal(ending)
    process.communicate(timeout=30)
    _, alive = psutil.wait_procs(workers, timeout=10)
    assert not alive
    assert process.returncode != 0


def test_a_script_without_its_guard_is_told(tmp_path):
    done = run_script(tmp_path, SCRIPT.replace('if __name__ == "__main__":', "if True:"))
    assert done.returncode != 0
    assert (
        'put the code of the script that starts them under  if __name__ == "__main__":'
        in done.stderr
    )
    # the workers end silently: one traceback, that of the script
    assert done.stderr.count("Traceback (most recent call last)") == 1
    assert "freeze_support" not in done.stderr


def test_processes_are_given_little_ahead():
    """So that few scenarios are repeated when one of them dies."""
    given = []

    def counted():
        for point in points(20):
            given.append(point.index)
            yield point

    with Processes(2) as workers:
        finished = []
        for number, _ in run_scenarios(Slow(), counted(), workers):
            finished.append(number)
            assert len(given) - len(finished) <= 2 * AHEAD
    assert sorted(finished) == given


class Instant:
    """A task of no time."""

    count = 1

    def run(self, offsets, parameters):
        return Outcome(parameters, None, "", 0.0)


def test_nothing_is_left_out_where_all_that_runs_is_finished_at_once():
    """Whoever takes the outcomes is slower than the workers."""
    with Processes(2) as workers:
        found = []
        for number, _ in run_scenarios(Instant(), points(40), workers):
            found.append(number)
            time.sleep(0.01)
    assert sorted(found) == list(range(40))


def test_a_broken_executor_of_others_is_theirs():
    class Broken:
        def submit(self, *arguments):
            raise BrokenExecutor("gone")

    with pytest.raises(BrokenExecutor, match="gone"):
        list(run_scenarios(Deadly(), points(3), Broken()))
