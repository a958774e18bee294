"""Points on the boundary and inside at which the end of a load path is checked."""

from dataclasses import dataclass
from functools import cached_property
from weakref import WeakKeyDictionary

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.rkpm.cells import sides_of
from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.rkpm.visibility import parts_of_sides
from seal_mdao.structure.particle_stress import deformation_gradients
from seal_mdao.terms.point_assembly import interpolate

SHARES = (0.25, 0.5, 0.75)
"""Fractions of the sides of the boundary at which they are evaluated between their ends."""


KEEPS_VOLUME = 10.0
"""Bulk modulus over the shear modulus above which a material is nearly incompressible."""

_BETWEEN = WeakKeyDictionary()
"""Shape tables of the points between particles by discretisation, which several paths share."""


@dataclass(frozen=True, eq=False)
class EvaluationPoints:
    """Points of a body at the end of a load path: its particles, and points between them.

    Attributes
    ----------
    path : PathResult
    """

    path: PathResult

    @cached_property
    def sides(self):
        """Outer and inner sides, as ``sides_of`` gives them."""
        return sides_of(self.path.discretization.body.cells)

    @cached_property
    def _between(self):
        """Points of the outer sides, middles of inner sides, points on interfaces once more for every
        part but the last, and middles of the cells, as a shape table."""
        disc = self.path.discretization
        if disc not in _BETWEEN:
            _BETWEEN[disc] = disc.sloped_table(self._between_particles())
        return _BETWEEN[disc]

    def _between_particles(self) -> PointSet:
        disc = self.path.discretization
        (outer, inner), cells = self.sides, disc.body.cells
        share = np.tile(SHARES, len(outer))
        ends = np.repeat(outer, len(SHARES), axis=0)
        others, of_others = disc.body.on_interfaces
        anchors = np.vstack([
            np.column_stack([ends, ends]), np.column_stack([inner, inner]), others, cells
        ])  # fmt: skip
        halves = 0.5 * np.column_stack([1.0 - share, share])
        weights = np.full(anchors.shape, 0.25)
        weights[: len(share)] = np.column_stack([halves, halves])
        parts = disc.body.parts
        if parts is not None:
            _, sides = parts_of_sides(cells, parts, np.vstack([ends, inner]))
            parts = np.concatenate([sides, of_others, parts])
        return PointSet(anchors, weights, 1, parts=parts)

    @cached_property
    def chains(self) -> np.ndarray:
        """Points along every outer side, its ends included, as numbers of ``places``, (m, 5)."""
        outer = self.sides[0]
        n, between = self.path.discretization.body.n_particles, len(SHARES)
        inside = n + np.arange(len(outer) * between).reshape(-1, between)
        return np.column_stack([outer[:, :1], inside, outer[:, 1:]])

    @cached_property
    def undeformed(self) -> np.ndarray:
        """All points, the particles first, shape (N, 2)."""
        return np.vstack([self.path.discretization.particles, self._between.coordinates])

    @cached_property
    def places(self) -> np.ndarray:
        """Positions of the points at the end of the load path, shape (N, 2), mm."""
        d = self.path.steps[-1].d
        moved = [np.empty((table.n_groups, 2)) for table in self._tables]
        for table, u in zip(self._tables, moved, strict=True):
            interpolate(table, d, u)
        return self.undeformed + np.vstack(moved)

    @cached_property
    def _tables(self) -> tuple:
        """Shape functions at the particles, and at the other points."""
        return self.path.discretization.everywhere.table, self._between.table

    @cached_property
    def _gradients(self) -> np.ndarray:
        """F_11, F_12, F_21, F_22 and J - 1 at the points, shape (N, 5); (N, 6) with h of a body of
        revolution."""
        d = self.path.steps[-1].d
        return np.concatenate([deformation_gradients(table, d) for table in self._tables])

    @cached_property
    def axial_stretch(self) -> float:
        """Stretch along a plane section at the end of the path."""
        body = self.path.problem.term("structure").definition
        return body.axial_stretch(self.path.steps[-1].fraction)

    def growth(self, region) -> float:
        """Return the free growth theta of the material of a region at the end of the path."""
        structure, fraction = self.path.problem.term("structure"), self.path.steps[-1].fraction
        own = structure.conditions(region, [fraction]).conditions
        return 1.0 if own is None else own.growth.item()

    @property
    def volume_change(self) -> np.ndarray:
        """J = det F of all three stretches at the points, shape (N,)."""
        return (1.0 + self._gradients[:, 4]) * self.axial_stretch

    @cached_property
    def stretches(self) -> np.ndarray:
        """Least and largest principal stretch at the points, shape (N, 2)."""
        f = self._gradients
        # lambda_2^2 = (T + sqrt(T^2 - 4 J^2)) / 2,  lambda_1 = |J| / lambda_2,  T = F : F,
        # J = F_11 F_22 - F_12 F_21
        t, j = (f[:, :4] ** 2).sum(axis=1), f[:, 0] * f[:, 3] - f[:, 1] * f[:, 2]
        largest = np.sqrt(0.5 * (t + np.sqrt(np.maximum(t**2 - 4.0 * j**2, 0.0))))
        pair = np.column_stack([np.abs(j) / largest, largest])
        # and the stretch across the plane: of a body of revolution, or along the section
        across = f[:, 5:]
        if self.axial_stretch != 1.0:
            across = np.full((len(f), 1), self.axial_stretch)
        every = np.column_stack([pair, across])
        return np.column_stack([every.min(axis=1), every.max(axis=1)])

    @property
    def cell_stretches(self) -> np.ndarray:
        """Least and largest principal stretch in the middle of every cell, shape (m, 2)."""
        # the middles of the cells are the last points
        return self.stretches[-len(self.path.discretization.body.cells) :]

    @cached_property
    def regions(self) -> np.ndarray:
        """Number of the region of every point, shape (N,)."""
        structure, (outer, inner) = self.path.problem.term("structure"), self.sides
        sides = np.vstack([np.repeat(outer, len(SHARES), axis=0), inner])
        return np.concatenate([
            structure.particle_regions, structure.side_regions(sides),
            self.path.discretization.body.on_interfaces[1], structure.cell_regions,
        ])  # fmt: skip

    @cached_property
    def keeps_volume(self) -> np.ndarray:
        """Whether the material of every region is nearly incompressible, K > 10 G, shape (regions,)."""
        materials = [region.material for region in self.material_regions]
        return np.array([m.bulk_modulus > KEEPS_VOLUME * m.shear_modulus for m in materials])

    @property
    def material_regions(self) -> tuple:
        """The regions of the body, numbered as in ``regions``."""
        return self.path.problem.term("structure").definition.regions

    @cached_property
    def wall(self) -> float:
        """Mean thickness of the undeformed body, twice its area over the length of its boundary."""
        x, outer = self.path.discretization.particles, self.sides[0]
        perimeter = np.linalg.norm(x[outer[:, 1]] - x[outer[:, 0]], axis=1).sum()
        return float(2.0 * self.path.discretization.weights.sum() / perimeter)
