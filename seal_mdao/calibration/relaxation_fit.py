"""Fit of a Prony series, and of the shift with temperature, to relaxation tests."""

from collections.abc import Callable
from dataclasses import replace
from functools import lru_cache

import numpy as np
import scipy

from seal_mdao.calibration.measurement_files import MaterialDataError
from seal_mdao.calibration.relaxation_data import RelaxationTests
from seal_mdao.calibration.relaxation_model import PronyModel
from seal_mdao.calibration.relaxation_result import RelaxationFit, covariance, result_of
from seal_mdao.calibration.relaxation_shift import SHIFTS, Arrhenius, fit_shift
from seal_mdao.calibration.relaxation_start import (
    BEYOND,
    parts,
    starting_shifts,
    starting_times,
    time_range,
)
from seal_mdao.values import integer, numbers, one_of, require

ROOM_TEMPERATURE = 23.0
"""Standard temperature of laboratories (ISO 23529), degrees Celsius."""
MAX_TERMS = 12
RESOLUTION = 1e-4
"""Differences below this part of the largest force do not justify a further term."""
NONE = 1e-6
"""Part of the force below which a term, or the long-term force, is taken as absent."""
PATIENCE = 2
"""Numbers of terms without improvement after which the search ends."""
WANDER = 3.0 * np.log(10.0)
"""Largest distance of ln a from its starting point."""
VAGUE = np.log(10.0)
"""Standard error of ln a above which a factor is not determined."""
EVIDENT = 10.0
"""Sum of squares of a fall, over the square of the scatter, above which it is no accident."""
EVALUATIONS = 300
"""Limit of evaluations per start."""


def fit_relaxation(
    tests: RelaxationTests,
    *,
    terms: int | None = None,
    tau=None,
    shift: str | None = None,
    reference: float | None = None,
    entropic: bool = False,
    progress: Callable | None = None,
) -> RelaxationFit:
    """Fit a Prony series by least squares in log time; equal calls give bitwise equal results.

    Every decade of time has the same weight. The number of terms minimises the Bayesian information
    criterion. Curves of several temperatures are placed on a master curve first; the shift function is
    fitted to their factors, and then all constants together to all readings.

    Parameters
    ----------
    tests : RelaxationTests
    terms : int, optional
        Number of terms.
    tau : array_like, optional
        Relaxation times at the reference temperature, s; then only g is fitted.
    shift : {"wlf", "arrhenius"}, optional
        Shift function for several temperatures; that with the better information criterion when left
        out, of which WLF needs four temperatures.
    reference : float, optional
        Reference temperature, one of the tested; the one nearest to 23 degrees when left out.
    entropic : bool
        Whether moduli are in proportion to the absolute temperature; matters for tests that share
        their force at several temperatures.
    progress : callable, optional
        ``progress(n)`` after every number of terms.

    Raises
    ------
    MaterialDataError
        If there are too few readings, or no relaxation or no long-term force is found.
    ValueError
        For inadmissible arguments.
    """
    degrees = tests.temperatures
    reference = _reference(tests, reference)
    several = len(degrees) > 1
    if shift is not None:
        one_of("shift", shift, tuple(SHIFTS))
        require(
            len(degrees) > len(SHIFTS[shift].names),
            f"the temperature shift {shift} can be fitted only to tests at "
            f"{len(SHIFTS[shift].names) + 1} or more temperatures, but {tests.source} has "
            f"{len(degrees)}",
        )
    require(
        not entropic or several,
        "entropic moduli (proportional to the absolute temperature) can be fitted only to tests at "
        f"several temperatures, but {tests.source} has {len(degrees)}; leave out the option "
        "entropic",
    )
    require(
        terms is None or tau is None,
        "terms (number of terms) and tau (relaxation times) exclude each other; give one of them",
    )
    if terms is not None:
        integer("terms", terms, 1, MAX_TERMS)
    model = PronyModel(tests, 1, reference, "free" if several else None, entropic)
    log_a, ratios = starting_shifts(model)
    if tau is not None:
        log_tau = np.log(_times(tau))
        model = replace(model, terms=log_tau.size, log_tau=log_tau)
        x, trials = _solve(model, [log_tau], log_a, ratios), []
    else:
        model, x, trials = _search(model, log_a, ratios, terms, progress)
    free, kind = (model, x), None
    if several:
        # the master curve gives factors of single temperatures, these the shift function
        kind, constants = _shift_function(model, x, shift)
        model = replace(model, shift=kind)
        e, own, _, q = free[0].split(x)
        start = [e, own if tau is None else [], constants, q]
        x = _descend(model, np.concatenate(start), log_a)
    return _checked(result_of(model, x, free, trials), tau is not None)


