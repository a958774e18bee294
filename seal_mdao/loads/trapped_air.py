"""Air trapped in a hole: its pressure is a function of the deformed volume.

    p = p_a (a (V0 / V)^gamma - 1),    R_j = -p dV/dx_j,    a = (T / T_0) h^(-gamma)

with the absolute temperatures T now and T_0 at the start, and the stretch h along a plane section, with
which the same air fills a longer hole (``structure.environment``). p is the excess over the pressure p_a
outside, and R the contribution to the residual. The volume V (``enclosed_volume``) is in plane strain
the area A = 1/2 sum_j x_j x x_{j+1}, in a body of revolution that of the complete ring. The volume V0 of
the undeformed hole depends on the design. The tangent couples neighbours, since the sides rotate, and
has a part of rank one, gamma (p_a + p) / V g g^T with g = dV/dx, over the complete hole.
"""

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import coo_array, csr_array

from seal_mdao import values
from seal_mdao.loads.enclosed_volume import coupled_points, enclosed_volume, second_derivatives
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.structure.environment import (
    AXIAL_STRETCH,
    TEMPERATURE,
    Environment,
)
from seal_mdao.terms.coupled_term import CoupledResponse, CoupledTerm, LocalMap
from seal_mdao.terms.points import MaterialPoints, fixed_points, single_points
from seal_mdao.terms.term import Scalar, TermDefinition

ATMOSPHERE = 101.325
"""Standard atmospheric pressure, kPa."""

ADIABATIC = 1.4
"""Adiabatic exponent of air; 1 is isothermal."""

_NO_BRANCH = np.empty(0, int)


@dataclass(frozen=True, eq=False)
class TrappedAir(TermDefinition):
    """Air trapped in a hole.

    Attributes
    ----------
    label : str
        Prefix of the names of its parameters.
    ring : ndarray of int, shape (k,)
        Particles around the hole, in either sense.
    pressure : float
        Absolute pressure p_a outside, and inside at the start, kPa.
    gamma : float
        Exponent: 1.4 adiabatic, 1 isothermal.
    environment : Environment, optional
        Temperature of the air, and stretch along the section, along the path.

    Raises
    ------
    ValueError
        For a pressure or an exponent that is not positive, or fewer than three particles.
    """

    label: str
    ring: np.ndarray
    pressure: float = ATMOSPHERE
    gamma: float = ADIABATIC
    environment: Environment | None = None
    n_columns = 1

    def __post_init__(self):
        values.real(f"pressure of {self.label!r}", self.pressure, above=0.0)
        values.real(f"gamma of {self.label!r}", self.gamma, above=0.0)
        if len(self.ring) < 3:
            raise ValueError(
                f"the hole that contains the air {self.label!r} needs at least three particles"
            )

    @property
    def where(self) -> MaterialPoints:
        """Points at which the pressure acts: the particles."""
        return fixed_points(single_points(self.ring), 0.0)

    @property
    def scalars(self) -> dict:
        """Parameters: pressure outside and exponent, and those of the environment."""
        return {
            f"{self.label}_pressure": Scalar(self.pressure, "kPa", "Absolute pressure outside."),
            f"{self.label}_gamma": Scalar(self.gamma, None, "Exponent of the trapped air."),
        } | ({} if self.environment is None else self.environment.scalars)

    def with_parameters(self, values: dict) -> "TrappedAir":
        """Return the air with other parameters."""
        prefix, around = f"{self.label}_", self.environment
        own = {n.removeprefix(prefix): v for n, v in values.items() if n.startswith(prefix)}
        if around is not None:
            own["environment"] = around.with_parameters(values)
        return replace(self, **own)

    def with_ends(self, ends) -> "TrappedAir":
        """Return the air in other load steps, whose ``ends`` are in nominal steps."""
        around = self.environment
        return self if around is None else replace(self, environment=around.with_ends(ends))

    def point_set(self):
        """Return the particles around the hole."""
        return self.where.points

    def pairs(self):
        """List neighbours: the follower pressure on a side couples its two points."""
        at = np.arange(len(self.ring))
        return np.column_stack([at, np.roll(at, -1)])

    def on(self, discretization, index) -> "TrappedAirTerm":
        """Build the term for one design."""
        return TrappedAirTerm(self, discretization, index)


