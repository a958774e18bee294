"""Opening a recorder file runs nothing that is in it, and a damaged one is one line."""

import pickle
import zlib

import openmdao.api as om
import pytest
from hostile import Bomb, array_of_bombs, bomb, put
from valley import record, valley_problem

import seal_mdao as sm
from seal_mdao.recording.evaluations import RestartError, read_cases
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.recording.recorder_file import open_model
from seal_mdao.report.write import write_report


@pytest.fixture
def cases(tmp_path, monkeypatch):
    """A recorder file of a finished run, in the current folder."""
    monkeypatch.chdir(tmp_path)
    problem = record(valley_problem(sm.UnoDriver()), "cases.sql")
    problem.run_driver()
    problem.cleanup()
    return tmp_path / "cases.sql"


@pytest.mark.parametrize(
    ("table", "column"),
    [("solver_metadata", "solver_options"), ("system_metadata", "scaling_factors"),
     ("system_metadata", "component_metadata")],
)  # fmt: skip
def test_pickle_in_a_recorder_file_is_not_run(cases, table, column):
    put(cases, table, column, bomb())
    assert write_report(cases).is_file()
    assert len(read_cases(cases)) > 10
    sm.restart(valley_problem(sm.UnoDriver()), cases)
    assert not (cases.parent / "exploded").exists()
    om.CaseReader(str(cases))  # what the documentation says of OpenMDAO's own reader
    assert (cases.parent / "exploded").exists()


@pytest.mark.parametrize("pickled", [pickle.dumps(Bomb()), array_of_bombs()])
def test_pickle_in_the_place_of_derivatives_is_refused(cases, pickled):
    """np.load takes a bare pickle too, and arrays of objects. A report does not read them."""
    put(cases, "driver_derivatives", "derivatives", pickled)
    with pytest.raises(RestartError, match=r"cases\.sql"):
        read_cases(cases)
    assert read_optimization(cases).major
    assert not (cases.parent / "exploded").exists()


def test_old_format_with_more_pickles_is_refused(cases):
    put(cases, "metadata", "format_version", 2)
    put(cases, "metadata", "abs2prom", pickle.dumps(Bomb()))
    with pytest.raises(ValueError, match=r"cases\.sql.*format 2 of the recorder file is older"):
        open_model(cases)
    assert not (cases.parent / "exploded").exists()


DAMAGED = [
    ("metadata", "abs2prom", b"no zlib"), ("metadata", "abs2prom", zlib.compress(b"{,")),
    ("metadata", "var_settings", zlib.compress(b"{}")), ("metadata", "format_version", "new"),
    ("metadata", "format_version", 99), ("metadata", "conns", None),
    ("metadata", "abs2meta", zlib.compress(b"[" * 10**5)),
    ("metadata", "abs2meta", zlib.compress(b"[%s]" % (b"9" * 5000))),
    ("driver_iterations", "outputs", '{"valley.f": [%s]}' % ("9" * 400)),
    ("driver_iterations", "outputs", "{,"), ("driver_iterations", "outputs", "[1]"),
    ("driver_iterations", "outputs", None), ("driver_iterations", "iteration_coordinate", None),
    ("driver_derivatives", "counter", "first"), ("driver_metadata", "model_viewer_data", "{"),
    ("run_log", "options", "{"), ("run_log", "versions", None),
]  # fmt: skip


@pytest.mark.parametrize(("table", "column", "value"), DAMAGED)
def test_damaged_file_is_one_line_that_names_it(cases, table, column, value):
    put(cases, table, column, value)
    with pytest.raises(ValueError, match=r"cases\.sql") as error:
        read_optimization(cases)
    assert isinstance(error.value, ValueError)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.9])
def test_file_that_was_cut_short_is_one_line_that_names_it(cases, share):
    whole = cases.read_bytes()
    cases.write_bytes(whole[: int(share * len(whole))])
    for read, error in ((read_optimization, ValueError), (read_cases, RestartError)):
        with pytest.raises(error, match=r"cases\.sql"):
            read(cases)
