"""Units of forces and energies: per metre of length in plane strain, of the complete ring
otherwise."""

from typing import NamedTuple

import numpy as np

PER_METRE = {"N/m": "N", "mJ/m": "mJ", "g/m": "g", "mm**3/s/m": "mm**3/s"}
"""Units of results per metre of depth, and of the same results of a ring."""


class ResultUnits(NamedTuple):
    """Units of results that are integrated over the depth of a seal.

    Attributes
    ----------
    force, energy : str
        Units in the notation of OpenMDAO.
    per_100_mm : float
        Factor from a force to N per 100 mm of the seal, of a ring along its mean circumference.
    radius : float or None
        Radius at which the circumference of a ring is taken: that of the centroid of its undeformed
        section, mm; None in plane strain.
    """

    force: str
    energy: str
    per_100_mm: float
    radius: float | None = None

    @property
    def per_mm(self) -> float | None:
        """Factor from a force on a ring to N per mm of its circumference; None in plane strain."""
        return None if self.radius is None else 0.01 * self.per_100_mm

    def is_ring_force(self, units: str | None) -> bool:
        """Whether a measure with ``units`` of plane strain is the force on a ring here."""
        return self.radius is not None and units == PLANE.force

    @property
    def directions(self) -> tuple[str, str]:
        """Names of the components x and y of a force."""
        return ("horizontal", "vertical") if self.radius is None else ("radial", "axial")

    @property
    def along(self) -> str:
        """Name of the length to which ``per_mm`` refers."""
        return f"per mm of circumference at the mean radius {self.radius:.4g} mm"

    def of(self, units: str | None) -> str | None:
        """Return the unit of a measure from its unit in plane strain."""
        return PER_METRE.get(units, units) if self.force == "N" else units

    @property
    def force_key(self) -> str:
        """Suffix of the names of forces in files: ``N_per_m`` or ``N``."""
        return self.force.replace("/", "_per_")

    @property
    def energy_key(self) -> str:
        """Suffix of the names of energies in files: ``mJ_per_m`` or ``mJ``."""
        return self.energy.replace("/", "_per_")


PLANE = ResultUnits("N/m", "mJ/m", 0.1)


def result_units(body, particles: np.ndarray) -> ResultUnits:
    """Return the units of the results of a ``Body`` with these undeformed particles (n, 2)."""
    if not body.axisymmetric:
        return PLANE
    # centroid of all cells by the sides of their polygons, with c = r_i y_(i+1) - r_(i+1) y_i:
    # R = int r dA / int dA = sum (r_i + r_(i+1)) c / (3 sum c),  circumference 2 pi R
    r, y = np.moveaxis(particles[body.cells], 2, 0)
    after = np.roll(r, -1, axis=1)
    cross = r * np.roll(y, -1, axis=1) - after * y
    radius = ((r + after) * cross).sum() / (3.0 * cross.sum())
    # without the rounding of sums, rings of one section on different particles have one circumference
    radius = float(f"{radius:.12g}")
    return ResultUnits("N", "mJ", 100.0 / (2.0 * np.pi * radius), radius)
