"""Fit of the constants of a law to material tests."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
import scipy

from seal_mdao.calibration.cycles import SoftenedLaw
from seal_mdao.calibration.data import MaterialDataError, MaterialTests
from seal_mdao.calibration.families import Family, family
from seal_mdao.calibration.fit_errors import errors_of
from seal_mdao.calibration.material_stability import MARGIN, check_stability, require_stable
from seal_mdao.calibration.residuals import mode_weights, residuals
from seal_mdao.calibration.standard_errors import standard_errors
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.values import integer, real

DRAWS, STARTS = 200, 12
"""Samples of the constants that are not moduli, and number of the best used as starting points."""
SAME = 1e-3
"""Relative difference of the sum of squares within which two starts reached the same minimum."""
INSIDE = 1e-6
"""Distance of an initial modulus from its bound, as a fraction of the largest stress."""
EVALUATIONS = 400
"""Limit of evaluations per start."""


@dataclass(frozen=True, eq=False)
class Fit:
    """Law fitted to material tests.

    Attributes
    ----------
    name : str
        Name of the law in seal files.
    law : Isotropic
    tests : MaterialTests
    weighting : str
    errors : dict of str to FitErrors
        By mode, and under ``"all"``.
    stability : dict of str to ModeStability
    margin : float
        Margin of the ranges over which stability is required.
    cost : float
        Sum of the squared weighted differences.
    starts, agreeing : int
        Number of starts, and how many of them reached this cost.
    standard_errors : dict of str to float
        Of the fitted constants, from the Gauss-Newton Hessian and the scatter of the fit; infinite for
        a constant that the data do not determine.
    unknowns : tuple of str
        Fitted constants.
    correlation : ndarray, shape (k, k)
        Correlation of their errors.
    softening : OgdenRoxburgh or None
        Of a cyclic test, fitted together with the law.
    """

    name: str
    law: Isotropic
    tests: MaterialTests
    weighting: str
    errors: dict
    stability: dict
    margin: float
    cost: float
    starts: int
    agreeing: int
    standard_errors: dict
    unknowns: tuple
    correlation: np.ndarray
    softening: OgdenRoxburgh | None = None

    @property
    def tested_law(self) -> Isotropic | SoftenedLaw:
        """The law with its softening, if it has one."""
        return self.law if self.softening is None else SoftenedLaw(self.law, self.softening)

    @property
    def stable(self) -> bool:
        """Whether the law is stable over the tested ranges with their margin."""
        return all(found.stable for found in self.stability.values())


@dataclass(frozen=True, eq=False)
class End:
    """Result of the fit from one starting point; ``law`` is an ``Isotropic`` or a
    ``SoftenedLaw``."""

    law: Isotropic | SoftenedLaw
    cost: float
    unknowns: tuple


def fit(
    law: str,
    tests: MaterialTests,
    *,
    weighting: str = "relative",
    margin: float = MARGIN,
    seed: int = 0,
    allow_unstable: bool = False,
    progress: Callable | None = None,
    **options,
) -> Fit:
    """Fit a law by nonlinear least squares from many starting points; equal calls give bitwise
    equal results.

    The result is the best stable minimum of all starts.

    Parameters
    ----------
    law : str
        One of ``materials.by_name.LAWS``.
    tests : MaterialTests
    weighting : {"relative", "absolute"}
        See ``residuals``.
    margin : float
        Widening of the tested ranges for the check of stability, a fraction of ln(lambda).
    seed : int
        Of the random starting points.
    allow_unstable : bool
        Accept the best minimum, stable or not.
    progress : callable, optional
        ``progress(done, of)`` after every start.
    **options
        ``terms``, ``nu`` and ``bulk_modulus`` of ``families.family``.

    Raises
    ------
    MaterialDataError
        If there are fewer readings than constants, and for cyclic tests, which need ``fit_softening``.
    UnstableMaterialError
        If no minimum is stable, with file, mode and stretch.
    ValueError
        For inadmissible arguments.
    """
    real("margin", margin, 0.0)
    integer("seed", seed, 0)
    if tests.cyclic:
        raise MaterialDataError(
            f"{tests.source}: {tests.cycles}; fit a law with Mullins softening to this test "
            "(seal-mdao fit, fit_softening), keep only the first loading, or, if the order of the "
            "readings has no meaning, sort them by stretch"
        )
    kind = family(law, tests, **options)
    # Poisson's ratios are fitted to the lateral stretches unless given
    lateral = law == "hyperfoam" and options.get("nu") is None
    differences = residuals(tests, weighting, lateral)
    count = len(kind.draw(np.random.default_rng(seed))[0])
    if tests.count * (2 if lateral else 1) < count:
        raise MaterialDataError(
            f"{tests.source}: {tests.count} readings are too few for the {count} constants of "
            f"{law}; add readings, or use fewer terms or another law"
        )
    scale = max(np.abs(data.stress).max() for data in tests.modes.values())
    ends = _ends(kind, differences, scale, np.random.default_rng(seed), progress)
    ranges = {name: data.range for name, data in tests.modes.items()}
    chosen, stability = _first_stable(ends, ranges, margin, allow_unstable, law, tests.source)
    deviations, correlation = uncertainty(differences, chosen, mode_weights(tests, lateral))
    # a minimum that many starts reach is likely the global one
    agreeing = sum(end.cost <= chosen.cost * (1.0 + SAME) + 1e-20 for end in ends)
    return Fit(
        law, chosen.law, tests, weighting, errors_of(chosen.law, tests), stability, margin,
        chosen.cost, len(ends), agreeing, deviations, chosen.unknowns, correlation,
    )  # fmt: skip


def _first_stable(ends, ranges, margin, allow_unstable, law, source):
    """Return the best stable minimum, or the best one where that is allowed; else raise an error."""
    refused = None
    for end in ends:
        stability = check_stability(end.law, ranges, margin)
        if allow_unstable or all(found.stable for found in stability.values()):
            return end, stability
        # the message is about the best minimum
        refused = refused or stability
    require_stable(refused, f"{source}: {law} with the best-fit constants")


# ---- starts ----


def _ends(kind: Family, differences, scale: float, rng, progress) -> list[End]:
    """Minimise from all starts; return the results, the best first."""
    # sample the nonlinear constants, solve for the moduli, and descend from the best samples
    started = []
    for _ in range(1 if kind.convex else DRAWS):
        unknowns, values = kind.draw(rng)
        found = _best_moduli(kind.template, unknowns, values, differences, scale)
        if found is not None:
            started.append((*found, unknowns))
    # the best samples, each followed to a minimum
    chosen, ends = sorted(started, key=lambda start: start[0])[:STARTS], []
    for i, (_, values, unknowns) in enumerate(chosen, 1):
        ends.append(descend(kind.template, unknowns, values, differences, scale))
        if progress is not None:
            progress(i, len(chosen))
    # starts that failed are dropped
    ends = [end for end in ends if end is not None and np.isfinite(end.cost)]
    if not ends:
        raise MaterialDataError(_no_end(kind, chosen))
    return sorted(ends, key=lambda end: end.cost)


def _no_end(kind: Family, started) -> str:
    """Explain why no start led to a law: the best constants are invalid, or give no stress."""
    try:
        for _, values, _ in started:
            kind.template.with_(**values)
    except ValueError as error:
        return (
            f"the best-fit constants of {kind.law} are not admissible: {error}; choose another law "
            "or correct the readings"
        )
    return (
        f"the fit of {kind.law} failed from all {len(started)} start values, because the stress of "
        "this law is not finite at the tested stretches; limit the range of stretches or choose "
        "another law"
    )


def _best_moduli(template, unknowns, values, differences, scale):
    """Solve for the best moduli within their bounds, other constants given; return cost, constants."""
    moduli = [unknown for unknown in unknowns if unknown.modulus]
    names = [unknown.name for unknown in moduli]
    lower, upper = (np.array([getattr(u, end) for u in moduli]) for end in ("lower", "upper"))
    # P = A m is linear in the moduli m, so the slope A is the same for all: min |A m - data|,
    # data = A m_0 - r(m_0) in weighted form
    some = np.where(upper > 0.0, 1.0, -1.0)
    law = template.with_(**values, **dict(zip(names, some.tolist(), strict=True)))
    value, slope = differences(law, names)
    if not (np.isfinite(value).all() and np.isfinite(slope).all()):
        return None
    found = scipy.optimize.lsq_linear(slope, slope @ some - value, (lower, upper), method="bvls")
    # strictly inside the bounds, where least_squares has to begin
    inside = np.clip(found.x, lower + INSIDE * scale, upper - INSIDE * scale)
    return found.cost, {**values, **dict(zip(names, inside.tolist(), strict=True))}


def descend(template, unknowns, values, differences, scale):
    """Minimise the sum of squares over all unknowns from one start; moduli over the largest stress."""
    names = tuple(unknown.name for unknown in unknowns)
    # all unknowns of order one
    units = np.array([scale if unknown.modulus else 1.0 for unknown in unknowns])
    bounds = np.array([(unknown.lower, unknown.upper) for unknown in unknowns]).T / units
    start = np.array([values[name] for name in names]) / units

    def law_of(x):
        return template.with_(**dict(zip(names, (np.array(x) * units).tolist(), strict=True)))

    # least_squares requests residuals and Jacobian separately at the same point
    @lru_cache(1)
    def both(*x):
        return differences(law_of(x), names)

    try:
        found = scipy.optimize.least_squares(
            lambda x: both(*x)[0], start, lambda x: both(*x)[1] * units, bounds=bounds,
            x_scale="jac", max_nfev=EVALUATIONS, xtol=1e-12, ftol=1e-12, gtol=1e-12,
        )  # fmt: skip
    except (ValueError, np.linalg.LinAlgError):  # residuals not finite, or invalid constants
        return None
    return End(_sorted_terms(law_of(found.x)), 2.0 * float(found.cost), names)


def _sorted_terms(law):
    """Sort the terms of a law by their contribution to the shear modulus, the largest first."""
    if not hasattr(law, "terms"):
        return law
    # mu alpha^2 k: Ogden mu alpha, hyperfoam 2 mu
    size = [-abs(m.mu * m.alpha * m.alpha * m.scale) for m in law.terms]
    order, changed = np.argsort(size, kind="stable"), {}
    for field in ("mu", "alpha", "nu"):
        own = getattr(law, field, None)
        if own is not None:
            changed |= {f"{field}_{i}": own[k] for i, k in enumerate(order, 1)}
    return law.with_(**changed)


# ---- uncertainty ----


def uncertainty(differences, end: End, weights):
    """Compute standard errors of the constants and their correlation, for readings of equal scatter and
    the ``weights`` (m,) of their squares."""
    names = end.unknowns
    deviation, correlation = standard_errors(*differences(end.law, names), weights)
    return dict(zip(names, deviation.tolist(), strict=True)), correlation
