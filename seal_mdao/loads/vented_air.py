"""Air in a hole with vents: what leaves it while the seal closes is lost for the rest of the path.

    p = p_a ((M / V)^gamma - 1),    dM/dt = -C_d a c Phi(M / V),    c = sqrt(2 p_a / rho_a) = sqrt(2 R T)

with M the mass of the air over its density outside, V0 at the start, a the area of the vents and Phi of
``orifice``. A load step takes the time in which the profile travels, or its part of a given duration;
over it the mass follows by backward Euler. In the fraction of the mass m = M / V0 and y = ln(M / V) that
is

    F(y) = V / V0 exp(y) - m_n + kappa Phi(y) = 0,    kappa = C_d a c dt / V0

a monotone equation, solved for every volume V. m is carried to the next load step.

In plane strain V is the area of the hole (mm^2), a the area of the vents per length of the strip (mm).
In a body of revolution V is that of the complete ring, V0 = 2 pi R_c A0 with the area A0 and the radius
R_c of the centroid of the undeformed hole (Pappus). The vents lie on the circle of the centroid, there
are 2 pi R_c over their spacing, with the area 2 pi R_c times that per length; hence in both

    a / V0 = (pi d^2 / 4 s) / A0.
"""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from seal_mdao import values
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.loads.orifice import Flow, orifice_flow
from seal_mdao.loads.trapped_air import TrappedAir, TrappedAirTerm
from seal_mdao.terms.coupled_term import CoupledResponse, LocalMap
from seal_mdao.terms.ramp import at_ends, at_fraction
from seal_mdao.terms.term import Scalar

SHARP_EDGED = 0.61
"""Discharge coefficient of a sharp-edged hole: pi / (pi + 2) (Kirchhoff 1869)."""

GAS_CONSTANT = 287.05
"""Of air, J/(kg K)."""

TEMPERATURE = 293.15
"""Of the air outside, K."""

VELOCITY = 1e3 * math.sqrt(2.0 * GAS_CONSTANT * TEMPERATURE)
"""c = sqrt(2 p_a / rho_a), mm/s."""

# relative error of y, the least that the solver takes
_PRECISION = 4.0 * np.finfo(float).eps
_NO_BRANCH = np.empty(0, int)
# the mass is the variable of the first point
_MASS = 0


class AirHistory(NamedTuple):
    """What a load step passes to the next one.

    Attributes
    ----------
    mass : float
        Fraction of the mass at the start that is left.
    fraction : float
        Path parameter at its end.
    """

    mass: float
    fraction: float


@dataclass(frozen=True, eq=False, kw_only=True)
class VentedAir(TrappedAir):
    """Air in a hole with vents.

    Attributes
    ----------
    vent_diameter, vent_spacing : float
        Of round vents, and the distance from one to the next along the strip, or in a body of
        revolution along the circle of the centroid of the undeformed hole, mm.
    closing_speed : float
        Speed along the path of the profile, mm/s.
    travel : ndarray, shape (n_steps + 1,)
        Length of that path at the start and after every nominal step, mm; linear between. Stages with a
        given duration do not count.
    discharge_coefficient : float
    time : ndarray, shape (n_steps + 1,), optional
        Time of the stages with a given duration, in the same form, s; None: there are none.

    Raises
    ------
    ValueError
        As ``TrappedAir``, and for a negative diameter or coefficient, a distance or a speed that is not
        positive, a travel or a time that decreases.
    """

    vent_diameter: float
    vent_spacing: float
    closing_speed: float
    travel: np.ndarray
    discharge_coefficient: float = SHARP_EDGED
    time: np.ndarray | None = None

    def __post_init__(self):
        super().__post_init__()
        for name in ("vent_diameter", "discharge_coefficient"):
            values.real(f"{name} of {self.label!r}", getattr(self, name), 0.0)
        for name in ("vent_spacing", "closing_speed"):
            values.real(f"{name} of {self.label!r}", getattr(self, name), above=0.0)
        if self.time is None:
            object.__setattr__(self, "time", np.zeros(np.shape(self.travel)))
        for name, what in (("travel", "lengths"), ("time", "times")):
            own = values.numbers(f"{name} of {self.label!r}", getattr(self, name))
            if own.ndim != 1 or not (np.isfinite(own).all() and (np.diff(own) >= 0.0).all()):
                raise ValueError(f"{name} of {self.label!r} must be {what} that do not decrease")
        if np.shape(self.time) != np.shape(self.travel):
            raise ValueError(f"travel and time of {self.label!r} must have one value for each step")

    @property
    def scalars(self) -> dict:
        """Parameters: those of trapped air, of the vents, and the speed."""
        own = {
            "vent_diameter": ("mm", "Diameter of the vents."),
            "vent_spacing": ("mm", "Distance between vents along the strip."),
            "discharge_coefficient": (None, "Discharge coefficient of the vents."),
            "closing_speed": ("mm/s", "Speed along the path of the profile."),
        }
        return super().scalars | {
            f"{self.label}_{name}": Scalar(getattr(self, name), *about)
            for name, about in own.items()
        }

    def with_ends(self, ends) -> "VentedAir":
        """Return the air for other load steps."""
        both = {name: np.asarray(getattr(self, name), float) for name in ("travel", "time")}
        return replace(self, **{name: at_ends(own, ends) for name, own in both.items()})

    def on(self, discretization, index) -> "VentedAirTerm":
        """Build the term for one design."""
        return VentedAirTerm(self, discretization, index)


