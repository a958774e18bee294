"""OpenMDAO's standard problems against known optima and against SciPy's SLSQP."""

from __future__ import annotations

import numpy as np
import openmdao.api as om
import pytest
from driver_models import BetzComp, PlaneComp, d_rosenbrock, rosenbrock
from openmdao.test_suite.components.paraboloid import Paraboloid
from openmdao.test_suite.components.sellar import SellarDerivatives

from seal_mdao.drivers.optimality import measure_optimality


def _paraboloid(driver):
    prob = om.Problem(driver=driver, reports=None)
    model = prob.model
    model.add_subsystem("comp", Paraboloid(), promotes=["*"])
    model.add_subsystem("con", om.ExecComp("c = x - y"), promotes=["*"])
    model.set_input_defaults("x", 50.0)
    model.set_input_defaults("y", 50.0)
    model.add_design_var("x", lower=-50.0, upper=50.0)
    model.add_design_var("y", lower=-50.0, upper=50.0)
    model.add_objective("f_xy")
    model.add_constraint("c", lower=15.0)
    return prob


def _sellar(driver):
    prob = om.Problem(SellarDerivatives(), driver=driver, reports=None)
    model = prob.model
    model.add_design_var("z", lower=np.array([-10.0, 0.0]), upper=np.array([10.0, 10.0]))
    model.add_design_var("x", lower=0.0, upper=10.0)
    model.add_objective("obj")
    model.add_constraint("con1", upper=0.0)
    model.add_constraint("con2", upper=0.0)
    return prob


def _rosenbrock(driver):
    prob = om.Problem(driver=driver, reports=None)
    model = prob.model
    comp = PlaneComp(f=rosenbrock, df=d_rosenbrock)
    model.add_subsystem("plane", comp, promotes=["*"])
    disc = om.ExecComp("g = x[0]**2 + x[1]**2", x=np.zeros(2), has_diag_partials=False)
    model.add_subsystem("disc", disc, promotes=["*"])
    model.set_input_defaults("x", np.array([-1.2, 1.0]))
    model.add_design_var("x", lower=-1.5, upper=1.5)
    model.add_objective("f")
    model.add_constraint("g", upper=1.0)
    return prob


def _betz(driver):
    prob = om.Problem(driver=driver, reports=None)
    prob.model.add_subsystem("disc", BetzComp(), promotes=["*"])
    prob.model.add_design_var("a", lower=0.0, upper=1.0)
    prob.model.add_design_var("Area", lower=0.0, upper=1.0)
    prob.model.add_objective("power", scaler=-1e-2)
    return prob


CASES = {
    "paraboloid": (_paraboloid, "f_xy", -27.0833333333, ("x", "y"), (7.16666667, -7.83333333)),
    "sellar": (_sellar, "obj", 3.18339395, ("z", "x"), (1.97763888, 0.0, 0.0)),
    "rosenbrock": (_rosenbrock, "f", 0.0456748087, ("x",), (0.78641515, 0.61769831)),
    "betz": (_betz, "Cp", 16 / 27, ("a", "Area"), (1 / 3, 1.0)),
}


def _solve(build, driver, desvars):
    prob = build(driver)
    prob.setup()
    prob.set_solver_print(level=-1)
    driver.options["singular_jac_behavior"] = "ignore"
    driver.options["invalid_desvar_behavior"] = "ignore"
    result = prob.run_driver()
    return prob, result, np.concatenate([prob.get_val(name).ravel() for name in desvars])


@pytest.mark.parametrize("case", CASES)
def test_known_optimum(case, make_driver):
    build, output, optimum, desvars, solution = CASES[case]
    prob, result, found = _solve(build, make_driver(), desvars)
    assert result.success, result.exit_status
    assert prob.get_val(output).item() == pytest.approx(optimum, rel=1e-7)
    assert found == pytest.approx(np.array(solution), abs=2e-5)
    assert result.model_evals < 70
    assert measure_optimality(prob.driver).satisfied(1e-4, 1e-6)
