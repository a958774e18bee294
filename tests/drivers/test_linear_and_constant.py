"""Linear constraints, constraints that are constants, colouring."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import TARGET, projection_problem, run_projection
from openmdao.utils.om_warnings import DriverWarning

import seal_mdao as sm
from seal_mdao.drivers.optimality import measure_optimality


def _with_linear_constraint(driver):
    prob = projection_problem(driver)
    comp = om.ExecComp("total = x[0] + x[1] + x[2]", x={"shape": 4, "units": "m"})
    prob.model.add_subsystem("adding", comp, promotes=["*"])
    prob.model.add_constraint("total", equals=0.5, linear=True)
    prob.model.add_constraint("s", indices=[0], upper=4.0)
    return prob


def test_linear_constraint(make_driver):
    x = run_projection(_with_linear_constraint(make_driver()))
    assert x[:3].sum() == pytest.approx(0.5, abs=1e-8)
    shift = (0.5 - 2.0 - TARGET[1:3].sum()) / 2
    expected = [2.0, TARGET[1] + shift, TARGET[2] + shift, TARGET[3]]
    assert x == pytest.approx(expected, abs=1e-5)


@pytest.mark.parametrize("kind", [sm.UnoDriver, sm.IpoptDriver, sm.SlsqpDriver])
@pytest.mark.parametrize("approximated", [False, True], ids=["exact", "approximated"])
def test_linear_constraint_in_other_units(kind, approximated):
    """OpenMDAO 3.45 gives derivatives of linear constraints in the units of the model, and sets up
    approximated totals for the last list of responses only."""
    design = {"lower": -5000.0, "upper": 5000.0, "units": "mm", "ref": 1000.0}
    prob = projection_problem(kind(tol=1e-8, disp=False), **design)
    comp = om.ExecComp("total = x[0] + x[1]", x={"shape": 4, "units": "m"}, total={"units": "m"})
    prob.model.add_subsystem("adding", comp, promotes=["*"])
    prob.model.add_constraint("total", upper=-6e-4, units="km", ref=1e-3, linear=True)
    prob.model.add_constraint("s", indices=[0], upper=4.0)
    if approximated:
        prob.model.approx_totals()
    # (3, -2) has the sum 1, which is to be -0.6; x_0 <= 2
    x = run_projection(prob, (0.5, 0.5, 0.5, 0.5))
    assert x == pytest.approx([2.0, -2.6, 1.0, 0.5], abs=1e-4)
    assert x[:2].sum() == pytest.approx(-0.6, abs=1e-8)


def test_optimality_with_a_linear_constraint_in_other_units():
    prob = projection_problem(om.ScipyOptimizeDriver(tol=1e-10, disp=False), units="cm")
    comp = om.ExecComp("total = x[0] + x[1]", x={"shape": 4, "units": "m"})
    prob.model.add_subsystem("adding", comp, promotes=["*"])
    prob.model.add_constraint("total", equals=-0.6, linear=True)
    prob.setup()
    prob.set_val("x", [2.2, -2.8, 1.0, 0.5])
    prob.run_model()
    found = measure_optimality(prob.driver)
    assert found.satisfied(1e-8, 1e-8)
    # df/dx_0 = df/dx_1 = 2 (2.2 - 3)
    assert found.multipliers == pytest.approx(1.6, rel=1e-8)


def test_linear_derivatives_are_computed_once(make_driver):
    prob = _with_linear_constraint(make_driver())
    calls = []
    compute = prob.driver._compute_totals

    def counting(of=None, **kwargs):
        calls.append(tuple(of))
        return compute(of=of, **kwargs)

    prob.driver._compute_totals = counting
    run_projection(prob)
    assert calls.count(("total",)) == 1
    assert set(calls) == {("total",), ("f", "s")}


def _colored_problem(driver):
    """Return a problem whose only nonlinear constraint has a diagonal Jacobian."""
    prob = om.Problem(driver=driver, reports=None)
    model = prob.model
    squares = om.ExecComp("s = x**2", x={"shape": 8}, s={"shape": 8}, has_diag_partials=True)
    model.add_subsystem("squares", squares, promotes=["*"])
    chain = om.ExecComp("f = sum((x - 2.0)**2)", x={"shape": 8})
    model.add_subsystem("chain", chain, promotes=["*"])
    model.add_design_var("x", lower=0.1, upper=5.0)
    model.add_objective("f")
    model.add_constraint("s", upper=np.linspace(1.0, 9.0, 8))
    prob.setup()
    prob.set_val("x", np.linspace(0.3, 0.9, 8))
    driver.options["singular_jac_behavior"] = "ignore"
    return prob


def test_coloring(make_driver):
    solution = np.minimum(2.0, np.sqrt(np.linspace(1.0, 9.0, 8)))
    driver = make_driver()
    driver.declare_coloring(show_summary=False, show_sparsity=False)
    prob = _colored_problem(driver)
    assert prob.run_driver().success
    assert prob.get_val("x") == pytest.approx(solution, abs=2e-5)
    assert driver._coloring_info.coloring.total_solves() < 8


# OpenMDAO's own sentence on rows of zeros
openmdao_may_warn_too = pytest.mark.filterwarnings(
    "ignore::openmdao.utils.om_warnings.DerivativesWarning"
)


def _with_constant_constraint(driver, value):
    prob = projection_problem(driver)
    prob.model.add_subsystem("other", om.ExecComp("g = 2 * y", y=value), promotes=["*"])
    prob.model.add_constraint("g", upper=4.0)
    prob.model.add_constraint("s", indices=[0], upper=4.0)
    prob.setup()
    return prob


@openmdao_may_warn_too
def test_constant_constraint_is_reported_and_left_out(make_driver):
    prob = _with_constant_constraint(make_driver(), 1.0)
    with pytest.warns(DriverWarning, match=r"constraint\(s\) \['g'\] do not depend on any"):
        result = prob.run_driver()
    assert result.success
    assert prob.get_val("x")[0] == pytest.approx(2.0, abs=1e-5)


@openmdao_may_warn_too
def test_violated_constant_constraint_is_no_success(make_driver):
    prob = _with_constant_constraint(make_driver(), 3.0)
    with pytest.warns(DriverWarning, match="do not depend on any"):
        result = prob.run_driver()
    assert not result.success
    assert "['g']" in result.exit_status
    assert "do not depend on any design variable" in result.exit_status


def test_constant_constraint_as_an_error(make_driver):
    prob = _with_constant_constraint(make_driver(singular_jac_behavior="error"), 1.0)
    with pytest.raises(RuntimeError, match="do not depend on any design variables"):
        prob.run_driver()


def test_model_level_finite_differences(make_driver):
    prob = projection_problem(make_driver(tol=1e-8))
    prob.model.approx_totals(form="central", step=1e-5)
    prob.model.add_constraint("s", indices=[0], upper=4.0)
    assert run_projection(prob) == pytest.approx([2.0, -2.0, 1.0, 0.5], abs=1e-4)
