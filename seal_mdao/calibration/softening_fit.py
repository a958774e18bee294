"""Fit of a law with its softening (Mullins effect) to cyclic tests."""

from collections.abc import Callable
from dataclasses import replace
from itertools import product

import numpy as np

from seal_mdao.calibration.cycles import SoftenedLaw
from seal_mdao.calibration.data import MaterialDataError, MaterialTests, ModeData
from seal_mdao.calibration.families import Unknown, distortion, family
from seal_mdao.calibration.fit_errors import errors_of
from seal_mdao.calibration.law_fit import SAME, End, Fit, descend, fit, uncertainty
from seal_mdao.calibration.loading_modes import MODES
from seal_mdao.calibration.material_stability import MARGIN, check_stability, require_stable
from seal_mdao.calibration.residuals import mode_weights, residuals
from seal_mdao.materials.ogden_roxburgh import PREFIX, OgdenRoxburgh

R, M, BETA = (PREFIX + name for name in ("r", "m", "beta"))
STARTS = 4
"""Number of the best of the following constants from which the fit starts."""
START_R, START_M, START_BETA = (1.2, 2.0, 5.0), (0.02, 0.1, 0.5), (0.02, 0.2, 0.5)
"""Constants of the starts, ``m`` over the largest energy."""
MOST_R = 1000.0
"""Largest r; the stress below the largest energy is then that of the first loading within 0.1 %."""
SAME_AMPLITUDE = 1.05
"""Ratio of the largest energies below which m and beta cannot be separated."""


