"""Number of layers of particles across the walls of a cloud, and walls with too few layers."""

from typing import NamedTuple

import numpy as np

from seal_mdao.seals.outline.section_cloud import wall_thickness

ENOUGH = 5
"""Layers with which forces are within half a percent (page on accuracy)."""
ALONG = 1.75
"""Least length of a wall over its thickness; tips and notches are shorter. Pads of 1.83 are 13 % too
stiff with 3 layers."""
NEARLY = 0.75
"""Tolerance of the number of cells across, as cells of a mesh differ in size."""


class ThinWall(NamedTuple):
    """The wall with the fewest layers of particles across it.

    Attributes
    ----------
    layers : int
    thickness : float
        mm.
    place : ndarray, shape (2,)
        A point of its boundary, mm.
    """

    layers: int
    thickness: float
    place: np.ndarray


def thin_wall(loops, particles: np.ndarray, cells: np.ndarray, wanted: int = ENOUGH):
    """Find the wall with the fewest layers of particles, if fewer than ``wanted``; else None.

    ``loops`` are the boundary particles of every loop, ``cells`` (m, 4).
    """
    points = [particles[loop] for loop in loops]
    size = _cell_sizes(particles, cells)
    worst = None
    for loop, at, thickness in zip(loops, points, wall_thickness(points), strict=True):
        # cells across the wall: thickness over the mean size of the cells; layers are one more
        across = thickness / size[loop]
        side = np.hypot(*(np.roll(at, -1, axis=0) - at).T)
        few = across < wanted - 1 - NEARLY
        for run in _runs(few):
            # tips and notches are no walls; corners at both ends, which face no wall, bound its length
            length = side[run[0] - 1] + side[run].sum()
            if length < ALONG * thickness[run].mean():
                continue
            thinnest = run[int(across[run].argmin())]
            layers = 1 + int(np.round(across[thinnest]))
            if worst is None or layers < worst.layers:
                worst = ThinWall(layers, float(thickness[thinnest]), at[thinnest])
    return worst


def _cell_sizes(particles, cells) -> np.ndarray:
    """Compute the root of the mean area of the cells at every particle, shape (n,), mm."""
    x, y = np.moveaxis(particles[cells], -1, 0)
    # half the cross product of the diagonals
    area = 0.5 * np.abs(
        (x[:, 2] - x[:, 0]) * (y[:, 3] - y[:, 1]) - (x[:, 3] - x[:, 1]) * (y[:, 2] - y[:, 0])
    )
    distinct = np.array([np.unique(cell).size for cell in cells])
    # a triangle counts as half of a quadrilateral of its size
    area = area * np.where(distinct == 3, 2.0, 1.0)
    total = np.bincount(cells.ravel(), np.repeat(area, 4), len(particles))
    count = np.bincount(cells.ravel(), minlength=len(particles))
    return np.sqrt(total / np.maximum(count, 1))


def _runs(chosen: np.ndarray) -> list[np.ndarray]:
    """Split the chosen points of a closed loop into runs of neighbours, indices in order."""
    if not chosen.any():
        return []
    if chosen.all():
        return [np.arange(chosen.size)]
    # start at a point that is not chosen, so that no run crosses the end of the list
    first = int(np.flatnonzero(~chosen)[0])
    order = np.roll(np.arange(chosen.size), -first)
    ends = np.flatnonzero(np.diff(chosen[order].astype(int)))
    return [part for part in np.split(order, ends + 1) if chosen[part[0]]]
