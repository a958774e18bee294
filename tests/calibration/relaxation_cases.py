"""Relaxation tests of known constants."""

import numpy as np

from seal_mdao.calibration.relaxation_data import relaxation_tests
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO

G, TAU = np.array([0.1, 0.15, 0.05]), np.array([1.0, 30.0, 2000.0])


def relaxed(time, g=G, tau=TAU):
    """Modulus over the instantaneous one after a step."""
    return 1.0 - (1.0 - np.exp(-np.asarray(time)[..., None] / tau)) @ g


def after_ramp(time, ramp, g=G, tau=TAU):
    """Mean of the step response over the loading, by Gauss's quadrature in 40 parts of 10 points."""
    points, weights = np.polynomial.legendre.leggauss(10)
    edges = np.linspace(0.0, ramp, 41)
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    when = (middle[:, None] + half[:, None] * points).ravel()
    share = (half[:, None] * weights).ravel() / ramp
    return relaxed(np.asarray(time)[:, None] - when, g, tau) @ share


def at_temperatures(shift, degrees, time, *, shared, entropic=False, noise=0.0, seed=0):
    """Curves at several temperatures; with forces of their own unless ``shared``."""
    rng, curves = np.random.default_rng(seed), []
    for t in degrees:
        a = np.exp(shift.log_factor(t)[0])
        size = 800.0 if shared else 800.0 * rng.uniform(0.7, 1.3)
        if entropic:
            size *= (t - ABSOLUTE_ZERO) / (shift.reference - ABSOLUTE_ZERO)
        force = size * (relaxed(time / a) + noise * rng.normal(size=time.size))
        curves.append((time, force, t, "one" if shared else f"at {t:g}"))
    return relaxation_tests(curves)