def _reference(tests, reference):
    degrees = tests.temperatures
    if reference is None:
        return min(degrees, key=lambda t: abs(t - ROOM_TEMPERATURE)) if degrees else None
    require(
        reference in degrees,
        "the reference temperature of a relaxation fit must be one of the tested temperatures "
        f"({', '.join(f'{t:g}' for t in degrees) or 'none is given'}), got {reference:g}",
    )
    return float(reference)


def _times(tau) -> np.ndarray:
    found = np.sort(np.ravel(numbers("tau", tau)))
    require(
        1 <= found.size <= MAX_TERMS and np.isfinite(found).all() and found[0] > 0.0,
        f"the relaxation times tau must be 1 to {MAX_TERMS} positive numbers (s), got "
        f"{found.tolist()}",
    )
    require(
        np.all(np.diff(found) > 0.0),
        f"the relaxation times tau must differ from each other, got {found.tolist()}",
    )
    return found


def _checked(found: RelaxationFit, given: bool) -> RelaxationFit:
    source = found.tests.source
    if not found.g.size:
        raise MaterialDataError(
            f"{source}: the test shows no stress relaxation, because the force rises, or decreases "
            "by less than its scatter; check that the strain is constant and that times count from "
            "the start of the loading"
        )
    if found.long_term < NONE:
        cure = "shorter relaxation times tau" if given else "a longer test or fewer terms"
        raise MaterialDataError(
            f"{source}: the test does not determine a long-term modulus: the sum of the relaxing "
            f"fractions g would be 1, so that the force relaxes to zero; use {cure}"
        )
    return found


# ---- number of terms ----


def _search(model, log_a, ratios, terms, progress):
    """Fit with growing numbers of terms; return the model and unknowns of the best, and all trials."""
    low, high = time_range(model, log_a)
    # more terms than decades + 2 cannot be distinguished
    most = min(MAX_TERMS, int(np.ceil((high - low) / np.log(10.0))) + 2)
    # m = (sum w)^2 / sum w^2 readings of equal weight
    effective = model.weight.sum() ** 2 / (model.weight**2).sum()
    best, before, trials = (np.inf, None, None), None, []
    for n in range(0, (terms or most) + 1):
        own = replace(model, terms=n)
        if len(own.names) >= model.tests.count:
            if terms:
                raise MaterialDataError(
                    f"{model.tests.source}: {model.tests.count} readings are too few for the "
                    f"{len(own.names)} constants of a Prony series with {n} terms; use fewer terms "
                    "or add readings"
                )
            break
        x = _solve(own, starting_times(own, log_a, _sizes(own, ratios), before), log_a, ratios)
        e, before, *_ = own.split(x)
        # BIC = m ln(mean square) + k ln m, with the effective number m of weighted readings
        square = np.average((own.evaluate(x)[0] - own.force) ** 2, weights=own.weight)
        score = effective * np.log(square + RESOLUTION**2) + len(own.names) * np.log(effective)
        # a term without a part of the force is one too many
        absent = bool(np.any(e[1:] < NONE * e.sum()))
        trials.append({"terms": n, "rms": float(np.sqrt(square)), "bic": float(score)})
        if terms == n or (terms is None and not absent and score < best[0]):
            best = score, own, x
        if progress is not None:
            progress(n)
        if terms is None and n - best[1].terms >= PATIENCE:
            break
    return best[1], best[2], trials


def _sizes(model, ratios) -> np.ndarray:
    """Evaluate q m of every curve."""
    return np.append(1.0, ratios)[np.array(model.tests.scales)] * model.modulus_factors()


def _solve(model, starts, log_a, ratios) -> np.ndarray:
    """Minimise from all starting points of ln tau; return the best unknowns."""
    best = None
    for log_tau in starts:
        # for given ln tau and ln a the forces are linear in e
        e = parts(model, log_tau, log_a, _sizes(model, ratios))
        shift = [log_a[_first(model, t)] for t in model.shifted] if model.shift else []
        free = [] if model.log_tau is not None else log_tau
        x = _descend(model, np.concatenate([e, free, shift, ratios]), log_a)
        cost = np.sum(model.residuals(x)[0] ** 2)
        if best is None or cost < best[0]:
            best = cost, x
    return best[1]


