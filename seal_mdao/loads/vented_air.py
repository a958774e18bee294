"""Air in a hole with vents: air that leaves while the seal closes does not return.

    p = p_a ((M / V)^gamma - 1),    dM/dt = -C_d a c Phi(M / V),
    c = sqrt(2 p_a / rho_a) = sqrt(2 R T_0)

with M the mass of the air over its density rho_a at the start, V0 at the start, T_0 its absolute
temperature there, a the area of the vents and Phi of ``orifice``. A load step takes the time in which
the profile travels, or its part of a given duration; beside materials that relax, the time of their path
(``terms.ramp.StageTimes``). Over it the mass follows by backward Euler. In the fraction of the mass
m = M / V0 and y = ln(M / V) that is

    F(y) = V / V0 exp(y) - m_n + kappa Phi(y) = 0,    kappa = C_d a c dt / V0

a monotone equation, solved for every volume V. m is carried to the next load step.

At the absolute temperature T, and in a section that is stretched by h (``structure.environment``),
p = p_a (T / T_0 (M / (h V))^gamma - 1) with M, V0 and a per length of the unstretched strip: the air and
the vents are those of the material, whose distance grows with h. The density at the pressure p_a is
that at the start over b = (T / T_0)^(1 / gamma), inside and outside. With y the logarithm of the density
over that one, u of ``orifice`` is exp((1 + gamma) y) / b for outflow and 1 / b for inflow, and

    M / (h V) = exp(y) / b,    F(y) = h V / V0 exp(y) - b m_n + sqrt(b) kappa Phi(y) = 0,
    m = m_n - kappa Phi(y) / sqrt(b).

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
import scipy

from seal_mdao import values
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import Motion
from seal_mdao.geometry.polygon import polygon_area
from seal_mdao.loads.orifice import Flow, orifice_flow
from seal_mdao.loads.trapped_air import TrappedAir, TrappedAirTerm
from seal_mdao.materials.viscoelastic import ABSOLUTE_ZERO
from seal_mdao.structure.environment import AXIAL_STRETCH, TEMPERATURE
from seal_mdao.terms.coupled_term import CoupledResponse, LocalMap
from seal_mdao.terms.ramp import StageTimes, at_ends, at_fraction
from seal_mdao.terms.term import Scalar

SHARP_EDGED = 0.61
"""Discharge coefficient of a sharp-edged hole: pi / (pi + 2) (Kirchhoff 1869)."""

GAS_CONSTANT = 287.05
"""Of air, J/(kg K)."""

START_TEMPERATURE = 23.0
"""Of the air at the start where the environment has no temperature, degrees Celsius."""

# relative error of y, the least that the solver takes
_PRECISION = 4.0 * np.finfo(float).eps
_NO_BRANCH = np.empty(0, int)
# the mass is the variable of the first point
_MASS = 0


def outflow_velocity(temperature: float) -> float:
    """Compute c = sqrt(2 p_a / rho_a) = sqrt(2 R T) of air at a temperature (degrees Celsius), mm/s."""
    return 1e3 * math.sqrt(2.0 * GAS_CONSTANT * (temperature - ABSOLUTE_ZERO))


class AirHistory(NamedTuple):
    """History that a load step passes to the next one.

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
    closing_speed : float, optional
        Speed along the path of the profile, mm/s; needed where it travels.
    travel : ndarray, shape (n_steps + 1,), optional
        Length of that path at the start and after every nominal step, mm; linear between. Stages with a
        given duration do not count. None where the environment has a time.
    discharge_coefficient : float
    time : ndarray, shape (n_steps + 1,), optional
        Time of the stages with a given duration, in the same form, s; None: there are none.
    motion : Motion, optional
        That of the profile, whose ``timing`` travel and time are; its parameters change them. None
        where travel and time are given.

    Raises
    ------
    ValueError
        As ``TrappedAir``, and for a negative diameter or coefficient, a distance or a speed that is not
        positive, a travel or a time that decreases, a travel without a speed, and for times beside that
        of the environment.
    """

    vent_diameter: float
    vent_spacing: float
    closing_speed: float | None = None
    travel: np.ndarray | None = None
    discharge_coefficient: float = SHARP_EDGED
    time: np.ndarray | None = None
    motion: Motion | None = None

    def __post_init__(self):
        super().__post_init__()
        for name in ("vent_diameter", "discharge_coefficient"):
            values.real(f"{name} of {self.label!r}", getattr(self, name), 0.0)
        values.real(f"vent_spacing of {self.label!r}", self.vent_spacing, above=0.0)
        if self.closing_speed is not None:
            values.real(f"closing_speed of {self.label!r}", self.closing_speed, above=0.0)
        if self.clock is None:
            self._check_times()
        elif any(own is not None for own in (self.closing_speed, self.travel, self.time)):
            raise ValueError(
                f"the times of the load steps of the vented air {self.label!r} are already given "
                "by the durations of the stages; leave out travel, time and closing_speed"
            )

    @property
    def clock(self) -> StageTimes | None:
        """Time along the load path, from the environment."""
        return None if self.environment is None else self.environment.time

    def _check_times(self) -> None:
        """Check travel and time, and set a time that is not given to zero."""
        if self.time is None:
            object.__setattr__(self, "time", np.zeros(np.shape(self.travel)))
        for name, what in (("travel", "lengths"), ("time", "times")):
            own = values.numbers(f"{name} of {self.label!r}", getattr(self, name))
            if own.ndim != 1 or not (np.isfinite(own).all() and (np.diff(own) >= 0.0).all()):
                raise ValueError(
                    f"{name} of {self.label!r} must be finite {what} that do not decrease"
                )
        if np.shape(self.time) != np.shape(self.travel):
            raise ValueError(
                f"travel and time of the vented air {self.label!r} must have one value for each "
                "load step"
            )
        if self.closing_speed is None and self.travel[-1] > 0.0:
            raise ValueError(
                f"the vented air {self.label!r} has a travel but no closing_speed; give the speed "
                "of the profile in mm/s"
            )

    @property
    def start_temperature(self) -> float:
        """Temperature of the air at the start, inside and outside, degrees Celsius."""
        given = None if self.environment is None else self.environment.temperature
        return START_TEMPERATURE if given is None else given.start

    @property
    def scalars(self) -> dict:
        """Parameters: those of trapped air, of the vents, and the speed."""
        own = {
            "vent_diameter": ("mm", "Diameter of the vents."),
            "vent_spacing": ("mm", "Distance between vents along the strip."),
            "discharge_coefficient": (None, "Discharge coefficient of the vents."),
            "closing_speed": ("mm/s", "Speed along the path of the profile."),
        }
        motion = () if self.motion is None else self.motion.names
        return (
            super().scalars
            | {
                f"{self.label}_{name}": Scalar(getattr(self, name), *about)
                for name, about in own.items()
                if getattr(self, name) is not None
            }
            | {name: Scalar(0.0, self.motion.unit(name), f"Motion: {name}.") for name in motion}
        )

    def among(self, definitions) -> "VentedAir":
        """Return the air with travel and time of the first profile of these definitions that travels,
        and their parameters, unless they are given."""
        if self.motion is None:
            return self
        motions = [own.motion for own in definitions if isinstance(own, RigidContact)]
        # parameters may have set the travel of all of them to zero
        motion = next((own for own in motions if own.travel > 0.0), motions[0])
        travel, time = motion.timing
        return replace(self, travel=travel, time=time, motion=motion)

    def with_ends(self, ends) -> "VentedAir":
        """Return the air for other load steps."""
        other = super().with_ends(ends)
        if self.clock is not None:
            return other
        both = {name: np.asarray(getattr(self, name), float) for name in ("travel", "time")}
        return replace(other, **{name: at_ends(own, ends) for name, own in both.items()})

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
        Logarithm of the density over that at the pressure outside.
    kappa : float
        C_d a c dt / V0.
    time_rates : dict of str to float
        Derivatives of ln dt by parameter.
    hot, stretch : float
        ln(T / T_0) and h.
    flow : Flow
        Phi(y).
    slope : float
        dF/dy.
    """

    volume: float
    by_index: np.ndarray
    y: float
    kappa: float
    time_rates: dict
    hot: float
    stretch: float
    flow: Flow
    slope: float


