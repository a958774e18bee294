"""Result of the fit of relaxation tests: constants with standard errors, response, differences."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.calibration.relaxation_data import RelaxationTests
from seal_mdao.calibration.relaxation_model import PronyModel
from seal_mdao.calibration.relaxation_shift import Shift

DETERMINED = 1e-10
"""Smallest singular value, relative to the largest, of a direction that the data determine."""


@dataclass(frozen=True, eq=False)
class RelaxationFit:
    """Prony series fitted to relaxation tests.

    Attributes
    ----------
    tests : RelaxationTests
    g, tau : ndarray, shape (n,)
        Relative moduli (of the instantaneous one) and relaxation times at the reference, s, ascending.
    long_term : float
        Long-term over instantaneous modulus, 1 - sum g.
    shift : Shift or None
        For several temperatures.
    reference : float or None
        Temperature of the relaxation times, degrees Celsius; None where the file has none.
    names : tuple of str
        ``g_i``, ``ln_tau_i`` and constants of the shift, those that were fitted.
    covariance : ndarray, shape (k, k)
        Of these constants; infinite variance for a constant that the data do not determine.
    factors : dict of float to tuple
        For every temperature ln a and its standard error, fitted without a shift function.
    rms, rms_free : float
        Root mean square difference over the largest force, with equal weight of every decade, and with
        free factors in place of the shift function.
    trials : list of dict
        Number of terms, rms and information criterion of the fits among which the number was chosen.
    model : PronyModel
    unknowns : ndarray
        Of the model.
    """

    tests: RelaxationTests
    g: np.ndarray
    tau: np.ndarray
    long_term: float
    shift: Shift | None
    reference: float | None
    names: tuple
    covariance: np.ndarray
    factors: dict
    rms: float
    rms_free: float
    trials: list
    model: PronyModel
    unknowns: np.ndarray

    @property
    def standard_errors(self) -> dict[str, float]:
        """Standard errors of all fitted constants; that of ln tau is relative to tau."""
        return dict(zip(self.names, np.sqrt(np.diag(self.covariance)).tolist(), strict=True))

    @property
    def correlation(self) -> np.ndarray:
        """Correlation of the errors, shape (k, k); zero for constants that are not determined."""
        deviation = np.sqrt(np.diag(self.covariance))
        known = np.isfinite(deviation)
        size = np.where(known & (deviation > 0.0), deviation, 1.0)
        matrix = np.where(np.outer(known, known), self.covariance, 0.0)
        # rho_ij = C_ij / (sigma_i sigma_j)
        return matrix / np.outer(size, size)

    @property
    def time_range(self) -> tuple[float, float]:
        """Smallest and largest tested time at the reference temperature, s."""
        reduced = self.reduced_time()
        return float(reduced.min()), float(reduced.max())

    def reduced_time(self) -> np.ndarray:
        """Compute t/a of all readings, s."""
        *_, shift, _ = self.model.split(self.unknowns)
        return self.model.time * np.exp(-self.model.log_factors(shift)[0][self.model.curve])

    def relaxed(self, time) -> np.ndarray:
        """Evaluate the modulus over the instantaneous one at times at the reference temperature."""
        # R(t) = 1 - sum g_i (1 - exp(-t/tau_i))
        fallen = -np.expm1(-np.asarray(time, float)[..., None] / self.tau)
        return 1.0 - fallen @ self.g

    def relaxed_error(self, time) -> np.ndarray:
        """Compute the standard error of ``relaxed`` from that of the constants."""
        held = np.asarray(time, float)[..., None] / self.tau
        # dR/dg_i = exp(-t/tau_i) - 1,  dR/d ln tau_i = g_i (t/tau_i) exp(-t/tau_i)
        slopes = {f"g_{i + 1}": np.expm1(-held[..., i]) for i in range(self.g.size)}
        rates = self.g * held * np.exp(-held)
        slopes |= {f"ln_tau_{i + 1}": rates[..., i] for i in range(self.g.size)}
        own = [k for k, name in enumerate(self.names) if name in slopes]
        matrix = self.covariance[np.ix_(own, own)]
        columns = np.stack([slopes[self.names[k]] for k in own], axis=-1)
        # sigma_R^2 = (dR/dc)^T C (dR/dc)
        return np.sqrt(np.einsum("...i,ij,...j->...", columns, matrix, columns))

    @property
    def fall_at_end(self) -> float:
        """Fall of the modulus over the last tested decade of time, over the modulus at its end."""
        end = self.time_range[1]
        before, after = self.relaxed(np.array([0.1 * end, end]))
        return float((before - after) / after)

    def differences(self) -> np.ndarray:
        """Compute computed minus measured force of all readings over the largest force of their test."""
        return self.model.evaluate(self.unknowns)[0] - self.model.force


def covariance(model: PronyModel, x: np.ndarray, fixed=(), least: float = 0.0) -> np.ndarray:
    """Compute the covariance of the unknowns, for readings of equal and independent scatter.

    Parameters
    ----------
    model : PronyModel
    x : ndarray, shape (k,)
    fixed : sequence of int
        Unknowns at their bounds, whose rows are zero.
    least : float
        Smallest standard deviation of a reading, relative to the largest force of its test.

    Returns
    -------
    ndarray, shape (k, k)
        Variances are infinite in directions that the data do not determine.
    """
    values, slopes = model.evaluate(x)
    free = np.setdiff1d(np.arange(x.size), fixed)
    root, away = np.sqrt(model.weight), values - model.force
    # s^2 = |r|^2 / (m - k);  C = s^2 (A^T W A)^-1 A^T W^2 A (A^T W A)^-1 = s^2 B B^T,
    # B = (W^(1/2) A)^+ W^(1/2), with weights W that are not the inverse of the scatter
    variance = max((away @ away) / max(values.size - free.size, 1), least**2)
    weighted = root[:, None] * slopes[:, free]
    length = np.linalg.norm(weighted, axis=0)
    # columns of unit length: singular values do not depend on the units of the unknowns
    size = 1.0 / np.where(length > 0.0, length, 1.0)
    left, singular, right = np.linalg.svd(weighted * size, full_matrices=False)
    known = singular > DETERMINED * singular[0]
    inverse = (right[known].T / singular[known]) @ (left[:, known].T * root)
    found = variance * (inverse @ inverse.T) * np.outer(size, size)
    # an unknown with a component in the null space is not determined by the data
    lost = np.any(np.abs(right[~known]) > 1e-6, axis=0)
    found[lost, lost] = np.inf
    result = np.zeros((x.size, x.size))
    result[np.ix_(free, free)] = found
    return result


def result_of(model: PronyModel, x: np.ndarray, free, trials) -> RelaxationFit:
    """Build the result of the unknowns ``x``; ``free`` is model and unknowns with free factors."""
    e, log_tau, shift, _ = model.split(x)
    total = e.sum()
    # terms that are absent are left out: of given times some may be without a part
    own = np.flatnonzero(e[1:] > 1e-8 * total)
    order = own[np.argsort(log_tau[own])]
    g = e[1:][order] / total
    absent = [i + 1 for i in range(model.terms) if i not in own]
    spread = covariance(model, x, absent)
    names, rows = [], []
    for i, k in enumerate(order, 1):
        # g_i = e_i / sum e:  dg_i/de_j = (delta_ij - g_i) / sum e
        row = np.zeros(x.size)
        row[: e.size] = -e[k + 1] / total**2
        row[k + 1] += 1.0 / total
        names.append(f"g_{i}")
        rows.append(row)
    for i, k in enumerate(order if model.log_tau is None else [], 1):
        names.append(f"ln_tau_{i}")
        rows.append(np.eye(x.size)[e.size + k])
    for name in model.shift.names if isinstance(model.shift, type) else ():
        names.append(name)
        rows.append(np.eye(x.size)[model.names.index(name)])
    jacobian = np.array(rows).reshape(-1, x.size)
    made = model.shift(tuple(shift.tolist()), model.reference) if model.shift else None
    return RelaxationFit(
        model.tests, g, np.exp(log_tau[order]), float(e[0] / total), made, model.reference,
        tuple(names), _transformed(jacobian, spread), _factors(*free), _rms(model, x), _rms(*free),
        trials, model, x,
    )  # fmt: skip


def _transformed(jacobian, spread) -> np.ndarray:
    """Compute T C T^T; variances stay infinite where T reaches an undetermined unknown."""
    lost = ~np.isfinite(np.diag(spread))
    finite = np.where(np.isfinite(spread), spread, 0.0)
    found = jacobian @ finite @ jacobian.T
    reached = np.any(jacobian[:, lost] != 0.0, axis=1)
    found[reached, reached] = np.inf
    return found


def _factors(model, x) -> dict:
    """Collect ln a and its standard error by temperature, of a fit with free factors."""
    if model.shift is None:
        return {}
    deviation = np.sqrt(np.diag(covariance(model, x)))
    *_, log_a, ratios = model.split(x)
    own = deviation[x.size - ratios.size - log_a.size : x.size - ratios.size]
    pairs = zip(log_a.tolist(), own.tolist(), strict=True)
    found = dict(zip(model.shifted, pairs, strict=True))
    return dict(sorted({model.reference: (0.0, 0.0), **found}.items()))


def _rms(model, x) -> float:
    away = model.evaluate(x)[0] - model.force
    return float(np.sqrt(np.average(away**2, weights=model.weight)))
