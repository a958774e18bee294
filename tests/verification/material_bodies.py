"""Every shipped law through the analysis: compressed blocks and inflated cylinders.

The exact values use the energies of the laws alone (``layered_cylinder``), never their derivatives.
Shear moduli are about one, bulk moduli a thousand (any one stress unit).
"""

import numpy as np

from seal_mdao.materials.gent import Gent
from seal_mdao.materials.hyperfoam import Hyperfoam
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.materials.neo_hookean import NeoHookean
from seal_mdao.materials.ogden import Ogden
from seal_mdao.materials.yeoh import Yeoh
from seal_mdao.structure.elastic_body import ElasticBody, elastic_body
from seal_mdao.structure.region import Region
from verification.cylinder import BORE, OUTSIDE, inflate
from verification.layered_cylinder import bore_pressure, free_stretch, principal_stress
from verification.patch import squeeze

BULK = 1e3
LAWS = {
    "neo-Hookean": NeoHookean(0.5, BULK),
    "Mooney-Rivlin": MooneyRivlin(0.4, 0.1, BULK),
    "Yeoh": Yeoh(0.5, -0.02, 0.01, BULK),
    "Gent": Gent(1.0, 12.0, BULK),
    "Ogden, 1 term": Ogden((1.5,), (1.3,), BULK),
    # the exponents are Ogden's for Treloar's rubber, 1972
    "Ogden, 3 terms": Ogden((1.5, 0.003, -0.024), (1.3, 5.0, -2.0), BULK),
    "hyperfoam, nu = 0": Hyperfoam((1.0,), (3.0,), (0.0,)),
    "hyperfoam, nu = 0.3": Hyperfoam((0.7, 0.3), (2.0, -2.0), (0.3, 0.3)),
}
"""Laws by name."""

SHORTEST, WIDEST = 0.6, 1.5
"""Final height of the blocks and final stretch of the bores."""
MIDDLE = 0.5 * (BORE + OUTSIDE)
"""Radius between the two layers."""


def compression_errors(material: Isotropic, walls: bool) -> tuple[float, float]:
    """Relative errors of platen force and width in four steps to ``SHORTEST``, irregular cloud.

    Exact: F = diag(l, h), with P_11(l, h) = 0 where the sides are free and l = 1 between walls; the
    platen pressure is -P_22.
    """
    stretch, pressure, width, _ = squeeze(material, (6, 3), walls, SHORTEST, n_steps=4)
    exact = np.ones(4) if walls else np.array([free_stretch(material, h) for h in stretch])
    stress = principal_stress(material, stretch, exact)
    return float(np.abs(pressure / stress + 1.0).max()), float(np.abs(width / exact - 1.0).max())


def cylinder_error(material: Isotropic, cells=(6, 12)) -> float:
    """Relative error of the bore pressure at ``WIDEST``, one material, four steps."""
    _, pressure = inflate(elastic_body(material), cells, WIDEST, 4)
    return abs(pressure[-1] / bore_pressure([(material, BORE, OUTSIDE)], WIDEST) - 1.0)


def layered_error(inner: Isotropic, outer: Isotropic, cells: tuple[int, int]) -> float:
    """Relative error of the bore pressure at ``WIDEST``: two layers of equal thickness, four steps."""
    half = cells[0] * cells[1] // 2
    regions = (
        Region(inner, np.arange(half), "inner_"),
        Region(outer, np.arange(half, 2 * half), "outer_"),
    )
    _, pressure = inflate(ElasticBody(regions), cells, WIDEST, 4)
    layers = [(inner, BORE, MIDDLE), (outer, MIDDLE, OUTSIDE)]
    return abs(pressure[-1] / bore_pressure(layers, WIDEST) - 1.0)
