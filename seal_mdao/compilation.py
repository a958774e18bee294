"""A word to the user while numba compiles the kernels, which happens once for an installation."""

import sys
from functools import cache

from numba.core import event

MESSAGE = "seal_mdao: compiling its kernels, once for this installation (a quarter of a minute) ..."


class _Announcement(event.Listener):
    """Writes the message when the first kernel of this package is really compiled."""

    def __init__(self):
        self.waiting = True

    def on_start(self, event):
        module = event.data["dispatcher"].py_func.__module__
        if self.waiting and module.startswith("seal_mdao."):
            self.waiting = False
            print(MESSAGE, file=sys.stderr, flush=True)

    def on_end(self, event):
        pass


@cache
def announce_compilation() -> None:
    """Say so on standard error when kernels are compiled; those in numba's cache are not."""
    event.register("numba:compile", _Announcement())
