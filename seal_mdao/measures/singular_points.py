"""Points of a section at which the exact stress is infinite."""

from typing import NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.rkpm.cells import sides_of
from seal_mdao.rkpm.visibility import parts_of_sides

REENTRANT = np.pi / 4.0
"""Angle by which a boundary turns into the body at a re-entrant corner, at the least."""
STIFFER = 1.25
"""Ratio of moduli of two materials above which stress is singular at the ends of their interface. Of two
incompressible materials with square ends and this ratio it grows by less than 0.5 % per halving of the
spacing."""
STRAIGHT = 1e-9
"""Sine of the angle up to which a side is parallel to a plane."""
FIXED_END = "the end of a fixed edge"
REENTRANT_CORNER = "a re-entrant corner"
INTERFACE_END = "the end of an interface between materials"
INTERFACE_CORNER = "a corner of an interface between materials"
"""Kinds of singular points."""


class SingularPoint(NamedTuple):
    """A point at which the stress of the exact solution is infinite."""

    place: np.ndarray
    spacing: float
    kind: str


def singular_points(body, particles: np.ndarray, elastic) -> list[SingularPoint]:
    """Find re-entrant corners, the ends of fixed edges, and the ends and corners of interfaces between
    materials of different stiffness, of a body with these particles (n, 2).

    Parameters
    ----------
    elastic : ElasticBody
        Its regions have the materials.
    """
    outer, inner = sides_of(body.cells)
    following, before = dict(outer.tolist()), dict(outer[:, ::-1].tolist())
    fixed, found = body.fixed.all(axis=1), []
    directions = _interface_directions(body, particles, elastic, inner)
    for point, after in following.items():
        last = before[point]
        one, other = particles[point] - particles[last], particles[after] - particles[point]
        # turn of the boundary, negative towards the body, which lies on the left
        turn = np.arctan2(one[0] * other[1] - one[1] * other[0], one @ other)
        planes = [in_plane(body, particles, *side) for side in ((last, point), (point, after))]
        if sum(planes) == 1:
            # the boundary continues with its mirror image: the angle pi - turn of the body is doubled
            turn = 2.0 * turn - np.pi
        lines, kind = directions.pop(point, []), ""
        # the fixed edge ends here, and does not continue with its mirror image
        held = [fixed[last] or planes[0], fixed[after] or planes[1]]
        if fixed[point] and not all(held):
            kind = FIXED_END
        elif turn < -REENTRANT and not fixed[point]:
            kind = REENTRANT_CORNER
        elif lines:
            kind = _kind_on_boundary(lines, body.fixed[point])
        if kind:
            # spacing of the particles there
            size = max(np.linalg.norm(one), np.linalg.norm(other))
            found.append(SingularPoint(particles[point], float(size), kind))
    # the other ends of lines lie inside
    for point, lines in directions.items():
        if _is_corner(lines):
            size = max(np.linalg.norm(line) for line in lines)
            found.append(SingularPoint(particles[point], float(size), INTERFACE_CORNER))
    return found


def in_plane(body, particles: np.ndarray, first: int, last: int) -> bool:
    """Whether a side of the boundary lies in a plane of symmetry or on the axis of revolution: its
    particles cannot move across it, but along it."""
    across = body.fixed[first] & body.fixed[last]
    side = np.abs(particles[last] - particles[first])
    return bool(across.sum() == 1 and side[across].item() <= STRAIGHT * side.sum())


def _interface_directions(body, particles, elastic, inner) -> dict[int, list[np.ndarray]]:
    """Find the sides (2,) of interfaces between materials of different stiffness at their particles."""
    if len(elastic.regions) == 1:
        return {}
    numbers = elastic.per_cell(range(len(elastic.regions)), len(body.cells), int)
    first, last = parts_of_sides(body.cells, numbers, inner)
    moduli = np.array([_moduli(region.material) for region in elastic.regions])
    ratio = np.abs(np.log(moduli[last] / moduli[first])).max(axis=1)
    found = {}
    for a, b in inner[ratio > np.log(STIFFER)].tolist():
        found.setdefault(a, []).append(particles[b] - particles[a])
        found.setdefault(b, []).append(particles[a] - particles[b])
    return found


def _moduli(material) -> tuple[float, float]:
    """Return G and the plane strain modulus E / (1 - nu^2) = 4 G (3 K + G) / (3 K + 4 G)."""
    shear, bulk = material.shear_modulus, material.initial_bulk_modulus
    return shear, 4.0 * shear * (3.0 * bulk + shear) / (3.0 * bulk + 4.0 * shear)


def _kind_on_boundary(lines, fixed) -> str:
    """Return the kind of a point of the boundary at which these sides of interfaces end; empty if the
    stress there is finite."""
    if fixed.all() or not fixed.any():
        return INTERFACE_END
    # in a plane of symmetry the interface continues with its mirror image
    mirror = np.where(fixed, -1.0, 1.0)
    return INTERFACE_CORNER if _is_corner([*lines, *(mirror * line for line in lines)]) else ""


def _is_corner(lines) -> bool:
    """Whether interfaces with these sides from a point have a corner or a junction there."""
    if len(lines) != 2:
        return True
    (a, b), (c, d) = lines
    # angle between one side and the continuation of the other
    return bool(abs(np.arctan2(b * c - a * d, -a * c - b * d)) > REENTRANT)


def away_from_singular(seal, distance: float) -> np.ndarray:
    """Find the points of ``Body.samples`` farther than ``distance`` (mm) from all singular points of the
    nominal section, so that they are the same in every design.

    Raises
    ------
    ValueError
        Where no point is left.
    """
    body, particles = seal.body, seal.nominal_particles
    places = body.samples.at(particles)
    singular = singular_points(body, particles, seal.definitions[0])
    if not singular:
        return np.arange(len(places))
    # |X_i - X_s| > distance for the nearest singular point s
    nearest = cKDTree([point.place for point in singular]).query(places)[0]
    left = np.flatnonzero(nearest > distance)
    if not left.size:
        raise ValueError(
            f"no point of the section is farther than {distance:g} mm from its singular points "
            f"(ends of fixed edges and of interfaces, corners); the farthest one is "
            f"{nearest.max():.3g} mm away; use a smaller away_from_singular"
        )
    return left
