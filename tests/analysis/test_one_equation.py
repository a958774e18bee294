"""Damped motion and descent of a single equation r(d) = 0, whose iterates are known."""

from types import SimpleNamespace

import numpy as np
import pytest

from seal_mdao.analysis import descent
from seal_mdao.analysis.descent import _definite, _step_length, descend
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.path_result import Status
from seal_mdao.analysis.pseudo_time import FIRST_DAMPING, STRONGER, relax


class Equation:
    """An increment with one displacement: residual and tangent are functions of it."""

    note = None

    def __init__(self, force, tangent, extent=100.0, symmetric=True, least=-np.inf):
        self._force, self._tangent, self._least = force, tangent, least
        particles = np.array([[0.0, 0.0], [extent, 0.0]])
        self.problem = SimpleNamespace(
            symmetric=symmetric, discretization=SimpleNamespace(particles=particles)
        )
        self.options = NewtonOptions(tolerance=1e-10, damped_iterations=200)

    def evaluate(self, d, iteration=None, tangent=True):
        if d[0, 0] < self._least:
            return None
        r, k = self._force(d[0, 0]), self._tangent(d[0, 0])

        def factorize(check=False, shift=0.0):
            return SimpleNamespace(positive=k + shift > 0.0, solve=lambda rhs: rhs / (k + shift))

        return SimpleNamespace(
            d=d, residual=np.array([r]), size=abs(r), mean_stiffness=1.0, iteration=None,
            rounding=False, unconverged=False, factorize=factorize, problem=self.problem,
        )  # fmt: skip

    def gather(self, solution):
        return np.array([[solution[0], 0.0]])


def at(d):
    return np.array([[d, 0.0]])


def well(d):
    """Slope of (d^2 - 1)^2 / 4, which has a maximum at 0 and minima at -1 and 1."""
    return d**3 - d


def curvature(d):
    return 3.0 * d**2 - 1.0


@pytest.fixture(autouse=True)
def _single_eigenvalue(monkeypatch):
    """The eigenvalue of one equation is the inverse of its solution for 1."""
    monkeypatch.setattr(
        descent, "nearest_mode", lambda factor, *others, **given: (1.0 / factor.solve(1.0),)
    )


@pytest.mark.parametrize("begin", [0.1, -0.1])
def test_descent_ends_at_the_nearer_minimum(begin):
    found = descend(Equation(well, curvature), at(begin))
    assert found.status is Status.CONVERGED
    assert found.d[0, 0] == pytest.approx(np.sign(begin), abs=1e-10)
    assert found.factor.positive


def test_descent_never_ends_at_a_maximum():
    """The residual is zero there, but the state is unstable."""
    found = descend(Equation(well, curvature), at(0.0))
    assert found.status is Status.NOT_CONVERGED


@pytest.mark.parametrize("symmetric", [True, False])
def test_a_tangent_that_is_not_a_number_ends_the_descent(symmetric):
    equation = Equation(lambda d: 1.0, lambda d: np.nan, symmetric=symmetric)
    assert descend(equation, at(0.0)).status is Status.SINGULAR


def test_shift_of_an_unsymmetric_tangent_opposes_the_residual():
    """Its determinant is positive for all shifts, as that of an even number of negative pivots."""
    now = Equation(lambda d: 1.0, lambda d: -10.0, symmetric=False).evaluate(at(0.0))
    factorize = now.factorize
    now.factorize = lambda **given: SimpleNamespace(positive=True, solve=factorize(**given).solve)
    assert _definite(now, 1.0, 1e-9)[1] == 16.0


def test_steps_are_halved_until_the_force_hardly_opposes_them():
    """r = 4 d at d = 1 with a step of -4: of r(1 - 4 t) the slope is 16 (1 - 4 t), at most half of
    that at t = 0 in the other direction for t = 1/4."""
    equation = Equation(lambda d: 4.0 * d, lambda d: 4.0, least=-2.0)
    now, step = equation.evaluate(at(1.0)), np.array([-4.0])
    assert _step_length(equation, now, step, full=False) == 0.25
    # the first one that is admissible, d >= -2
    assert _step_length(equation, now, step, full=True) == 0.5
    # upwards
    assert _step_length(equation, now, -step, full=False) == 0.0


def test_damping_grows_at_rejected_steps_and_follows_the_residual():
    """r = d with a tangent of 0.01: steps with residuals above three times the last are rejected."""
    equation = Equation(lambda d: d, lambda d: 0.01)
    found = relax(equation, at(1.0))
    alpha = FIRST_DAMPING * STRONGER**6
    first = 1.0 - 1.0 / (0.01 + alpha)
    second = first * (1.0 - 1.0 / (0.01 + alpha * abs(first)))
    np.testing.assert_allclose(found.residuals[:3], np.abs([1.0, first, second]), rtol=1e-12)
    # one rejection less would have been too few
    assert abs(1.0 - 1.0 / (0.01 + alpha / STRONGER)) > 3.0 >= abs(first)


def test_damped_motion_is_newtons_method_in_the_end():
    found = relax(Equation(well, curvature), at(0.8))
    assert found.converged
    assert found.d[0, 0] == pytest.approx(1.0, abs=1e-10)
    assert len(found.residuals) < 10


@pytest.mark.parametrize("iterate", [relax, descend])
def test_a_body_that_nothing_stops_moves_off(iterate):
    """At a displacement of 1.5 times its size."""
    equation = Equation(lambda d: -1.0, lambda d: 0.1)
    found = iterate(equation, at(0.0))
    assert found.status is Status.MOVED_OFF
    assert found.d[0, 0] > 150.0 >= found.d[0, 0] - 10.0


@pytest.mark.parametrize("iterate", [relax, descend])
def test_residuals_that_are_not_numbers_end_at_once(iterate):
    equation = Equation(lambda d: np.nan, lambda d: 1.0)
    found = iterate(equation, at(0.0))
    assert found.status is Status.DIVERGED
    assert len(found.residuals) == 1
