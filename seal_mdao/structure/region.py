"""Regions of a body: cells of one material."""

from typing import NamedTuple

import numpy as np

from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.materials.viscoelastic import PronySeries
from seal_mdao.structure.environment import Growth


class Region(NamedTuple):
    """Cells of one material.

    Attributes
    ----------
    material : Isotropic
    cells : ndarray of int, or None
        Indices of the cells; None for all of them.
    prefix : str
        Put before the names of the material's constants.
    growth : Growth
        By heat and swelling, where the body has an environment.
    density : float or None
        kg/m^3; the measure ``mass`` alone needs it.
    prony : PronySeries or None
        Relaxation; the environment of the body knows the time then.
    softening : OgdenRoxburgh or None
        Softening by the largest energy so far.
    """

    material: object
    cells: np.ndarray | None = None
    prefix: str = ""
    growth: Growth = Growth()
    density: float | None = None
    prony: PronySeries | None = None
    softening: OgdenRoxburgh | None = None

    @property
    def name(self) -> str:
        """Name of the material; empty if it is the only one."""
        return self.prefix.rstrip("_")

    @property
    def title(self) -> str:
        """How messages call the material."""
        return f"the material {self.name!r}" if self.name else "the material"

    @property
    def names(self) -> tuple:
        """Names of the constants as parameters."""
        return tuple(self.prefix + name for name in self.material.names)

    def with_parameters(self, values: dict) -> "Region":
        """Return the region with some constants changed; names of others are ignored."""
        own = {
            name.removeprefix(self.prefix): value
            for name, value in values.items()
            if name.startswith(self.prefix)
        }
        constants = {name: own[name] for name in self.material.names if name in own}
        material = self.material.with_(**constants) if constants else self.material
        prony, softening = (
            law and law.with_(**{name: own[name] for name in law.constants if name in own})
            for law in (self.prony, self.softening)
        )
        growth = self.growth.with_parameters(own)
        return self._replace(material=material, growth=growth, prony=prony, softening=softening)

    @property
    def at(self):
        """Index of the region's cells."""
        return slice(None) if self.cells is None else self.cells
