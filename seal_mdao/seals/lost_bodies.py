"""Bodies without supports that have moved away because nothing holds them."""

from collections.abc import Iterator

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.rkpm.cells import bodies
from seal_mdao.values import place


def lost_bodies(path: PathResult) -> Iterator[str]:
    """Yield a text about every body that has moved farther than profiles and supports can push it, up to
    the last converged step of a path, complete or not.

    The limit is the size of the section and the largest displacement of a profile or of a prescribed
    particle. Motions along an axis along which a particle of the body is prescribed are left out.
    """
    disc = path.discretization
    of_body = bodies(disc.body.cells, disc.body.n_particles)
    prescribed = disc.body.fixed
    size = float(np.ptp(disc.particles, axis=0).max())
    pushed = max(_largest_motion(path), _largest_prescribed(path))
    end = path.displacement_at(path.steps[-1])
    for number in range(of_body.max() + 1):
        own = of_body == number
        # particles that belong to no cell are none of a body
        if own.sum() < 3:
            continue
        free = ~prescribed[own].any(axis=0)
        distance = float(np.hypot(*(end[own].mean(axis=0) * free)))
        if not distance <= size + pushed:
            yield (
                f"the body near {place(disc.particles[own].mean(axis=0))} has moved by "
                f"{distance:.3g} mm, although no profile moves by more than {pushed:.3g} mm, so nothing "
                "holds it; fix one of its edges ([fixed] with directions), give the profiles that touch "
                "it friction, or let it touch its supports at the start"
            )


def _largest_motion(path: PathResult) -> float:
    """Compute how far a profile carries the corners of the section's bounding box, mm, at most."""
    low, high = (own(path.discretization.particles, axis=0) for own in (np.min, np.max))
    corners = np.array([(x, y) for x in (low[0], high[0]) for y in (low[1], high[1])])
    found = 0.0
    for term in path.problem.terms:
        if isinstance(term, ContactTerm):
            first = term.motion.pose(0.0)
            others = (term.motion.pose(step.fraction) for step in path.steps)
            # x' = c + Q^T (x - z - c) at the start
            own = (corners - first.position - first.pivot) @ first.matrix + first.pivot
            moved = [np.hypot(*(pose.places(own) - corners).T).max() for pose in others]
            found = max(found, *moved, 0.0)
    return float(found)


def _largest_prescribed(path: PathResult) -> float:
    """Compute the largest prescribed displacement of a particle over all converged steps, mm."""
    prescribed = path.discretization.body.fixed
    moved = (path.displacement_at(step) * prescribed for step in path.steps)
    return max((float(np.hypot(*own.T).max()) for own in moved), default=0.0)
