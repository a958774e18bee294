"""No recorder file runs code, reads without end, or makes SQLite delete another file."""

import gc
import json
import sqlite3
import subprocess
import sys
import zlib
from contextlib import closing, suppress
from pathlib import Path

import openmdao
import openmdao.api as om
import pytest
from hostile import ATTACKS, LEFT_OPEN, UNITS, change, put
from openmdao.recorders.sqlite_reader import SqliteCaseReader
from valley import record, valley_problem

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.recording.evaluations import RestartError, read_cases
from seal_mdao.recording.plain_reading import TWO_FILES, PlainDatabase, checked_units
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.recording.recorder_file import read_driver_cases
from seal_mdao.report.write import write_report

OPENMDAO = tuple(map(int, openmdao.__version__.split(".")[:2]))


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    """A recorder file of a finished run."""
    path = tmp_path_factory.mktemp("run") / "cases.sql"
    problem = record(valley_problem(sm.UnoDriver()), path)
    problem.run_driver()
    problem.cleanup()
    return path.read_bytes()


@pytest.fixture
def cases(finished, tmp_path):
    """A copy of it in the current folder."""
    path = tmp_path / "cases.sql"
    path.write_bytes(finished)
    return path


def exploded():
    return Path("exploded").exists()


@LEFT_OPEN
@pytest.mark.parametrize("attack", ATTACKS)
def test_attack_runs_nothing(cases, attack):
    attack(cases)
    with suppress(ValueError):
        write_report(cases)
    with suppress(RestartError):
        sm.restart(valley_problem(sm.UnoDriver()), cases)
    assert not exploded()
    with suppress(Exception):  # a reader that trusts the file
        SqliteCaseReader(str(cases), pre_load=True)
    gc.collect()
    assert exploded()


@pytest.mark.parametrize("attack", ATTACKS)
def test_attack_is_one_line_of_the_command(cases, attack):
    attack(cases)
    command = ("-m", "openmdao.utils.om", "seal_report", "cases.sql", "--no-display")
    ended = subprocess.run([sys.executable, *command], capture_output=True, text=True, check=False)
    assert ended.returncode in (0, 2)  # a report needs no derivatives
    assert ended.stderr.count("\n") == (ended.returncode == 2)
    assert "Traceback" not in ended.stderr
    assert not exploded()


def metadata_of(path, column):
    """What a column of the metadata holds."""
    with closing(sqlite3.connect(path)) as connection:
        (blob,) = connection.execute(f"SELECT {column} FROM metadata").fetchone()
    return json.loads(zlib.decompress(blob))


def with_units(path, text):
    """The objective is in these units."""
    metadata, settings = (metadata_of(path, name) for name in ("abs2meta", "var_settings"))
    metadata["valley.f"]["units"], settings["f"]["units"] = "m", text
    for column, value in (("abs2meta", metadata), ("var_settings", settings)):
        put(path, "metadata", column, zlib.compress(json.dumps(value).encode()))


def test_units_are_not_evaluated(cases):
    with_units(cases, f"{UNITS} or 'again'")  # OpenMDAO evaluates none twice
    with pytest.raises(ValueError, match=r"cases\.sql cannot be read: .* invalid units"):
        read_optimization(cases)
    assert not exploded()


@pytest.mark.skipif(OPENMDAO < (3, 44), reason="this release converts no units there")
def test_units_are_evaluated_by_openmdao(cases):
    """So the file of the test before would do harm."""
    with_units(cases, f"{UNITS} or 'again'")
    with suppress(Exception):
        reader = om.CaseReader(str(cases))
        reader.get_case(0).get_objectives(scaled=False)
    assert exploded()


def test_units_of_others_are_converted(cases):
    in_metres = read_optimization(cases).objective
    with_units(cases, "mm")
    assert read_optimization(cases).objective == pytest.approx(1e3 * in_metres, rel=1e-12)


@pytest.mark.parametrize(
    "text",
    ["mm", "kPa/mm", "N*m/s**2", "1/s", "kg/(m*s)", "N**0.5", "m**-1", "lbf/ft**2", "as_*3", None],
)
def test_units(text):
    assert checked_units(text) == text


@pytest.mark.parametrize(
    "text",
    ["", "9**9**9", "m**99", "m.real", "m()", "m(s)", "().x", "[m]", "m if m else m", "m,m", "__x",
     "(m)**2", "m\n", "'m'", "<b>", "lambda: m"],
)  # fmt: skip
def test_what_are_no_units(text):
    with pytest.raises(ValueError, match="invalid units"):
        checked_units(text)


def replaced(table, statement):
    """A table that is made anew by a statement."""
    return f"DROP TABLE {table}", statement


COLUMNS = (
    "1 AS id, 1 AS counter, 'rank0:Uno|0' AS iteration_coordinate, 1 AS success, '' AS msg, "
    "'{}' AS inputs, '{}' AS outputs"
)
NOT_TABLES = {
    "view": replaced(
        "driver_iterations",
        "CREATE VIEW driver_iterations AS SELECT id, counter, iteration_coordinate, success, msg, "
        "'{}' AS inputs, '{}' AS outputs FROM driver_derivatives",
    ),
    "endless view": replaced(
        "driver_iterations",
        "CREATE VIEW driver_iterations AS WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 "
        f"FROM n) SELECT {COLUMNS} FROM n",
    ),
    "function": replaced(
        "driver_iterations",
        "CREATE TABLE driver_iterations(id INTEGER PRIMARY KEY, counter INT, iteration_coordinate "
        "TEXT, success INT, msg TEXT, inputs TEXT, outputs TEXT AS (hex(zeroblob(9e8))))",
    ),
    "virtual": replaced(
        "driver_iterations",
        "CREATE VIRTUAL TABLE driver_iterations USING fts5(counter, iteration_coordinate, success, "
        "msg, inputs, outputs)",
    ),
}


