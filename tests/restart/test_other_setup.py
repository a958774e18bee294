"""A run is continued by the problem and driver that wrote it; what differs is said."""

import re

import openmdao.api as om
import pytest
from valley import Valley, record

import seal_mdao as sm
from seal_mdao.recording.recorder import record_all
from seal_mdao.recording.restart import RestartWarning

SETUP = {
    "x": {"lower": -3.0, "upper": 3.0, "ref": 2.0, "ref0": 0.5},
    "f": {"ref": 3.0},
    "g": {"upper": 2.0, "ref": 2.0},
}


def problem_with(driver=None, **changed):
    """The valley with the settings of one variable changed."""
    x, f, g = ({**SETUP[name], **changed.get(name, {})} for name in "xfg")
    driver = sm.UnoDriver(disp=False, maxiter=3) if driver is None else driver
    problem = om.Problem(driver=driver, reports=None)
    problem.model.add_subsystem("valley", Valley(), promotes=["*"])
    problem.model.add_design_var("x", **x)
    problem.model.add_objective("f", **f)
    problem.model.add_constraint("g", **g)
    problem.setup()
    return problem


@pytest.fixture
def recorded():
    problem = record(problem_with())
    problem.run_driver()
    problem.cleanup()


OTHERS = {
    "upper bound": ({"x": {"upper": 2.5}}, "upper of 'x' was 3.0 and is 2.5"),
    "bound of one entry": (
        {"x": {"upper": [3.0, 3.0, 2.0]}}, "upper of 'x' was 3.0 and is [3.0, 3.0, 2.0]",
    ),
    "scaling of a variable": ({"x": {"ref": 4.0}}, "ref of 'x' was 2.0 and is 4.0"),
    "scaling of the objective": ({"f": {"ref": 1.0}}, "ref of 'f' was 3.0 and is 1.0"),
    "limit": ({"g": {"upper": 1.9}}, "upper of 'g' was 2.0 and is 1.9"),
    "other entries": (
        {"x": {"indices": [0, 2]}}, "indices of 'x' was None and is [0, 2]; size of 'x' was 3 and is 2",
    ),
    "two at once": (
        {"x": {"lower": -1.0}, "g": {"ref": 1.0}},
        "lower of 'x' was -3.0 and is -1.0; ref of 'g' was 2.0 and is 1.0",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", OTHERS)
def test_other_bounds_and_scaling_are_refused_with_both_values(recorded, name):
    changed, words = OTHERS[name]
    problem = problem_with(**changed)
    before = problem.driver.options["hotstart_file"]
    with pytest.raises(ValueError, match=re.escape(words)):
        sm.restart(problem, "./cases.sql")
    assert problem.driver.options["hotstart_file"] == before


def test_another_driver_is_refused(recorded):
    problem = problem_with(sm.IpoptDriver(disp=False))
    with pytest.raises(ValueError, match="the driver was UnoDriver and is IpoptDriver"):
        sm.restart(problem, "./cases.sql")


def test_other_options_are_reported_unless_they_only_end_the_run(recorded):
    sm.restart(problem_with(sm.UnoDriver(disp=False, maxiter=9, tol=1e-5)), "./cases.sql")
    problem = problem_with(sm.UnoDriver(disp=False, trust_radius=0.7))
    with pytest.warns(RestartWarning, match=r"trust_radius was 0.3 and is 0.7"):
        sm.restart(problem, "./cases.sql")
    assert problem.driver.options["hotstart_file"]


def test_limits_that_differ_by_rounding_are_the_same(recorded):
    sm.restart(problem_with(g={"upper": 2.0 * (1.0 + 1e-14)}), "./cases.sql")


def test_files_of_other_recorders_are_compared_too():
    problem = problem_with()
    record_all(problem.driver, om.SqliteRecorder("./cases.sql"))
    problem.run_driver()
    problem.cleanup()
    sm.restart(problem_with(), "./cases.sql")
    with pytest.raises(ValueError, match=r"upper of 'g' was 2.0 and is 1.9"):
        sm.restart(problem_with(g={"upper": 1.9}), "./cases.sql")
