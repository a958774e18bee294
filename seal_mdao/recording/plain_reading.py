"""Read files of OpenMDAO's recorders without running code from them.

A recorder file may come from a stranger. OpenMDAO's own reader unpickles its contents, and a pickle can
call any function; it also evaluates units as Python. Here the few tables that are needed are read by
queries of this package, and their text, JSON and numeric arrays are decoded. Nothing is unpickled,
whatever the schema of the file. SQLite reads rows of tables only, no views and no functions, and no more
bytes than the file has.
"""

import io
import json
import re
import sqlite3
import struct
import tokenize
import zlib
from contextlib import contextmanager
from pathlib import Path

import numpy as np

DAMAGE = (
    OSError, sqlite3.Error, zlib.error, json.JSONDecodeError, UnicodeError, EOFError, LookupError,
    TypeError, AttributeError, ArithmeticError, struct.error, MemoryError, RuntimeError, SyntaxError,
    NameError, tokenize.TokenError,
)  # fmt: skip
"""Exceptions that damaged or foreign files cause in a reader."""
STEPS_PER_BYTE = 10
"""Steps of SQLite's virtual machine; a row takes about one per byte."""
LEAST_STEPS = 10**6
LARGEST_JSON = 2**26
"""Largest decompressed metadata, bytes."""
LARGEST_HEADER = 10**6
"""Largest header of an array, which names every derivative, bytes."""
LONGEST_ERROR = 300
TWO_FILES = bytes.fromhex("d9d505f920a163d7")
"""Last bytes of a journal of SQLite that names a second journal, which SQLite would delete."""

_FACTOR = r"\(*(?:[A-Za-z]\w*(?:\*\*-?\d(?:\.\d{1,4})?)?|\d{1,9}(?:\.\d{1,9})?)\)*"
UNITS = re.compile(rf"{_FACTOR}(?:[*/]{_FACTOR})*", re.ASCII)
"""Products and quotients of names with powers, such as ``kPa/mm`` and ``N*m/s**2``."""


class PlainDatabase:
    """Tables of a recorder file.

    Raises
    ------
    ValueError
        If the path is no file, or beside it is a journal that would make SQLite delete another file.
    """

    def __init__(self, path):
        path = Path(path)
        if not path.is_file():
            raise ValueError(f"{path} is not a file")
        beside = [path.with_name(path.name + ending) for ending in ("-journal", "-wal")]
        if beside[0].is_file() and beside[0].read_bytes()[-8:] == TWO_FILES:
            raise ValueError(
                f"the recorder file {path} has an SQLite journal of a transaction over several "
                "files, which is not supported"
            )
        # limits of what is read follow from the size of the file
        self._bytes = sum(file.stat().st_size for file in (path, *beside) if file.is_file())
        self._steps = LEAST_STEPS + STEPS_PER_BYTE * self._bytes
        self._connection = own = sqlite3.connect(path)
        # no function has no arguments: a schema that calls one is refused
        own.setlimit(sqlite3.SQLITE_LIMIT_FUNCTION_ARG, 0)
        own.setlimit(sqlite3.SQLITE_LIMIT_LENGTH, max(self._bytes, 10**6))
        # ends endless queries
        own.set_progress_handler(self._out_of_steps, 1000)
        own.execute("PRAGMA trusted_schema = OFF")
        own.execute("PRAGMA query_only = ON")
        own.set_authorizer(_rows_of_tables)

    def _out_of_steps(self) -> bool:
        self._steps -= 1000
        return self._steps < 0

    def rows(self, table: str, columns: dict) -> list[tuple]:
        """Read all rows of a table.

        Parameters
        ----------
        columns : dict of str to type
            Columns to read, with the required types.

        Raises
        ------
        TypeError
            For a value of another type.
        ValueError
            If the rows have more bytes than the file.
        """
        found, left = [], self._bytes
        for row in self._connection.execute(f"SELECT {', '.join(columns)} FROM {table}"):
            for (name, kind), value in zip(columns.items(), row, strict=True):
                # SQLite columns hold values of any type, whatever is declared
                if not isinstance(value, kind):
                    raise TypeError(
                        f"column {name!r} of its table {table!r} contains a value of the type "
                        f"{type(value).__name__}"
                    )
                left -= len(value) if isinstance(value, str | bytes) else 1
            if left < 0:
                raise ValueError(
                    f"the table {table!r} of the recorder file yields more data than the size of "
                    "the file"
                )
            found.append(row)
        return found

    def numbered_rows(self, table: str, columns: dict) -> list[tuple]:
        """Read all rows of a table in the order of their ``id``, which is omitted."""
        # sorted here: an index of the file could change the order
        found = self.rows(table, {"id": int} | columns)
        return [row[1:] for row in sorted(found, key=lambda row: row[0])]

    def has(self, table: str) -> bool:
        """Return whether there is a table of this name."""
        return ("table", table) in self.rows("sqlite_master", {"type": str, "name": str})

    def __enter__(self) -> "PlainDatabase":
        return self

    def __exit__(self, *exception) -> None:
        self._connection.close()


