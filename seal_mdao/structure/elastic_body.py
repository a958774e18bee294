"""The body: regions of hyperelastic materials, and the environment along the path."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.materials import ogden_roxburgh, viscoelastic
from seal_mdao.structure.environment import EXPANSION, Environment
from seal_mdao.structure.region import Region
from seal_mdao.structure.structural_term import StructuralTerm
from seal_mdao.terms.term import Scalar, TermDefinition


@dataclass(frozen=True, eq=False)
class ElasticBody(TermDefinition):
    """Internal force of a body of one or several hyperelastic materials.

    Attributes
    ----------
    regions : tuple of Region
        They divide the cells.
    environment : Environment, optional
        Axial stretch and temperature along the path.
    """

    regions: tuple
    environment: Environment | None = None
    label = "structure"

    @property
    def scalars(self) -> dict:
        """Constants of all regions; equal names are one parameter. Then those of the environment."""
        found = {
            region.prefix + name: Scalar(
                value,
                "kPa" if name in region.material.moduli else None,
                f"Material constant {name}.",
            )
            for region in self.regions
            for name, value in region.material.constants.items()
        }
        found |= {
            region.prefix + name: Scalar(
                value,
                ogden_roxburgh.UNITS.get(name),
                f"Constant {name} of the law of Ogden and Roxburgh.",
            )
            for region in self.regions
            if region.softening is not None
            for name, value in region.softening.constants.items()
        }
        if self.environment is None:
            return found
        found |= {
            region.prefix + name: scalar
            for region in self.regions
            if self.environment.acts_on(region.growth)
            for name, scalar in region.growth.scalars.items()
            # without a temperature an expansion changes nothing
            if name != EXPANSION or self.environment.temperature is not None
        }
        found |= {
            region.prefix + name: Scalar(
                value, viscoelastic.unit_of(name), f"Constant {name} of the relaxation."
            )
            for region in self.regions
            if region.prony is not None
            for name, value in region.prony.constants.items()
        }
        return found | self.environment.scalars

    def with_parameters(self, values: dict) -> "ElasticBody":
        """Return the body with some constants changed."""
        environment = self.environment
        return replace(
            self,
            regions=tuple(region.with_parameters(values) for region in self.regions),
            environment=None if environment is None else environment.with_parameters(values),
        )

    def with_ends(self, ends) -> "ElasticBody":
        """Return the body for other load steps, whose ``ends`` are in nominal steps."""
        if self.environment is None:
            return self
        grown = (r._replace(growth=r.growth.with_ends(ends)) for r in self.regions)
        return replace(self, regions=tuple(grown), environment=self.environment.with_ends(ends))

    def axial_stretch(self, fraction: float) -> float:
        """Evaluate the axial stretch at a path parameter; 1 if none is given."""
        ramp = None if self.environment is None else self.environment.axial_stretch
        return 1.0 if ramp is None else float(ramp.at([fraction])[0])

    def on(self, discretization, index) -> "StructuralTerm":
        """Build the term for one design."""
        return StructuralTerm(self, discretization, index)

    def per_cell(self, values, n_cells: int, dtype=float) -> np.ndarray:
        """A value of each region spread to its cells."""
        out = np.empty(n_cells, dtype)
        for region, value in zip(self.regions, values, strict=True):
            out[region.at] = value
        return out


def elastic_body(material) -> ElasticBody:
    """Create a body of one material."""
    return ElasticBody((Region(material),))
