"""Uno and IPOPT on the Hock-Schittkowski problems."""

from __future__ import annotations

import numpy as np
import pytest
from hock_schittkowski import PROBLEMS, TOL, build, make_driver, solve
from openmdao.utils.assert_utils import assert_check_partials


@pytest.mark.parametrize("number", PROBLEMS)
def test_partials(number):
    prob = build(number, make_driver("SLSQP"))
    prob.set_val("x", np.array(PROBLEMS[number].start) + 0.123)
    prob.run_model()
    data = prob.check_partials(out_stream=None, method="fd", form="central", step=1e-6)
    assert_check_partials(data, atol=1e-4, rtol=1e-5)


@pytest.mark.parametrize("name", ["Uno", "IPOPT"])
@pytest.mark.parametrize("number", PROBLEMS)
def test_optimum(number, name):
    solution = solve(number, name)
    assert solution.success, solution.status
    assert solution.status == "Optimal solution found"
    assert solution.error <= solution.bound
    assert solution.violation <= TOL * (1.0 + _largest_bound(number))
    assert solution.model_evals <= 60


def _largest_bound(number):
    problem = PROBLEMS[number]
    bounds = np.array([*problem.c_lower, *problem.c_upper, 0.0])
    return np.abs(bounds[np.isfinite(bounds)]).max()
