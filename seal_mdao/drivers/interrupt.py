"""Ctrl-C during an optimisation: stop at the best point instead of losing the run."""

from __future__ import annotations

import signal
import threading
import time
from contextlib import contextmanager

SAME = 0.5
"""Seconds within which further signals belong to the first one: those of a group of processes, or a key
that is held. Without this time they would end the code of an optimiser that is not written in Python,
which does not survive it."""


class InterruptGuard:
    """Convert the first Ctrl-C into a request to stop; one after ``SAME`` seconds raises
    KeyboardInterrupt.

    While the model runs (inside `running`) Ctrl-C raises KeyboardInterrupt there, so that a
    long analysis ends at once. Between runs, in the code of the optimiser, it only sets `requested`.
    Outside the main thread no handler can be installed and KeyboardInterrupt keeps its usual meaning,
    as it does after the context is left. An optimiser may install a handler of its own when it begins
    (Uno does); every run of the model replaces it.
    """

    def __init__(self):
        self.requested = False
        self._running = False
        self._previous, self._first = None, 0.0

    def __enter__(self) -> InterruptGuard:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.signal(signal.SIGINT, self._handle)
        return self

    def __exit__(self, *exc_info) -> None:
        if self._previous is not None:
            # what follows an optimisation, such as writing its best design, is not interrupted either
            if self.requested:
                time.sleep(max(0.0, SAME - (time.monotonic() - self._first)))
            signal.signal(signal.SIGINT, self._previous)
        self.requested, self._previous = False, None

    @contextmanager
    def running(self):
        """Context in which Ctrl-C interrupts at once."""
        self._running = True
        # the optimiser may have installed its own handler
        if self._previous is not None:
            signal.signal(signal.SIGINT, self._handle)
        try:
            # requested between two runs: do not begin another one
            if self.requested:
                raise KeyboardInterrupt
            yield
        finally:
            self._running = False

    def _handle(self, signum, frame) -> None:
        again, now = self.requested, time.monotonic()
        if not again:
            self.requested, self._first = True, now
        elif now - self._first < SAME:
            return
        # second Ctrl-C, or during an analysis: raise
        if again or self._running:
            raise KeyboardInterrupt