def _first(model, temperature) -> int:
    """Find the first curve of a temperature."""
    return [own.temperature for own in model.tests.curves].index(temperature)


def bounds(model, log_a) -> tuple[np.ndarray, np.ndarray]:
    """Compute lower and upper bounds of the unknowns; log_a (c,) gives the range of reduced times."""
    low, high = time_range(model, log_a)
    # e_i >= 0, ln tau in the range that readings resolve
    box = {"e": (0.0, np.inf), "ln_tau": (low - BEYOND, high), "ratio": (0.0, np.inf)}
    pairs = [box.get(name.rpartition("_")[0], (-np.inf, np.inf)) for name in model.names]
    lower, upper = map(np.array, zip(*pairs, strict=True))
    if model.shift == "free":
        own = [model.names.index(f"ln_a_{t:g}") for t in model.shifted]
        start = np.array([log_a[_first(model, t)] for t in model.shifted])
        lower[own], upper[own] = start - WANDER, start + WANDER
    if isinstance(model.shift, type):
        own = [model.names.index(name) for name in model.shift.names]
        lower[own], upper[own] = model.shift.bounds(model.reference, model.tests.temperatures)
    return lower, upper


def _descend(model, start, log_a) -> np.ndarray:
    """Minimise the weighted squares from one starting point within the bounds."""
    lower, upper = bounds(model, log_a)
    inside = np.clip(start, lower + 1e-9, upper - 1e-9)

    # least_squares requests residuals and Jacobian separately at the same point
    @lru_cache(1)
    def both(*x):
        return model.residuals(np.array(x))

    found = scipy.optimize.least_squares(
        lambda x: both(*x)[0], inside, lambda x: both(*x)[1], bounds=(lower, upper), x_scale="jac",
        max_nfev=EVALUATIONS, xtol=1e-11, ftol=1e-12, gtol=1e-13,
    )  # fmt: skip
    return found.x


# ---- shift function ----


def _relaxing(model, x) -> dict:
    """Find out of which temperatures the curves relax by more than their scatter."""
    values, _ = model.evaluate(x)
    # sigma^2 of a reading
    scatter = np.mean((values - model.force) ** 2) + RESOLUTION**2
    found = dict.fromkeys(model.tests.temperatures, False)
    for k, own in enumerate(model.tests.curves):
        force = values[model.curve == k]
        # chi^2 of the fitted fall, with one degree of freedom
        found[own.temperature] |= bool(np.sum((force - force.mean()) ** 2) > EVIDENT * scatter)
    return found


def _shift_function(model, x, name):
    """Choose and fit the shift function to the free factors; return its class and constants."""
    # covariance of ln a, the other unknowns free
    own = [model.names.index(f"ln_a_{t:g}") for t in model.shifted]
    matrix = covariance(model, x, least=RESOLUTION)[np.ix_(own, own)]
    visible = _relaxing(model, x)
    # factors with a small enough variance, between curves that relax
    known = (np.diag(matrix) < VAGUE**2) & [visible[t] for t in model.shifted]
    known &= visible[model.reference]
    if known.sum() < len(SHIFTS[name].names if name else Arrhenius.names):
        lost = np.array(model.shifted)[~known].tolist()
        raise MaterialDataError(
            f"{model.tests.source}: the shift of the relaxation times from {model.reference:g} to "
            f"{', '.join(f'{t:g}' for t in lost)} °C cannot be determined, because the relaxation "
            "curves at these temperatures do not overlap with other curves, or their force does not "
            "decrease by more than its scatter; add tests at temperatures between these, or readings "
            "at shorter times"
        )
    own, degrees = np.array(own)[known], np.array(model.shifted)[known].tolist()
    # a factor is not more accurate than the resolution of a force
    weights = np.linalg.inv(matrix[np.ix_(known, known)] + RESOLUTION**2 * np.eye(len(own)))
    weights = 0.5 * (weights + weights.T)
    kinds, best = [SHIFTS[name]] if name else list(SHIFTS.values()), None
    for kind in kinds:
        # a function that passes through all factors is chosen only by name
        if name is None and len(kind.names) > 1 and len(own) <= len(kind.names):
            continue
        found, cost = fit_shift(kind, model.reference, degrees, x[own], weights)
        # BIC: a further constant has to gain more than ln m
        score = cost + len(kind.names) * np.log(model.tests.count)
        if best is None or score < best[0]:
            best = score, kind, found.constants
    return best[1], np.array(best[2])
