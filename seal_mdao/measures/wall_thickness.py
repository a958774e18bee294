"""Smooth lower bound of the smallest wall thickness of the undeformed section, and its position."""

from dataclasses import dataclass
from itertools import combinations
from math import ceil, log, log1p
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.geometry.polygon import from_sides
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.smooth_peaks import p_norm
from seal_mdao.rkpm.cells import bodies, joined

DEFICIT = 0.02
"""Default bound on the relative amount by which the smooth minimum is below the smallest thickness."""


class Distances(NamedTuple):
    """Distances of points from straight sides.

    Attributes
    ----------
    points : ndarray of int, shape (m,)
        Particles.
    sides : ndarray of int, shape (m, 2)
        Particles at the ends of the sides.
    along : ndarray, shape (m,)
        Where on the side the closest point is, from 0 to 1.
    across : ndarray, shape (m, 2)
        Vectors from the closest points to the points, mm.
    size : ndarray, shape (m,)
        Distances, mm.
    """

    points: np.ndarray
    sides: np.ndarray
    along: np.ndarray
    across: np.ndarray
    size: np.ndarray


@dataclass(frozen=True)
class WallThickness(Measure):
    """Smooth lower bound of the smallest wall thickness of the undeformed section.

    The thickness is the smallest distance d_i of the boundary particles on one side of a wall from the
    straight sides on the other, for both sides. With n such pairs

        (1 - deficit) min_i d_i <= n^(-1/p) min_i d_i <= (sum_i d_i^-p)^(-1/p) <= min_i d_i,

    p = -ln n / ln(1 - deficit). It needs no load path: its derivatives are those in the particles.

    Attributes
    ----------
    edges, opposite : tuple of str
        Names of edges on the two sides of the wall; without any, the walls between all closed
        boundaries of one body: its outside and its holes.
    deficit : float
        Bound on the relative deficit: with a smaller one the derivatives change faster with the design.

    Raises
    ------
    ValueError
        For a deficit that is not between 0 and 1, or edges of one side alone.
    """

    edges: tuple = ()
    opposite: tuple = ()
    deficit: float = DEFICIT
    name: str = "wall_thickness"
    units = "mm"
    text = "Smallest wall thickness of the undeformed section, a smooth lower bound."

    def __post_init__(self):
        values.real(f"deficit of {self.name!r}", self.deficit, above=0.0, below=1.0)
        if bool(self.edges) != bool(self.opposite):
            raise ValueError(
                f"the measure {self.name!r} needs both edges and opposite, the two sides of a "
                "wall, or neither of these keys"
            )

    def evaluate(self, result, partials):
        found = self.distances(result.seal.body, result.particles)
        value, by_size = self._smooth_minimum(found.size)
        # dd/dx = e,  dd/da = -(1 - t) e,  dd/db = -t e with e = (x - c) / d, c = a + t (b - a)
        pull = (by_size / found.size)[:, None] * found.across
        along = found.along[:, None]
        for at, weight in ((found.points, 1.0), (found.sides.T[0], along - 1.0),
                           (found.sides.T[1], -along)):  # fmt: skip
            np.add.at(partials.particles[0], at, weight * pull)
        return value

    def _smooth_minimum(self, size: np.ndarray) -> tuple[float, np.ndarray]:
        """Compute (sum d^-p)^(-1/p) and its derivatives, shape (m,)."""
        # n^(-1/p) >= 1 - deficit
        order = max(2, ceil(-log(len(size)) / log1p(-self.deficit)))
        norm, by_inverse = p_norm(1.0 / size, order)
        # m = 1 / N(1 / d),  dm/dd = dN / N^2 / d^2
        return 1.0 / norm, by_inverse / (norm * size) ** 2

    def place(self, result) -> np.ndarray:
        """Return the middle of the wall at its thinnest point, in the undeformed section, shape
        (2,)."""
        found = self.distances(result.seal.body, result.particles)
        least = found.size.argmin()
        return result.particles[found.points[least]] - 0.5 * found.across[least]

    def distances(self, body, particles: np.ndarray) -> Distances:
        """Compute the distances of points and sides across all walls.

        Raises
        ------
        ValueError
            For a section without such a wall, or edges that meet.
        """
        walls = self._walls(body)
        if not walls:
            raise ValueError(
                f"the measure {self.name!r} cannot find a wall, because the section has no hole; "
                "give both sides of a wall by the keys edges and opposite"
            )
        # points of either side with the straight sides of the other
        pairs = [_every_pair(*own) for wall in walls for own in (wall, wall[::-1])]
        points, sides = (np.concatenate(own) for own in zip(*pairs, strict=True))
        x, a, b = particles[points], particles[sides[:, 0]], particles[sides[:, 1]]
        along, across = from_sides(x, a, b)
        # d_i = |x - c|
        size = np.hypot(*across.T)
        if not size.all():
            raise ValueError(
                f"the edges of the measure {self.name!r}, {', '.join(self.edges)} and "
                f"{', '.join(self.opposite)}, share a point, where the thickness is zero; name "
                "edges that do not meet"
            )
        return Distances(points, sides, along, across, size)

    def _walls(self, body) -> list:
        """List the pairs of straight sides (m, 2) on both sides of every wall."""
        if self.edges:
            named = self.edges, self.opposite
            return [[np.concatenate([body.edge(n).sides for n in names]) for names in named]]
        # closed boundaries are joined by sides, bodies by cells
        every = np.concatenate([edge.sides for edge in body.edges.values()])
        # number of the boundary of every side, number of the body of every particle
        loop = joined(every, body.n_particles)[every[:, 0]]
        of_body = bodies(body.cells, body.n_particles)
        loops = [every[loop == number] for number in dict.fromkeys(loop.tolist())]
        return [
            pair for pair in combinations(loops, 2)
            if of_body[pair[0][0, 0]] == of_body[pair[1][0, 0]]
        ]  # fmt: skip


def _every_pair(own: np.ndarray, others: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Pair every particle of the sides ``own`` with every side of ``others``."""
    points = np.unique(own)
    return np.repeat(points, len(others)), np.tile(others, (len(points), 1))
