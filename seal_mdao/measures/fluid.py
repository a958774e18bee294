"""Measures of a fluid that a seal holds back."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.measures.measure import Measure

BEYOND = 2.0
"""Load steps beyond the last one that held to which the pressure may be extrapolated."""


class _Held(NamedTuple):
    """A load step at which the fluid did not come through.

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
    (``FluidPressure.share``). It is taken from the line through the last two load steps that held, on
    which the seal is still closed; so it does not matter how the seal gives way, nor whether there is an
    equilibrium afterwards. A seal that holds all of the pressure has a value above it, at most that of
    ``BEYOND`` load steps more; one that nothing closes has 0.

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
        held, most = self._held(result, term)
        if not held:
            return 0.0
        last, slope, span = held[-1], 0.0, np.inf
        if len(held) > 1:
            span = last.share - held[-2].share
            slope = (last.closing - held[-2].closing) / span
        # closing + slope (share - last.share) = (1 + term.share) pressure share
        stiff = (1.0 + term.share) * term.pressure - slope
        on_pressure = partials.parameter(term.names[0])
        if (last.closing - slope * last.share) >= most * stiff:
            on_pressure[0] += most
            return most * term.pressure
        share = (last.closing - slope * last.share) / stiff
        on_slope, scale = (share - last.share) / span, term.pressure / stiff
        self._add(partials, last, scale * (1.0 + on_slope))
        if len(held) > 1:
            self._add(partials, held[-2], -scale * on_slope)
        on_pressure[0] -= share * slope / stiff
        return share * term.pressure

    def _held(self, result, term):
        """Load steps with pressure, and the one before, that held; and the largest share to say."""
        steps, closed = result.path.nominal_steps, int(np.flatnonzero(term.ramp)[0]) - 1
        if len(steps) < closed:
            result.require_converged()
        held, most = [], 0.0
        for number in range(closed, len(steps) + 1):
            share = float(term.ramp[number])
            step = steps[number - 1] if number else None
            closing = result.response(self.fluid, step).outputs[:, 1] if number else np.zeros(1)
            point = int(closing.argmax())
            if closing[point] <= (1.0 + term.share) * term.pressure * share:
                break
            held.append(_Held(share, float(closing[point]), point, step))
            following = min(number + 1, len(term.ramp) - 1)
            most = share + BEYOND * float(term.ramp[following] - term.ramp[following - 1])
        return held, most

    def _add(self, partials, held, slope) -> None:
        partials.output(self.fluid, "closing", held.step)[0, held.point] += slope