class TrappedAirTerm(CoupledTerm):
    """``TrappedAir`` in one design; what it gives are the pressure over that outside, kPa, and the
    volume: mm^2, the area of the hole, in plane strain; m mm^2 in a body of revolution."""

    output_names = ("pressure", "volume")
    conservative = True

    def __init__(self, definition: TrappedAir, discretization, index: int):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, index
        )
        self.outside, self.gamma = definition.pressure, definition.gamma
        self.environment = definition.environment
        self.axisymmetric = discretization.body.axisymmetric
        # V0 and g0; the sense of the ring is the sign of V0
        volume, by_index = enclosed_volume(self.reference, self.axisymmetric)
        self.orientation = 1.0 if volume > 0.0 else -1.0
        self.nominal_volume = self.orientation * volume
        self.by_reference = self.orientation * by_index
        self.rounding = self.outside * float(np.abs(self.reference).max())
        self.rounding *= discretization.depth
        self._pairs = coupled_points(len(self.where), self.axisymmetric)

    def _enclosed(self, x):
        """Compute the volume, positive for either sense of the ring, and its gradient; None where it is
        not positive."""
        volume, by_index = enclosed_volume(x, self.axisymmetric)
        volume *= self.orientation
        return None if volume <= 0.0 else (volume, self.orientation * by_index)

    def _turned(self, x, pressure) -> np.ndarray:
        """Tangents -p d^2 V/dx dx of the pairs, shape (m, 2, 2)."""
        return -pressure * (self.orientation * second_derivatives(x, self.axisymmetric))

    def _heated(self, fraction) -> tuple[float, float, dict]:
        """Compute ln(T / T_0), ln h, and the derivatives of ln a by parameter."""
        hot, longer, rates = 0.0, 0.0, {}
        around = self.environment
        if around is not None and around.temperature is not None:
            # ln(T / T_0), d ln a = dT / T
            own, start = around.temperature, around.temperature.start - ABSOLUTE_ZERO
            absolute = float(own.at([fraction])[0]) - ABSOLUTE_ZERO
            hot, rates[TEMPERATURE] = np.log(absolute / start), own.rates([fraction])[0] / absolute
        if around is not None and around.axial_stretch is not None:
            h = float(around.axial_stretch.at([fraction])[0])
            # a has h^-gamma: d ln a = -gamma dh / h
            longer = np.log(h)
            rates[AXIAL_STRETCH] = -self.gamma / h * around.axial_stretch.rates([fraction])[0]
        return hot, longer, rates

    def _state(self, x, fraction):
        """Compute volume, its gradient and excess pressure; None where the volume is not positive."""
        enclosed = self._enclosed(x)
        if enclosed is None:
            return None
        volume, by_index = enclosed
        hot, longer, _ = self._heated(fraction)
        # p = p_a (a (V0 / V)^gamma - 1)
        left = np.log(self.nominal_volume / volume) - longer
        return volume, by_index, self.outside * np.expm1(hot + self.gamma * left)

    def changes(self, step, response, target):
        if self.environment is None:
            return []
        # dR = -(p(target) - p) g at fixed places
        _, by_index, before = self._state(response.x, step.fraction)
        change = self._state(response.x, target)[2] - before
        force = np.zeros(self.discretization.layout.force_size)
        self._add_force(-change * by_index, np.ones(len(by_index), np.int64), force)
        return [force]

    def respond(self, x, fraction, history):
        state = self._state(x, fraction)
        if state is None:
            return None
        volume, by_index, pressure = state
        every = np.ones(len(x), np.int64)
        # R = -p g,   K = -p d^2 V/dx dx + gamma (p_a + p) / V g g^T,   dp/dV = -gamma (p_a + p) / V
        stiffness = self.gamma * (self.outside + pressure) / volume
        return CoupledResponse(
            x, -pressure * by_index, every, self._pairs, self._turned(x, pressure), by_index[None],
            np.array([stiffness]), _NO_BRANCH, None, np.array([[pressure, volume]]),
        )  # fmt: skip

    def potential(self, d, response) -> float:
        left, power = response.outputs[0, 1] / self.nominal_volume, 1.0 - self.gamma
        # a from the pressure: a = (p / p_a + 1) v^gamma,  v = V / V0
        amount = (response.outputs[0, 0] / self.outside + 1.0) * left**self.gamma
        amount = 1.0 if self.environment is None else amount
        # Pi = int_V^V0 p dV = p_a V0 [ a (1 - v^(1 - gamma)) / (1 - gamma) - (1 - v) ];
        # the first term tends to -a ln v for gamma = 1
        squeezed = -np.log(left) if power == 0.0 else np.expm1(power * np.log(left)) / -power
        return float(self.outside * self.nominal_volume * (amount * squeezed - (1.0 - left)))

    def linearize(self, response, fraction, history):
        volume, by_index, pressure = self._state(response.x, fraction)
        k, (at_x, _, _, at_parameters, at_reference) = len(self.where), self.inputs
        _, longer, rates = self._heated(fraction)
        absolute = self.outside + pressure
        shrunk = np.log(self.nominal_volume / volume) - longer
        # the two outputs by what they depend on; the force turns with the places beside
        by_inputs = np.zeros((2, at_reference.stop))
        # dp = -gamma (p_a + p) (dV / V - dV0 / V0)
        by_inputs[0, at_x] = -self.gamma * absolute / volume * by_index.ravel()
        by_inputs[0, at_reference] = (
            self.gamma * absolute / self.nominal_volume * self.by_reference.ravel()
        )
        # dp/dp_a, dp/dgamma, and (p_a + p) d ln a of temperature and stretch
        by_names = dict.fromkeys(self.names, 0.0) | {
            n: absolute * rate for n, rate in rates.items()
        }
        by_names[f"{self.label}_pressure"] = pressure / self.outside
        by_names[f"{self.label}_gamma"] = absolute * shrunk
        by_inputs[0, at_parameters] = [by_names[name] for name in self.names]
        by_inputs[1, at_x] = by_index.ravel()
        left = np.zeros((2 * k + 2, 2))
        # dR = -g dp - p d^2 V: the first as a product of low rank
        left[: 2 * k, 0], left[2 * k :] = -by_index.ravel(), np.eye(2)
        shape = (2 * k + 2, at_reference.stop)
        return LocalMap(self._scattered(self._turned(response.x, pressure), shape), left, by_inputs)

    def _scattered(self, tangent, shape) -> csr_array:
        """Tangents of the pairs as a matrix over places."""
        rows = 2 * self._pairs[:, 0, None, None] + np.arange(2)[None, :, None]
        columns = 2 * self._pairs[:, 1, None, None] + np.arange(2)[None, None, :]
        at = tuple(np.broadcast_to(part, tangent.shape).ravel() for part in (rows, columns))
        return coo_array((tangent.ravel(), at), shape=shape).tocsr()

    def describe(self, response, fraction) -> str:
        pressure, volume = response.outputs[0]
        # 1 m mm^2 = 1000 mm^3
        left, unit = (1e3 * volume, "mm^3") if self.axisymmetric else (volume, "mm^2")
        return f"{self.label}: {pressure:.4g} kPa over the outside, {left:.4g} {unit} left"