class _State(NamedTuple):
    """State of the air at the end of a load step.

    Attributes
    ----------
    volume : float
    by_index : ndarray, shape (k, 2)
        dV/dx.
    y : float
        Logarithm of the density over that outside.
    kappa : float
        C_d a c dt / V0.
    moving : float
        Fraction of dt that depends on the closing speed.
    flow : Flow
        Phi(y).
    slope : float
        dF/dy.
    """

    volume: float
    by_index: np.ndarray
    y: float
    kappa: float
    moving: float
    flow: Flow
    slope: float


class VentedAirTerm(TrappedAirTerm):
    """``VentedAir`` in one design. The force of a load step has a potential, but not that of the path:
    the flow through the vents dissipates."""

    history_size = 1
    conservative = False

    def __init__(self, definition: VentedAir, discretization, index: int):
        super().__init__(definition, discretization, index)
        self.travel, self.speed = np.asarray(definition.travel, float), definition.closing_speed
        self.time = np.asarray(definition.time, float)
        # A0: area of the undeformed hole, V0 / (2 pi R_c) in a body of revolution
        self.nominal_area, self.area_by_reference = self.nominal_volume, self.by_reference
        if self.axisymmetric:
            area, by_index = polygon_area(self.reference)
            self.nominal_area = self.orientation * area
            self.area_by_reference = self.orientation * by_index
        # pi d^2 / (4 s): area of the vents per length of the strip, mm
        area = 0.25 * math.pi * definition.vent_diameter**2 / definition.vent_spacing
        self.conductance = definition.discharge_coefficient * area * VELOCITY
        # d ln kappa of coefficient, diameter, spacing and speed
        vents = definition.discharge_coefficient, definition.vent_diameter, definition.vent_spacing
        powers = {"discharge_coefficient": 1.0, "vent_diameter": 2.0, "vent_spacing": -1.0}
        own = dict(zip(powers, vents, strict=True)) | {"closing_speed": self.speed}
        powers["closing_speed"] = -1.0
        self._by_logarithm = {
            f"{self.label}_{name}": power / own[name] if own[name] else 0.0
            for name, power in powers.items()
        }

    # ---- the state ----

    def no_history(self) -> AirHistory:
        return AirHistory(1.0, 0.0)

    def times_between(self, first: float, last: float) -> tuple[float, float]:
        """Of the travel at the closing speed, and of given durations, between two path parameters, s."""
        travel, time = (
            float(at_fraction(own, last) - at_fraction(own, first))
            for own in (self.travel, self.time)
        )
        return travel / self.speed, time

    def _vented(self, x, fraction, history: AirHistory) -> _State | None:
        """Solve for the state at the end of a load step; None where the volume is not positive."""
        enclosed = self._enclosed(x)
        if enclosed is None:
            return None
        volume, by_index = enclosed
        moving, given = self.times_between(history.fraction, fraction)
        time = moving + given
        left, kappa = volume / self.nominal_volume, self.conductance * time / self.nominal_area
        y = density(left, history.mass, kappa, self.gamma)
        flow = orifice_flow(y, self.gamma)
        # dF/dy = V / V0 exp(y) + kappa dPhi/dy
        slope = left * math.exp(y) + kappa * flow.by_density
        share = moving / time if time else 0.0
        return _State(volume, by_index, y, kappa, share, flow, slope)

    def _pressure(self, y: float) -> float:
        """Compute p = p_a (exp(gamma y) - 1)."""
        return self.outside * math.expm1(self.gamma * y)

    def respond(self, x, fraction, history):
        state = self._vented(x, fraction, history)
        if state is None:
            return None
        pressure, every = self._pressure(state.y), np.ones(len(x), np.int64)
        # dp/dV = gamma (p_a + p) dy/dV,  dy/dV = -exp(y) / (V0 dF/dy)
        by_volume = math.exp(state.y) / (self.nominal_volume * state.slope)
        stiffness = self.gamma * (self.outside + pressure) * by_volume
        # R = -p g,   K = -p d^2 V/dx dx - dp/dV g g^T,   m = m_n - kappa Phi
        left = AirHistory(history.mass - state.kappa * state.flow.value, fraction)
        return CoupledResponse(
            x, -pressure * state.by_index, every, self._pairs, self._turned(x, pressure),
            state.by_index[None], np.array([stiffness]), _NO_BRANCH, left,
            np.array([[pressure, state.volume]]),
        )  # fmt: skip

    def uses_history(self, following):
        return np.array([_MASS])

    # ---- sensitivities ----

    def linearize(self, response, fraction, history):
        state = self._vented(response.x, fraction, history)
        pressure, mass, volume = self._rates(state, history)
        force, passed, outputs = self.rows
        # force -p g, the mass passed on, pressure and volume by what they depend on
        left = np.zeros((outputs.stop, 3))
        left[force, 0] = -state.by_index.ravel()
        left[passed.start + _MASS, 1] = 1.0
        left[outputs, [0, 2]] = np.eye(2)
        shape = (outputs.stop, self.inputs[-1].stop)
        turned = self._scattered(self._turned(response.x, response.outputs[0, 0]), shape)
        return LocalMap(turned, left, np.stack([pressure, mass, volume]))

    def _rates(self, state: _State, history: AirHistory) -> tuple:
        """Differentiate pressure, mass and volume with respect to the columns of a ``LocalMap``."""
        at_x, at_history, _, at_parameters, at_reference = self.inputs
        pressure, kappa, flow = self._pressure(state.y), state.kappa, state.flow
        volume, nominal, area, before, exponent, logarithm = np.zeros((6, at_reference.stop))
        volume[at_x], nominal[at_reference] = state.by_index.ravel(), self.by_reference.ravel()
        area[at_reference] = self.area_by_reference.ravel()
        before[at_history.start + _MASS] = 1.0
        columns = {name: at_parameters.start + i for i, name in enumerate(self.names)}
        exponent[columns[f"{self.label}_gamma"]] = 1.0
        for name, rate in self._by_logarithm.items():
            logarithm[columns[name]] = rate
        # dt = travel / speed + given time
        logarithm[columns[f"{self.label}_closing_speed"]] *= state.moving
        # kappa' / kappa = (ln kappa)' - A0' / A0
        logarithm -= area / self.nominal_area
        flowing = kappa * (flow.value * logarithm + flow.by_gamma * exponent)
        # F' = exp(y) / V0 (V' - V V0' / V0) - m_n' + (kappa Phi)' + dF/dy y' = 0
        squeezed = math.exp(state.y) / self.nominal_volume
        closing = squeezed * (volume - state.volume / self.nominal_volume * nominal)
        y = (before - closing - flowing) / state.slope
        # m' = m_n' - (kappa Phi)'
        mass = before - flowing - kappa * flow.by_density * y
        # p' = (p_a + p)(gamma y' + y gamma') + p / p_a p_a'
        grown = (self.outside + pressure) * (self.gamma * y + state.y * exponent)
        grown[columns[f"{self.label}_pressure"]] += pressure / self.outside
        return grown, mass, volume

    # ---- the path ----

    def changes(self, step, response, target):
        """Compute the change of the residual while air leaves the hole at fixed displacements."""
        if sum(self.times_between(step.fraction, target)) == 0.0:
            return []
        later = self._vented(response.x, target, response.history)
        # dR = -(p(t + dt) - p(t)) g at fixed V
        change = self._pressure(later.y) - response.outputs[0, 0]
        every = np.ones(len(response.x), np.int64)
        return [self.point_loads(-change * later.by_index, every)]

    def describe(self, response, fraction) -> str:
        mass = 100.0 * response.history.mass
        return f"{super().describe(response, fraction)}, {mass:.4g} % of its air"


def density(left: float, mass: float, kappa: float, gamma: float) -> float:
    """Solve left exp(y) - mass + kappa Phi(y) = 0 for y, the logarithm of the density over that outside.

    Parameters
    ----------
    left : float
        Volume over that at the start, V / V0.
    mass : float
        Fraction of the mass m_n at the beginning of the load step.
    kappa : float
        C_d a c dt / V0, zero for no vents or no time.
    gamma : float
    """
    # y is between that of the sealed hole, exp(y) = m_n V0 / V, and that outside, 0
    sealed = math.log(mass / left)

    def residual(y):
        # exp(y) V / V0 - m_n, with the difference of small numbers by expm1
        return left * math.expm1(y) + (left - mass) + kappa * orifice_flow(y, gamma).value

    beyond = residual(sealed)
    # no flow, up to rounding
    if kappa == 0.0 or beyond == 0.0 or (beyond > 0.0) != (sealed > 0.0):
        return sealed
    return brentq(residual, *sorted((0.0, sealed)), xtol=1e-300, rtol=_PRECISION, maxiter=1000)
