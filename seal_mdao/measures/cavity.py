"""Measure of the pressure in a cavity."""

from dataclasses import dataclass

from seal_mdao.measures.measure import Measure


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
    text = "Excess pressure of the air in a hole over the outside."

    def evaluate(self, result, partials):
        partials.output(self.air, "pressure")[0] += 1.0
        return result.response(self.air).outputs[0, 0]
