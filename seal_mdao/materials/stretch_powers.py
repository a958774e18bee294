"""Laws of sums over powers of the principal stretches, as functions of T and J.

W = sum_p mu_p k_p [2 J^q C(c) + h(J)],   c = T / (2 J),   h'(J) = -2 q J^(-r - 1),

C of ``materials.chebyshev`` with a = alpha_p / 2. With h' of this form the undeformed state is free
of stress in the plane.
"""

from abc import abstractmethod
from copy import copy
from dataclasses import fields
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.materials.chebyshev import stretch_power
from seal_mdao.materials.isotropic import MOST_CONSTANT, NO_VALUE, STEP, Isotropic

LEAST_POWER, MOST_POWER = 1e-6, 200.0
"""Range of |alpha|: beyond it powers of moderate stretches are lost in rounding or overflow."""


class PowerTerm(NamedTuple):
    """One term of the sum, and the derivatives of k, q, r with respect to alpha.

    Attributes
    ----------
    mu, alpha : float
        Modulus and exponent.
    scale, q, r : float
        k, q and r above.
    scale_rate, q_rate, r_rate : float
        d / d alpha.
    """

    mu: float
    alpha: float
    scale: float
    q: float
    r: float
    scale_rate: float
    q_rate: float
    r_rate: float


class StretchPowers(Isotropic):
    """Base class of laws with tuples of constants, one entry per term, named ``mu_1``, ``mu_2``, ..."""

    @property
    @abstractmethod
    def terms(self) -> tuple[PowerTerm, ...]:
        """The terms of the sum."""

    @abstractmethod
    def rest(self, term: PowerTerm, log_j) -> np.ndarray:
        """Evaluate h(J) of a term, with the constant that makes the undeformed energy zero."""

    @property
    def constants(self):
        """Values by name, in the order of ``names``."""
        out = {}
        for field in fields(self):
            value = getattr(self, field.name)
            if isinstance(value, tuple):
                out |= {f"{field.name}_{i}": entry for i, entry in enumerate(value, 1)}
            else:
                out[field.name] = value
        return out

    @property
    def moduli(self):
        """Names of the constants with the unit of stress: mu_1, mu_2, ..., ``bulk_modulus``."""
        return tuple(name for name in self.names if name.startswith(("mu_", "bulk_modulus")))

    def with_(self, **constants):
        """Return the same law with other constants, by name: ``with_(mu_2=-4.0)``."""
        self._refuse_unknown(constants)
        values, changed = iter((self.constants | constants).values()), {}
        for field in fields(self):
            old = getattr(self, field.name)
            many = isinstance(old, tuple)
            changed[field.name] = tuple(next(values) for _ in old) if many else next(values)
        return type(self)(**changed)

    def _stepped(self, name):
        if name in vars(self):
            return super()._stepped(name)
        other, (field, number) = copy(self), name.rsplit("_", 1)
        entries = list(getattr(self, field))
        # complex step in one entry of the tuple
        entries[int(number) - 1] += 1j * STEP
        object.__setattr__(other, field, tuple(entries))
        return other

    @np.errstate(**NO_VALUE)
    def energy(self, t, j):
        """Evaluate the strain energy density W, shape of ``t``."""
        v, log_j = _variables(t, j)
        # W = sum mu k [2 J^q C(1 + v) + h(J)]
        return sum(
            m.mu * m.scale
            * (2.0 * np.exp(m.q * log_j) * stretch_power(v, 0.5 * m.alpha, 1)[0] + self.rest(m, log_j))
            for m in self.terms
        )  # fmt: skip

    @np.errstate(**NO_VALUE)
    def derivatives(self, t, j):
        """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...)."""
        v, log_j = _variables(t, j)
        # sum mu k (E_T, E_J, E_TT, E_TJ, E_JJ)
        return sum(m.mu * m.scale * _term_derivatives(m, v, log_j, j) for m in self.terms)

    @np.errstate(**NO_VALUE)
    def constant_derivatives(self, t, j):
        """Evaluate d(W_T, W_J) / d constant: all mu, all alpha, then ``further_constants``."""
        v, log_j = _variables(t, j)
        by_mu, by_alpha = [], []
        for m in self.terms:
            # d/dmu = k E,  d/dalpha = mu (k' E + k E')  with the bracket E = 2 J^q C + h
            first, rate = _term_rates(m, v, log_j, j)
            by_mu.append(m.scale * first)
            by_alpha.append(m.mu * (m.scale_rate * first + m.scale * rate))
        return np.array([*by_mu, *by_alpha, *self.further_constants(log_j, j)])

    @abstractmethod
    def further_constants(self, log_j, j) -> list[np.ndarray]:
        """Evaluate d(W_T, W_J) / d constant, (2, ...) each, of the constants after mu and alpha."""


