"""Self-affine roughness pressed against rubber: critical constriction of Persson's theory.

With the power spectrum C(q) of the heights (rms^2 = 2 pi int q C dq), the pressure p over the plane
strain modulus E* and S(q) = pi int_{q_0}^q k^3 C(k) dk, half the squared rms slope of what wavenumbers
up to q resolve, contact covers the fraction

    A(q) / A_0 = erf(p / (E* sqrt(S)))

of the nominal area (Persson, J. Chem. Phys. 115 (2001) 3840). Seen with more and more resolution, it
decreases until the open area percolates, at q_c with A / A_0 = ``PERCOLATION``. The fluid then passes
constrictions of height u_c, the separation u_1 of surfaces that lose contact at the resolution q
(Persson and Yang, J. Phys.: Condens. Matter 20 (2008) 315011):

    u_1 = u + A du/dA,
    u = sqrt(pi) int_q^{q_1} k^2 C w int_{p A_0/A}^inf [gamma + 3 (1 - gamma) P^2] exp(-s^2) dp'/p' dk,
    w = (S(k) - S(q))^(-1/2),  s = w p' / E*,  P = erf(s).

With T = S(k), tau = T - S, a = p A_0 / (A E* sqrt(tau)) and integration by parts this is one integral,
exactly (docs/theory/leak_rate.md):

    u_c = 1/sqrt(pi) int_{S_c}^{S(q_1)} M(a) dT / (k(T) sqrt(tau)),
    M(a) = I + J + kappa a^2 / (2 beta^2) (J - I),
    J(a) = [gamma + 3 (1 - gamma) erf(a)^2] exp(-a^2),  I(a) = int_a^inf J(x)/x dx,

where a = beta sqrt(S_c / tau), beta = erfinv(A/A_0) / (A/A_0), kappa = sqrt(pi) exp(e^2) / beta with
e = erfinv(A/A_0).
"""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.special import erf, erfinv, exp1

from seal_mdao import values

PERCOLATION = 0.42
"""Relative contact area below which the open area percolates: Dapp, Luecke, Persson and Mueser,
Phys. Rev. Lett. 108 (2012) 244301."""
GAMMA = 0.45
"""Factor of the elastic energy of partial contact, gamma: Lorenz and Persson, Eur. Phys. J. E 31 (2010)
159."""
LARGEST = 6.5
"""a where exp(-a^2) is below rounding."""
WIDEST = 1e9
"""Largest ratio of the longest to the shortest wavelength."""

_ERFINV = float(erfinv(PERCOLATION))
_BETA = _ERFINV / PERCOLATION
_KAPPA = np.sqrt(np.pi) * np.exp(_ERFINV**2) / _BETA
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(64)
_LAGUERRE, _LAGUERRE_WEIGHTS = np.polynomial.laguerre.laggauss(64)


