"""Edges that penetrate a rigid profile because they are not among its contact edges."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.geometry.motion import Motion
from seal_mdao.rkpm.cells import sides_of
from seal_mdao.seals.profiles import stage_of

SAME = 1e-9
"""Difference of the gaps to two profiles that have the same curve and motion, mm: rounding."""


class Buried(NamedTuple):
    """Edge that penetrates a profile without being one of its contact edges, with its deepest
    particle in all load steps.

    Attributes
    ----------
    edge, profile : str
    depth : float
        mm.
    place : ndarray, shape (2,)
        Deformed, mm.
    since : str
        Position of the profile at the first load step after which the edge lies inside.
    cure : str
    """

    edge: str
    profile: str
    depth: float
    place: np.ndarray
    since: str
    cure: str


def buried_edges(path: PathResult, least: float) -> Iterator[Buried]:
    """Yield the edges that penetrate a profile by more than ``least`` mm without being one of its
    contact edges.

    Edges of holes are left out: the wall before them lies inside the profile, too.
    """
    body, nominal = path.discretization.body, path.nominal_steps
    terms = [term for term in path.problem.terms if isinstance(term, ContactTerm)]
    # x = X + u after every load step
    x = [path.discretization.particles + path.displacement(k) for k in range(len(nominal))]
    leading = next((term.motion for term in terms if term.motion.moves), None)
    outside = [
        name for name in body.edges if not _of_hole(body.edges, name, path.discretization.particles)
    ]
    for term in terms:
        # ends of the sides that belong to the contact points
        same = [term, *same_profiles(path, term)]
        touched = np.unique(np.concatenate([own.where.edges.ravel() for own in same]))
        free = {name: np.setdiff1d(body.edges[name].particles, touched) for name in outside}
        may = [name for name, own in free.items() if not own.size]
        found = {}
        for name in (name for name in free if name not in may):
            # deepest particle of every load step: g_n < 0 inside
            gaps = [term.gaps(at[free[name]], s.fraction) for at, s in zip(x, nominal, strict=True)]
            depths = np.array([-gap.min() for gap in gaps])
            if (depths > least).any():
                worst = int(depths.argmax())
                place = x[worst][free[name]][gaps[worst].argmin()]
                found[name] = float(depths[worst]), place, int((depths > least).argmax())
        motion = term.motion if leading is None or term.motion.moves else leading
        for name, (depth, place, first) in found.items():
            cure = _cure(body, name, [*may, *found])
            yield Buried(name, term.label, depth, place, _position(motion, first), cure)


def same_profiles(path: PathResult, term: ContactTerm) -> list[ContactTerm]:
    """List the other contacts with a profile of the same curve and motion, for other edges: the gaps of
    all particles are the same after every load step."""

    def is_same(other):
        for k, step in enumerate(path.nominal_steps):
            x = path.discretization.particles + path.displacement(k)
            one, two = term.gaps(x, step.fraction), other.gaps(x, step.fraction)
            if not np.allclose(one, two, rtol=0.0, atol=SAME):
                return False
        return True

    others = [own for own in path.problem.terms if isinstance(own, ContactTerm) and own is not term]
    return [own for own in others if is_same(own)]


def missing_contact(path: PathResult) -> str:
    """Describe the edge nearest to a profile that is not one of its contact edges, for an analysis
    that failed.

    Empty unless a particle of it came nearer than half of a side of the boundary.
    """
    body = path.discretization.body
    a, b = path.discretization.particles[sides_of(body.cells)[0].T]
    near = buried_edges(path, -0.5 * float(np.hypot(*(b - a).T).mean()))
    own = max(near, key=lambda own: own.depth, default=None)
    if own is None:
        return ""
    lies = f"came as near as {-own.depth:.3g} mm"
    if own.depth > 0.0:
        lies = f"penetrates it by up to {own.depth:.3g} mm"
    return (
        f"The edge {own.edge!r} has no contact with the profile {own.profile!r} (key contact), but "
        f"{lies}; {own.cure}"
    )


def _of_hole(edges: dict, name: str, x: np.ndarray) -> bool:
    """Return whether an edge is part of a closed boundary that is walked clockwise."""
    loop = [name]
    # each edge ends where the next one begins
    while not edges[loop[-1]].closed:
        end = edges[loop[-1]].particles[-1]
        following = [n for n, e in edges.items() if e.particles[0] == end and not e.closed]
        if not following or following[0] in loop:
            break
        loop.append(following[0])
    a = x[np.concatenate([edges[own].particles for own in loop])]
    b = np.roll(a, -1, axis=0)
    # A = 1/2 sum x_a x x_b
    return bool((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum() < 0.0)


def _position(motion: Motion, step: int) -> str:
    """Write the travel or turn since its stage began, or else the load step, after a step (from 0)."""
    stage = int(stage_of(motion, step)) - 1
    begin = np.array([*motion.positions[stage], motion.angles[stage]])
    x, y, angle = np.array(motion.coordinates(step + 1.0)) - begin
    of_stage = f" in stage {stage + 1}" if len(motion.steps) > 1 else ""
    if np.hypot(x, y) > 0.0:
        return f"a travel of {np.hypot(x, y):.3g} mm{of_stage}"
    turned = f"a turn of {abs(np.degrees(angle)):.3g} degrees{of_stage}"
    return turned if angle else f"load step {step + 1}"


def _cure(body, name: str, touching) -> str:
    """Say what to do for an edge, where all edges of ``touching`` have to touch the profile."""
    if body.fixed[body.edges[name].particles].all():
        return "the edge is fixed, so use less travel, or end the fixed edge before the profile"
    listed = [own for own in body.edges if own in touching]
    # neighbours on the boundary begin once, or nowhere all round it
    ends = {int(body.edges[own].particles[-1]) for own in listed}
    if sum(int(body.edges[own].particles[0]) not in ends for own in listed) > 1:
        return "add a second [[profile]] with the same curve and motion for this edge"
    names = ", ".join(f'"{own}"' for own in listed)
    return (
        f"add this edge, contact = [{names}], or leave out contact to include all free "
        "neighbouring edges"
    )
