"""Free surfaces that are compressed so much that rubber forms creases in them.

The surface of an incompressible Mooney-Rivlin body in plane strain is unstable to creases below a
stretch of 0.647 along it (W. Hong, X. Zhao, Z. Suo, Formation of creases on the surfaces of elastomers
and gels, *Appl. Phys. Lett.* 95, 2009), and to waves of any length below 0.544 (M. A. Biot, Surface
instability of rubber in compression, *Appl. Sci. Res.* A 12, 1963). Neither has a size of its own:
coarse particles and a linear basis hide them, finer particles and a quadratic basis do not.
"""

import numpy as np

from seal_mdao import values
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.contact.self_contact import SelfContactTerm
from seal_mdao.seals.evaluation_points import EvaluationPoints

CREASES = 0.647
"""Stretch along a free surface below which it forms creases."""


def creases(samples: EvaluationPoints) -> str:
    """Describe the free segment of the boundary with the smallest stretch if that is below
    ``CREASES``; else return an empty text.

    Empty for compressible materials, such as foam, too.
    """
    if not samples.keeps_volume:
        return ""
    chains = samples.chains
    ends = chains[:, [0, -1]]
    # stretch of a side between two particles: |x_b - x_a| / |X_b - X_a|
    lengths = [
        np.hypot(*(x[ends[:, 1]] - x[ends[:, 0]]).T) for x in (samples.places, samples.undeformed)
    ]
    held = _touching(samples, chains, lengths[0]) | _held(samples, ends)
    stretch = np.where(held, np.inf, lengths[0] / lengths[1])
    worst = int(stretch.argmin())
    if not stretch[worst] < CREASES:
        return ""
    point = samples.undeformed[chains[worst, chains.shape[1] // 2]]
    return (
        f"the free surface is compressed to {stretch[worst]:.2g} of its length at "
        f"{values.place(point)} (undeformed coordinates): below {CREASES:.2g} rubber forms "
        "creases, which a large particle spacing does not resolve, so an analysis with a smaller "
        "spacing may give another force or fail; use a larger radius at this point, or less travel"
    )


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
            points, gap = term.gaps(samples.places[term.where.at_particles])
            particles = term.where.at_particles[points[gap <= 0.0]]
            touching |= np.isin(chains[:, [0, -1]], particles).any(axis=1)
    return touching
