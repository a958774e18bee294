"""Recorder files changed at random, in schema and content: nothing runs, and an error is one line."""

import gc
import io
import itertools
import json
import os
import random
import sqlite3
import sys
import zlib
from collections import Counter
from contextlib import closing, suppress
from pathlib import Path

import numpy as np
import openmdao.api as om
import pytest
from hostile import ATTACKS, BOMBS, LEFT_OPEN, PICKLED, UNITS, change, literal, put
from openmdao.recorders.sqlite_reader import SqliteCaseReader
from valley import Valley, record

import seal_mdao as sm
from seal_mdao.recording.evaluations import RecordedEvaluations, RestartError
from seal_mdao.report.write import write_report

MUTATIONS = 500
TEXTS = (
    "", "null", "[]", "{}", "[1]", '"text"', "9" * 5000, "[" * 10**5, "{" * 10**5, "NaN", "1e999",
    json.dumps({"valley.f": int("9" * 400)}), json.dumps({"valley.f": [[1.0], [2.0, 3.0]]}),
    json.dumps({"valley.f": None, "valley.g": {"a": 1}}), "rank0:Uno|x", "</script><b>", "$\\frac{$",
)  # fmt: skip
PARTS = (None, 1, -1.5, "text", [], {}, [1, 2], int("9" * 400), {"val": False})
VALUES = (None, -1, 0, 2**62, 1.5, float("inf"), b"", b"\x00\xff", bytes(1000))


def problem():
    """The valley with units, and with options that are settings of a seal which is not there."""
    made = om.Problem(driver=sm.UnoDriver(), reports=None)
    made.model.add_subsystem("valley", Valley(), promotes=["*"])
    made.model.add_subsystem("size", om.ExecComp("h = f", h={"units": "m"}), promotes=["*"])
    made.model.add_design_var("x", lower=-3.0, upper=3.0, ref=2.0, ref0=0.5)
    made.model.add_objective("h", ref=3.0, units="mm")
    made.model.add_constraint("g", upper=2.0, ref=2.0)
    made.setup()
    return made


@pytest.fixture
def finished():
    """Bytes of the recorder file of a finished run."""
    run = record(problem())
    run.run_driver()
    run.cleanup()
    return Path("cases.sql").read_bytes()


def tables(path):
    """Names of all tables with those of their columns."""
    with closing(sqlite3.connect(path)) as connection:
        query = "SELECT name FROM sqlite_master WHERE type='table'"
        names = [name for (name,) in connection.execute(query)]
        return {
            name: [row[1] for row in connection.execute(f'PRAGMA table_info("{name}")')]
            for name in names
            if name in PICKLED or name == "problem_cases"
        }


def content(path, choose):
    """A value of another kind in a column that some reader unpickles, or in any."""
    table = choose.choice([*PICKLED])
    column = choose.choice(PICKLED[table])
    if choose.random() < 0.3:
        column = choose.choice(tables(path)[table])
    texts = [value for text in TEXTS for value in (text, zlib.compress(text.encode()))]
    put(path, table, column, choose.choice([*BOMBS, *BOMBS, *BOMBS, *texts, *VALUES]))


def part_of_json(path, choose):
    """A value deep in recorded JSON."""
    table = choose.choice(["metadata", "driver_metadata", "driver_iterations", "run_log"])
    column = choose.choice(PICKLED[table])
    with closing(sqlite3.connect(path)) as connection:
        value = connection.execute(f"SELECT {column} FROM {table}").fetchone()[0]
    packed = isinstance(value, bytes)
    found = json.loads(zlib.decompress(value) if packed else value)
    at = found
    while isinstance(at, dict | list) and len(at):
        key = choose.choice([*at] if isinstance(at, dict) else range(len(at)))
        if not isinstance(at[key], dict | list) or not at[key] or choose.random() < 0.1:
            at[key] = choose.choice([*PARTS, other_units(choose)])
            break
        at = at[key]
    text = json.dumps(found)
    put(path, table, column, zlib.compress(text.encode()) if packed else text)


def other_units(choose):
    """Units that OpenMDAO has not seen: it evaluates none twice."""
    return f"{UNITS} or {choose.random()}"


def all_units(path, choose):
    """Every variable has units that are Python."""
    with closing(sqlite3.connect(path)) as connection:
        packed = connection.execute("SELECT abs2meta, var_settings FROM metadata").fetchone()
    for column, blob in zip(("abs2meta", "var_settings"), packed, strict=True):
        found = json.loads(zlib.decompress(blob))
        for settings in found.values():
            if isinstance(settings, dict):
                settings["units"] = choose.choice(["m", other_units(choose)])
        put(path, "metadata", column, zlib.compress(json.dumps(found).encode()))