class VentedAirTerm(TrappedAirTerm):
    """``VentedAir`` in one design. The force of a load step has a potential, but not that of the path:
    the flow through the vents dissipates."""

    history_size = 1
    conservative = False

    def __init__(self, definition: VentedAir, discretization, index: int):
        super().__init__(definition, discretization, index)
        self.clock, self.speed = definition.clock, definition.closing_speed
        if self.clock is None:
            self.travel = np.asarray(definition.travel, float)
            self.time = np.asarray(definition.time, float)
            # ds/dp of the parameters of the motion, shape (n_steps + 1,) each
            motion = definition.motion
            rates = () if motion is None else motion.timed_travel_rates
            names = () if motion is None else motion.names
            self.travel_rates = dict(zip(names, rates, strict=True))
        # A0: area of the undeformed hole, V0 / (2 pi R_c) in a body of revolution
        self.nominal_area, self.area_by_reference = self.nominal_volume, self.by_reference
        if self.axisymmetric:
            area, by_index = polygon_area(self.reference)
            self.nominal_area = self.orientation * area
            self.area_by_reference = self.orientation * by_index
        # pi d^2 / (4 s): area of the vents per length of the strip, mm
        area = 0.25 * math.pi * definition.vent_diameter**2 / definition.vent_spacing
        velocity = outflow_velocity(definition.start_temperature)
        self.conductance = definition.discharge_coefficient * area * velocity
        # d ln(C_d a) of coefficient, diameter and spacing
        vents = definition.discharge_coefficient, definition.vent_diameter, definition.vent_spacing
        powers = {"discharge_coefficient": 1.0, "vent_diameter": 2.0, "vent_spacing": -1.0}
        own = dict(zip(powers, vents, strict=True))
        self._by_logarithm = {
            f"{self.label}_{name}": power / own[name] if own[name] else 0.0
            for name, power in powers.items()
        }

    # ---- the state ----

    def no_history(self) -> AirHistory:
        return AirHistory(1.0, 0.0)

    def time_between(self, first: float, last: float) -> tuple[float, dict]:
        """Time between two path parameters, s, and the derivatives of its logarithm by parameter."""
        if self.clock is not None:
            time = float(np.diff(self.clock.at([first, last]))[0])
            rates = self.environment.time_rates([first, last])
            return time, {
                n: float(np.diff(own)[0]) / time if time else 0.0 for n, own in rates.items()
            }
        travel, given = (
            float(at_fraction(own, last) - at_fraction(own, first))
            for own in (self.travel, self.time)
        )
        if self.speed is None:
            return given, {}
        # dt = travel / speed + given time
        moving = travel / self.speed
        time = moving + given
        if not time:
            return time, {}
        # (ln dt)' = -dt_moving / (v dt) by the speed,  (s' of the end - s' of the start) / (v dt) by
        # parameters of the motion
        rates = {
            name: float(at_fraction(own, last) - at_fraction(own, first)) / (self.speed * time)
            for name, own in self.travel_rates.items()
        }
        return time, rates | {f"{self.label}_closing_speed": -moving / (self.speed * time)}

    def _vented(self, x, fraction, history: AirHistory) -> _State | None:
        """Solve for the state at the end of a load step; None where the volume is not positive."""
        enclosed = self._enclosed(x)
        if enclosed is None:
            return None
        volume, by_index = enclosed
        time, time_rates = self.time_between(history.fraction, fraction)
        hot, longer, _ = self._heated(fraction)
        stretch = math.exp(longer)
        # h V / V0,  kappa,  b = (T / T_0)^(1 / gamma)
        left = stretch * volume / self.nominal_volume
        kappa = self.conductance * time / self.nominal_area
        growth = math.exp(hot / self.gamma)
        flowing = kappa * math.sqrt(growth)
        y = density(left, history.mass * growth, flowing, self.gamma)
        flow = orifice_flow(y, self.gamma)
        # dF/dy = h V / V0 exp(y) + sqrt(b) kappa dPhi/dy
        slope = left * math.exp(y) + flowing * flow.by_density
        return _State(volume, by_index, y, kappa, time_rates, hot, stretch, flow, slope)

    def _pressure(self, y: float) -> float:
        """Compute p = p_a (exp(gamma y) - 1)."""
        return self.outside * math.expm1(self.gamma * y)

    def respond(self, x, fraction, history):
        state = self._vented(x, fraction, history)
        if state is None:
            return None
        pressure, every = self._pressure(state.y), np.ones(len(x), np.int64)
        # dp/dV = gamma (p_a + p) dy/dV,  dy/dV = -h exp(y) / (V0 dF/dy)
        by_volume = state.stretch * math.exp(state.y) / (self.nominal_volume * state.slope)
        stiffness = self.gamma * (self.outside + pressure) * by_volume
        # R = -p g,   K = -p d^2 V/dx dx - dp/dV g g^T,   m = m_n - kappa Phi / sqrt(b)
        through = state.kappa * math.exp(-0.5 * state.hot / self.gamma)
        left = AirHistory(history.mass - through * state.flow.value, fraction)
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
        pressure, mass, volume = self._rates(state, fraction, history)
        force, passed, outputs = self.rows
        # force -p g, the mass passed on, pressure and volume by what they depend on
        left = np.zeros((outputs.stop, 3))
        left[force, 0] = -state.by_index.ravel()
        left[passed.start + _MASS, 1] = 1.0
        left[outputs, [0, 2]] = np.eye(2)
        shape = (outputs.stop, self.inputs[-1].stop)
        turned = self._scattered(self._turned(response.x, response.outputs[0, 0]), shape)
        return LocalMap(turned, left, np.stack([pressure, mass, volume]))

    def _rates(self, state: _State, fraction, history: AirHistory) -> tuple:
        """Differentiate pressure, mass and volume with respect to the columns of a ``LocalMap``."""
        at_x, at_history, _, at_parameters, at_reference = self.inputs
        pressure, kappa, flow = self._pressure(state.y), state.kappa, state.flow
        volume, nominal, area, before, exponent, logarithm = np.zeros((6, at_reference.stop))
        volume[at_x], nominal[at_reference] = state.by_index.ravel(), self.by_reference.ravel()
        area[at_reference] = self.area_by_reference.ravel()
        before[at_history.start + _MASS] = 1.0
        columns = {name: at_parameters.start + i for i, name in enumerate(self.names)}
        exponent[columns[f"{self.label}_gamma"]] = 1.0
        for name, rate in (self._by_logarithm | state.time_rates).items():
            logarithm[columns[name]] = rate
        growth, longer = self._growth_rates(state, fraction, columns, exponent)
        root = math.exp(0.5 * state.hot / self.gamma)
        # kappa' / kappa = (ln kappa)' - A0' / A0
        logarithm -= area / self.nominal_area
        by_flow = flow.by_gamma * exponent
        # (sqrt(b) kappa Phi)'
        flowing = root * kappa * (flow.value * (logarithm + 0.5 * growth) + by_flow)
        # F' = h exp(y) / V0 (V' - V V0' / V0 + V h' / h) - b (m_n' + m_n b' / b)
        #      + (sqrt(b) kappa Phi)' + dF/dy y' = 0
        squeezed = state.stretch * math.exp(state.y) / self.nominal_volume
        closing = squeezed * (
            volume - state.volume / self.nominal_volume * nominal + state.volume * longer
        )
        y = (root**2 * (before + history.mass * growth) - closing - flowing) / state.slope
        # m' = m_n' - (kappa Phi / sqrt(b))'
        flowing = kappa / root * (flow.value * (logarithm - 0.5 * growth) + by_flow)
        mass = before - flowing - kappa / root * flow.by_density * y
        # p' = (p_a + p)(gamma y' + y gamma') + p / p_a p_a'
        grown = (self.outside + pressure) * (self.gamma * y + state.y * exponent)
        grown[columns[f"{self.label}_pressure"]] += pressure / self.outside
        return grown, mass, volume

    def _growth_rates(self, state: _State, fraction, columns, exponent) -> tuple:
        """Differentiate ln b and ln h with respect to the columns of a ``LocalMap``."""
        growth, longer = np.zeros((2, len(exponent)))
        # ln b = ln(T / T_0) / gamma;  rates are those of ln(T / T_0) and -gamma ln h
        _, _, rates = self._heated(fraction)
        if TEMPERATURE in rates:
            growth[columns[TEMPERATURE]] = rates[TEMPERATURE] / self.gamma
        if AXIAL_STRETCH in rates:
            longer[columns[AXIAL_STRETCH]] = -rates[AXIAL_STRETCH] / self.gamma
        return growth - state.hot / self.gamma**2 * exponent, longer

    # ---- the path ----

    def changes(self, step, response, target):
        """Compute the change of the residual at fixed displacements, as air leaves the hole and is
        heated and stretched."""
        if self.environment is None and self.time_between(step.fraction, target)[0] == 0.0:
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
    """Solve left exp(y) - mass + kappa Phi(y) = 0 for y, the logarithm of the density over that at the
    pressure outside.

    Parameters
    ----------
    left : float
        Volume over that at the start, h V / V0.
    mass : float
        Fraction of the mass at the beginning of the load step, times b: b m_n.
    kappa : float
        sqrt(b) C_d a c dt / V0, zero for no vents or no time.
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
    # scipy loads a module at its first use; few files have vents
    return scipy.optimize.brentq(
        residual, *sorted((0.0, sealed)), xtol=1e-300, rtol=_PRECISION, maxiter=1000
    )