def _rows_of_tables(action, table, column, database, view) -> int:
    # ``view`` names the view or trigger in which the action would be done
    reads = action in (sqlite3.SQLITE_SELECT, sqlite3.SQLITE_READ)
    return sqlite3.SQLITE_OK if reads and view is None else sqlite3.SQLITE_DENY


def without_programs(connection: sqlite3.Connection) -> sqlite3.Connection:
    """Restrict a connection: every trigger and every view of the file fails."""
    # the fifth argument names the trigger or view
    connection.execute("PRAGMA trusted_schema = OFF")
    connection.set_authorizer(
        lambda *asked: sqlite3.SQLITE_OK if asked[4] is None else sqlite3.SQLITE_DENY
    )
    return connection


def unpacked(blob: bytes):
    """Decompress and decode a column of JSON."""
    # decompression stops at a limit: a small file may expand without end
    decompressor = zlib.decompressobj()
    text = decompressor.decompress(blob, LARGEST_JSON)
    if not decompressor.eof:
        raise EOFError(
            "the compressed metadata of the recorder file are truncated or larger than "
            f"{LARGEST_JSON} bytes"
        )
    return json.loads(text)


def numbers(text: str) -> dict[str, np.ndarray]:
    """Decode the numeric values of a case by name, from JSON."""
    found = {}
    for name, value in (json.loads(text) or {}).items():
        try:
            found[name] = np.asarray(value, float)
        except (TypeError, ValueError):  # a discrete variable
            continue
    return found


def fields(blob: bytes) -> dict[str, np.ndarray]:
    """Decode the fields of the only record of an array in NumPy's format; objects are refused."""
    stream = io.BytesIO(blob)
    table = np.lib.format.read_array(stream, allow_pickle=False, max_header_size=LARGEST_HEADER)
    return {name: np.asarray(table[name][0], float) for name in table.dtype.names or ()}


def checked_units(text: str | None) -> str | None:
    """Require text that OpenMDAO, which evaluates units as Python, can only read as units.

    Raises
    ------
    ValueError
        For any other text.
    """
    if text is not None and not UNITS.fullmatch(text):
        raise ValueError(f"a variable in the recorder file has the invalid units {text!r}")
    return text


@contextmanager
def reading(path):
    """Open a recorder file.

    Raises
    ------
    ValueError
        One line with the path, in place of any error that a damaged or foreign file causes.
    """
    try:
        with PlainDatabase(path) as database:
            yield database
    except DAMAGE as error:
        raise ValueError(
            f"{path} is not a file of an OpenMDAO recorder, or it is damaged "
            f"({type(error).__name__}: {_one_line(error)})"
        ) from error
    except ValueError as error:
        if str(path) in str(error):
            raise
        raise ValueError(f"{path} cannot be read: {_one_line(error)}") from error


def _one_line(error: Exception) -> str:
    # the message may quote the file: printable characters only
    text = "".join(letter if letter.isprintable() else " " for letter in str(error))
    return text if len(text) <= LONGEST_ERROR else f"{text[:LONGEST_ERROR]}..."
