"""Errors of an extruded boundary: random, and smooth along the arc."""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.seals.samples import sides_of
from seal_mdao.seals.seal import Seal


@dataclass(frozen=True)
class BoundaryTolerance:
    """How far an extruded boundary is from the drawn one.

    Attributes
    ----------
    std : float
        Root mean square of its error over what may move of it, mm.
    length : float
        Along the arc, mm: two places at this distance have a correlation of exp(-1/2).
    """

    std: float
    length: float

    def __post_init__(self):
        values.real("std of the boundary", self.std, 0.0)
        values.real("length of the boundary", self.length, above=0.0)


def boundary_covariance(seal: Seal, tolerance: BoundaryTolerance) -> np.ndarray:
    """Covariance of the boundary offsets, shape (P, P), mm^2.

    Each offset has its place on a boundary, the centre of what it moves. Between two places of a
    boundary of length l at the distance s along it the covariance is that of Gauss of their chord in a
    circle, c = l / pi sin(pi s / l): exp(-c^2 / 2 length^2), a proper covariance for any length.
    Different boundaries have nothing to do with each other. Each is scaled to the stated error.
    """
    loops, velocity = boundary_loops(seal), seal.design_velocity
    weight = np.array([[(v[loop] ** 2).sum() for loop in loops] for v in velocity])
    covariance = np.zeros((len(velocity), len(velocity)))
    for number, loop in enumerate(loops):
        own = np.flatnonzero(weight.reshape(-1, len(loops)).argmax(axis=1) == number)
        if own.size:
            block = _kernel(seal, loop, own, tolerance.length)
            moved = velocity[own][:, loop]
            square = np.einsum("pni,qni,pq->n", moved, moved, block)
            free = np.abs(moved).max(axis=(0, 2)) > 0.0
            covariance[np.ix_(own, own)] = block * tolerance.std**2 / square[free].mean()
    return covariance


def square_root(covariance: np.ndarray) -> np.ndarray:
    """The symmetric square root of a covariance: unlike other factors it does not hang on the order or
    the sign of eigenvectors, so the same seed gives the same boundaries on every machine."""
    values, vectors = np.linalg.eigh(covariance)
    return (vectors * np.sqrt(np.maximum(values, 0.0))) @ vectors.T


def boundary_loops(seal: Seal) -> list[np.ndarray]:
    """Particles of every closed boundary of a seal, in order."""
    sides, _ = sides_of(seal.body.cells)
    after, loops = dict(sides.tolist()), []
    while after:
        loop = [next(iter(after))]
        while (following := after.pop(loop[-1])) != loop[0]:
            loop.append(following)
        loops.append(np.array(loop))
    return loops


def _kernel(seal, loop, own, length) -> np.ndarray:
    """Correlation of the offsets ``own`` by the distances of their centres along a loop."""
    x = seal.drawn_particles[loop]
    pieces = np.linalg.norm(np.roll(x, -1, axis=0) - x, axis=1)
    around = pieces.sum()
    angle = 2.0 * np.pi * (np.cumsum(pieces) - pieces) / around
    weight = (seal.design_velocity[own][:, loop] ** 2).sum(axis=2)
    centre = np.angle(weight @ np.exp(1j * angle))
    chord = around / np.pi * np.sin(0.5 * (centre[:, None] - centre))
    return np.exp(-0.5 * (chord / length) ** 2)
