"""Measure of the strain energy."""

from dataclasses import dataclass

from seal_mdao.measures.measure import Measure


@dataclass(frozen=True)
class StrainEnergy(Measure):
    """Elastic energy of the body at the end of the path, per unit depth."""

    name: str = "strain_energy"
    units = "mJ/m"
    text = "Elastic energy of the body per unit depth."

    def evaluate(self, result, partials):
        partials.energy()[0] += 1.0
        return result.term("structure").energy(result.end.d)
