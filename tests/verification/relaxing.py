"""Homogeneous states of a viscoelastic Mooney-Rivlin block, independent of the package.

Finite linear viscoelasticity (J. C. Simo, Comput. Methods Appl. Mech. Engrg. 60 (1987) 153; G. A.
Holzapfel, Nonlinear Solid Mechanics, 6.10) with the long-term constants c10, c01, K:

    P   = F (S_iso + sum_i Q_i) + K (J - 1) J F^-T
    Q_i = beta_i int exp(-(t - s)/tau_i) dS_iso(s)/ds ds,    beta_i = g_i / (1 - sum g)

in three dimensions, with the isochoric second Piola-Kirchhoff stress

    S_iso = 2 c10 J^(-2/3) (1 - I1/3 C^-1) + 2 c01 J^(-4/3) (I1 1 - C - 2/3 I2 C^-1).

Every history begins at rest; a first stretch other than that of the undeformed body is a step at the
first time. Stresses are in the unit of c10, times in s.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np
import scipy

ONE = np.eye(3)


class Rubber(NamedTuple):
    """Long-term constants, bulk modulus (infinite: incompressible) and Prony series."""

    c10: float
    c01: float
    bulk: float
    g: tuple
    tau: tuple

    @property
    def beta(self) -> np.ndarray:
        """g_i / (1 - sum g), shape (n,)."""
        return np.array(self.g) / (1.0 - sum(self.g))

    def instantaneous(self) -> "Rubber":
        """The elastic rubber of very fast loading."""
        factor = 1.0 / (1.0 - sum(self.g))
        return self._replace(c10=factor * self.c10, c01=factor * self.c01, g=(), tau=())

    def long_term(self) -> "Rubber":
        """The elastic rubber of very slow loading."""
        return self._replace(g=(), tau=())


def isochoric_stress(rubber: Rubber, F: np.ndarray) -> np.ndarray:
    """Evaluate S_iso of deformation gradients (..., 3, 3)."""
    C, J = np.swapaxes(F, -1, -2) @ F, np.linalg.det(F)[..., None, None]
    inverse = np.linalg.inv(C)
    first = np.trace(C, axis1=-2, axis2=-1)[..., None, None]
    second = 0.5 * (first**2 - np.sum(C * C, axis=(-2, -1))[..., None, None])
    return 2.0 * rubber.c10 * J ** (-2.0 / 3.0) * (ONE - first / 3.0 * inverse) + 2.0 * (
        rubber.c01 * J ** (-4.0 / 3.0) * (first * ONE - C - 2.0 / 3.0 * second * inverse)
    )


def nominal(rubber: Rubber, F, viscous) -> np.ndarray:
    """Evaluate P = F (S_iso + sum Q) + K (J - 1) J F^-T, without the pressure if incompressible."""
    P = F @ (isochoric_stress(rubber, F) + viscous)
    if np.isfinite(rubber.bulk):
        J = np.linalg.det(F)
        P = P + rubber.bulk * (J - 1.0) * J * np.linalg.inv(F).T
    return P


def advance(rubber: Rubber, Q, S, new, dt: float) -> np.ndarray:
    """Advance the overstresses Q (n, ..., 3, 3) by the recursion of second order over a step."""
    shape = (-1,) + (1,) * np.ndim(S)
    tau, beta = np.array(rubber.tau).reshape(shape), rubber.beta.reshape(shape)
    return np.exp(-dt / tau) * Q + beta * np.exp(-0.5 * dt / tau) * (new - S)


# ---- states ----


class State(NamedTuple):
    """Homogeneous state: F of an imposed stretch (or shear) and a free stretch, the loaded component of
    P, the number of loaded directions, and the free stretch at constant volume."""

    name: str
    gradient: object
    loaded: tuple
    directions: int
    isochoric: object


UNIAXIAL = State(
    "uniaxial", lambda s, x: np.diag([s, x, x]), (0, 0), 1, lambda s: s**-0.5
)  # fmt: skip
PLANE_STRAIN = State(
    "plane strain", lambda s, x: np.diag([s, x, 1.0]), (0, 0), 1, lambda s: 1.0 / s
)
EQUIBIAXIAL = State(
    "equibiaxial, axisymmetric", lambda s, x: np.diag([s, x, s]), (0, 0), 2, lambda s: s**-2.0
)  # fmt: skip
SHEAR = State(
    "simple shear", lambda s, x: ONE + s * np.outer(ONE[0], ONE[1]), (0, 1), 1, None
)  # fmt: skip
STATES = {own.name: own for own in (UNIAXIAL, PLANE_STRAIN, EQUIBIAXIAL, SHEAR)}


def balanced(rubber: Rubber, state: State, stretch: float, viscous, start: float):
    """Solve P_22 = 0 for the free stretch; return F, the loaded component of P, and the stretch.

    ``viscous(F)`` is the sum of the overstresses.
    """
    if state.isochoric is None:
        F = state.gradient(stretch, 1.0)
        return F, nominal(rubber, F, viscous(F))[state.loaded], 1.0
    x = start
    if np.isinf(rubber.bulk):
        x = state.isochoric(stretch)
    else:

        def across(x):
            F = state.gradient(stretch, x)
            return nominal(rubber, F, viscous(F))[1, 1]

        # Newton-Raphson with a slope by differences
        for _ in range(30):
            step = 1e-6
            change = across(x) * 2.0 * step / (across(x + step) - across(x - step))
            x -= change
            if abs(change) < 1e-13:
                break
    F = state.gradient(stretch, x)
    P = nominal(rubber, F, viscous(F))
    # the pressure that makes P_22 zero, which also takes the rounding of K (J - 1) away
    return F, P[0, 0] - P[1, 1] * x / stretch, x


# ---- histories of the stretch ----


class History(NamedTuple):
    """Stretch or shear that is linear between corners; the first value is reached by a step."""

    times: tuple
    values: tuple

    def at(self, time):
        """Stretch at a time after the step."""
        return np.interp(time, self.times, self.values)


def recursion(rubber: Rubber, state: State, times, stretches) -> np.ndarray:
    """Compute the loaded component of P at all times by the recursion, shape (m,)."""
    Q, S, x, found, last = np.zeros((len(rubber.tau), 3, 3)), np.zeros((3, 3)), 1.0, [], times[0]
    for time, stretch in zip(times, stretches, strict=True):

        def viscous(F, old=Q, before=S, dt=time - last):
            return advance(rubber, old, before, isochoric_stress(rubber, F), dt).sum(0)

        F, P, x = balanced(rubber, state, stretch, viscous, x)
        new = isochoric_stress(rubber, F)
        Q, S, last = advance(rubber, Q, S, new, time - last), new, time
        found.append(P)
    return np.array(found)


def convolution(rubber: Rubber, state: State, history: History, times) -> np.ndarray:
    """Compute the loaded component of P at all times from the convolution, shape (m,).

    By parts, Q_i = beta_i S_iso - A_i with the integral A_i = beta_i/tau_i int exp(-(t - s)/tau_i)
    S_iso(s) ds, which obeys dA_i/dt = (beta_i S_iso - A_i)/tau_i. The free stretch follows from P_22 = 0
    at every time. Integrated by Dormand and Prince's method of order 8 from corner to corner.
    """
    times = np.asarray(times, float)
    tau, beta = np.array(rubber.tau), rubber.beta
    last = [1.0]

    def solved(time, A):
        total = A.reshape(-1, 3, 3).sum(0)
        F, P, last[0] = balanced(
            rubber, state, float(history.at(time)),
            lambda F: beta.sum() * isochoric_stress(rubber, F) - total, last[0],
        )  # fmt: skip
        return F, P

    def rate(time, A):
        S = isochoric_stress(rubber, solved(time, A)[0])
        drive = beta[:, None] * S.ravel() - A.reshape(-1, 9)
        return (drive / tau[:, None]).ravel()

    A, found = np.zeros(9 * tau.size), np.full(times.size, np.nan)
    size = (rubber.c10 + rubber.c01) * max(1.0, beta.sum())
    # no interpolation inside of a step: the integration stops at every corner and every time
    stops = np.union1d(history.times, times)
    found[times == stops[0]] = solved(stops[0], A)[1]
    for begin, end in pairwise(stops):
        done = scipy.integrate.solve_ivp(
            rate, (begin, end), A, "DOP853", rtol=1e-13, atol=1e-14 * size
        )
        A = done.y[:, -1]
        found[times == end] = solved(end, A)[1]
    return found


# ---- closed forms ----


def elastic(rubber: Rubber, state: State, stretch) -> np.ndarray:
    """Loaded component of P of the incompressible long-term law, textbook formulas."""
    c10, c01, s = rubber.c10, rubber.c01, np.asarray(stretch, float)
    return {
        "uniaxial": lambda: 2.0 * (c10 + c01 / s) * (s - s**-2.0),
        "plane strain": lambda: 2.0 * (c10 + c01) * (s - s**-3.0),
        "equibiaxial, axisymmetric": lambda: 2.0 * (c10 + c01 * s**2) * (s - s**-5.0),
        "simple shear": lambda: 2.0 * (c10 + c01) * s,
    }[state.name]()


def after_step(rubber: Rubber, state: State, stretch: float, times) -> np.ndarray:
    """P(t) = P_long (1 + sum beta_i exp(-t/tau_i)) of a stretch held from t = 0, incompressible."""
    held = np.exp(-np.asarray(times, float)[:, None] / np.array(rubber.tau))
    return elastic(rubber, state, stretch) * (1.0 + held @ rubber.beta)


def sheared(rubber: Rubber, history: History, times) -> np.ndarray:
    """P_12 of simple shear by the exact integral, for shears that are linear between corners.

    With I1 = I2 = 3 + k^2 the shear k gives polynomials, and P_12 = S_12 + k S_22 + sum (Q_12 + k Q_22):

        S_12 = 2 c10 (k + k^3/3) + 2 c01 (k + 2 k^3/3),    S_22 = -(2 c10 + 4 c01) k^2/3.

    On a segment S is a polynomial p of t; int exp(-(t - s)/tau) dS/ds ds by Gauss's quadrature with 20
    points in panels of 2 tau is exact to rounding. What is older than 40 tau is below it.
    """
    c10, c01 = rubber.c10, rubber.c01
    twelve = np.polynomial.Polynomial([0.0, 2.0 * (c10 + c01), 0.0, 2.0 * (c10 + 2.0 * c01) / 3.0])
    other = np.polynomial.Polynomial([0.0, 0.0, -(2.0 * c10 + 4.0 * c01) / 3.0])
    found = []
    for time in times:
        k = float(history.at(time))
        total = twelve(k) + k * other(k)
        for beta, tau in zip(rubber.beta, rubber.tau, strict=True):
            Q = [_fading(p, history, time, tau) for p in (twelve, other)]
            total += beta * (Q[0] + k * Q[1])
        found.append(total)
    return np.array(found)


def _fading(p, history: History, time: float, tau: float) -> float:
    """Evaluate int exp(-(t - s)/tau) dS/ds ds with S = p(k(s)), the step at the first time included."""
    total = p(history.values[0]) * np.exp(-(time - history.times[0]) / tau)
    points, weights = np.polynomial.legendre.leggauss(20)
    corners = zip(pairwise(history.times), pairwise(history.values), strict=True)
    for (begin, end), (first, last) in corners:
        low, high = max(begin, time - 40.0 * tau), min(end, time)
        if low >= high or first == last:
            continue
        rate = (last - first) / (end - begin)
        edges = np.linspace(low, high, int(np.ceil((high - low) / (2.0 * tau))) + 1)
        half = 0.5 * np.diff(edges)[:, None]
        s = edges[:-1, None] + half * (1.0 + points)
        slope = p.deriv()(first + rate * (s - begin)) * rate
        total += np.sum(half * weights * np.exp(-(time - s) / tau) * slope)
    return total


# ---- work of isochoric histories ----


def work(rubber: Rubber, times, F: np.ndarray) -> np.ndarray:
    """Work of the overstresses, int F sum Q : dF, over histories of given F by the recursion.

    Parameters
    ----------
    times : ndarray, shape (m,)
    F : ndarray, shape (m, ..., 3, 3)
        Deformation gradients, the first of which is reached by a step without work.

    Returns
    -------
    ndarray, shape (...)
    """
    S = isochoric_stress(rubber, F[0])
    shape = (len(rubber.tau), *F.shape[1:])
    Q = advance(rubber, np.zeros(shape), np.zeros(F.shape[1:]), S, 0.0)
    found = np.zeros(F.shape[1:-2])
    for i in range(1, len(times)):
        new = isochoric_stress(rubber, F[i])
        after = advance(rubber, Q, S, new, times[i] - times[i - 1])
        # int Q : dE with the mean of Q and the exact increment of E = (C - 1)/2
        E = 0.5 * (np.swapaxes(F[i], -1, -2) @ F[i] - np.swapaxes(F[i - 1], -1, -2) @ F[i - 1])
        found = found + np.sum(0.5 * (Q + after).sum(0) * E, axis=(-2, -1))
        Q, S = after, new
    return found
