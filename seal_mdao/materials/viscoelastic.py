"""Relaxation of rubber: Prony series of finite linear viscoelasticity, shifted by the temperature.

With the second Piola-Kirchhoff stress S of the law (of a nearly incompressible one its isochoric part),
every term (g_i, tau_i) has a stress Q_i that decays,

    Q_i+ = exp(-xi / tau_i) Q_i + beta_i exp(-xi / (2 tau_i)) (S+ - S),    P = e F S+ + F sum_i Q_i+,

xi = dt / a_T the reduced time of a step. The constants of the law are those of

    long times      e = 1,                beta_i = g_i / (1 - sum g)
    short times     e = 1 - sum g,        beta_i = g_i

so that a fast strain meets (e + sum beta) S and a held one e S. J. C. Simo, Comput. Methods Appl. Mech.
Eng. 60, 1987; G. A. Holzapfel, Nonlinear Solid Mechanics, 2000, section 6.10. g_i are those of a Prony
series of Abaqus, relative to the modulus of short times.
"""

import math
from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np

from seal_mdao import values

GAS_CONSTANT = 8.314462618
"""J/(mol K)."""
ABSOLUTE_ZERO = -273.15
"""Degrees Celsius."""


def unit_of(name: str) -> str | None:
    """Unit of a constant of ``PronySeries``, as OpenMDAO writes it."""
    others = {"wlf_c2": "degK", "activation_energy": "kJ/mol"}
    return "s" if name.startswith("tau_") else others.get(name)


class _Shift:
    """Factor a_T of all relaxation times over the temperature; a frozen dataclass of its constants."""

    @property
    def constants(self) -> dict[str, float]:
        """Values of the parameters by name; the temperature of reference is none."""
        return {f.name: getattr(self, f.name) for f in fields(self) if f.name != "reference"}


@dataclass(frozen=True)
class WilliamsLandelFerry(_Shift):
    """log10 a_T = -c1 (T - T_r) / (c2 + T - T_r), for temperatures up to about 100 K above the glass
    transition.

    Attributes
    ----------
    wlf_c1, wlf_c2 : float
        c1, and c2 in K.
    reference : float
        T_r, degrees Celsius.
    """

    wlf_c1: float
    wlf_c2: float
    reference: float

    def log_factor(self, temperature: np.ndarray) -> tuple[np.ndarray, dict]:
        """Evaluate ln a_T and its derivatives, by the constants and ``temperature`` (degrees Celsius).

        Raises
        ------
        ValueError
            For a temperature at or below T_r - c2, where the law ends.
        """
        beyond = np.asarray(temperature, float) - self.reference
        below = self.wlf_c2 + beyond
        if np.any(below <= 0.0):
            raise ValueError(
                f"the WLF law is valid only above {self.reference - self.wlf_c2:g} degC (reference "
                f"- c2), but the temperature is {np.min(temperature):g} degC; raise the "
                "temperature or use arrhenius"
            )
        # ln a = -ln 10 c1 x / (c2 + x)
        log = -math.log(10.0) * self.wlf_c1 * beyond / below
        rates = {
            "wlf_c1": -math.log(10.0) * beyond / below,
            "wlf_c2": -log / below,
            "temperature": -math.log(10.0) * self.wlf_c1 * self.wlf_c2 / below**2,
        }
        return log, rates


@dataclass(frozen=True)
class Arrhenius(_Shift):
    """ln a_T = (E / R) (1 / T - 1 / T_r) of absolute temperatures.

    Attributes
    ----------
    activation_energy : float
        E, kJ/mol.
    reference : float
        T_r, degrees Celsius.
    """

    activation_energy: float
    reference: float

    def log_factor(self, temperature: np.ndarray) -> tuple[np.ndarray, dict]:
        """Evaluate ln a_T and its derivatives, by the constant and ``temperature`` (degrees Celsius)."""
        # ln a = (E / R) (1 / T - 1 / T_r), d ln a/dT = -(E / R) / T^2, E in kJ/mol
        absolute = np.asarray(temperature, float) - ABSOLUTE_ZERO
        difference = 1.0 / absolute - 1.0 / (self.reference - ABSOLUTE_ZERO)
        scale = 1e3 / GAS_CONSTANT
        rates = {
            "activation_energy": scale * difference,
            "temperature": -scale * self.activation_energy / absolute**2,
        }
        return scale * self.activation_energy * difference, rates


