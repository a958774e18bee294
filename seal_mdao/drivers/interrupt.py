"""Ctrl-C during a run: stop at the best point instead of losing the run."""

from __future__ import annotations

import signal
import threading
from contextlib import contextmanager


class InterruptGuard:
    """Turns the first Ctrl-C into a request to stop and lets the second one through.

    While the model runs (inside `running`) Ctrl-C raises KeyboardInterrupt there, so that a
    long analysis does not have to be waited for. Between runs, when the optimiser's own code is
    at work, it only sets `requested`. Outside the main thread no handler can be installed and
    KeyboardInterrupt keeps its usual meaning, as it does after the context is left.
    An optimiser may take the signal for itself when it begins (Uno does); every run of the model
    takes it back.
    """

    def __init__(self):
        self.requested = False
        self._running = False
        self._previous = None

    def __enter__(self) -> InterruptGuard:
        if threading.current_thread() is threading.main_thread():
            self._previous = signal.signal(signal.SIGINT, self._handle)
        return self

    def _take(self) -> None:
        if self._previous is not None:
            signal.signal(signal.SIGINT, self._handle)

    def __exit__(self, *exc_info) -> None:
        if self._previous is not None:
            signal.signal(signal.SIGINT, self._previous)
        self.requested, self._previous = False, None

    @contextmanager
    def running(self):
        """Context in which Ctrl-C may interrupt at once."""
        self._running = True
        self._take()
        try:
            if self.requested:
                raise KeyboardInterrupt
            yield
        finally:
            self._running = False

    def _handle(self, signum, frame) -> None:
        again, self.requested = self.requested, True
        if again or self._running:
            raise KeyboardInterrupt
