"""AnalysisError on the way: the drivers back off, and say so when there is no way forward."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import (
    constrained_problem,
    d_rosenbrock,
    failing_where,
    plane_problem,
    quadratic,
    rosenbrock,
)

import seal_mdao as sm
from seal_mdao.drivers.optimality import measure_optimality


def quartic(x):
    """Return a function with its minimum 0 at (0.5, 1), whose first steps go much too far."""
    return 1000 * (x[0] - 0.5) ** 4 + (x[1] - 1) ** 2


def d_quartic(x):
    """Return the gradient of the quartic."""
    return [4000 * (x[0] - 0.5) ** 3, 2 * (x[1] - 1)]


def _outside_valley(x):
    """Return whether x lies outside a band along the valley of Rosenbrock's function."""
    return not -0.3 <= x[1] - x[0] ** 2 <= 1.5


REGIONS = {
    "beyond the optimum": (quartic, d_quartic, lambda x: x[0] < 0.3, (5, 5), (0.5, 1)),
    "slab": (None, None, lambda x: 1 < x[0] < 3, (5, 5), (0, 1)),
    "thin slab": (None, None, lambda x: 1.5 < x[0] < 2, (5, 5), (0, 1)),
    "disc": (None, None, lambda x: np.hypot(x[0] - 2.5, x[1] - 2) < 0.7, (5, 3), (0, 1)),
    "off the valley": (rosenbrock, d_rosenbrock, _outside_valley, (-1.2, 1.44), (1, 1)),
}


FAILING = ("beyond the optimum",)
"""Regions that no driver gets round without a failed analysis."""


def region_problem(driver, region, **hooks):
    """Return the problem of a region and its solution."""
    f, df, _, start, solution = REGIONS[region]
    functions = {} if f is None else {"f": f, "df": df}
    return plane_problem(driver, start, **functions, **hooks), solution


@pytest.mark.parametrize("region", REGIONS)
def test_values_fail_in_a_region(make_driver, region):
    condition = REGIONS[region][2]
    prob, solution = region_problem(make_driver(), region, hook=failing_where(condition))
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.get_val("f") == pytest.approx([0.0], abs=1e-6)
    assert prob.get_val("x") == pytest.approx(np.array(solution, dtype=float), abs=0.03)
    assert result.model_evals < 80
    assert prob.driver.failed_analyses > 0 or region not in FAILING


@pytest.mark.parametrize("region", REGIONS)
def test_derivatives_fail_in_a_region(make_driver, region):
    condition = REGIONS[region][2]
    hook = failing_where(condition)
    prob, solution = region_problem(make_driver(), region, partials_hook=hook)
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.get_val("x") == pytest.approx(np.array(solution, dtype=float), abs=0.03)
    assert result.model_evals < 90
    assert prob.driver.failed_analyses > 0 or region not in FAILING


def test_failures_with_constraints(make_driver):
    hook = failing_where(lambda x: x[0] < 0.9)
    prob = constrained_problem(make_driver(), (5, 5), "x[0] * x[1]", 2.0, hook=hook)
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.get_val("g") == pytest.approx([2.0], abs=1e-6)
    assert measure_optimality(prob.driver).satisfied(1e-4, 1e-6)


def test_nan_without_an_exception_counts_as_failure(make_driver):
    def f(x):
        return np.nan if x[0] < 0.3 else quartic(x)

    prob = plane_problem(make_driver(), (5, 5), f=f, df=d_quartic)
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.driver.failed_analyses > 0
    assert prob.get_val("f") == pytest.approx([0.0], abs=1e-6)


def test_optimum_inside_the_failing_region(make_driver):
    driver = make_driver()
    prob = plane_problem(driver, (5, 5), hook=failing_where(lambda x: x[0] < 0.3))
    result = prob.run_driver()
    assert not result.success
    assert "every step from the best design found leads to a failed analysis" in result.exit_status
    assert "the analysis does not converge here" in result.exit_status
    assert result.model_evals < 100
    assert prob.get_val("x")[0] == pytest.approx(0.3, abs=1e-3)
    assert prob.get_val("f") == pytest.approx([quadratic(prob.get_val("x"))])


def test_everything_fails_but_the_start(make_driver):
    tried = []

    def hook(x, call):
        tried.append(x.tobytes())
        if not np.array_equal(x, [5.0, 5.0]):
            raise om.AnalysisError("only the start can be analysed")

    driver = make_driver()
    prob = plane_problem(driver, (5, 5), hook=hook)
    result = prob.run_driver()
    assert not result.success
    assert "only the start can be analysed" in result.exit_status
    assert prob.get_val("x").tolist() == [5.0, 5.0]
    assert result.model_evals <= 2 * driver.options["max_failures"] + 4
    assert len(tried[1:-1]) == len(set(tried[1:-1]))


