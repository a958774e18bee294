"""Fit of the constants of a law to material tests."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares, lsq_linear

from seal_mdao.calibration.data import MaterialDataError, MaterialTests
from seal_mdao.calibration.errors import errors_of
from seal_mdao.calibration.families import Family, family
from seal_mdao.calibration.residuals import Residuals, residuals
from seal_mdao.calibration.stability import (
    MARGIN,
    check_stability,
    require_stable,
)
from seal_mdao.materials.isotropic import Isotropic

DRAWS, STARTS = 200, 12
"""Draws of the constants that are no moduli, and how many of the best are followed to the end."""
SAME = 1e-3
"""Relative difference of the sum of squares within which two starts have reached the same."""
INSIDE = 1e-6
"""Distance of a first modulus from its bound, as a share of the largest stress."""
EVALUATIONS = 400
"""Most evaluations of one start."""


@dataclass(frozen=True, eq=False)
class Fit:
    """A law fitted to tests.

    Attributes
    ----------
    name : str
        Of the law, as seal files have it.
    law : Isotropic
    tests : MaterialTests
    weighting : str
    errors : dict of str to FitErrors
        By mode, and under ``"all"``.
    stability : dict of str to ModeStability
    margin : float
        Of the ranges over which stability was asked for.
    cost : float
        Sum of the squared weighted differences.
    starts, agreeing : int
        Starts followed to the end, and how many of them reached this cost.
    standard_errors : dict of str to float
        Of the constants that were found, from the Gauss-Newton Hessian and the scatter of the fit;
        infinite for one that the data do not tell.
    unknowns : tuple of str
        Constants that were found.
    correlation : ndarray, shape (k, k)
        Between the errors of these.
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

    @property
    def stable(self) -> bool:
        """Whether the law is stable over the tested ranges with their margin."""
        return all(found.stable for found in self.stability.values())


@dataclass(frozen=True, eq=False)
class _End:
    """Where one start has led to."""

    law: Isotropic
    cost: float
    unknowns: tuple


def fit(
    law: str,
    tests: MaterialTests,
    *,
    terms: int = 1,
    nu: float | None = None,
    bulk_modulus: float = 80_000.0,
    weighting: str = "relative",
    margin: float = MARGIN,
    seed: int = 0,
    allow_unstable: bool = False,
    progress: Callable | None = None,
) -> Fit:
    """Fit a law by nonlinear least squares from many starts; the same call gives the same bits.

    Of the ends of all starts the best one that is stable is taken.

    Parameters
    ----------
    law, terms, nu, bulk_modulus
        As ``families.family`` has them.
    tests : MaterialTests
    weighting : {"relative", "absolute"}
        See ``residuals``.
    margin : float
        By which the tested ranges are widened for the check of stability, a share of ln(lambda).
    seed : int
        Of the draws.
    allow_unstable : bool
        Take the best end, stable or not.
    progress : callable, optional
        ``progress(done, of)`` after every start.

    Raises
    ------
    MaterialDataError
        When there are fewer readings than constants.
    UnstableMaterialError
        When no end is stable, with file, mode and stretch.
    ValueError
        For arguments that are not admissible.
    """
    if not (np.isfinite(margin) and margin >= 0.0):
        raise ValueError(f"margin must not be negative, got {margin}")
    if seed < 0:
        raise ValueError(f"seed must not be negative, got {seed}")
    kind = family(law, tests, terms, nu, bulk_modulus)
    lateral = law == "hyperfoam" and nu is None
    differences = residuals(tests, weighting, lateral)
    rng = np.random.default_rng(seed)
    _require_readings(tests, len(kind.draw(np.random.default_rng(seed))[0]), law, lateral)
    ends = _ends(kind, differences, rng, progress)
    ranges = {name: data.range for name, data in tests.modes.items()}
    chosen, stability = _first_stable(ends, ranges, margin, allow_unstable, law, tests.source)
    deviations, correlation = _uncertainty(differences, chosen)
    agreeing = sum(end.cost <= chosen.cost * (1.0 + SAME) + 1e-20 for end in ends)
    return Fit(
        law, chosen.law, tests, weighting, errors_of(chosen.law, tests), stability, margin,
        chosen.cost, len(ends), agreeing, deviations, chosen.unknowns, correlation,
    )  # fmt: skip


def _require_readings(tests, count, law, lateral):
    readings = tests.count * (2 if lateral else 1)
    if readings < count:
        raise MaterialDataError(
            f"{tests.source}: {tests.count} readings are too few for the {count} constants of {law}"
        )


def _first_stable(ends, ranges, margin, allow_unstable, law, source):
    """The best end that is stable, or the best one where that is allowed; else an error."""
    refused = None
    for end in ends:
        stability = check_stability(end.law, ranges, margin)
        if allow_unstable or all(found.stable for found in stability.values()):
            return end, stability
        refused = refused or stability
    require_stable(refused, f"{source}: {law} with the constants that fit best")


# ---- starts ----