class StepCoefficients(NamedTuple):
    """Coefficients of K load steps, or their derivatives in one parameter.

    Attributes
    ----------
    factor : ndarray, shape (K,)
        e + sum_i beta_i exp(-xi / (2 tau_i)), of the stress of the law.
    keep, take : ndarray, shape (N, K)
        exp(-xi / tau_i), and beta_i exp(-xi / (2 tau_i)).
    """

    factor: np.ndarray
    keep: np.ndarray
    take: np.ndarray


@dataclass(frozen=True)
class PronySeries:
    """Relaxation of one material.

    Attributes
    ----------
    g : tuple of float
        Part of the modulus of short times that relaxes with every time.
    tau : tuple of float
        Relaxation times, s.
    instantaneous : bool
        Whether the law's constants are those of short times, and not those of long ones.
    shift : WilliamsLandelFerry or Arrhenius, optional
        Factor of the times over the temperature; 1 unless given.

    Raises
    ------
    ValueError
        For negative parts, or a sum of at least 1; for times that are not positive, or as many of them
        as of parts.
    """

    g: tuple[float, ...]
    tau: tuple[float, ...]
    instantaneous: bool = False
    shift: WilliamsLandelFerry | Arrhenius | None = None

    def __post_init__(self):
        for name in ("g", "tau"):
            own = values.numbers(f"{name} of a Prony series", getattr(self, name))
            object.__setattr__(self, name, tuple(float(value) for value in np.ravel(own)))
        if len(self.g) != len(self.tau) or not self.g:
            raise ValueError(
                "a Prony series needs one relaxation time tau for every relative modulus g, and at "
                f"least one term, got {len(self.g)} g and {len(self.tau)} tau"
            )
        if min(self.g) < 0.0 or not sum(self.g) < 1.0:
            raise ValueError(
                "the relative moduli g of a Prony series must not be negative and their sum must "
                f"be below 1 (1 - sum(g) is the long-term modulus), got g = {list(self.g)} with "
                f"the sum {sum(self.g):g}"
            )
        if not min(self.tau) > 0.0 or not math.isfinite(max(self.tau)):
            raise ValueError(
                "the relaxation times tau of a Prony series must be finite and above 0 s, got "
                f"{list(self.tau)}"
            )

    @property
    def constants(self) -> dict[str, float]:
        """Parameters by name: ``g_1``, ..., ``tau_1``, ..., and those of the shift."""
        own = {f"g_{i}": value for i, value in enumerate(self.g, 1)}
        own |= {f"tau_{i}": value for i, value in enumerate(self.tau, 1)}
        return own if self.shift is None else own | self.shift.constants

    def with_(self, **constants) -> "PronySeries":
        """Return the same series with some of the ``constants`` changed."""
        own, shift = self.constants | constants, self.shift
        if shift is not None:
            shift = replace(shift, **{name: own[name] for name in shift.constants})
        count = range(1, len(self.g) + 1)
        g, tau = (tuple(own[f"{name}_{i}"] for i in count) for name in ("g", "tau"))
        return replace(self, g=g, tau=tau, shift=shift)

    @property
    def short_time_factor(self) -> float:
        """Stress of a fast strain over that of the law, e + sum beta."""
        return 1.0 if self.instantaneous else 1.0 / (1.0 - sum(self.g))

    def _long(self) -> tuple[float, np.ndarray]:
        # e, beta
        left, g = 1.0 - sum(self.g), np.array(self.g)
        return (left, g) if self.instantaneous else (1.0, g / left)

    def _long_rates(self, i: int) -> tuple[float, np.ndarray]:
        """Differentiate e and beta in g_i, counted from 0."""
        # constants of short times: e' = -1, beta_j' = delta_ij
        beta_rate = np.zeros(len(self.g))
        beta_rate[i] = 1.0
        if self.instantaneous:
            return -1.0, beta_rate
        # of long times: e = 1, beta_j' = (delta_ij + beta_j) / (1 - sum g)
        return 0.0, (beta_rate + self._long()[1]) / (1.0 - sum(self.g))

    def _reduced(self, duration, temperature):
        """Compute xi and the derivatives of its logarithm."""
        duration = np.asarray(duration, float)
        if self.shift is None:
            return duration, {}
        log, rates = self.shift.log_factor(temperature)
        # xi = dt / a_T,  d ln xi = -d ln a
        return duration * np.exp(-log), {name: -rate for name, rate in rates.items()}

    def relaxed(self, duration: np.ndarray, temperature: np.ndarray) -> tuple[float, dict]:
        """Compute the relaxation function over the modulus of the law, R = e + sum_i beta_i
        exp(-sum xi / tau_i), after K steps of ``duration`` and ``temperature`` (K,), as of ``step``.

        Returns
        -------
        float
            Stress of a strain that is kept since the first step, over that of the law.
        dict
            Derivatives of R in every constant (float), and in ``duration`` and ``temperature`` (K,).
        """
        (xi, by_log), (long, beta) = self._reduced(duration, temperature), self._long()
        tau, total = np.array(self.tau), xi.sum()
        decayed = np.exp(-total / tau)
        factor = float(long + beta @ decayed)
        # dR/d(sum xi) = -sum_i beta_i exp(-sum xi / tau_i) / tau_i
        by_total = -float(beta @ (decayed / tau))
        rates = {name: by_total * (xi * rate) for name, rate in by_log.items()}
        heat = {"temperature": rates.pop("temperature")} if "temperature" in rates else {}
        out = {name: float(rate.sum()) for name, rate in rates.items()}
        # d xi/d(dt) = 1 / a_T
        unshifted = np.ones_like(xi)
        if self.shift is not None:
            unshifted = np.exp(-self.shift.log_factor(temperature)[0])
        for i, own in enumerate(self.tau):
            # dR/dtau_i = beta_i exp(-sum xi / tau_i) sum xi / tau_i^2
            out[f"tau_{i + 1}"] = float(beta[i] * decayed[i] * total / own**2)
            long_rate, beta_rate = self._long_rates(i)
            out[f"g_{i + 1}"] = float(long_rate + beta_rate @ decayed)
        return factor, out | heat | {"duration": by_total * unshifted}

    def step(self, duration: np.ndarray, temperature: np.ndarray) -> StepCoefficients:
        """Compute the coefficients of K steps.

        Parameters
        ----------
        duration : ndarray, shape (K,)
            dt, s.
        temperature : ndarray, shape (K,)
            In the middle of every step, degrees Celsius.
        """
        (xi, _), (long, beta) = self._reduced(duration, temperature), self._long()
        # exp(-xi / (2 tau_i)): b_i = beta_i times it, a_i is its square, k = e + sum b_i
        half = np.exp(-0.5 * xi / np.array(self.tau)[:, None])
        take = beta[:, None] * half
        return StepCoefficients(long + take.sum(axis=0), half * half, take)

    def step_rates(self, duration, temperature) -> dict[str, StepCoefficients]:
        """Differentiate ``step`` in every constant, and in ``duration`` and ``temperature``."""
        own, (xi, by_log) = self.step(duration, temperature), self._reduced(duration, temperature)
        tau, none = np.array(self.tau)[:, None], np.zeros_like(own.keep)
        # of keep and take in xi: -keep / tau, -take / (2 tau)
        keep, take = -own.keep / tau, -0.5 * own.take / tau
        # dxi/d(dt) = 1 / a_T, xi dlnxi of temperature and constants of the shift
        ratio = np.divide(xi, duration, out=np.ones_like(xi), where=np.asarray(duration) > 0.0)
        if self.shift is not None:
            ratio = np.exp(-self.shift.log_factor(temperature)[0])
        by_xi = {"duration": ratio} | {name: xi * rate for name, rate in by_log.items()}
        out = {
            name: StepCoefficients((take * rate).sum(axis=0), keep * rate, take * rate)
            for name, rate in by_xi.items()
        }
        half = np.exp(-0.5 * xi / tau)
        for i in range(len(self.g)):
            # of tau_i: -xi / tau_i times those of xi
            of_keep, of_take = none.copy(), none.copy()
            of_keep[i], of_take[i] = -xi / self.tau[i] * keep[i], -xi / self.tau[i] * take[i]
            out[f"tau_{i + 1}"] = StepCoefficients(of_take.sum(axis=0), of_keep, of_take)
            # of g_i: those of e and beta
            long_rate, beta_rate = self._long_rates(i)
            of_take = beta_rate[:, None] * half
            out[f"g_{i + 1}"] = StepCoefficients(long_rate + of_take.sum(axis=0), none, of_take)
        return out
