"""Measures of a fluid that a seal holds back."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.measures.measure import Measure

BEYOND = 0.1
"""Of the fluid's pressure, to which it may be extrapolated beyond the last load step that held."""


class _State(NamedTuple):
    """A load step at which the fluid presses.

    Attributes
    ----------
    share : float
        Of the fluid's pressure that acts.
    closing : float
        Highest contact pressure along the edge, kPa.
    point : int
        Where that is.
    step : ConvergedStep
    """

    share: float
    closing: float
    point: int
    step: object


@dataclass(frozen=True)
class BlowOffPressure(Measure):
    """Pressure at which a fluid comes through to the dry end of its edge.

    That is where the highest contact pressure along the edge has fallen to 1 + share times the fluid's
    (``FluidPressure.share``), on the line between the last load step that held and the one after it.
    Where there is none after it, because the path ended when the seal gave way or because the seal holds
    all of the pressure, the line through the last two goes on, by ``BEYOND`` of the pressure at most:
    then the value is above the pressure that was applied. One that nothing closes has 0.

    Attributes
    ----------
    fluid : str
        Label of the ``FluidPressure``.
    """

    fluid: str
    name: str = "blow_off_pressure"
    units = "kPa"
    text = "Fluid pressure at which the fluid comes through to the dry end of its edge."
    wants_end = False

    def evaluate(self, result, partials):
        term = result.term(self.fluid)
        states = list(self._states(result, term))
        needed = (1.0 + term.share) * term.pressure
        held = next((i for i, s in enumerate(states) if s.closing <= needed * s.share), len(states))
        if held == 0:
            return 0.0
        last = min(held, len(states) - 1)
        return self._crossing(partials, term, needed, states[max(last - 1, 0)], states[last])

    def _states(self, result, term):
        """Those with pressure, and the one before."""
        steps, closed = result.path.nominal_steps, int(np.flatnonzero(term.ramp)[0]) - 1
        if len(steps) < closed:
            result.require_converged()
        for number in range(closed, len(steps) + 1):
            step = steps[number - 1] if number else None
            # nothing touches at the start
            closing = result.response(self.fluid, step).outputs[:, 1] if number else np.zeros(1)
            point = int(closing.argmax())
            yield _State(float(term.ramp[number]), float(closing[point]), point, step)

    def _crossing(self, partials, term, needed, first, second) -> float:
        """Pressure at which the line through two states comes to what is ``needed``."""
        span = second.share - first.share
        slope = (second.closing - first.closing) / span if span else 0.0
        stiff, start = needed - slope, first.closing - slope * first.share
        most, on_pressure = second.share + BEYOND, partials.parameter(term.names[0])
        if start >= most * stiff:
            on_pressure[0] += most
            return most * term.pressure
        share, scale = start / stiff, term.pressure / stiff
        weight = (share - first.share) / span if span else 0.0
        for state, own in ((first, 1.0 - weight), (second, weight)):
            if own and state.step is not None:
                on_closing = partials.output(self.fluid, "closing", state.step)
                on_closing[0, state.point] += scale * own
        on_pressure[0] -= share * slope / stiff
        return share * term.pressure