def test_best_point_is_kept_when_derivatives_leave_no_way_forward(make_driver):
    driver = make_driver()
    hook = failing_where(lambda x: x[0] < 0.3)
    prob = plane_problem(driver, (5, 5), partials_hook=hook)
    result = prob.run_driver()
    assert not result.success
    assert prob.get_val("f")[0] == min(quadratic(x) for x in prob.model.plane.visited)
    assert prob.get_val("x")[0] < 0.3


def test_max_failures(make_driver):
    few, many = (
        _count_runs(make_driver(max_failures=limit), lambda x: x[0] < 4.999999) for limit in (3, 9)
    )
    assert few < many


def _count_runs(driver, condition):
    prob = plane_problem(driver, (5, 5), hook=failing_where(condition))
    return prob.run_driver().model_evals


def test_failure_at_the_start_is_raised_unchanged(make_driver):
    prob = plane_problem(make_driver(), (5, 5), hook=failing_where(lambda x: x[0] > 4))
    with pytest.raises(om.AnalysisError, match="does not converge here") as caught:
        prob.run_driver()
    assert "hook" in [entry.name for entry in caught.traceback]


def test_derivatives_failing_at_the_start_are_raised_unchanged(make_driver):
    hook = failing_where(lambda x: x[0] > 4)
    prob = plane_problem(make_driver(), (5, 5), partials_hook=hook)
    with pytest.raises(om.AnalysisError, match="does not converge here") as caught:
        prob.run_driver()
    assert "hook" in [entry.name for entry in caught.traceback]


def test_nan_at_the_start(make_driver):
    prob = plane_problem(make_driver(), (5, 5), f=lambda x: np.nan)
    with pytest.raises(om.AnalysisError, match=r"not finite: (plane\.)?f$"):
        prob.run_driver()


def test_failed_points_are_not_run_twice(make_driver):
    seen = []

    def hook(x, call):
        if x[0] < 0.3:
            seen.append(x.tobytes())
            raise om.AnalysisError("no")

    prob = constrained_problem(make_driver(), (5, 5), "x[0] * x[1]", -50.0, hook=hook)
    prob.run_driver()
    assert len(seen) == len(set(seen)) > 3


def approximated_problem(driver):
    """Return a problem whose finite differences fail at its optimum (0.5, 1), a bound."""
    prob = plane_problem(driver, (5, 5), hook=failing_where(lambda x: x[0] < 0.5))
    prob.model.set_design_var_options("x", lower=np.array([0.5, -10.0]))
    prob.model.approx_totals(form="backward", step=1e-3)
    prob.setup()
    prob.set_val("x", np.array([5.0, 5.0]))
    return prob


def test_design_is_restored_after_finite_differences_that_fail(make_driver):
    """The last design is not the one at which a difference was to be taken."""
    prob = approximated_problem(make_driver())
    prob.run_driver()
    assert prob.driver.failed_analyses > 0
    x = prob.get_val("x")
    assert x[0] >= 0.5
    assert prob.get_val("f")[0] == quadratic(x)


def test_slsqp_raises_a_failure_in_finite_differences():
    with pytest.raises(om.AnalysisError, match="does not converge here"):
        approximated_problem(sm.SlsqpDriver(disp=False)).run_driver()


@pytest.mark.filterwarnings("ignore:The top level group has a nonlinear solver")
def test_states_are_restored_after_a_failure(make_driver):
    """A diverged implicit state would keep the next Newton solve from converging."""

    class Fragile(om.ImplicitComponent):
        def setup(self):
            self.add_input("x", val=5.0)
            self.add_output("y", val=1.0)
            self.declare_partials("*", "*")

        def solve_nonlinear(self, inputs, outputs):
            if not np.isfinite(outputs["y"]).all():
                raise ValueError("started from a state that is not finite")
            if inputs["x"] < 0.3:
                outputs["y"] = np.nan
                raise om.AnalysisError("diverged")
            outputs["y"] = inputs["x"] ** 2

        def apply_nonlinear(self, inputs, outputs, residuals):
            residuals["y"] = outputs["y"] - inputs["x"] ** 2

        def linearize(self, inputs, outputs, jacobian):
            jacobian["y", "y"] = 1.0
            jacobian["y", "x"] = -2 * inputs["x"]

    prob = om.Problem(driver=make_driver(), reports=None)
    model = prob.model
    model.add_subsystem("fragile", Fragile(), promotes=["*"])
    model.linear_solver = om.DirectSolver()
    model.add_subsystem("goal", om.ExecComp("f = 100 * (y - 0.25)**2"), promotes=["*"])
    model.add_design_var("x", lower=-5.0, upper=5.0)
    model.add_objective("f")
    prob.setup()
    result = prob.run_driver()
    assert result.success, result.exit_status
    assert prob.driver.failed_analyses > 0
    assert prob.get_val("x") == pytest.approx([0.5], abs=1e-3)
