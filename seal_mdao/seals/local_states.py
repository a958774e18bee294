"""Local states at the end of a path that mean nothing, and points where stress is singular.

Equilibrium of the section as a whole does not show either: forces and gaps are hardly changed by one
corner.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.measures.singular_points import singular_points
from seal_mdao.seals.samples import Samples
from seal_mdao.structure.particle_stress import particle_stress

LARGEST_STRETCH = 8.0
"""Principal stretch beyond that of any rubber at break."""
LARGEST_STRESS = 100.0
"""Von Mises stress over the shear modulus that no rubber has."""
ABOVE_NEIGHBOURS = 5.0
"""Ratio of such a stress to the median around it above which it is that of a single point."""
NEAR = 2.0
"""Distance from a singular point, in spacings there, within which a stress is that of the point."""
CURE = "round the corner, refine the particles there (spacing, layers), or use less travel"


def meaningless_states(samples: Samples):
    """Describe a stretch or a stress at single points that no rubber has, one line each."""
    found = largest_stretch(samples)
    if not found.value <= LARGEST_STRETCH:
        yield (
            f"a principal stretch is {found.value:.3g} {found.where}, beyond that of any rubber at "
            f"break, so the stress there means nothing; {CURE}"
        )
    path, body = samples.path, samples.path.discretization.body
    places = body.samples.at(samples.path.discretization.particles)
    stress = particle_stress(path, np.arange(len(places)))[0]
    shear = max(
        region.material.shear_modulus
        for region in path.problem.term("structure").definition.regions
    )
    # NaN counts as the largest
    worst = int(np.argmax(np.where(np.isnan(stress), np.inf, stress)))
    if not stress[worst] <= LARGEST_STRESS * shear:
        # the twelve nearest samples, without the point itself
        near = np.median(stress[cKDTree(places).query(places[worst], k=13)[1][1:]])
        if not stress[worst] <= ABOVE_NEIGHBOURS * near:
            yield (
                f"the von Mises stress is {stress[worst]:.3g} kPa, {stress[worst] / shear:.0f} times "
                f"the shear modulus, {_where(places[worst])}, and {near:.3g} kPa around it: the "
                f"cells there are distorted, and this stress means nothing; {CURE}"
            )


class Largest(NamedTuple):
    """A largest value and where it is, in words."""

    value: float
    where: str


def largest_stretch(samples: Samples) -> Largest:
    """Find the largest principal stretch at the samples in the plane of the section."""
    stretch = samples.stretches[:, 1]
    # NaN counts as the largest
    worst = int(np.argmax(np.where(np.isnan(stretch), np.inf, stretch)))
    return Largest(float(stretch[worst]), _where(samples.undeformed[worst]))


def _where(point) -> str:
    return f"where x = {point[0]:.3g}, y = {point[1]:.3g} undeformed"


class StressPeak(NamedTuple):
    """Largest von Mises stress over a section.

    Attributes
    ----------
    stress : float
        kPa.
    place : ndarray, shape (2,)
        Undeformed, mm.
    singular : str
        Kind of the singular point within ``NEAR`` spacings; empty where there is none.
    elsewhere : tuple of float and ndarray, or None
        The largest one farther from all singular points, and its place; None where there are none.
    """

    stress: float
    place: np.ndarray
    singular: str
    elsewhere: tuple | None


def stress_peak(result) -> StressPeak:
    """Find the largest von Mises stress at the end of a completed path, with that away from singular
    points."""
    places, stress = result.section_stress()
    points = singular_points(result.path.discretization.body, result.particles)
    worst, away, kind, least = int(stress.argmax()), np.ones(len(stress), bool), "", NEAR
    for point in points:
        # distance of every sample in spacings at the point
        distance = np.linalg.norm(places - point.place, axis=1) / point.spacing
        away &= distance > NEAR
        # the nearest singular point names the peak
        if distance[worst] <= least:
            kind, least = point.kind, distance[worst]
    elsewhere = None
    if points and away.any():
        largest = int(np.where(away, stress, -np.inf).argmax())
        elsewhere = float(stress[largest]), places[largest]
    return StressPeak(float(stress[worst]), places[worst], kind, elsewhere)
