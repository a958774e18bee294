"""What is special to IpoptDriver: ipyopt, Ipopt's options and return codes."""

from __future__ import annotations

import sys

import numpy as np
import pytest
from driver_models import d_rosenbrock, failing_where, plane_problem, rosenbrock

from seal_mdao.drivers.ipopt_driver import IpoptDriver
from seal_mdao.drivers.ipopt_options import INTEGER_OPTIONS, ipopt_settings
from seal_mdao.drivers.ipopt_status import MESSAGES, SUCCESS_CODES, status_message


def test_missing_ipyopt_names_the_extra(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipyopt", None)
    with pytest.raises(ImportError) as caught:
        IpoptDriver()
    message = str(caught.value)
    assert 'pip install "seal_mdao[ipopt]"' in message
    assert "\n" not in message


def test_module_imports_without_ipyopt(monkeypatch):
    monkeypatch.setitem(sys.modules, "ipyopt", None)
    for name in [n for n in sys.modules if n.startswith("seal_mdao.drivers.ipopt")]:
        monkeypatch.delitem(sys.modules, name)
    import seal_mdao.drivers.ipopt_driver as module

    assert module.IpoptDriver is not IpoptDriver


def test_only_real_success_is_success():
    assert {0, 1} == SUCCESS_CODES
    assert status_message(0) == "Optimal solution found"
    for code in set(MESSAGES) - SUCCESS_CODES:
        assert f"Ipopt code {code}" in status_message(code)
    assert "Unknown return code" in status_message(77)


class TestWithIpopt:
    """Tests that need Ipopt itself."""

    @pytest.fixture(autouse=True)
    def _need_ipopt(self):
        pytest.importorskip("ipyopt")

    def _run(self, start=(-1.2, 1), settings=None, **options):
        driver = IpoptDriver(**options)
        driver.opt_settings.update(settings or {})
        prob = plane_problem(driver, start, rosenbrock, d_rosenbrock)
        return prob, prob.run_driver()

    def test_limited_memory_hessian_by_default(self):
        assert ipopt_settings({})["hessian_approximation"] == "limited-memory"

    def test_settings_win_over_options(self):
        settings = ipopt_settings({"max_iter": 7, "tol": 1e-3}, max_iter=200, tol=1e-6)
        assert settings["max_iter"] == 7
        assert settings["tol"] == 1e-3
        prob, result = self._run(settings={"max_iter": 3})
        assert result.iter_count == 3
        assert prob.driver.ipopt_code == -1
        assert result.exit_status == "Maximum number of iterations exceeded (Ipopt code -1)"

    @pytest.mark.parametrize(
        ("name", "value", "expected"),
        [
            ("max_iter", 5.0, 5),
            ("max_iter", np.int64(5), 5),
            ("tol", 1, 1.0),
            ("tol", np.float32(0.5), 0.5),
            ("check_derivatives_for_naninf", True, "yes"),
            ("mu_strategy", "adaptive", "adaptive"),
        ],
    )
    def test_values_are_converted(self, name, value, expected):
        found = ipopt_settings({name: value})[name]
        assert found == expected
        assert type(found) is type(expected)

    def test_unknown_option(self):
        with pytest.raises(ValueError, match=r"no option 'max_itr'; did you mean .*'max_iter'"):
            self._run(settings={"max_itr": 3})

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            ("tol", -1.0),
            ("mu_strategy", "fast"),
            ("max_iter", 2.5),
            ("tol", "small"),
            ("tol", None),
        ],
    )
    def test_refused_value(self, name, value):
        with pytest.raises(ValueError, match=rf"opt_settings\['{name}'\]"):
            self._run(settings={name: value})

    def test_options_are_checked_before_the_model_runs(self):
        driver = IpoptDriver()
        driver.opt_settings["nonsense"] = 1
        prob = plane_problem(driver, (-1.2, 1))
        with pytest.raises(ValueError, match="nonsense"):
            prob.run_driver()
        assert prob.model.plane.calls == 0

    def test_integer_options_are_what_ipopt_takes(self):
        import ipyopt

        names = {option["name"] for option in ipyopt.get_ipopt_options()}
        assert names >= INTEGER_OPTIONS
        settings = {"limited_memory_max_history": 8, "max_soc": 0, "acceptable_iter": 5}
        _, result = self._run(settings=settings)
        assert result.success

    def test_ipopts_own_output(self, capfd):
        self._run(settings={"print_level": 5})
        assert "Number of Iterations" in capfd.readouterr().out

    def test_solver_that_is_not_there(self):
        _, result = self._run(settings={"linear_solver": "ma57"})
        assert not result.success
        assert "Invalid option" in result.exit_status

    def test_acceptable_level_is_success(self):
        settings = {"acceptable_tol": 1e-2, "acceptable_iter": 1, "tol": 1e-12}
        prob, result = self._run(settings=settings)
        assert prob.driver.ipopt_code == 1
        assert result.success
        assert result.exit_status == "Solved to acceptable level"

    def test_unbounded_problem(self):
        driver = IpoptDriver()
        prob = plane_problem(
            driver, (1, 1), f=lambda x: -(x[0] ** 3), df=lambda x: [-3 * x[0] ** 2, 0]
        )
        prob.model.set_design_var_options("x", lower=-1e30, upper=1e30)
        prob.setup()
        prob.set_val("x", np.ones(2))
        result = prob.run_driver()
        assert not result.success
        assert driver.ipopt_code != 0

    def test_too_many_equalities(self):
        import openmdao.api as om

        driver = IpoptDriver()
        prob = om.Problem(driver=driver, reports=None)
        prob.model.add_subsystem("c", om.ExecComp(["f = x**2"]), promotes=["*"])
        prob.model.add_subsystem("d", om.ExecComp("g = 2 * x"), promotes=["*"])
        prob.model.add_subsystem("e", om.ExecComp("h = x**3"), promotes=["*"])
        prob.model.add_design_var("x", lower=-5.0, upper=5.0)
        prob.model.add_objective("f")
        prob.model.add_constraint("g", equals=1.0)
        prob.model.add_constraint("h", equals=1.0)
        prob.setup()
        result = prob.run_driver()
        assert not result.success
        assert "Too few degrees of freedom" in result.exit_status

    def test_feasible_set_without_interior(self):
        """Two inequalities that leave only a line, which the tight bounds must not forbid."""
        import openmdao.api as om

        prob = om.Problem(driver=IpoptDriver(), reports=None)
        prob.model.add_subsystem("c", om.ExecComp("f = x**2 + y**2"), promotes=["*"])
        prob.model.add_subsystem("d", om.ExecComp("g = x + y"), promotes=["*"])
        prob.model.add_subsystem("e", om.ExecComp("h = x + y"), promotes=["*"])
        for name in ("x", "y"):
            prob.model.add_design_var(name, lower=-5.0, upper=5.0)
        prob.model.add_objective("f")
        prob.model.add_constraint("g", lower=1.0)
        prob.model.add_constraint("h", upper=1.0)
        prob.setup()
        result = prob.run_driver()
        assert result.success, result.exit_status
        assert prob.get_val("x") == pytest.approx([0.5], abs=1e-4)

    def test_failure_at_the_point_ipopt_starts_from(self):
        """Ipopt moves a start that lies on a bound into the interior."""
        driver = IpoptDriver()
        hook = failing_where(lambda x: -9.999 < x[0] < -9)
        prob = plane_problem(driver, (-10, 1), hook=hook)
        result = prob.run_driver()
        assert not result.success
        assert "not a number" in result.exit_status
        assert "the analysis does not converge here" in result.exit_status
        assert prob.get_val("x").tolist() == [-10.0, 1.0]


@pytest.mark.parametrize("tol", [2e-2, 1e-4])
def test_stalled_run_is_a_success_only_at_an_optimum(tol):
    """Around the optimum everything fails; Ipopt itself is asked for more than can be had."""
    driver = IpoptDriver(tol=tol)
    driver.opt_settings["dual_inf_tol"] = 1e-12
    hook = failing_where(lambda x: np.hypot(x[0], x[1] - 1) < 1e-3)
    result = plane_problem(driver, (5, 5), hook=hook).run_driver()
    assert driver.failed_analyses > 0
    assert result.success == (tol > 1e-2)
    assert ("optimality conditions hold" in result.exit_status) == (tol > 1e-2)
