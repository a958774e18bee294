"""The section of a seal file with every cell divided into four."""

from dataclasses import replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.quadrilaterals import halved
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.sampling import doubled
from seal_mdao.seals.outline.section_cloud import OutlineCloud


class RefinedFile(NamedTuple):
    """A seal file with a finer cloud that contains the particles of the coarse one.

    Attributes
    ----------
    file : SealFile
    particles : ndarray of int, shape (n,)
        Index in the finer cloud of every particle of the coarse one.
    parents : ndarray of int, shape (n_fine_cells,)
        Cell of the coarse cloud that contains every cell of the finer one.
    """

    file: SealFile
    particles: np.ndarray
    parents: np.ndarray


def refined_file(file: SealFile, seal: OutlineSeal) -> RefinedFile:
    """Divide every cell of the cloud of a seal into four; new boundary particles lie on the curves.

    Parameters
    ----------
    file : SealFile
    seal : OutlineSeal
        The nominal seal of the file, which has its cloud.

    Raises
    ------
    ValueError
        For a stored cloud whose pressure is continuous through columns of cells.
    """
    section = file.section
    if isinstance(section.spacing, Rays):
        # twice the rays, and a layer between any two: ray r and layer k become 2 r and 2 k
        rays = section.spacing
        finer = replace(rays, rays=2 * rays.rays, layers=2 * rays.layers - 1)
        ray, layer = np.divmod(np.arange(rays.rays * rays.layers), rays.layers)
        cell_ray, cell_layer = np.divmod(np.arange(len(finer.cells)), finer.layers - 1)
        parents = cell_ray // 2 * (rays.layers - 1) + cell_layer // 2
        kept = finer.particle(2 * ray, 2 * layer)
        return RefinedFile(_with_spacing(file, finer), kept, parents)
    if seal.kernels.column != 1:
        raise ValueError(
            "the mesh file named by cloud in [section] has a pressure that is continuous across "
            "the wall, and such a mesh cannot be refined; use spacing instead of cloud, or a mesh "
            "with one pressure per cell"
        )
    # new particles at the boundary are on the curve, at half of the arc length between two old ones
    boundaries = doubled(section.outline, seal.boundaries)
    loops = [boundary.points for boundary in boundaries]
    # boundary particles first, loop after loop, then the others
    rim = np.concatenate(seal.loops)
    order = np.concatenate([rim, np.setdiff1d(np.arange(len(seal.nominal_particles)), rim)])
    number = np.argsort(order)
    cells = number[seal.body.cells]
    particles, finer_cells = halved(seal.nominal_particles[order], cells, loops)
    ends = np.cumsum([0, *map(len, loops)])
    # a cell of k corners is divided into k quadrilaterals of its part
    parents = np.repeat(np.arange(len(cells)), np.where(cells[:, 2] == cells[:, 3], 3, 4))
    finer = OutlineCloud(
        particles, finer_cells, tuple(np.arange(a, b) for a, b in pairwise(ends)),
        seal.parts[parents], boundaries=tuple(boundaries), kernels=seal.kernels,
    )  # fmt: skip
    # old boundary particles have even numbers, the others follow the boundary in their order
    inside = ends[-1] + np.arange(len(order) - len(rim))
    kept = np.concatenate([np.arange(0, ends[-1], 2), inside])
    return RefinedFile(_with_spacing(file, finer), kept[number], parents)


def _with_spacing(file: SealFile, spacing: Rays | OutlineCloud) -> SealFile:
    """Replace the cloud of a file, and leave out its designs, whose velocities are not needed."""
    return replace(file, section=replace(file.section, spacing=spacing), designs=())
