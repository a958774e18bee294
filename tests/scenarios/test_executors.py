"""The same bits whoever runs the scenarios: in line, processes, MPI, Dask; each started for real."""

import importlib
import os
import subprocess
import sys
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

from seal_mdao.scenarios.evaluate import evaluate, points_of
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import run_scenarios, usual_workers

OFFSETS = 0.02 * np.cos(np.arange(25))


@pytest.fixture(scope="module")
def in_line(task, scenarios, design):
    found = evaluate(task, scenarios, OFFSETS, design)
    assert found.failures == ("",) * len(scenarios)
    return found


def assert_same_bits(found, expected):
    np.testing.assert_array_equal(found.values, expected.values)
    np.testing.assert_array_equal(found.gradients, expected.gradients)
    assert found.failures == expected.failures


def test_in_line_twice(task, scenarios, design, in_line):
    assert np.abs(in_line.gradients).max() > 0.0
    assert_same_bits(evaluate(task, scenarios, OFFSETS, design), in_line)


def test_two_processes_and_again(task, scenarios, design, in_line):
    """Every process does some of them; both stay."""
    with Processes(2) as workers:
        for _ in range(2):
            assert_same_bits(evaluate(task, scenarios, OFFSETS, design, workers), in_line)


@pytest.mark.long
@pytest.mark.parametrize("count", [1, 4])
def test_one_and_four_processes(task, scenarios, design, in_line, count):
    assert_same_bits(evaluate(task, scenarios, OFFSETS, design, count), in_line)


def test_any_order(task, scenarios, design, in_line):
    points = points_of(scenarios, OFFSETS, design)[::-1]
    outcomes = dict(run_scenarios(task, points))
    for number, values in enumerate(in_line.values):
        np.testing.assert_array_equal(outcomes[number].values, values)


def test_threads(task, scenarios, design, in_line):
    with ThreadPoolExecutor(3) as workers:
        assert_same_bits(evaluate(task, scenarios, OFFSETS, design, workers), in_line)


@pytest.mark.long
def test_a_process_pool_of_ones_own(task, scenarios, design, in_line):
    import multiprocessing

    with ProcessPoolExecutor(2, multiprocessing.get_context("spawn")) as workers:
        assert_same_bits(evaluate(task, scenarios, OFFSETS, design, workers), in_line)


def needed(module: str, extra: str):
    """A library of an extra; skipped without it, unless it has to be there."""
    if os.environ.get("SEAL_MDAO_REQUIRE_CLUSTERS"):
        return importlib.import_module(module)
    return pytest.importorskip(module, reason=f"pip install seal_mdao[{extra}]")


def test_a_local_dask_cluster_of_two_workers(task, scenarios, design, in_line, tmp_path):
    distributed = needed("dask.distributed", "dask")
    cluster = distributed.LocalCluster(
        n_workers=2, threads_per_worker=1, dashboard_address=None, local_directory=tmp_path
    )
    with cluster, distributed.Client(cluster) as client:
        found = evaluate(task, scenarios, OFFSETS, design, client.get_executor())
    assert_same_bits(found, in_line)


MPI = """
import pickle, sys
from mpi4py.futures import MPIPoolExecutor
from seal_mdao.scenarios.evaluate import evaluate

if __name__ == "__main__":
    with open(sys.argv[1], "rb") as file:
        arguments = pickle.load(file)
    with MPIPoolExecutor() as workers:
        found = evaluate(*arguments, workers)
    with open(sys.argv[2], "wb") as file:
        pickle.dump(found, file)
"""


def mpiexec():
    """The command beside this Python, where the extra ``mpi`` is installed with an MPI of PyPI."""
    needed("mpi4py", "mpi")
    found = Path(sys.executable).with_name("mpiexec")
    if not found.exists() and not os.environ.get("SEAL_MDAO_REQUIRE_CLUSTERS"):
        pytest.skip("no mpiexec beside this Python: pip install mpich")
    return found


def test_mpi_with_three_processes(task, scenarios, design, in_line, tmp_path):
    import pickle

    script, given, made = (tmp_path / name for name in ("run.py", "given", "made"))
    script.write_text(MPI)
    given.write_bytes(pickle.dumps((task, scenarios, OFFSETS, design)))
    command = [mpiexec(), "-n", "3", sys.executable, "-m", "mpi4py.futures", script, given, made]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    assert_same_bits(pickle.loads(made.read_bytes()), in_line)


def test_a_task_that_cannot_be_sent_says_so(task, scenarios, design):
    from dataclasses import replace

    from seal_mdao.measures.measure import Measure

    class OfThisTest(Measure):
        name = "mine"

    own = replace(task, measures=(OfThisTest(),))
    with Processes(1) as workers, pytest.raises(ValueError, match=r"cannot be sent.*workers=0"):
        evaluate(own, scenarios, OFFSETS, design, workers)


def test_no_process_without_a_second_core(monkeypatch):
    for cores, expected in (({0}, 0), ({0, 3}, 2)):
        monkeypatch.setattr("os.sched_getaffinity", lambda _, cores=cores: cores)
        assert usual_workers() == expected
    with pytest.raises(ValueError, match="number of worker processes"):
        Processes(0)
