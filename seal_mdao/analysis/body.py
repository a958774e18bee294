"""The body that is analysed (what is decided once) and its discretisation for one design."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from seal_mdao.analysis.equations import TangentLayout, tangent_layout
from seal_mdao.analysis.threads import one_blas_thread
from seal_mdao.rkpm.basis import BASIS_SIZE
from seal_mdao.rkpm.cells import CellMap, cell_map, quadrature_weights
from seal_mdao.rkpm.essential import EssentialTransformation, essential_transformation
from seal_mdao.rkpm.integration import CellTable, EdgeRule, build_cell_table, edge_rule
from seal_mdao.rkpm.scatter import scatter_add
from seal_mdao.rkpm.shape_functions import Cloud, PointSet
from seal_mdao.rkpm.tables import PointTable, build_table, raw_table


@dataclass(frozen=True, eq=False)
class Body:
    """Everything about the discretised body that no design changes.

    Attributes
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        Background cells by their corner particles, counter-clockwise.
    support_radius : ndarray, shape (n,)
        Kernel support of every particle.
    fixed : ndarray of bool, shape (n, 2)
        Displacement components that are imposed.
    contact : ndarray of int, shape (k,)
        Particles that may touch the rigid profile.
    contact_ends : ndarray of int, shape (k, 2)
        The boundary neighbours of each contact particle; half of each edge is its tributary length.
    basis_order : int
        1 linear, 2 quadratic.
    n_gauss : int
        Gauss points per direction of a cell.
    solver : str
        "auto", "banded", "superlu" or "pardiso".
    """

    cells: np.ndarray
    support_radius: np.ndarray
    fixed: np.ndarray
    contact: np.ndarray = field(default_factory=lambda: np.empty(0, int))
    contact_ends: np.ndarray = field(default_factory=lambda: np.empty((0, 2), int))
    basis_order: int = 1
    n_gauss: int = 2
    solver: str = "auto"

    @property
    def n_particles(self) -> int:
        return len(self.support_radius)

    @property
    def constrained(self) -> np.ndarray:
        """Sorted particles with an imposed component."""
        return np.flatnonzero(self.fixed.any(axis=1))

    @cached_property
    def cell_map(self) -> CellMap:
        return cell_map(self.cells, self.n_gauss)

    @cached_property
    def edge_rule(self) -> EdgeRule:
        return edge_rule(self.cells, self.constrained)

    def cloud(self, particles: np.ndarray) -> Cloud:
        """Particles of one design with the body's kernels."""
        return Cloud(
            np.ascontiguousarray(particles, float),
            self.support_radius,
            float(self.support_radius.max()),
            BASIS_SIZE[self.basis_order],
        )


def at_particles(which: np.ndarray) -> PointSet:
    """Point set of the particles ``which`` themselves, one a group."""
    which = np.asarray(which, int).reshape(-1, 1)
    return PointSet(which, np.ones(which.shape), 1)


@dataclass(frozen=True, eq=False)
class Discretization:
    """A body with the particles of one design: shape functions, weights, equations.

    Attributes
    ----------
    body : Body
    cloud : Cloud
    transformation : EssentialTransformation
    constrained_rows : PointTable
        Raw shape functions at the constrained particles.
    cells : CellTable
        Shape functions at the quadrature points.
    contact : PointTable
        Shape functions at the contact points.
    contact_length : ndarray, shape (k,)
        Tributary lengths.
    layout : TangentLayout
        Equation numbers and where each entry of the tangent goes.
    """

    body: Body
    cloud: Cloud
    transformation: EssentialTransformation
    constrained_rows: PointTable
    cells: CellTable
    contact: PointTable
    contact_length: np.ndarray
    layout: TangentLayout

    @property
    def weights(self) -> np.ndarray:
        """Quadrature weights, area unit, shape (n_cells, q)."""
        return self.cells.weights

    @property
    def particles(self) -> np.ndarray:
        return self.cloud.particles

    @one_blas_thread
    def table_at(self, which: np.ndarray) -> PointTable:
        """Shape functions at the particles ``which``."""
        return build_table(self.cloud, at_particles(which), self.transformation)

    @cached_property
    def everywhere(self) -> PointTable:
        """Shape functions at all particles, for displacements and stresses to look at."""
        return self.table_at(np.arange(self.body.n_particles))


@one_blas_thread
def discretize(body: Body, particles: np.ndarray) -> Discretization:
    """Shape functions, weights and equations of ``body`` with the given particles.

    Parameters
    ----------
    particles : ndarray, shape (n, 2)
        Undeformed coordinates.

    Raises
    ------
    ValueError
        Coordinates of a wrong number, or not finite.
    GeometryError
        A folded cell, or a point that too few supports cover.
    """
    particles = np.asarray(particles, float)
    if particles.shape != (body.n_particles, 2):
        raise ValueError(
            f"particles must have shape ({body.n_particles}, 2), got {particles.shape}"
        )
    if not np.isfinite(particles).all():
        where = int(np.argwhere(~np.isfinite(particles))[0, 0])
        raise ValueError(f"particle {where} has a coordinate that is not a finite number")
    cloud = body.cloud(particles)
    weights = quadrature_weights(body.cell_map, cloud.particles)
    rows = at_particles(body.constrained)
    coordinates, raw = raw_table(cloud, rows)
    transformation = essential_transformation(body.constrained, raw)
    cells = build_cell_table(cloud, body.cell_map, body.edge_rule, weights, transformation)
    contact = build_table(cloud, at_particles(body.contact), transformation)
    layout = tangent_layout(body.fixed, [cells.raw, contact.raw], transformation, body.solver)
    return Discretization(
        body, cloud, transformation, PointTable(rows, coordinates, raw, raw), cells,
        contact, tributary_lengths(body, cloud.particles), layout,
    )  # fmt: skip


def tributary_lengths(body: Body, particles: np.ndarray) -> np.ndarray:
    """Half the length of the two boundary edges at each contact particle, shape (k,)."""
    edges = particles[body.contact_ends] - particles[body.contact][:, None]
    return 0.5 * np.hypot(edges[..., 0], edges[..., 1]).sum(axis=1)


def tributary_rates(body: Body, particles: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Rates of the tributary lengths along design velocities (P, n, 2), shape (P, k)."""
    edges = particles[body.contact_ends] - particles[body.contact][:, None]
    unit = edges / np.linalg.norm(edges, axis=2, keepdims=True)
    motion = velocity[:, body.contact_ends] - velocity[:, body.contact][:, :, None]
    return 0.5 * np.einsum("kei,pkei->pk", unit, motion)


def add_tributary_seeds(body: Body, particles, length_bar, x_bar) -> None:
    """Transpose of ``tributary_rates``: seeds (k, M) on the lengths added to ``x_bar`` (n, 2, M)."""
    edges = particles[body.contact_ends] - particles[body.contact][:, None]
    unit = edges / np.linalg.norm(edges, axis=2, keepdims=True)
    pull = 0.5 * unit[..., None] * length_bar[:, None, None]
    scatter_add(x_bar, body.contact_ends, pull)
    scatter_add(x_bar, body.contact, -pull.sum(axis=1))
