"""Force of a relaxation test by the Prony series, with derivatives in its constants.

At a constant stretch, the stress of an incompressible rubber with the law of finite linear
viscoelasticity (J. C. Simo, Comput. Methods Appl. Mech. Engrg. 60 (1987) 153) is

    P(t) = P_long (1 + sum_i beta_i psi_i(t)),    psi_i = exp(-t/theta_i),    theta_i = a(T) tau_i,

with beta_i = g_i / (1 - sum g), at every stretch and in every mode. A loading at a constant rate during
t_r, rather than a step, changes the decaying functions of small strains to

    psi_i = exp(-(t - t_r)/theta_i) (1 - exp(-z)) / z,    z = t_r/theta_i,    t >= t_r.

Unknowns are the parts e_0 = P_long and e_i = P_long beta_i of the force, ln tau_i, the shift, and the
ratios of the forces of different tests. Forces are divided by the largest of their test.
"""

from dataclasses import dataclass, field

import numpy as np

from seal_mdao.calibration.relaxation_data import RelaxationTests
from seal_mdao.calibration.relaxation_shift import Shift
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO

WIDEST = 0.25 * np.log(10.0)
"""Largest interval of ln t that one reading stands for."""


def decay(time: np.ndarray, theta: np.ndarray, ramp: float) -> tuple[np.ndarray, np.ndarray]:
    """Evaluate psi and d psi/d ln theta of relaxation after a ramp.

    Parameters
    ----------
    time, theta : ndarray
        Arrays that broadcast, s; times of at least ``ramp``.
    ramp : float
        Duration of the loading; 0 for a step.
    """
    held, z = (time - ramp) / theta, ramp / theta
    after, during = np.exp(-held), np.exp(-z)
    # phi(z) = (1 - exp(-z)) / z, 1 at z = 0;  d phi/d ln theta = phi - exp(-z)
    small = z == 0.0
    phi = np.where(small, 1.0, -np.expm1(-z) / np.where(small, 1.0, z))
    psi = after * phi
    # d exp(-held)/d ln theta = held exp(-held)
    return psi, held * psi + after * (phi - during)


def log_weights(time: np.ndarray) -> np.ndarray:
    """Compute the interval of ln t that every reading represents, at most a quarter of a decade.

    So a decade of time has the same weight whether a logger took ten readings in it or a thousand.
    """
    log = np.log(time)
    # from middle to middle of the neighbours in ln t
    middle = np.concatenate([log[:1], 0.5 * (log[1:] + log[:-1]), log[-1:]])
    return np.minimum(np.diff(middle), WIDEST)


