"""Inadmissible stretches and stresses at single points at the end of a load path, and points of
singular stress.

Equilibrium of the section as a whole does not show either: forces and gaps are hardly changed by one
corner.
"""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao import values
from seal_mdao.measures.singular_points import REENTRANT_CORNER, singular_points
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.structure.particle_stress import particle_stress

LARGEST_STRETCH = 8.0
"""Principal stretch beyond that of any rubber at break."""
LARGEST_STRESS = 100.0
"""Von Mises stress over the shear modulus that no rubber has."""
ABOVE_NEIGHBOURS = 5.0
"""Ratio of such a stress to the median around it above which it is that of a single point."""
NEAR = 2.0
"""Distance from a singular point, in spacings there, within which a stress is that of the point."""
BESIDE = 1.0
"""Distance from the end or a corner of a bond, in spacings there, within which its singularity may
invert points between the particles. On a bonded half disc and a bonded gasket no point farther away
does."""
CURE = "round the corner, use a smaller spacing or more layers there, or use less travel"
LEAVE_OUT = (
    "the exact stress at this point is infinite, so the computed stress grows with refinement; "
    "exclude this point from stress measures (away_from_singular of von_mises)"
)
"""What to do at the end or a corner of a bond, which no refinement cures."""


def ends_of_bonds(samples: EvaluationPoints, points: np.ndarray) -> np.ndarray:
    """Find the kind of the singular point within ``BESIDE`` spacings at which a bond to a rigid body, or
    between two materials, ends or has a corner, for points (k, 2); empty texts elsewhere, shape (k,)."""
    kinds, least = np.full(len(points), "", object), np.full(len(points), BESIDE)
    for end in section_singular_points(samples.path):
        if end.kind != REENTRANT_CORNER:
            # |X - X_s| <= BESIDE h_s; the nearest one counts
            distance = np.linalg.norm(points - end.place, axis=1) / end.spacing
            kinds[distance <= least] = end.kind
            least = np.minimum(least, distance)
    return kinds


def section_singular_points(path):
    """Find the singular points of the undeformed section of a path."""
    disc, structure = path.discretization, path.problem.term("structure")
    return singular_points(disc.body, disc.particles, structure.definition)


def meaningless_states(samples: EvaluationPoints):
    """Describe stretches and stresses at single points that are beyond the range of rubber, one
    line each, with the undeformed point (2,), mm.

    The stress of inverted material at the end of a fixed edge is not a number; ``seals.checks`` reports
    it by the volume change; so is that at the end or a corner of an interface.
    """
    found = largest_stretch(samples)
    if not found.value <= LARGEST_STRETCH:
        yield (
            f"a principal stretch is {found.value:.3g} {found.where}, larger than the stretch at "
            "break of any rubber, so the stress at this point is meaningless; "
            f"{cure_at(samples, found.point)}",
            found.point,
        )
    path, body = samples.path, samples.path.discretization.body
    places = body.samples.at(samples.path.discretization.particles)
    stress = particle_stress(path, np.arange(len(places))).value
    structure = path.problem.term("structure")
    moduli = np.array([region.material.shear_modulus for region in structure.definition.regions])
    # stress over the shear modulus of the own material
    ratio = stress / moduli[structure.sample_regions]
    # NaN counts as the largest, but at the end of a bond
    unknown = np.where(ends_of_bonds(samples, places) != "", 0.0, np.inf)
    worst = int(np.argmax(np.where(np.isnan(ratio), unknown, ratio)))
    if np.isnan(stress[worst]):
        yield (
            f"the von Mises stress cannot be computed {_where(places[worst])}, because the "
            f"material is inverted there (det F < 0); {cure_at(samples, places[worst])}",
            places[worst],
        )
    elif ratio[worst] > LARGEST_STRESS:
        # the twelve nearest samples, without the point itself, of the same material if it has as many
        own = np.flatnonzero(structure.sample_regions == structure.sample_regions[worst])
        own = own if len(own) >= 13 else np.arange(len(places))
        near = np.median(stress[own[cKDTree(places[own]).query(places[worst], k=13)[1][1:]]])
        if not stress[worst] <= ABOVE_NEIGHBOURS * near:
            yield (
                f"the von Mises stress is {stress[worst]:.3g} kPa, {ratio[worst]:.0f} "
                f"times the shear modulus, {_where(places[worst])}, but only {near:.3g} kPa at "
                "the points around it: the background cells at this point are distorted, and "
                f"this stress is meaningless; {cure_at(samples, places[worst])}",
                places[worst],
            )


def cure_at(samples: EvaluationPoints, point: np.ndarray) -> str:
    """Describe the remedy for an inadmissible state at an undeformed point."""
    return LEAVE_OUT if ends_of_bonds(samples, point[None])[0] else CURE


class Largest(NamedTuple):
    """Largest value of a quantity, its position in words, and the undeformed point, mm."""

    value: float
    where: str
    point: np.ndarray


def largest_stretch(samples: EvaluationPoints) -> Largest:
    """Find the largest principal stretch at the samples in the plane of the section."""
    stretch = samples.stretches[:, 1]
    # NaN counts as the largest
    worst = int(np.argmax(np.where(np.isnan(stretch), np.inf, stretch)))
    point = samples.undeformed[worst]
    return Largest(float(stretch[worst]), _where(point), point)


def _where(point) -> str:
    return f"at {values.place(point)} (undeformed coordinates)"


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
    points = section_singular_points(result.path)
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