@dataclass(frozen=True)
class Roughness:
    """Isotropic roughness with a power spectrum that is constant, then falls as q^(-2 (1 + H)).

    Attributes
    ----------
    rms_roughness : float
        Root-mean-square height, um.
    roll_off_wavelength, shortest_wavelength : float
        Where the spectrum begins to fall and where it ends, um.
    hurst_exponent : float
        H, above 0 and below 1.
    longest_wavelength : float, optional
        Where the spectrum begins, um; at the roll-off unless given.

    Raises
    ------
    ValueError
        For a number outside of its range, or wavelengths in the wrong order.
    """

    rms_roughness: float
    roll_off_wavelength: float
    shortest_wavelength: float
    hurst_exponent: float = 0.8
    longest_wavelength: float | None = None

    def __post_init__(self):
        for name in ("rms_roughness", "roll_off_wavelength", "shortest_wavelength"):
            values.real(name, getattr(self, name), above=0.0)
        values.real("hurst_exponent", self.hurst_exponent, above=0.0, below=1.0)
        if self.longest_wavelength is not None:
            values.real("longest_wavelength", self.longest_wavelength, above=0.0)
        shortest, roll_off, longest = ends = self.wavelengths[::-1]
        if not shortest < roll_off <= longest <= WIDEST * shortest:
            raise ValueError(
                "the wavelengths of the roughness must satisfy shortest_wavelength < "
                f"roll_off_wavelength <= longest_wavelength <= {WIDEST:g} shortest_wavelength, got "
                + ", ".join(f"{own:g}" for own in ends)
                + " um"
            )

    # ---- spectrum ----

    @property
    def wavelengths(self) -> tuple[float, float, float]:
        """The longest, that of the roll-off and the shortest, um."""
        longest = self.longest_wavelength
        roll_off = self.roll_off_wavelength
        return roll_off if longest is None else longest, roll_off, self.shortest_wavelength

    @cached_property
    def wavenumbers(self) -> tuple[float, float, float]:
        """q_0, q_r and q_1 of the longest, the roll-off and the shortest wavelength, 1/um."""
        return tuple(2.0 * np.pi / own for own in self.wavelengths)

    @cached_property
    def plateau(self) -> float:
        """C(q) between q_0 and q_r, um^4."""
        q_0, q_r, q_1 = self.wavenumbers
        # rms^2 = 2 pi int q C dq = pi C_0 [q_r^2 - q_0^2 + q_r^2 (1 - (q_r/q_1)^(2H)) / H]
        falling = -np.expm1(-2.0 * self.hurst_exponent * np.log(q_1 / q_r)) / self.hurst_exponent
        return self.rms_roughness**2 / (np.pi * (q_r**2 * (1.0 + falling) - q_0**2))

    def spectrum(self, q) -> np.ndarray:
        """Evaluate C(q) between q_0 and q_1, um^4."""
        # C = C_0 (q / q_r)^(-2 (1 + H)) for q > q_r
        ratio = np.maximum(np.asarray(q, float) / self.wavenumbers[1], 1.0)
        return self.plateau * ratio ** (-2.0 * (1.0 + self.hurst_exponent))

    def half_squared_slope(self, q) -> np.ndarray:
        """Evaluate S(q) = pi int_{q_0}^q k^3 C dk between q_0 and q_1."""
        q_0, q_r, _ = self.wavenumbers
        q, power = np.asarray(q, float), 2.0 - 2.0 * self.hurst_exponent
        # pi C_0 (q^4 - q_0^4) / 4 up to q_r, then + pi C_0 q_r^4 ((q / q_r)^(2 - 2H) - 1) / (2 - 2H)
        flat = 0.25 * (np.minimum(q, q_r) ** 4 - q_0**4)
        falling = q_r**4 * np.expm1(power * np.log(np.maximum(q / q_r, 1.0))) / power
        return np.pi * self.plateau * (flat + falling)

    def wavenumber_at(self, half_squared_slope) -> np.ndarray:
        """Evaluate q(S), the inverse of ``half_squared_slope``, 1/um."""
        q_0, q_r, _ = self.wavenumbers
        scaled = np.asarray(half_squared_slope, float) / (np.pi * self.plateau)
        power, corner = 2.0 - 2.0 * self.hurst_exponent, 0.25 * (q_r**4 - q_0**4)
        # q^4 = q_0^4 + 4 S / (pi C_0) up to q_r
        flat = (q_0**4 + 4.0 * np.minimum(scaled, corner)) ** 0.25
        beyond = np.maximum(scaled - corner, 0.0) / q_r**4
        return flat * np.exp(np.log1p(power * beyond) / power)

    @property
    def rms_slope(self) -> float:
        """Root-mean-square slope of the complete surface, (2 S(q_1))^(1/2)."""
        return float(np.sqrt(2.0 * self.half_squared_slope(self.wavenumbers[2])))

    # ---- contact ----

    def contact_area(self, ratio) -> np.ndarray:
        """Evaluate the relative contact area A / A_0 for pressures over E*, ``ratio``."""
        # erf(p / (E* sqrt(S_1))), S_1 = slope^2 / 2
        return erf(np.sqrt(2.0) * np.asarray(ratio, float) / self.rms_slope)

    @property
    def percolation_ratio(self) -> float:
        """Pressure over E* above which no open path is left."""
        return _ERFINV * self.rms_slope / np.sqrt(2.0)

    def constriction(self, ratio) -> tuple[np.ndarray, np.ndarray]:
        """Evaluate the height of the critical constriction and its derivative in the pressure over E*.

        Parameters
        ----------
        ratio : ndarray, shape (k,)
            Pressures over E*, above 0.

        Returns
        -------
        height, slope : ndarray, shape (k,)
            u_c, um, zero from ``percolation_ratio`` on, where all derivatives vanish; du_c / d(ratio).
        """
        height, slope = np.zeros((2, *np.shape(ratio)))
        # S_c = (p / (E* e))^2 where A / A_0 = PERCOLATION;  Theta = S_1 / S_c - 1
        critical = (np.asarray(ratio, float) / _ERFINV) ** 2
        total = float(self.half_squared_slope(self.wavenumbers[2]))
        # the smallest a is that of q_1: beta / sqrt(Theta)
        some = (_BETA / LARGEST) ** 2 * critical < total - critical
        height[some], by_critical = self._integral(critical[some], total)
        # dS_c/d(ratio) = 2 S_c / ratio
        slope[some] = by_critical * 2.0 * critical[some] / np.asarray(ratio)[some]
        return height, slope

    def _integral(self, critical: np.ndarray, total: float) -> tuple[np.ndarray, np.ndarray]:
        """Integrate u_c over x = ln(tau / S_c), and its derivative in S_c, shape (k,) each."""
        corner = float(self.half_squared_slope(self.wavenumbers[1]))
        # from a = LARGEST to q_1, divided at q_r, where the spectrum has a corner
        first = np.full(critical.size, 2.0 * np.log(_BETA / LARGEST))
        last = np.log(total / critical - 1.0)
        with np.errstate(divide="ignore"):
            middle = np.log(np.maximum(corner / critical - 1.0, 0.0))
        middle = np.clip(middle, first, last)
        x, weight = (
            np.concatenate(own, axis=1)
            for own in zip(_panel(first, middle), _panel(middle, last), strict=True)
        )
        # tau = S_c exp(x), T = S_c + tau, a = beta exp(-x / 2):  dT / sqrt(tau) = sqrt(tau) dx
        tau, modified = critical[:, None] * np.exp(x), separation_kernel(_BETA * np.exp(-0.5 * x))
        reached = critical[:, None] + tau
        q = self.wavenumber_at(reached)
        part = weight * np.sqrt(tau / np.pi) * modified / q
        height = part.sum(axis=1)
        # u_c = sqrt(S_c / pi) int exp(x / 2) M / q(S_c (1 + exp(x))) dx up to ln(S_1 / S_c - 1):
        # du_c/dS_c = u_c / (2 S_c) - int part (T / S_c) dq/dT / q - (upper end) S_1 / (S_c (S_1 - S_c))
        bent = reached / (np.pi * q**4 * self.spectrum(q))
        end = np.sqrt((total - critical) / np.pi) * separation_kernel(_BETA * np.exp(-0.5 * last))
        by_critical = 0.5 * height - (part * bent).sum(axis=1)
        by_critical -= end / self.wavenumbers[2] * total / (total - critical)
        return height, by_critical / critical