@pytest.mark.parametrize("statements", NOT_TABLES.values(), ids=NOT_TABLES)
def test_only_tables_are_read(cases, statements):
    change(cases, *statements)
    reasons = "prohibited|not authorized|too many arguments on function|constructor failed"
    with pytest.raises(ValueError, match=rf"cases\.sql is not a file of .*({reasons})"):
        read_optimization(cases)
    with pytest.raises(RestartError, match=r"cases\.sql"):
        read_cases(cases)


def test_metadata_of_two_models_are_refused(cases):
    change(cases, "INSERT INTO metadata SELECT * FROM metadata")
    with pytest.raises(
        ValueError, match="the table 'metadata' of the recorder file has 2 rows, not one"
    ):
        read_optimization(cases)


def test_pages_that_are_there_many_times_are_not_read_without_end(cases):
    """All rows of a table give the same long text, which the file holds once."""
    change(
        cases,
        "CREATE TABLE long(text TEXT)",
        f"INSERT INTO long VALUES ('{{{' ' * 10**5}}}')",
        *replaced(
            "driver_iterations",
            "CREATE TABLE driver_iterations(id INTEGER PRIMARY KEY, counter INT DEFAULT 1, success "
            "INT DEFAULT 1, msg TEXT, inputs TEXT DEFAULT '{}', iteration_coordinate TEXT DEFAULT "
            "'rank0:Uno|0')",
        ),
        "INSERT INTO driver_iterations(msg) SELECT '' FROM driver_derivatives",
        f"ALTER TABLE driver_iterations ADD COLUMN outputs TEXT DEFAULT '{{{' ' * 10**5}}}'",
    )
    with pytest.raises(ValueError, match="yields more data than the size of the file"):
        read_optimization(cases)


def test_steps_of_sqlite_are_limited(cases):
    with PlainDatabase(cases) as database:
        assert len(read_driver_cases(database)) > 10
        database._steps = 0
        with pytest.raises(sqlite3.OperationalError, match="interrupted"):
            read_many_times(database)


def read_many_times(database):
    for _ in range(1000):
        read_driver_cases(database)


def test_metadata_that_unpack_without_end(cases):
    """A megabyte of zeros for each kilobyte."""
    packer = zlib.compressobj()
    blob = b"".join(packer.compress(bytes(2**24)) for _ in range(5)) + packer.flush()
    put(cases, "metadata", "conns", blob)
    with pytest.raises(ValueError, match="larger than 67108864 bytes"):
        read_optimization(cases)


def test_journal_that_names_another_file(cases):
    """SQLite would delete that file when it rolls the journal back."""
    Path("cases.sql-journal").write_bytes(bytes(100) + TWO_FILES)
    with pytest.raises(ValueError, match="has an SQLite journal of a transaction over several"):
        read_optimization(cases)


@pytest.mark.parametrize("name", ["$\\frac{$", "</script><script>", "{}%s"])
def test_names_are_text(cases, name):
    """In figures and in the page."""
    settings = metadata_of(cases, "var_settings")
    for old in ("f", "g"):
        settings[name + old] = settings.pop(old)
    put(cases, "metadata", "var_settings", zlib.compress(json.dumps(settings).encode()))
    history = read_optimization(cases)
    assert history.objective_name == name + "f"
    for draw in (plotting.objective_history, plotting.constraint_history):
        plotting.save(draw(history), Path("history.svg"))
    page = write_report(cases).read_text(encoding="utf-8")
    assert page.count("<script") == 2


@pytest.mark.parametrize("text", ['{"valley.x": [1.0]}', '{"valley.x": []}'])
def test_values_of_other_sizes_are_not_continued(cases, text):
    put(cases, "driver_iterations", "inputs", text)
    with pytest.raises(RestartError, match=r"no case in .*cases\.sql contains"):
        sm.restart(valley_problem(sm.UnoDriver()), cases)


def test_settings_to_compare_are_read_from_their_table_only(cases):
    """A restart compares the recorded settings of variables with those of the problem."""
    change(
        cases,
        "ALTER TABLE metadata RENAME TO other",
        "CREATE VIEW metadata AS SELECT * FROM other",
    )
    with pytest.raises(
        ValueError, match=r"cases\.sql is not a file of .*(prohibited|not authorized)"
    ):
        sm.restart(valley_problem(sm.UnoDriver()), cases)


TRIGGERS = (
    "CREATE TRIGGER once AFTER INSERT ON driver_iterations BEGIN DELETE FROM driver_derivatives; END",
    "CREATE TRIGGER once AFTER INSERT ON run_log BEGIN DELETE FROM driver_derivatives; END",
)


@pytest.mark.parametrize("trigger", TRIGGERS)
def test_trigger_does_nothing_in_a_continued_run(cases, trigger):
    change(cases, trigger, "DELETE FROM driver_iterations WHERE id > 5")
    before = read_cases(cases)
    problem = valley_problem(sm.UnoDriver())
    sm.restart(problem, cases)
    with pytest.raises(sqlite3.DatabaseError, match="not authorized"):
        problem.run_driver()
    problem.cleanup()
    with closing(sqlite3.connect(cases)) as connection:
        kept = connection.execute("SELECT COUNT(*) FROM driver_derivatives").fetchone()[0]
    assert kept >= len(before)
