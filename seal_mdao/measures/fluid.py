"""Measures of fluids: pressure of trapped air, pressure at which a fluid penetrates a seal."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.measures.measure import Measure

BEYOND = 0.1
"""Limit of extrapolation beyond the last tight load step, as a fraction of the fluid pressure."""


@dataclass(frozen=True)
class CavityPressure(Measure):
    """Excess pressure of trapped air over the outside, at the end of the path.

    Attributes
    ----------
    air : str
        Label of the ``TrappedAir``.
    """

    air: str
    name: str = "cavity_pressure"
    units = "kPa"
    text = "Pressure of the air in a hole above the outside pressure."

    def evaluate(self, result, partials):
        partials.output(self.air, "pressure")[0] += 1.0
        return result.response(self.air).outputs[0, 0]


class _State(NamedTuple):
    """Load step with fluid pressure.

    Attributes
    ----------
    share : float
        Fraction of the fluid pressure that acts.
    closing : float
        Highest contact pressure along the edge, kPa.
    point : int
        Index of its point.
    step : ConvergedStep
    """

    share: float
    closing: float
    point: int
    step: object


@dataclass(frozen=True)
class BlowOffPressure(Measure):
    """Blow-off pressure, at which a fluid reaches the dry end of its edge.

    There the highest contact pressure along the edge equals 1 + share times the fluid pressure
    (``FluidPressure.share``), interpolated between the last tight load step and the next one.
    If there is no next one, because the path ended at the blow-off or because the seal holds the full
    pressure, the line through the last two is extrapolated, by at most ``BEYOND`` of the pressure:
    then the value is above the applied pressure. It is 0 without contact.

    Attributes
    ----------
    fluid : str
        Label of the ``FluidPressure``.
    """

    fluid: str
    name: str = "blow_off_pressure"
    units = "kPa"
    text = "Blow-off pressure, at which the fluid reaches the dry end of its edge."
    wants_end = False

    def evaluate(self, result, partials):
        term = result.term(self.fluid)
        states = list(self._states(result, term))
        needed = (1.0 + term.share) * term.pressure
        # first state in which the contact pressure is too small: c <= (1 + share) p s
        failed = next(
            (i for i, s in enumerate(states) if s.closing <= needed * s.share), len(states)
        )
        if failed == 0:
            return 0.0
        last = min(failed, len(states) - 1)
        return self._crossing(partials, term, needed, states[max(last - 1, 0)], states[last])

    def missing(self, result):
        term = result.term(self.fluid)
        value, last = result.value(self)[0], float(term.ramp[-1])
        # the limit of extrapolation, see ``_crossing``, is no result but a lower bound
        if value < (last + BEYOND) * term.pressure:
            return ""
        return (
            f"{self.name}: the seal retains the complete pressure of the fluid {self.fluid!r}, "
            f"{last * term.pressure:.6g} kPa, so the value {value:.6g} kPa is the limit of "
            "extrapolation; the blow-off pressure is higher, or there is no blow-off; increase the "
            "pressure of the fluid to compute it"
        )

    def _states(self, result, term):
        """Generate the states with pressure, and the one before."""
        steps, closed = result.path.nominal_steps, int(np.flatnonzero(term.ramp)[0]) - 1
        if len(steps) < closed:
            result.require_converged()
        # begin with the last step without pressure
        for number in range(closed, len(steps) + 1):
            step = steps[number - 1] if number else None
            # no contact at the start
            closing = result.response(self.fluid, step).outputs[:, 1] if number else np.zeros(1)
            point = int(closing.argmax())
            yield _State(float(term.ramp[number]), float(closing[point]), point, step)

    def _crossing(self, partials, term, needed, first, second) -> float:
        """Compute the pressure at which the line through two states reaches the ``needed`` pressure."""
        span = second.share - first.share
        slope = (second.closing - first.closing) / span if span else 0.0
        # c(s) = c_1 + slope (s - s_1) = needed s:  s = (c_1 - slope s_1) / (needed - slope)
        stiff, start = needed - slope, first.closing - slope * first.share
        # s is at most s_2 + BEYOND
        most, on_pressure = second.share + BEYOND, partials.parameter(term.names[0])
        if start >= most * stiff:
            on_pressure[0] += most
            return most * term.pressure
        fraction, scale = start / stiff, term.pressure / stiff
        weight = (fraction - first.share) / span if span else 0.0
        for state, own in ((first, 1.0 - weight), (second, weight)):
            # dm/dc_1 = p (1 - w) / stiff,  dm/dc_2 = p w / stiff,  w = (s - s_1) / (s_2 - s_1)
            if own and state.step is not None:
                on_closing = partials.output(self.fluid, "closing", state.step)
                on_closing[0, state.point] += scale * own
        # m = s p, needed = (1 + share) p:  dm/dp = s - s needed / stiff = -s slope / stiff
        on_pressure[0] -= fraction * slope / stiff
        return fraction * term.pressure
