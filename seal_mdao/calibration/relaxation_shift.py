"""Fit of the shift of relaxation times with the temperature, by the laws of ``materials.viscoelastic``.

The times of all Prony terms at the temperature T are a(T) times those at the reference T_r
(thermorheologically simple rubber; J. D. Ferry, Viscoelastic Properties of Polymers, chapter 11).
"""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import scipy

from seal_mdao.materials import viscoelastic

LARGEST_C1, LARGEST_C2, LARGEST_ENERGY = 1e3, 1e4, 1e3
"""Bounds of the constants; c2 in K, energy in kJ/mol."""
POLE = 1.0
"""Smallest distance (K) of the lowest tested temperature from the pole of the WLF equation."""


@dataclass(frozen=True)
class Shift:
    """Shift function with its constants.

    Attributes
    ----------
    constants : tuple of float
        In the order of ``names``.
    reference : float
        Reference temperature, degrees Celsius.
    law : type
        Of ``materials.viscoelastic``; takes the constants and the reference.
    """

    constants: tuple
    reference: float

    name: ClassVar[str] = ""
    names: ClassVar[tuple] = ()
    law: ClassVar[type]

    def log_factor(self, temperature: float) -> tuple[float, np.ndarray]:
        """Evaluate ln a and its derivatives in the constants, shape (k,)."""
        law = self.law(*self.constants, self.reference)
        value, rates = law.log_factor(temperature)
        return float(value), np.array([rates[name] for name in law.constants], float)

    @classmethod
    def bounds(cls, reference: float, temperatures) -> tuple[list, list]:
        """Compute lower and upper bounds of the constants for tests at these temperatures."""
        raise NotImplementedError

    def table(self) -> dict:
        """Return the keys of the seal file."""
        return {**dict(zip(self.names, self.constants, strict=True)), "reference": self.reference}


class Arrhenius(Shift):
    """Shift function of Arrhenius; its constant is the activation energy in kJ/mol."""

    name, names, law = "arrhenius", ("activation_energy",), viscoelastic.Arrhenius

    @classmethod
    def bounds(cls, reference, temperatures):
        return [0.0], [LARGEST_ENERGY]


class Wlf(Shift):
    """Shift function of Williams, Landel and Ferry; its constants are c1, and c2 in K."""

    name, names, law = "wlf", ("c1", "c2"), viscoelastic.WilliamsLandelFerry

    @classmethod
    def bounds(cls, reference, temperatures):
        # c2 + T - T_r > 0 at all tested temperatures
        return [0.0, reference - min(reference, *temperatures) + POLE], [LARGEST_C1, LARGEST_C2]


SHIFTS = {own.name: own for own in (Wlf, Arrhenius)}


def fit_shift(kind: type[Shift], reference: float, temperatures, logs, weights) -> tuple:
    """Fit a shift function to factors of single temperatures by weighted least squares.

    Parameters
    ----------
    kind : type
        ``Wlf`` or ``Arrhenius``.
    reference : float
    temperatures, logs : array_like, shape (m,)
        Temperatures other than the reference, and ln a there.
    weights : array_like, shape (m, m)
        W, the inverse of the covariance of ``logs``.

    Returns
    -------
    shift : Shift
    cost : float
        r^T W r.
    """
    logs = np.asarray(logs, float)
    lower, upper = map(np.array, kind.bounds(reference, temperatures))
    # W = L L^T: minimise |L^T r|^2
    root = np.linalg.cholesky(weights).T

    def both(x):
        made = kind(tuple(x), reference)
        values, slopes = zip(*map(made.log_factor, temperatures), strict=True)
        # L^T (ln a(T_i) - logs_i) and its derivatives
        return root @ (np.array(values) - logs), root @ np.array(slopes)

    # the universal constants of Williams, Landel and Ferry, or 100 kJ/mol
    best = None
    for start in ([17.44, 51.6], [8.86, 101.6], [5.0, 300.0]) if kind is Wlf else ([100.0],):
        inside = np.clip(start, lower + 1e-3 * POLE, upper)
        found = scipy.optimize.least_squares(
            lambda x: both(x)[0], inside, lambda x: both(x)[1], bounds=(lower, upper), x_scale="jac",
            max_nfev=1000, xtol=1e-12, ftol=1e-12, gtol=1e-12,
        )  # fmt: skip
        if best is None or found.cost < best.cost:
            best = found
    return kind(tuple(best.x.tolist()), reference), 2.0 * float(best.cost)
