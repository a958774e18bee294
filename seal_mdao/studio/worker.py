"""Worker process of the live section, which computes with the open seal and can be replaced."""

import asyncio
import multiprocessing
import os
import signal
import warnings
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import wait
from threading import Thread

from seal_mdao.errors import GeometryError, LoadPathError, SealFileError

FAILURES = (SealFileError, GeometryError, LoadPathError, ValueError, ImportError, OSError)
"""Errors that are about what was asked for; anything else is a fault of the program."""


class Worker:
    """Process that executes one job at a time, as seen from the server.

    Parameters
    ----------
    receive : callable
        Called in the event loop with serial number, kind and content of every message; with the kind
        ``died`` when the process has ended by itself.

    Attributes
    ----------
    serial : int
        Number of the last job.
    """

    def __init__(self, receive: Callable):
        self._receive, self._context = receive, multiprocessing.get_context("spawn")
        # jobs below this number are stopped; without a lock, which a killed worker could hold
        self._least = self._context.RawValue("q", 0)
        self.serial, self._process, self._pipe = 0, None, None

    @property
    def pid(self) -> int | None:
        """Identifier of the process; None without one."""
        return None if self._process is None else self._process.pid

    def start(self) -> None:
        """Start the process and end the previous one."""
        self.end()
        self._pipe, theirs = self._context.Pipe()
        self._process = self._context.Process(
            target=work, args=(theirs, self._least), name="seal-mdao studio worker", daemon=True
        )
        self._process.start()
        # the end of the process is seen as the end of the pipe
        theirs.close()
        asyncio.get_running_loop().add_reader(self._pipe.fileno(), self._read)

    def request(self, kind: str, stops: bool = False, **arguments) -> int:
        """Send a job; those before it are stopped where it ``stops`` them. Return its number."""
        self.serial += 1
        if stops:
            self._least.value = self.serial
        # of a process that has died the reader learns
        with suppress(OSError):
            self._pipe.send((self.serial, kind, arguments))
        return self.serial

    def stop(self) -> None:
        """Stop all jobs so far, at the next load step."""
        self._least.value = self.serial + 1

    def _read(self) -> None:
        try:
            message = self._pipe.recv()
        except (EOFError, OSError):
            self.end()
            self._receive(self.serial, "died", None)
            return
        self._receive(*message)

    def end(self) -> None:
        """End the process now."""
        if self._process is None:
            return
        asyncio.get_running_loop().remove_reader(self._pipe.fileno())
        self._pipe.close()
        self._process.kill()
        self._process.join()
        self._process = self._pipe = None


def work(pipe, least) -> None:
    """Execute the jobs that arrive through a pipe, until it closes."""
    # Ctrl-C is sent to all processes of a terminal; the server handles it
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()
    from seal_mdao.studio.jobs import Jobs

    jobs = Jobs(pipe, least)
    while True:
        try:
            serial, kind, arguments = pipe.recv()
        except (EOFError, OSError):
            return
        with warnings.catch_warnings(record=True) as noted:
            warnings.simplefilter("always")
            jobs.run(serial, kind, arguments, FAILURES, noted)


def _end_with_parent() -> None:
    wait([multiprocessing.parent_process().sentinel])
    os._exit(1)
