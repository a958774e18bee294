"""Calibrate parameters of a seal to its measured force: constants of rubber, friction, relaxation times.

With the computed forces F_i(p) at the readings, the measured ones M_i and the largest of these M,

    min over q of sum_i r_i^2,    r_i = (F_i(p) - M_i) / M,    p_k = p_0k q_k

with q_k from 1 / FACTOR to FACTOR, by Gauss-Newton steps in a trust region
(scipy.optimize.least_squares) with the exact J_ik = dr_i/dq_k = p_0k / M dF_i/dp_k. Parameters keep
their signs. A trial that the seal refuses, or whose path is not completed, is followed by a shorter
step. The standard errors are those of ``calibration.standard_errors``.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from seal_mdao.calibration.standard_errors import standard_errors
from seal_mdao.dsa.parameters import parameter_rates
from seal_mdao.dsa.sensitivity import Wanted, direct_rates
from seal_mdao.measures.reaction import Reaction
from seal_mdao.seals.result import SealResult, analyze
from seal_mdao.seals.seal import Seal

FACTOR = 10.0
"""Largest ratio of a parameter to its first value, and of that to it."""
SMALL_GAIN, SMALL_STEP = 1e-5, 1e-9
"""Relative change of the sum of squares, or of the parameters, at which the iteration ends."""
MOST_ANALYSES = 60


@dataclass(frozen=True, eq=False)
class ForceCalibration:
    """Parameters of a seal calibrated to n readings of its force.

    Attributes
    ----------
    names : tuple of str
        Of k parameters, as in ``Seal.scalars``.
    start, values : ndarray, shape (k,)
        Before and after.
    standard_errors : ndarray, shape (k,)
        Infinite where the readings leave a combination of the parameters undetermined.
    correlation : ndarray, shape (k, k)
    measured, before, after : ndarray, shape (n,)
        Forces: read, computed with ``start`` and with ``values``, in the unit of the measure.
    analyses : int
    converged : bool
        Whether the iteration ended by ``SMALL_GAIN`` or ``SMALL_STEP``, within ``MOST_ANALYSES``.
    """

    names: tuple
    start: np.ndarray
    values: np.ndarray
    standard_errors: np.ndarray
    correlation: np.ndarray
    measured: np.ndarray
    before: np.ndarray
    after: np.ndarray
    analyses: int
    converged: bool

    @property
    def rms(self) -> float:
        """Root mean square of the differences, over the largest measured force."""
        return float(np.sqrt(np.mean((self.after - self.measured) ** 2)) / self.largest)

    @property
    def largest(self) -> float:
        """Largest measured force, without sign."""
        return float(np.abs(self.measured).max())

    @property
    def at_bounds(self) -> tuple:
        """Names of parameters that ended ``FACTOR`` times above or below their first values."""
        far = np.abs(np.log(self.values / self.start)) > np.log(FACTOR) - SMALL_GAIN
        return tuple(name for name, own in zip(self.names, far, strict=True) if own)


def calibrate_force(
    seal: Seal, force: Reaction, measured, names, callback: Callable | None = None
) -> ForceCalibration:
    """Find the parameters of a seal with which a force on it is the measured one.

    Parameters
    ----------
    seal : Seal
        Its parameters are the first values.
    force : Reaction
        With one value at each of n travels, times or ends of stages.
    measured : array_like, shape (n,)
        In the unit of ``force``.
    names : sequence of str
        k parameters of ``seal.scalars``, none of them zero.
    callback : callable, optional
        Called after every analysis with their number and the root mean square of r.

    Raises
    ------
    ValueError
        For readings that are not n finite numbers, or all zero; fewer than k + 1 of them; names that are
        no parameters, twice there, or zero at the start.
    LoadPathError
        When the path with the first values is not completed.
    """
    names = tuple(names)
    measured = np.asarray(measured, float)
    _check(seal, force, measured, names)
    problem = _LeastSquares(seal, force, measured, names, callback)
    one = np.ones(len(names))
    first = problem.at(one)
    first.result.require_converged()
    # min over q of |r|^2, r = (F - M_i) / M, with p = q p_0 and q from 1/FACTOR to FACTOR
    found = least_squares(
        problem.residual, one, problem.jacobian, (one / FACTOR, one * FACTOR), method="trf",
        ftol=SMALL_GAIN, xtol=SMALL_STEP, gtol=None, max_nfev=MOST_ANALYSES,
    )  # fmt: skip
    # standard errors of q; those of p are |p_0| times as large
    errors, correlation = standard_errors(found.fun, found.jac)
    start = problem.start
    return ForceCalibration(
        names, start, start * found.x, np.abs(start) * errors, correlation, measured, first.force,
        measured + problem.largest * found.fun, problem.analyses, found.status > 0,
    )  # fmt: skip


def _check(seal, force, measured, names) -> None:
    """Refuse readings and names with which there is nothing to find."""
    n, scalars = force.size(seal), seal.scalars
    if measured.shape != (n,) or not np.isfinite(measured).all() or not measured.any():
        raise ValueError(
            f"the measured forces must be {n} finite numbers, one per reading, and not all zero"
        )
    unknown = [name for name in names if name not in scalars]
    if unknown:
        raise ValueError(
            f"the seal has no parameter {unknown[0]!r}; its parameters are {', '.join(scalars)}"
        )
    if len(set(names)) < len(names) or not names:
        raise ValueError(
            "the parameters to identify must be at least one name, and none twice; got "
            f"{', '.join(names) or 'none'}"
        )
    zero = [name for name in names if scalars[name].value == 0.0]
    if zero:
        raise ValueError(
            f"the parameter {zero[0]} starts at zero, but parameters are identified as a ratio to "
            "their start value; give it a start value other than 0"
        )
    if n <= len(names):
        raise ValueError(
            f"{n} readings are too few for {len(names)} parameters and their standard errors; give "
            f"at least {len(names) + 1} readings or identify fewer parameters"
        )


@dataclass(frozen=True, eq=False)
class _Point:
    """An analysis at q (k,): forces (n,), nan where the path is not completed."""

    q: np.ndarray
    result: SealResult | None
    force: np.ndarray


class _LeastSquares:
    """Residuals r and their derivatives J, of which the last analysis is shared by both."""

    def __init__(self, seal, force, measured, names, callback):
        self.seal, self.measured, self.names, self.callback = seal, measured, names, callback
        # values by name need one measure of that name
        self.force = replace(force, name="calibrated_force")
        self.start = np.array([seal.scalars[name].value for name in names])
        self.largest, self.analyses, self.last = np.abs(measured).max(), 0, None

    def at(self, q: np.ndarray) -> _Point:
        """Analyse the seal at q, unless that was the last analysis."""
        if self.last is None or not np.array_equal(self.last.q, q):
            self.last = self._analyzed(q.copy())
            self.analyses += 1
            if self.callback is not None:
                r = (self.last.force - self.measured) / self.largest
                self.callback(self.analyses, float(np.sqrt(np.mean(r**2))))
        return self.last

    def _analyzed(self, q) -> _Point:
        nothing = np.full(self.measured.shape, np.nan)
        changed = dict(zip(self.names, (self.start * q).tolist(), strict=True))
        try:
            # the first values are those of the seal itself
            changed = changed if (q != 1.0).any() else {}
            result = analyze(self.seal, parameters=changed, keep_factors=True)
        except ValueError:
            # such as relaxation of more than the modulus: scipy takes a shorter step after nan
            if not changed:
                raise
            return _Point(q, None, nothing)
        return _Point(q, result, result.value(self.force) if result.converged else nothing)

    def residual(self, q: np.ndarray) -> np.ndarray:
        """r = (F - M_i) / M."""
        return (self.at(q).force - self.measured) / self.largest

    def jacobian(self, q: np.ndarray) -> np.ndarray:
        """J = p_0k / M dF_i/dp_k by the direct method, shape (n, k)."""
        result = self.at(q).result
        # no particle moves: p alone
        still = np.zeros((0, *result.particles.shape))
        wanted = Wanted(result, (self.force,))
        rates = direct_rates(result, wanted, parameter_rates(still, self.names))
        return wanted.by_name(rates)[self.force.name] * self.start / self.largest