@dataclass(frozen=True, eq=False)
class PronyModel:
    """Forces of all readings as a function of the unknowns.

    The unknowns are ordered as e_0, e_1 to e_n, ln tau_1 to ln tau_n (unless given), constants of the
    shift, ratios of tests.

    Attributes
    ----------
    tests : RelaxationTests
    terms : int
        Number n of Prony terms.
    reference : float or None
        Reference temperature; None where no temperatures were given.
    shift : "free", a subclass of Shift, or None
        ``"free"`` has ln a of every temperature but the reference as an unknown.
    entropic : bool
        Whether moduli are in proportion to the absolute temperature.
    log_tau : ndarray, shape (n,), or None
        Given ln tau.
    """

    tests: RelaxationTests
    terms: int
    reference: float | None = None
    shift: object = None
    entropic: bool = False
    log_tau: np.ndarray | None = None

    time: np.ndarray = field(init=False)
    force: np.ndarray = field(init=False)
    weight: np.ndarray = field(init=False)
    curve: np.ndarray = field(init=False)

    def __post_init__(self):
        curves = self.tests.curves
        size = dict.fromkeys(self.tests.scales, 0.0)
        for scale, own in zip(self.tests.scales, curves, strict=True):
            size[scale] = max(size[scale], own.force.max())
        # forces over the largest one of their test
        force = [c.force / size[k] for k, c in zip(self.tests.scales, curves, strict=True)]
        weight = np.concatenate([log_weights(own.time) for own in curves])
        put = object.__setattr__
        put(self, "time", np.concatenate([own.time for own in curves]))
        put(self, "force", np.concatenate(force))
        put(self, "weight", weight / weight.mean())
        put(self, "curve", np.repeat(np.arange(len(curves)), [own.time.size for own in curves]))

    @property
    def shifted(self) -> tuple[float, ...]:
        """Temperatures other than the reference."""
        return tuple(t for t in self.tests.temperatures if t != self.reference)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the unknowns."""
        numbers = range(1, self.terms + 1)
        taus = () if self.log_tau is not None else tuple(f"ln_tau_{i}" for i in numbers)
        if self.shift == "free":
            shift = tuple(f"ln_a_{t:g}" for t in self.shifted)
        else:
            shift = self.shift.names if self.shift else ()
        ratios = tuple(f"ratio_{i}" for i in range(1, max(self.tests.scales) + 1))
        return ("e_0", *(f"e_{i}" for i in numbers), *taus, *shift, *ratios)

    def split(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Split the unknowns: e (n + 1,), ln tau (n,), constants of the shift, ratios of tests."""
        n, ratios = self.terms, max(self.tests.scales)
        rest = x[n + 1 : x.size - ratios]
        log_tau, shift = (rest[:n], rest[n:]) if self.log_tau is None else (self.log_tau, rest)
        return x[: n + 1], log_tau, shift, x[x.size - ratios :]

    def log_factors(self, shift: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate ln a of every curve (c,) and its derivatives in the constants (c, k)."""
        curves = self.tests.curves
        values, slopes = np.zeros(len(curves)), np.zeros((len(curves), shift.size))
        made = None
        if isinstance(self.shift, type) and issubclass(self.shift, Shift):
            made = self.shift(tuple(shift), self.reference)
        for i, own in enumerate(curves):
            if made is not None:
                values[i], slopes[i] = made.log_factor(own.temperature)
            elif self.shift == "free" and own.temperature != self.reference:
                k = self.shifted.index(own.temperature)
                # ln a is the unknown itself
                values[i], slopes[i, k] = shift[k], 1.0
        return values, slopes

    def modulus_factors(self) -> np.ndarray:
        """Evaluate the factor of the moduli of every curve, T/T_r of absolute temperatures or 1."""
        if not self.entropic:
            return np.ones(len(self.tests.curves))
        zero = self.reference - ABSOLUTE_ZERO
        return np.array([(own.temperature - ABSOLUTE_ZERO) / zero for own in self.tests.curves])

    def evaluate(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate the scaled forces (m,) and their derivatives in the unknowns (m, k)."""
        e, log_tau, shift, ratios = self.split(x)
        log_a, slope_a = self.log_factors(shift)
        scale = np.array(self.tests.scales)
        q, m = np.append(1.0, ratios)[scale], self.modulus_factors()
        # theta_i = a tau_i, one row per reading
        theta = np.exp(log_tau + log_a[self.curve][:, None])
        psi, slope = decay(self.time[:, None], theta, self.tests.ramp)
        size = (q * m)[self.curve]
        # f = q m (e_0 + sum e_i psi_i)
        relaxed, by_theta = e[0] + psi @ e[1:], slope * e[1:]
        columns = [size[:, None], size[:, None] * psi]
        if self.log_tau is None:
            columns.append(size[:, None] * by_theta)
        # every theta changes with a: df/ds = q m sum e_i (d psi_i/d ln theta_i) d ln a/ds
        columns.append((size * by_theta.sum(1))[:, None] * slope_a[self.curve])
        # df/dq of the reading's own test: m (e_0 + sum e_i psi_i)
        own = scale[self.curve][:, None] == np.arange(1, ratios.size + 1)
        columns.append((m[self.curve] * relaxed)[:, None] * own)
        return size * relaxed, np.concatenate(columns, axis=1)

    def residuals(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate sqrt(w) (f - data) and its derivatives."""
        values, slopes = self.evaluate(x)
        # r = sqrt(w) (f - y)
        root = np.sqrt(self.weight)
        return root * (values - self.force), root[:, None] * slopes
