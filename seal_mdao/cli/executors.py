"""Executors of scenarios: processes of this machine, MPI, or Dask."""

import argparse
from contextlib import contextmanager

from seal_mdao.cli.arguments import WrongArgumentError
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import usual_workers

EXECUTORS = ("processes", "mpi", "dask")


def add_executor_arguments(made: argparse.ArgumentParser) -> None:
    """Add the options that choose the executor of the scenarios."""
    group = made.add_argument_group("running")
    group.add_argument(
        "--workers", type=_count, metavar="N",
        help="number of processes, or of Dask workers on this machine; 0: one after the other in this "
        "process; default: one per core",
    )  # fmt: skip
    group.add_argument(
        "--executor", choices=EXECUTORS, default=EXECUTORS[0],
        help="how analyses run in parallel; mpi needs a start with mpiexec -n N python -m "
        "mpi4py.futures SCRIPT",
    )  # fmt: skip
    group.add_argument(
        "--dask-address",
        metavar="HOST:PORT",
        help="address of the scheduler of a running Dask cluster",
    )


def _count(text: str) -> int:
    if not text.isdecimal():
        raise argparse.ArgumentTypeError(f"{text!r} is not an integer of at least 0")
    return int(text)


@contextmanager
def executor(arguments: argparse.Namespace):
    """Open the executor for the argument ``workers`` of ``scenarios.running.run_scenarios``."""
    if arguments.dask_address and arguments.executor != "dask":
        raise WrongArgumentError("--dask-address needs --executor dask")
    # one worker per core unless given
    count = usual_workers() if arguments.workers is None else arguments.workers
    if arguments.executor == "mpi":
        # the ranks were started by mpiexec
        with _library("mpi4py.futures", "mpi").MPIPoolExecutor() as workers:
            yield workers
    elif arguments.executor == "dask":
        # a cluster of its own, or an existing one by its address
        with _dask_client(arguments.dask_address, max(count, 1)) as client:
            yield client.get_executor()
    elif count:
        # worker processes of this machine
        with Processes(count) as workers:
            yield workers
    else:
        # 0: serial, in this process
        yield 0


@contextmanager
def _dask_client(address, count):
    distributed = _library("dask.distributed", "dask")
    if address:
        with distributed.Client(address) as client:
            yield client
        return
    # one thread a worker: the analysis itself is threaded
    cluster = distributed.LocalCluster(
        n_workers=count, threads_per_worker=1, dashboard_address=None
    )
    with cluster, distributed.Client(cluster) as client:
        yield client


def _library(name: str, extra: str):
    from importlib import import_module

    try:
        return import_module(name)
    except ImportError as error:
        raise WrongArgumentError(
            f"--executor {extra} needs {name}: pip install seal_mdao[{extra}] ({error})"
        ) from error