def _variables(t, j):
    """Compute v = c - 1 = (T - 2 J) / (2 J) and ln J."""
    j = np.asarray(j)
    return (t - 2.0 * j) / (2.0 * j), np.log(j)


def _term_derivatives(m, v, log_j, j):
    """Differentiate E = 2 J^q C + h: by T, J, TT, TJ, JJ."""
    C, C1, C2 = stretch_power(v, 0.5 * m.alpha)
    c, swell, balance = 1.0 + v, np.exp(m.q * log_j), np.exp(-m.r * log_j)
    # c_T = 1 / (2 J),  c_J = -c / J,  h' = -2 q J^(-r - 1):
    # E_T = J^q C' / J,   E_J = [2 q (J^q C - J^-r) - 2 J^q c C'] / J
    # E_TT = J^q C'' / (2 J^2),   E_TJ = J^q [(q - 1) C' - c C''] / J^2
    # E_JJ = {J^q [2 q (q - 1) C - 4 (q - 1) c C' + 2 c^2 C''] + 2 q (r + 1) J^-r} / J^2
    q = m.q
    return np.array(
        [
            swell * C1 / j,
            (2.0 * q * (swell * C - balance) - 2.0 * swell * c * C1) / j,
            0.5 * swell * C2 / (j * j),
            swell * ((q - 1.0) * C1 - c * C2) / (j * j),
            (
                swell * (2.0 * q * (q - 1.0) * C - 4.0 * (q - 1.0) * c * C1 + 2.0 * c * c * C2)
                + 2.0 * q * (m.r + 1.0) * balance
            )
            / (j * j),
        ]
    )


def _term_rates(m, v, log_j, j):
    """Evaluate E_T, E_J of E = 2 J^q C + h, and their derivatives with respect to alpha."""
    C, C1, _, C_a, C1_a = stretch_power(v, 0.5 * m.alpha, 5)
    c, swell, balance = 1.0 + v, np.exp(m.q * log_j), np.exp(-m.r * log_j)
    q, grow = m.q, m.q_rate * log_j
    # d/dalpha of J^q C, J^q C' and J^-r;  a = alpha / 2, hence 1/2 dC/da
    power, slope = swell * (grow * C + 0.5 * C_a), swell * (grow * C1 + 0.5 * C1_a)
    balance_rate = -m.r_rate * log_j * balance
    # J E_T and J E_J, then their derivatives; J and c do not depend on alpha
    first = [swell * C1, 2.0 * q * (swell * C - balance) - 2.0 * swell * c * C1]
    rate = [
        slope,
        2.0 * m.q_rate * (swell * C - balance) + 2.0 * q * (power - balance_rate) - 2.0 * c * slope,
    ]
    return np.array(first) / j, np.array(rate) / j


def checked_terms(material, names: tuple[str, ...]) -> None:
    """Convert the tuples ``names`` of a law to tuples of floats and validate the terms.

    Raises
    ------
    ValueError
        With the name of the constant.
    """
    kind = type(material).__name__
    for name in names:
        given = values.numbers(f"{name} of {kind}", getattr(material, name))
        constants = tuple(given.ravel().tolist())
        object.__setattr__(material, name, constants)
        for i, value in enumerate(constants, 1):
            values.real(f"{name}_{i} of {kind}", value, -MOST_CONSTANT, MOST_CONSTANT)
            if name == "alpha" and not LEAST_POWER <= abs(value) <= MOST_POWER:
                raise ValueError(
                    f"alpha_{i} of {kind} must have a magnitude between {LEAST_POWER:g} and "
                    f"{MOST_POWER:g}, got {value:g}"
                )
    counts = {name: len(getattr(material, name)) for name in names}
    if len(set(counts.values())) > 1 or 0 in counts.values():
        raise ValueError(
            f"{kind} needs equally many values of {' and '.join(names)}, at least one of each, got "
            f"{counts}"
        )