def _ends(kind: Family, differences: Residuals, rng, progress) -> list[_End]:
    """Ends of the starts, the best first."""
    draws = 1 if kind.convex else DRAWS
    scale = max(np.abs(part.data.stress).max() for part in differences.parts)
    started = []
    for _ in range(draws):
        unknowns, values = kind.draw(rng)
        found = _best_moduli(kind.template, unknowns, values, differences, scale)
        if found is not None:
            started.append((*found, unknowns))
    started.sort(key=lambda start: start[0])
    ends = []
    followed = started[:STARTS]
    for i, (_, values, unknowns) in enumerate(followed, 1):
        ends.append(_descend(kind.template, unknowns, values, differences, scale))
        if progress is not None:
            progress(i, len(followed))
    ends = [end for end in ends if end is not None and np.isfinite(end.cost)]
    if not ends:
        raise MaterialDataError(_no_end(kind, followed))
    return sorted(ends, key=lambda end: end.cost)


def _no_end(kind: Family, started) -> str:
    """Why no start has led to a law: the constants that suit the data are refused, or give no stress."""
    try:
        for _, values, _ in started:
            kind.template.with_(**values)
    except ValueError as error:
        return f"{kind.law} with the constants that suit the data: {error}"
    return f"{kind.law} has no value at these stretches, from any start"


def _best_moduli(template, unknowns, values, differences, scale):
    """Cost and constants with the moduli that suit the others best, within their bounds."""
    moduli = [unknown for unknown in unknowns if unknown.modulus]
    names = [unknown.name for unknown in moduli]
    lower, upper = (np.array([getattr(u, end) for u in moduli]) for end in ("lower", "upper"))
    # the stress is linear in the moduli: its slopes at any of them are those at all
    some = np.where(upper > 0.0, 1.0, -1.0)
    law = template.with_(**values, **dict(zip(names, some.tolist(), strict=True)))
    value, slope = differences(law, names)
    if not (np.isfinite(value).all() and np.isfinite(slope).all()):
        return None
    found = lsq_linear(slope, slope @ some - value, (lower, upper), method="bvls")
    inside = np.clip(found.x, lower + INSIDE * scale, upper - INSIDE * scale)
    return found.cost, {**values, **dict(zip(names, inside.tolist(), strict=True))}


def _descend(template, unknowns, values, differences, scale):
    """Least squares over all unknowns from one start; moduli in units of the largest stress."""
    names = tuple(unknown.name for unknown in unknowns)
    units = np.array([scale if unknown.modulus else 1.0 for unknown in unknowns])
    lower = np.array([unknown.lower for unknown in unknowns]) / units
    upper = np.array([unknown.upper for unknown in unknowns]) / units
    start = np.array([values[name] for name in names]) / units

    def law_of(x):
        return template.with_(**dict(zip(names, (x * units).tolist(), strict=True)))

    last = {}  # least squares asks for differences and derivatives at the same point

    def both(x):
        key = x.tobytes()
        if key not in last:
            last.clear()
            last[key] = differences(law_of(x), names)
        return last[key]

    def value(x):
        return both(x)[0]

    def slope(x):
        return both(x)[1] * units

    try:
        found = least_squares(
            value, start, slope, bounds=(lower, upper), x_scale="jac", max_nfev=EVALUATIONS,
            xtol=1e-12, ftol=1e-12, gtol=1e-12,
        )  # fmt: skip
    except (ValueError, np.linalg.LinAlgError):  # no finite value, or no law, where it was led to
        return None
    return _End(_sorted_terms(law_of(found.x)), 2.0 * float(found.cost), names)


def _sorted_terms(law):
    """Terms of a sum with the largest contribution to the shear modulus first."""
    if not hasattr(law, "terms"):
        return law
    size = [-abs(m.mu * m.alpha * m.alpha * m.scale) for m in law.terms]
    order, changed = np.argsort(size, kind="stable"), {}
    for field in ("mu", "alpha", "nu"):
        if hasattr(law, field):
            own = getattr(law, field)
            changed |= {f"{field}_{i}": own[k] for i, k in enumerate(order, 1)}
    return law.with_(**changed)


# ---- uncertainty ----


def _uncertainty(differences, end: _End):
    """Standard errors of the constants and the correlation between them."""
    names = end.unknowns
    value, slope = differences(end.law, names)
    free = max(value.size - len(names), 1)
    length = np.linalg.norm(slope, axis=0)
    size = 1.0 / np.where(length > 0.0, length, 1.0)
    scaled = slope * size  # columns of length one: what is told does not depend on units
    _, singular, directions = np.linalg.svd(scaled, full_matrices=False)
    told = singular > 1e-10 * singular[0]
    inverse = (directions[told].T / singular[told] ** 2) @ directions[told]
    deviation = np.sqrt(np.diag(inverse) * (value @ value) / free)
    # a constant that takes part in a direction that changes nothing is not told
    lost = np.any(np.abs(directions[~told]) > 1e-6, axis=0)
    root = np.sqrt(np.maximum(np.diag(inverse), 1e-300))
    deviation = np.where(lost, np.inf, deviation)
    return dict(zip(names, (deviation * size).tolist(), strict=True)), inverse / np.outer(
        root, root
    )
