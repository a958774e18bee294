"""Random errors of an extruded boundary, smooth along the arc."""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.rkpm.cells import sides_of
from seal_mdao.seals.seal import Seal


@dataclass(frozen=True)
class BoundaryTolerance:
    """Error of an extruded boundary.

    Attributes
    ----------
    std : float
        Root mean square over the movable part of the boundary, mm.
    length : float
        Correlation length along the arc, mm: two points at this distance have the correlation exp(-1/2).
    """

    std: float
    length: float

    def __post_init__(self):
        values.real("std of the boundary", self.std, 0.0)
        values.real("length of the boundary", self.length, above=0.0)


def boundary_covariance(seal: Seal, tolerance: BoundaryTolerance) -> np.ndarray:
    """Compute the covariance of the boundary offsets, shape (P, P), mm^2.

    Each offset is located at the centre of the particles that it moves. On a closed boundary of length l
    the covariance of two points at the distance s along it is Gaussian in their chord in a circle,
    c = l / pi sin(pi s / l): exp(-c^2 / 2 length^2), positive semidefinite for any length. Different
    boundaries are independent. Each is scaled to the given error.
    """
    loops, velocity = boundary_loops(seal), seal.design_velocity
    # an offset belongs to the loop that it moves most
    weight = np.array([[(v[loop] ** 2).sum() for loop in loops] for v in velocity])
    nearest = weight.reshape(-1, len(loops)).argmax(axis=1)
    covariance = np.zeros((len(velocity), len(velocity)))
    for number, loop in enumerate(loops):
        own = np.flatnonzero(nearest == number)
        if own.size:
            block = _correlation(seal, loop, own, tolerance.length)
            # variance of every particle: V_p . V_q C_pq; mean over those that move
            moved = velocity[own][:, loop]
            square = np.einsum("pni,qni,pq->n", moved, moved, block)
            free = np.abs(moved).max(axis=(0, 2)) > 0.0
            covariance[np.ix_(own, own)] = block * tolerance.std**2 / square[free].mean()
    return covariance


def square_root(covariance: np.ndarray) -> np.ndarray:
    """Compute the symmetric square root of a covariance.

    Unlike other factors it does not depend on order or sign of the eigenvectors, so that a seed gives
    the same boundaries on every machine.
    """
    # C^(1/2) = Q diag(sqrt(lambda)) Q^T
    values, vectors = np.linalg.eigh(covariance)
    return (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T


def boundary_loops(seal: Seal) -> list[np.ndarray]:
    """List the particles of every closed boundary of a seal, in order."""
    # the next particle by each particle of the boundary
    sides, _ = sides_of(seal.body.cells)
    after, loops = dict(sides.tolist()), []
    while after:
        # follow the sides until the loop closes
        loop = [next(iter(after))]
        while (following := after.pop(loop[-1])) != loop[0]:
            loop.append(following)
        loops.append(np.array(loop))
    return loops


def _correlation(seal, loop, own, length) -> np.ndarray:
    """Compute the correlation of the offsets ``own`` from the distances of their centres on a loop."""
    x = seal.nominal_particles[loop]
    pieces = np.linalg.norm(np.roll(x, -1, axis=0) - x, axis=1)
    around = pieces.sum()
    # angle of every particle, 2 pi s / l, and weighted circular mean of those that an offset moves
    angle = 2.0 * np.pi * (np.cumsum(pieces) - pieces) / around
    weight = (seal.design_velocity[own][:, loop] ** 2).sum(axis=2)
    centre = np.angle(weight @ np.exp(1j * angle))
    # c = l / pi sin(pi s / l)
    chord = around / np.pi * np.sin(0.5 * (centre[:, None] - centre))
    return np.exp(-0.5 * (chord / length) ** 2)