def _panel(first: np.ndarray, last: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Place Gauss points between limits (k,); return points and weights (k, n)."""
    half = 0.5 * (last - first)[:, None]
    return 0.5 * (first + last)[:, None] + half * _NODES, half * _WEIGHTS


def pressure_integrand(a: np.ndarray) -> np.ndarray:
    """Evaluate J(a) = [gamma + 3 (1 - gamma) erf(a)^2] exp(-a^2)."""
    return (GAMMA + 3.0 * (1.0 - GAMMA) * erf(a) ** 2) * np.exp(-(a**2))


def pressure_integral(a: np.ndarray) -> np.ndarray:
    """Evaluate I(a) = int_a^inf J(x) / x dx for a > 0."""
    square = np.asarray(a, float) ** 2
    # int_a^inf exp(-x^2) / x dx = E_1(a^2) / 2
    partial = 0.5 * GAMMA * exp1(square)
    # int_a^inf erf(x)^2 exp(-x^2) / x dx = exp(-a^2) / 2 int_0^inf exp(-v) erf(x)^2 / x^2 dv,
    # x^2 = a^2 + v: an entire function of v, by Gauss-Laguerre quadrature
    x_square = square[..., None] + _LAGUERRE
    inner = (erf(np.sqrt(x_square)) ** 2 / x_square) @ _LAGUERRE_WEIGHTS
    return partial + 1.5 * (1.0 - GAMMA) * np.exp(-square) * inner


def separation_kernel(a: np.ndarray) -> np.ndarray:
    """Evaluate M(a) = I + J + kappa a^2 / (2 beta^2) (J - I), which gives u_1 at percolation."""
    integral, integrand = pressure_integral(a), pressure_integrand(a)
    return integral + integrand + 0.5 * _KAPPA * (a / _BETA) ** 2 * (integrand - integral)