def schema(path, choose):
    """A table that is a view, or has a generated column, or a name in capitals, or one row more."""
    table = choose.choice([*PICKLED])
    column, blob = choose.choice(PICKLED[table]), literal(choose.choice(BOMBS))
    own = tables(path)[table]
    others = [name for name in own if name != column]
    kind = choose.choice(["view", "generated", "column", "table", "rows", "drop", "index", "known"])
    if kind == "view":
        read = ", ".join(f"{blob} AS {n}" if n == column else n for n in own)
        change(
            path, f"ALTER TABLE {table} RENAME TO other",
            f"CREATE VIEW {table} AS SELECT {read} FROM other",
        )  # fmt: skip
    elif kind == "generated":
        change(
            path, f"CREATE TABLE other AS SELECT {', '.join(others)} FROM {table}",
            f"DROP TABLE {table}", f"ALTER TABLE other RENAME TO {table}",
            f"ALTER TABLE {table} ADD COLUMN {column} BLOB AS ({blob}) VIRTUAL",
        )  # fmt: skip
    elif kind == "column":
        change(path, f"ALTER TABLE {table} RENAME COLUMN {column} TO {column.upper()}")
        put(path, table, column, choose.choice(BOMBS))
    elif kind == "table":
        change(
            path, f"ALTER TABLE {table} RENAME TO other",
            f"ALTER TABLE other RENAME TO {table.upper()}",
        )  # fmt: skip
        put(path, table, column, choose.choice(BOMBS))
    elif kind == "rows":
        names = ", ".join(name for name in others if name != "id") or "rowid"
        change(
            path,
            f"CREATE INDEX by_{column} ON {table}({choose.choice(others or own)} DESC)",
            f"INSERT INTO {table}({names}, {column}) SELECT {names}, {blob} FROM {table}",
        )
    elif kind == "index":
        change(path, f"CREATE INDEX by_{column} ON {table}({choose.choice(own)} DESC)")
    elif kind == "drop":
        change(path, f"DROP TABLE {table}")
    else:
        choose.choice(ATTACKS)(path, choose.choice(BOMBS))


def bytes_of_file(path, choose):
    """A few bytes anywhere, or an end that is missing."""
    content = bytearray(path.read_bytes())
    for _ in range(choose.randint(1, 20)):
        content[choose.randrange(len(content))] = choose.randrange(256)
    if choose.random() < 0.2:
        del content[choose.randrange(len(content)) :]
    path.write_bytes(content)


KINDS = (content, content, part_of_json, part_of_json, all_units, schema, schema, bytes_of_file)


REFUSED = (sqlite3.Error, zlib.error, ValueError, OSError, TypeError, KeyError, RecursionError)
"""What SQLite, and changes to what was changed before, end in."""


def mutate(path, choose):
    """Change a file; what SQLite refuses to change stays."""
    for kind in choose.choices(KINDS, k=choose.randint(1, 3)):
        with suppress(
            sqlite3.Error, ValueError, OSError, TypeError, KeyError, zlib.error, RecursionError
        ):
            kind(path, choose)


def read(path, driver):
    """How report and restart end, as their commands would: errors they do not know are raised."""
    return tuple(
        _end(reading, known, path)
        for reading, known in (
            (lambda: write_report(path), (ValueError, OSError)),
            (lambda: RecordedEvaluations(path, driver).load_start(), RestartError),
        )
    )


def _end(reading, known, path) -> str:
    try:
        reading()
    except known as error:
        return "refused" if str(path) in str(error) and "\n" not in str(error) else str(error)
    return "read"


def exploded():
    """Whether anything ran since the last call."""
    there = os.path.exists("exploded")
    if there:
        os.remove("exploded")
    return there


def trusting(path):
    """A reader that loads every pickle it finds, and evaluates units, as OpenMDAO's does."""
    with suppress(Exception), closing(sqlite3.connect(path)) as connection:
        for table in [n for (n,) in connection.execute("SELECT name FROM sqlite_master")]:
            with suppress(sqlite3.Error):
                for blob in itertools.chain(*connection.execute(f'SELECT * FROM "{table}"')):
                    load(blob)
    with suppress(Exception):
        reader = SqliteCaseReader(str(path))
        reader.get_case(0).get_objectives(scaled=False)


def load(blob):
    for content in (lambda: blob, lambda: zlib.decompress(blob)):
        with suppress(Exception):
            np.load(io.BytesIO(content()), allow_pickle=True)


@pytest.mark.skipif(sys.platform == "win32", reason="SQLite's files stay open on errors")
@LEFT_OPEN
def test_no_mutation_runs_anything(finished):
    prepared = problem()
    prepared.final_setup()
    path, choose, ends, armed = Path("cases.sql"), random.Random(33), Counter(), 0
    for number in range(MUTATIONS):
        path.unlink()
        path.write_bytes(finished)
        mutate(path, choose)
        found = read(path, prepared.driver)
        assert {*found} <= {"read", "refused"}, number
        ends[found] += 1
        assert not exploded(), number
        if number % 5 == 0:
            trusting(path)
            gc.collect()
            armed += exploded()
    assert ends["refused", "refused"] > MUTATIONS // 5
    assert ends["read", "read"] > MUTATIONS // 50
    assert armed > MUTATIONS // 20  # of a fifth of the files
