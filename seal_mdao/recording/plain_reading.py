"""Reading files of OpenMDAO's recorders without running what is in them.

A recorder file holds pickles (options of systems and solvers, scaling factors), and a pickle can call
any function when it is loaded. OpenMDAO's own reader forbids four of them and loads everything. Here no
class or function of a pickle is ever looked up: plain containers, text and numbers come through, and
everything else becomes an ``Unknown``. Arrays that would hold pickled objects are refused.
"""

import io
import json
import pickle
import sqlite3
import struct
import zlib
from contextlib import contextmanager

import numpy as np

DAMAGE = (
    OSError, sqlite3.Error, zlib.error, pickle.UnpicklingError, json.JSONDecodeError, UnicodeError,
    EOFError, LookupError, TypeError, AttributeError, OverflowError, struct.error, MemoryError,
    RuntimeError,
)  # fmt: skip
"""What damaged or foreign files end in, somewhere in a reader."""
ARRAY_COLUMNS = ("derivatives", "jacobian")


class Unknown:
    """Stands for an object of a pickle: takes what is done to it, and does nothing.

    Attributes
    ----------
    state : object
        What the pickle would have set.
    """

    def __init__(self, *args, **kwargs):
        self.state = None

    def __setstate__(self, state):
        self.state = state

    def __setitem__(self, key, value):
        pass

    def append(self, item):
        """Nothing."""

    def extend(self, items):
        """Nothing."""

    def add(self, item):
        """Nothing."""


class _PlainUnpickler(pickle.Unpickler):
    def find_class(self, module, name):
        return Unknown


def plain_pickle(blob: bytes):
    """What a compressed pickle holds of plain data, everything else as ``Unknown``."""
    return _PlainUnpickler(io.BytesIO(zlib.decompress(blob))).load()


def text_options(blob: bytes | None) -> dict[str, str]:
    """Options with text as values out of a recorded ``OptionsDictionary``."""
    state = getattr(plain_pickle(blob), "state", None) if blob else None
    entries = state.get("_dict", {}) if isinstance(state, dict) else {}
    values = {name: meta.get("val") for name, meta in entries.items() if isinstance(meta, dict)}
    return {name: value for name, value in values.items() if isinstance(value, str)}


def refuse_objects(connection: sqlite3.Connection) -> None:
    """Check that all recorded arrays are arrays of numbers.

    Raises
    ------
    ValueError
        For one that holds, or is, a pickle.
    """
    tables = [
        row[0] for row in connection.execute("SELECT name FROM sqlite_master WHERE type='table'")
    ]
    for table in tables:
        columns = [row[1] for row in connection.execute(f'PRAGMA table_info("{table}")')]
        for column in (name for name in columns if name in ARRAY_COLUMNS):
            for (blob,) in connection.execute(f'SELECT "{column}" FROM "{table}"'):
                if blob and not _holds_numbers(blob):
                    raise ValueError(
                        f"column {column!r} of its table {table!r} holds objects, not numbers"
                    )


def _holds_numbers(blob) -> bool:
    if not isinstance(blob, bytes):
        return False
    stream = io.BytesIO(blob)
    try:
        version = np.lib.format.read_magic(stream)
        read = {
            (1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0
        }[version]  # fmt: skip
        return not read(stream)[2].hasobject
    except (ValueError, KeyError):
        return False


@contextmanager
def reading(path):
    """What a damaged or foreign file ends in, as one line that names it.

    Raises
    ------
    ValueError
        In place of whatever a reader raised.
    """
    try:
        yield
    except DAMAGE as error:
        raise ValueError(
            f"{path} is not a file of an OpenMDAO recorder, or it is damaged "
            f"({type(error).__name__}: {error})"
        ) from error
    except ValueError as error:
        if str(path) in str(error):
            raise
        raise ValueError(f"{path} cannot be read: {error}") from error
