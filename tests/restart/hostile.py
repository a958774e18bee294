"""Recorder files that would run code in a reader that trusts them."""

import io
import pickle
import shutil
import sqlite3
import zlib
from contextlib import closing

import numpy as np
import pytest

LEFT_OPEN = pytest.mark.filterwarnings("ignore:unclosed database:ResourceWarning")
"""OpenMDAO's reader leaves a file open that it cannot read. Python 3.13 warns of it when the reader is
collected: the test asks for the collection."""

PICKLED = {
    "metadata": ("abs2prom", "prom2abs", "abs2meta", "var_settings", "conns"),
    "driver_metadata": ("model_viewer_data",),
    "driver_iterations": ("inputs", "outputs", "residuals"),
    "driver_derivatives": ("derivatives",),
    "problem_cases": ("inputs", "outputs", "residuals", "jacobian"),
    "system_metadata": ("scaling_factors", "component_metadata"),
    "solver_metadata": ("solver_options",),
    "run_log": ("options", "versions"),
}
"""Columns where some version of OpenMDAO's reader, or a careless one, loads a pickle."""
UNITS = (
    "[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == 'catch_warnings'][0]()"
    "._module.__builtins__['open']('exploded', 'w')"
)
"""OpenMDAO evaluates units as Python; these make a file."""


class Bomb:
    """An object whose loading copies a file, by a function that OpenMDAO's reader does not forbid."""

    def __reduce__(self):
        return shutil.copyfile, ("cases.sql", "exploded")


def bomb():
    return zlib.compress(pickle.dumps(Bomb()))


def array_of_bombs():
    stream = io.BytesIO()
    np.save(stream, np.array([Bomb()], dtype=object), allow_pickle=True)
    return stream.getvalue()


BOMBS = (pickle.dumps(Bomb()), pickle.dumps(Bomb(), 0), bomb(), array_of_bombs())


def change(path, *statements):
    """Execute statements, each text or (text, parameters)."""
    with closing(sqlite3.connect(path)) as connection, connection:
        for statement in statements:
            connection.execute(*((statement,) if isinstance(statement, str) else statement))


def put(path, table, column, value):
    """Give a column one value in all rows."""
    change(path, (f"UPDATE {table} SET {column}=?", (value,)))


def literal(blob):
    return f"x'{blob.hex()}'"


def with_view(path, blob=BOMBS[0]):
    """``driver_derivatives`` is no table."""
    change(
        path,
        "ALTER TABLE driver_derivatives RENAME TO other",
        "CREATE VIEW driver_derivatives AS SELECT id, counter, iteration_coordinate, timestamp, "
        f"success, msg, {literal(blob)} AS derivatives FROM other",
    )


def with_generated_column(path, blob=BOMBS[0]):
    """SQLite's list of columns leaves out those that are generated."""
    change(
        path,
        "ALTER TABLE driver_derivatives RENAME TO other",
        "CREATE TABLE driver_derivatives(id INTEGER PRIMARY KEY, counter INT, "
        "iteration_coordinate TEXT, timestamp REAL, success INT, msg TEXT, "
        f"derivatives BLOB GENERATED ALWAYS AS ({literal(blob)}))",
        "INSERT INTO driver_derivatives SELECT id, counter, iteration_coordinate, timestamp, "
        "success, msg FROM other",
        "DROP TABLE other",
    )


def with_capitals(path, blob=BOMBS[0]):
    """Names have no case in SQLite."""
    put(path, "driver_derivatives", "derivatives", blob)
    change(path, "ALTER TABLE driver_derivatives RENAME COLUMN derivatives TO DERIVATIVES")


def with_two_rows(path, blob=BOMBS[0]):
    """The row of an old format comes first, but last in the index by which formats are looked up."""
    columns = "format_version, openmdao_version, abs2prom, prom2abs, abs2meta, var_settings, conns"
    change(
        path,
        "ALTER TABLE metadata RENAME TO other",
        "CREATE TABLE metadata(format_version INT, openmdao_version TEXT, abs2prom BLOB, prom2abs "
        "BLOB, abs2meta BLOB, var_settings BLOB, conns BLOB)",
        (
            f"INSERT INTO metadata({columns}) SELECT 1, openmdao_version, ?, ?, ?, "
            "var_settings, conns FROM other",
            (blob,) * 3,
        ),
        f"INSERT INTO metadata({columns}) SELECT {columns} FROM other",
        "DROP TABLE other",
        "CREATE INDEX by_format ON metadata(format_version DESC)",
    )


ATTACKS = (with_view, with_generated_column, with_capitals, with_two_rows)