def fit_softening(
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
    """Fit a law and its softening to all readings of cyclic tests; equal calls give bitwise equal
    results.

    The law is fitted to the first loading, and then all constants together to all readings. ``beta``
    is zero if the test has one amplitude, which determines only m + beta W_max. The parameters are those
    of ``fit``.

    Raises
    ------
    MaterialDataError
        If there is no unloading, or too few readings, or the constants of the softening are not
        determined.
    UnstableMaterialError
        If the law of the first loading is not stable.
    ValueError
        For inadmissible arguments, and a compressible law.
    """
    if not tests.cyclic:
        raise MaterialDataError(
            f"{tests.source}: Mullins softening is identified from unloading, but none of the "
            "tests contains an unloading; add a cyclic test, or fit the law without softening"
        )
    if law == "hyperfoam":
        raise ValueError(
            f"{tests.source}: this is a cyclic test, but Mullins softening can be fitted for "
            f"nearly incompressible laws only, not for {law}; keep only the first loading, or fit "
            "another law"
        )
    # a start, whose stability does not matter yet
    first = fit(
        law, first_loading(tests), weighting=weighting, margin=margin, seed=seed,
        allow_unstable=True, progress=progress, **options,
    )  # fmt: skip
    # constants of the law; r > 1, m >= 0, and beta >= 0 with several amplitudes
    unknowns = _unknowns(family(law, tests, **options), first, seed)
    softening = [Unknown(R, 1.0, MOST_R, False), Unknown(M, 0.0, np.inf)]
    if _amplitudes(tests) > SAME_AMPLITUDE:
        softening.append(Unknown(BETA, 0.0, np.inf, False))
    below = tests.count - first.tests.count
    if below < len(softening):
        raise MaterialDataError(
            f"{tests.source}: {below} readings during unloading or reloading (below the largest "
            f"earlier stretch) are too few for the {len(softening)} constants of the Mullins "
            "softening; add readings"
        )
    differences = residuals(tests, weighting)
    ends = _ends(first, tests, [*unknowns, *softening], differences)
    best = ends[0]
    stability = check_stability(
        best.law.law, {name: data.range for name, data in tests.modes.items()}, margin
    )
    if not allow_unstable:
        require_stable(stability, f"{tests.source}: {law} with the best-fit constants")
    deviations, correlation = uncertainty(differences, best, mode_weights(tests))
    _require_determined(best, deviations, correlation, tests)
    agreeing = sum(end.cost <= best.cost * (1.0 + SAME) + 1e-20 for end in ends)
    return Fit(
        law, best.law.law, tests, weighting, errors_of(best.law, tests), stability, margin, best.cost,
        len(ends), agreeing, deviations, best.unknowns, correlation, best.law.softening,
    )  # fmt: skip


def first_loading(tests: MaterialTests) -> MaterialTests:
    """Select the readings of cyclic modes at which I1 exceeds all values before, and all readings
    of the others."""
    modes = {}
    for name, data in tests.modes.items():
        # I1 - 3; first loading: at its maximum so far
        own = distortion(MODES[name], data.stretch)
        top = own >= np.maximum.accumulate(own) if data.unloadings else np.full(own.shape, True)
        modes[name] = ModeData(data.stretch[top], data.stress[top])
    return MaterialTests(modes, tests.source)


def _amplitudes(tests) -> float:
    """Compute the ratio of the largest to the smallest I1 - 3 from which a test unloads."""
    tops = []
    for name, data in tests.modes.items():
        if data.unloadings:
            own = distortion(MODES[name], data.stretch)
            # maxima so far at the readings below them
            largest = np.maximum.accumulate(own)
            tops.append(largest[own < largest])
    tops = np.concatenate(tops)
    return float(tops.max() / tops.min())


def _unknowns(kind, first: Fit, seed: int) -> list[Unknown]:
    """Build the unknowns of the law with the signs that the constants of the first loading have."""
    found = []
    for own in kind.draw(np.random.default_rng(seed))[0]:
        # bounds of the other sign where the first fit has that
        inside = own.lower <= first.law.constants[own.name] <= own.upper
        found.append(own if inside else replace(own, lower=-own.upper, upper=-own.lower))
    return found


def _ends(first: Fit, tests, unknowns, differences) -> list[End]:
    """Minimise from the best of some constants of the softening; return the results, the best first."""
    names = [own.name for own in unknowns]
    scale = max(np.abs(data.stress).max() for data in tests.modes.values())
    largest = _largest_energy(first.law, tests)
    values, started = first.law.constants, []
    for r, m, beta in product(START_R, START_M, START_BETA if BETA in names else (0.0,)):
        law = SoftenedLaw(first.law, OgdenRoxburgh(r, m * largest, beta))
        # cost |r|^2 of the start
        away = differences(law, names)[0]
        started.append((float(away @ away), law))
    ends = []
    for _, law in sorted(started, key=lambda start: start[0])[:STARTS]:
        own = {**values, **law.softening.constants}
        ends.append(descend(law, unknowns, own, differences, scale))
    ends = [end for end in ends if end is not None and np.isfinite(end.cost)]
    if not ends:
        raise MaterialDataError(
            f"{tests.source}: the fit of {first.name} with softening failed from every start "
            "value, because the stress of this law is not finite at the tested stretches; choose "
            "another law, or fit the first loading alone"
        )
    return sorted(ends, key=lambda end: end.cost)


def _largest_energy(law, tests) -> float:
    """Compute the largest energy of all readings of cyclic modes, kPa."""
    soft = SoftenedLaw(law, OgdenRoxburgh(2.0, 1.0, 0.0))
    return max(
        float(soft.energy(MODES[name], data.stretch).max())
        for name, data in tests.modes.items()
        if data.unloadings
    )


def _require_determined(end: End, deviations: dict, correlation, tests) -> None:
    """Raise an error where the readings do not determine the softening."""
    own = end.law.softening
    if own.r > 0.5 * MOST_R or deviations[R] > own.r:
        raise MaterialDataError(
            f"{tests.source}: the constant r of the Mullins softening is not determined "
            f"({own.r:.3g} with a standard error of {deviations[R]:.2g}): the stress of unloading "
            "equals that of loading within the scatter, or the unloading ends too early; unload "
            "further, or fit the law without softening"
        )
    # s = m + beta W_max at the largest energy, and its standard error
    largest = _largest_energy(end.law.law, tests)
    rates = {M: 1.0, BETA: largest}
    index = [i for i, name in enumerate(end.unknowns) if name in rates]
    error = np.array([rates[end.unknowns[i]] * deviations[end.unknowns[i]] for i in index])
    width = own.m + own.beta * largest
    # sigma_s^2 = sum_ij (ds/dc_i) sigma_i rho_ij sigma_j (ds/dc_j)
    spread = np.sqrt(max(error @ correlation[np.ix_(index, index)] @ error, 0.0))
    if not np.isfinite(error).all() or spread > width:
        raise MaterialDataError(
            f"{tests.source}: the constants m and beta of the Mullins softening are not "
            f"determined: m + beta W_max is {width:.3g} kPa with a standard error of {spread:.2g}; "
            "add readings at the beginning of the unloading, where the stress drops"
        )
