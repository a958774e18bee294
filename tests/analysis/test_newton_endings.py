"""How iterations of Newton's method end: converged, at rounding, or in a cycle."""

from types import SimpleNamespace

import numpy as np
import pytest

from seal_mdao.analysis.newton import (
    LONGEST_CYCLE,
    SAME_PLACE,
    NewtonOptions,
    _cycle,
    _iterate,
    _stagnates,
    converged,
)
from seal_mdao.analysis.path_result import Status

OPTIONS = NewtonOptions(tolerance=1e-8)


def state(size=1.0, rounding=False, noise=False, unconverged=False):
    return SimpleNamespace(size=size, rounding=rounding, noise=noise, unconverged=unconverged)


def test_small_residuals_and_rounding_are_convergence():
    assert converged(state(1e-8), OPTIONS)
    assert not converged(state(1.1e-8), OPTIONS)
    assert converged(state(1.0, rounding=True), OPTIONS)
    # a residual of a linearisation says nothing of the law itself
    assert not converged(state(1e-8, unconverged=True), OPTIONS)
    assert not converged(state(1.0, rounding=True, unconverged=True), OPTIONS)


def test_residuals_stagnate_at_rounding_where_they_are_not_halved():
    assert _stagnates(state(noise=True), [1.0, 0.5])
    assert not _stagnates(state(noise=True), [1.0, 0.49])
    assert not _stagnates(state(noise=True), [1.0])
    assert not _stagnates(state(noise=False), [1.0, 0.5])
    assert not _stagnates(state(noise=True, unconverged=True), [1.0, 0.5])


@pytest.mark.parametrize("period", range(2, LONGEST_CYCLE + 2))
def test_cycles_are_found_when_they_begin_again(rng, period):
    places = [*rng.standard_normal((period, 4, 2))]
    assert _cycle(places) == 0
    step = np.abs(places[0] - places[-1]).max()
    for miss, found in ((0.9, period if period <= LONGEST_CYCLE else 0), (1.1, 0)):
        again = places[0] + miss * SAME_PLACE * step / (1.0 - SAME_PLACE)
        assert _cycle([*places, again]) == found
    assert _cycle(places[:1]) == 0


class Turning:
    """Iterations that turn by a third about a centre, with their number as state of the terms."""

    options, centre = OPTIONS, np.array([[3.0, 1.0]])

    def evaluate(self, d, iteration=None, tangent=True):
        c, s = np.cos(2.0 * np.pi / 3.0), np.sin(2.0 * np.pi / 3.0)
        turned = self.centre + (d - self.centre) @ np.array([[c, s], [-s, c]])
        factor = SimpleNamespace(solve=lambda residual: residual)
        number = 0 if iteration is None else iteration + 1
        return SimpleNamespace(
            **vars(state()), d=d, residual=d - turned, iteration=number, factorize=lambda: factor
        )

    def gather(self, solution):
        return solution


def test_a_cycle_ends_at_its_mean():
    """Of its three places, with the states of one turn."""
    found = _iterate(Turning(), np.array([[4.0, 1.0]]), None, mixed=False)
    assert found.status is Status.CYCLED
    np.testing.assert_allclose(found.d, Turning.centre, atol=1e-14)
    assert found.cycle == (1, 2, 3)
