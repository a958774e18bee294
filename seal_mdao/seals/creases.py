"""Free surfaces that are compressed so much that rubber forms creases in them.

The surface of an incompressible Mooney-Rivlin body in plane strain is unstable to creases below a
stretch of 0.647 along it (W. Hong, X. Zhao, Z. Suo, Formation of creases on the surfaces of elastomers
and gels, *Appl. Phys. Lett.* 95, 2009), and to waves of any length below 0.544 (M. A. Biot, Surface
instability of rubber in compression, *Appl. Sci. Res.* A 12, 1963). Neither has a size of its own:
coarse particles and a linear basis hide them, finer particles and a quadratic basis do not.

With a stretch h across the plane creases form at the same ratio 2.4 of the stretches normal to the
surface and along it (Hong et al.), 1 / (l^2 h) = 1 / 0.647^2, that is, below l = 0.647 / h^(1/2). Free
growth theta is no compression: l / theta and h / theta take the places of l and h.
"""

import numpy as np

from seal_mdao import values
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.contact.self_contact import SelfContactTerm
from seal_mdao.seals.evaluation_points import EvaluationPoints

CREASES = 0.647
"""Stretch along a free surface below which it forms creases in plane strain."""


def creases(samples: EvaluationPoints) -> str:
    """Describe the free segment of the boundary with the smallest ratio of its stretch to that at which
    creases form if that is below 1; else return an empty text.

    Segments of compressible materials, such as foam, form none.
    """
    chains = samples.chains
    ends = chains[:, [0, -1]]
    # stretch of a side between two particles: |x_b - x_a| / |X_b - X_a|
    lengths = [
        np.hypot(*(x[ends[:, 1]] - x[ends[:, 0]]).T) for x in (samples.places, samples.undeformed)
    ]
    held = _touching(samples, chains, lengths[0]) | _held(samples, ends)
    # a side has the material of its middle; an end may lie on an interface
    regions = samples.regions[chains[:, chains.shape[1] // 2]]
    held |= ~samples.keeps_volume[regions]
    growth, across = _growth(samples)[regions], _across(samples, chains)
    # l / theta below 0.647 / (h / theta)^(1/2)
    stretch, limit = lengths[0] / lengths[1], CREASES * growth * np.sqrt(growth / across)
    ratio = np.where(held, np.inf, stretch / limit)
    worst = int(ratio.argmin())
    if not ratio[worst] < 1.0:
        return ""
    point = samples.undeformed[chains[worst, chains.shape[1] // 2]]
    return (
        f"the free surface is compressed to {stretch[worst]:.2g} of its length at "
        f"{values.place(point)} (undeformed coordinates): below {limit[worst]:.2g} rubber forms "
        "creases, which a large particle spacing does not resolve, so an analysis with a smaller "
        "spacing may give another force or fail; use a larger radius at this point, or less travel"
    )


def _growth(samples: EvaluationPoints) -> np.ndarray:
    """Free growth theta of the material of every region at the end of the path, shape (regions,)."""
    return np.array([samples.growth(region) for region in samples.material_regions])


def _across(samples: EvaluationPoints, chains) -> np.ndarray:
    """Stretch across the plane at the middles of sides, shape (m,)."""
    if not samples.path.discretization.body.axisymmetric:
        return np.full(len(chains), samples.axial_stretch)
    # h = r / R; 1 on the axis and beyond it, where no surface is
    middles = chains[:, chains.shape[1] // 2]
    radius, deformed = samples.undeformed[middles, 0], samples.places[middles, 0]
    outside = (radius > 0.0) & (deformed > 0.0)
    return np.where(outside, deformed / np.where(outside, radius, 1.0), 1.0)


def _held(samples: EvaluationPoints, ends) -> np.ndarray:
    """Find the sides with a prescribed displacement at both ends (m, 2), a mask (m,): fixed and moved
    edges, planes of symmetry and the axis of revolution are no free surfaces."""
    return samples.path.discretization.body.fixed[ends].all(axis=1).any(axis=1)


def _touching(samples: EvaluationPoints, chains, lengths) -> np.ndarray:
    """Find the sides that touch a profile or another part of the boundary, a mask (m,)."""
    path, touching = samples.path, np.zeros(len(chains), bool)
    middles = samples.places[chains[:, chains.shape[1] // 2]]
    for term in path.problem.terms:
        if isinstance(term, ContactTerm):
            # nearer to the profile than half of the side's length
            touching |= term.gaps(middles, path.steps[-1].fraction) < 0.5 * lengths
        elif isinstance(term, SelfContactTerm):
            points, gap = term.gaps(path.responses(term.label)[-1].x)
            particles = term.where.of_particles[points[gap <= 0.0]]
            touching |= np.isin(chains[:, [0, -1]], particles).any(axis=1)
    return touching
