"""An O-ring squeezed between two planes: the closed form of small squeeze, Lindley's law of large."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from scipy.optimize import brentq

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.contours import Arc, Contour, Outline
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.seals.result import analyze

PENALTY = 2e6
"""Normal penalty of the planes, kPa/mm: they give way by less than 1e-3 of the squeeze."""


class SqueezedRing(NamedTuple):
    """A ring along its path.

    Attributes
    ----------
    squeeze : ndarray, shape (n,)
        Over the diameter.
    force : ndarray, shape (n,)
        N/m.
    width : ndarray, shape (n,)
        Undeformed length in contact with one plane, mm.
    peak : ndarray, shape (n,)
        Pressure, kPa.
    diameter : float
        mm.
    modulus : float
        Of plane strain, E / (1 - nu^2), kPa.
    """

    squeeze: np.ndarray
    force: np.ndarray
    width: np.ndarray
    peak: np.ndarray
    diameter: float
    modulus: float


def squeeze_ring(file: SealFile, spacing: float, share: float = 1.0) -> SqueezedRing:
    """The whole ring of a seal file between two planes, without the walls beside it.

    Parameters
    ----------
    file : SealFile
        Half a circle that stands on y = 0, at x = 0; its first profile comes down on it, its second one
        is the plane below.
    spacing : float
        mm.
    share : float
        Of the travel and of the steps that the file has.
    """
    diameter = float(np.ptp(file.section.outline.box[:, 1]))
    result = analyze(build_seal(_whole(file, diameter, spacing, share)))
    result.require_converged()
    history = profile_histories(result)[0]
    rubber = file.materials[file.section.material]
    shear, bulk = rubber.shear_modulus, rubber.bulk_modulus
    poisson = (3.0 * bulk - 2.0 * shear) / (6.0 * bulk + 2.0 * shear)
    return SqueezedRing(
        history.travel / diameter, history.force[:, 1], history.width, history.peak, diameter,
        2.0 * shear / (1.0 - poisson),
    )  # fmt: skip


def _whole(file, diameter, spacing, share) -> SealFile:
    """The whole ring between the first two profiles: at a plane of symmetry pressures go up and down."""
    radius, names = 0.5 * diameter, ("right", "left")
    outline = Outline(Contour(tuple(
        Arc((0.0, radius), radius, start, np.pi, name)
        for start, name in zip((-0.5 * np.pi, 0.5 * np.pi), names, strict=True)
    )))  # fmt: skip
    lid, plane = (replace(p, contact=names, normal_penalty=PENALTY) for p in file.profiles[:2])
    (stage,) = lid.stages
    steps = round(share * stage.steps)
    way = tuple(steps / stage.steps * x for x in stage.translate)
    lid = replace(lid, stages=(replace(stage, translate=way, steps=steps),))
    return replace(
        file, section=replace(file.section, outline=outline, spacing=spacing),
        symmetries=(), profiles=(lid, plane), measures=(), designs=(), optimize=None,
    )  # fmt: skip


def small_squeeze(force: float, diameter: float, modulus: float) -> tuple[float, float, float]:
    """Squeeze over the diameter, width of contact and peak pressure of an elastic cylinder.

    delta = 2 P / (pi E*) (2 ln(4 R / a) - 1), a^2 = 4 P R / (pi E*), p0 = 2 P / (pi a) (K. L. Johnson,
    Contact Mechanics, 1985, Eqs. (4.43), (4.45), Sec. 5.6).

    Parameters
    ----------
    force : float
        P, N/m.
    diameter : float
        2 R, mm.
    modulus : float
        E* = E / (1 - nu^2), kPa.
    """
    radius = 0.5 * diameter
    a = np.sqrt(4.0 * force * radius / (np.pi * modulus))
    squeeze = 2.0 * force / (np.pi * modulus) * (2.0 * np.log(4.0 * radius / a) - 1.0)
    return float(squeeze / diameter), float(2.0 * a), float(2.0 * force / (np.pi * a))


def small_force(squeeze: float, diameter: float, modulus: float) -> float:
    """Force at a squeeze over the diameter, the inverse of ``small_squeeze``, N/m."""
    most = 0.5 * modulus * diameter
    return float(
        brentq(lambda p: small_squeeze(p, diameter, modulus)[0] - squeeze, 1e-9 * most, most)
    )


def lindley_force(squeeze: float, diameter: float, modulus: float) -> float:
    """E d (1.25 c^1.5 + 50 c^6) at a squeeze c over the diameter d, N/m.

    P. B. Lindley, J. Strain Anal. 1 (1966) 190, from experiments.
    """
    return modulus * diameter * (1.25 * squeeze**1.5 + 50.0 * squeeze**6)
