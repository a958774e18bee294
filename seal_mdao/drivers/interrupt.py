"""Ctrl-C during an optimisation: stop at the best point instead of losing the run."""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager


class InterruptGuard:
    """Convert the first Ctrl-C into a request to stop; the second one raises KeyboardInterrupt.

    While the model runs (inside `running`) Ctrl-C raises KeyboardInterrupt there, so that a
    long analysis ends at once. Between runs, in the code of the optimiser, it only sets `requested`.
    Outside the main thread no handler can be installed and KeyboardInterrupt keeps its usual meaning,
    as it does after the context is left. An optimiser may install a handler of its own when it begins
    (Uno does); every run of the model replaces it.
    """

    def __init__(self):
        self.requested = False
        self._running = False
        self._previous = None

    def __enter__(self) -> InterruptGuard:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.signal(signal.SIGINT, self._handle)
        return self

    def __exit__(self, *exc_info) -> None:
        if self._previous is not None:
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
        # second Ctrl-C, or during an analysis: raise
        again, self.requested = self.requested, True
        if again or self._running:
            raise KeyboardInterrupt
