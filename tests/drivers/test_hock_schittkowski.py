"""Both drivers and SciPy's SLSQP on the Hock-Schittkowski problems."""

from __future__ import annotations

import numpy as np
import pytest
from hock_schittkowski import PROBLEMS, build, make_driver, solve
from openmdao.utils.assert_utils import assert_check_partials


def test_table_is_large_enough():
    assert len(PROBLEMS) >= 30


@pytest.mark.parametrize("number", PROBLEMS)
def test_partials(number):
    prob = build(number, make_driver("SciPy"))
    prob.set_val("x", np.array(PROBLEMS[number].start) + 0.123)
    prob.run_model()
    data = prob.check_partials(out_stream=None, method="fd", form="central", step=1e-6)
    assert_check_partials(data, atol=1e-4, rtol=1e-5)


@pytest.mark.parametrize("number", PROBLEMS)
def test_ipopt(number):
    pytest.importorskip("ipyopt")
    solution = solve(number, "Ipopt")
    assert solution.success, solution.status
    assert solution.status == "Optimal solution found"
    assert solution.error < 1e-7
    assert solution.violation < 1e-7 * (1.0 + _largest_bound(number))
    assert solution.model_evals <= 60


@pytest.mark.parametrize("number", PROBLEMS)
def test_resilient_slsqp(number):
    solution = solve(number, "Resilient")
    assert solution.success, solution.status
    assert solution.status.startswith("Optimization terminated successfully")
    assert solution.error < 2e-9
    assert solution.violation < 1e-7


@pytest.mark.parametrize("number", PROBLEMS)
def test_resilient_slsqp_takes_the_steps_of_scipy(number):
    ours, scipys = solve(number, "Resilient"), solve(number, "SciPy")
    if not scipys.success:
        assert number in (37, 100), "SciPy's line search is stuck at the optimum of these two"
        return
    assert ours.error == pytest.approx(scipys.error, abs=1e-12)
    assert ours.deriv_evals == scipys.deriv_evals
    assert ours.model_evals <= scipys.model_evals


def _largest_bound(number):
    problem = PROBLEMS[number]
    bounds = np.array([*problem.c_lower, *problem.c_upper, 0.0])
    return np.abs(bounds[np.isfinite(bounds)]).max()
