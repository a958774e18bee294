"""Symmetric seals that buckle to one side: the equations do not say to which."""

import numpy as np
from scipy.spatial import cKDTree

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.contact.self_contact import SelfContactTerm
from seal_mdao.rkpm.cells import sides_of
from seal_mdao.terms.point_assembly import interpolate

SYMMETRIC = 1e-3
"""Largest distance of mirrored points and difference of their gaps, over the size of the section."""
ONE_SIDED = 0.1
"""Difference of mirrored displacements over the largest one above which a seal has buckled."""


def arbitrary_side(path: PathResult) -> str:
    """Describe a section that buckles to one side at the end of a path, although it, its supports and
    the motion of all profiles are symmetric about a line along the closing direction; else empty.

    Empty with prescribed displacements and other loads, and for bodies of revolution, too.
    """
    problem, disc = path.problem, path.discretization
    others = [term for term in problem.terms if term is not problem.term("structure")]
    profiles = [term for term in others if isinstance(term, ContactTerm)]
    leading = next((term.motion for term in profiles if term.motion.moves), None)
    only_contact = all(isinstance(term, ContactTerm | SelfContactTerm) for term in others)
    if leading is None or not only_contact or problem.imposed or disc.body.axisymmetric:
        return ""
    closing = leading.positions[1] - leading.positions[0]
    if not closing.any():
        return ""
    mirror = _Mirror(disc.particles, closing)
    boundary = np.unique(sides_of(disc.body.cells)[0])
    x, displacement = disc.particles[boundary], path.displacement()[boundary]
    image = mirror.images(x)
    if image is None or not _symmetric(path, mirror, boundary, image):
        return ""
    symmetric = (
        "the section, its supports and the motion of the profiles are symmetric about a line along the "
        "closing direction"
    )
    choose = (
        "turn the profile by about one degree (angle), or make the section slightly curved, so that "
        "the side is defined"
    )
    # displacements below the tolerance are those of a seal that is released again
    sideways = np.abs(displacement @ mirror.normal).max()
    if sideways > mirror.tolerance and mirror.is_one_sided(displacement, image):
        return (
            f"{symmetric}, but the seal has buckled and deflects sideways by up to {sideways:.3g} "
            "mm: to which side is arbitrary, and a real seal may buckle to the other one; " + choose
        )
    for point in path.critical_points:
        mode = np.empty_like(disc.particles)
        interpolate(disc.everywhere.table, point.mode, mode)
        # the path has stayed on the symmetric branch
        if point.moved == 0.0 and mirror.is_one_sided(mode[boundary], image):
            return (
                f"{symmetric}, and the analysis follows symmetric equilibria, which may not be stable "
                f"from load step {point.fraction:.4g} on: a real seal may buckle to either side; "
                + choose
            )
    return ""


class _Mirror:
    """Reflection x -> x - 2 (n . x - m) n about the middle line of a section along a direction.

    Parameters
    ----------
    particles : ndarray, shape (n, 2)
        Of the section.
    direction : ndarray, shape (2,)
        Of the line.
    """

    def __init__(self, particles: np.ndarray, direction: np.ndarray):
        self.normal = np.array([direction[1], -direction[0]]) / np.hypot(*direction)
        across = particles @ self.normal
        self.middle = 0.5 * (across.min() + across.max())
        self.tolerance = SYMMETRIC * float(np.ptp(particles, axis=0).max())

    def of(self, x: np.ndarray) -> np.ndarray:
        """Reflect points (k, 2)."""
        return x - 2.0 * np.outer(x @ self.normal - self.middle, self.normal)

    def images(self, x: np.ndarray) -> np.ndarray | None:
        """Return which point is the image of each one (k, 2), shape (k,); None where one has none."""
        away, image = cKDTree(x).query(self.of(x))
        return image if away.max() <= self.tolerance else None

    def is_one_sided(self, u: np.ndarray, image: np.ndarray) -> bool:
        """Return whether displacements (k, 2) of points with these images are not symmetric."""
        # u(M x) - M u(x)
        difference = u[image] - u + 2.0 * np.outer(u @ self.normal, self.normal)
        return bool(np.hypot(*difference.T).max() > ONE_SIDED * np.hypot(*u.T).max())


def _symmetric(path: PathResult, mirror: _Mirror, boundary, image) -> bool:
    """Return whether supports, materials and profiles are symmetric, with the ``image`` of every
    boundary particle (k,)."""
    disc = path.discretization
    fixed = disc.body.fixed[boundary]
    if not np.array_equal(fixed, fixed[image]):
        return False
    # centroids of the materials on the line
    across = disc.particles[disc.body.cells].mean(axis=1) @ mirror.normal
    area = disc.weights.sum(axis=1)
    for region in path.problem.term("structure").definition.regions:
        own = slice(None) if region.cells is None else region.cells
        centroid = np.average(across[own], weights=area[own])
        if abs(centroid - mirror.middle) > mirror.tolerance:
            return False
    for term in path.problem.terms:
        if not isinstance(term, ContactTerm | SelfContactTerm):
            continue
        # friction that differs between edges is taken to be unsymmetric
        if isinstance(term.law.friction, FrictionByGroup):
            return False
        if isinstance(term, SelfContactTerm):
            continue
        if mirror.images(term.reference) is None:
            return False
        # friction drags the seal to the side to which a profile slides or turns
        sideways = np.ptp(term.motion.positions @ mirror.normal)
        if sideways > mirror.tolerance or np.ptp(term.motion.angles):
            return False
        # equal gaps of mirrored contact points at the start and after every stage
        both = term.reference, mirror.of(term.reference)
        for fraction in np.cumsum([0, *term.motion.steps]):
            gap, other = (term.gaps(x, float(fraction)) for x in both)
            if np.abs(gap - other).max() > mirror.tolerance:
                return False
    return True
