"""The body (independent of the design) and its discretisation for one design."""

from dataclasses import dataclass, field
from functools import cached_property
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from seal_mdao.equilibrium.couplings import Link
from seal_mdao.equilibrium.tangent_layout import TangentLayout, equation_numbers, tangent_layout
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.errors import GeometryError
from seal_mdao.rkpm.averages import EdgeAverages, averaged_table
from seal_mdao.rkpm.axisymmetry import zero_radius
from seal_mdao.rkpm.basis import BASIS_SIZE
from seal_mdao.rkpm.cells import CellMap, cell_map, quadrature_weights
from seal_mdao.rkpm.consistent_gradients import CellTable, EdgeRule, build_cell_table, edge_rule
from seal_mdao.rkpm.essential import EssentialTransformation, essential_transformation
from seal_mdao.rkpm.shape_functions import NO_INTERFACE, NOTHING_HIDDEN, Cloud, PointSet
from seal_mdao.rkpm.tables import PointTable, build_table, raw_tables
from seal_mdao.rkpm.visibility import particles_in_parts, parts_of_sides
from seal_mdao.structure.pressure_functions import PressureSpace, through_column
from seal_mdao.terms.points import MaterialPoints, boundary_particles, single_points


class Edge(NamedTuple):
    """A named boundary of the body.

    Attributes
    ----------
    particles : ndarray of int
        In order along the boundary, the body on the left.
    closed : bool
        Whether the last one is joined to the first.
    """

    particles: np.ndarray
    closed: bool

    @property
    def sides(self) -> np.ndarray:
        """Particles at the ends of its straight sides, shape (m, 2)."""
        following = np.roll(self.particles, -1)
        pairs = np.column_stack([self.particles, following])
        return pairs if self.closed else pairs[:-1]

    @property
    def neighbours(self) -> np.ndarray:
        """Particles before and after each one, itself at the end of an open edge, shape (k, 2)."""
        # (before, after) of each particle; an end without a neighbour is its own,
        # so that its tributary length is half of one side
        pairs = np.column_stack([np.roll(self.particles, 1), np.roll(self.particles, -1)])
        if not self.closed:
            pairs[0, 0], pairs[-1, 1] = self.particles[0], self.particles[-1]
        return pairs


@dataclass(frozen=True, eq=False)
class Body:
    """Data of the discretised body that are independent of the design.

    Attributes
    ----------
    cells : ndarray of int, shape (n_cells, 4)
        Background cells by their corner particles, counter-clockwise; a triangle repeats one.
    support_radius : ndarray, shape (n,)
        Kernel support of every particle.
    fixed : ndarray of bool, shape (n, 2)
        Prescribed displacement components.
    edges : dict of str to Edge
        Named boundaries.
    nominal : ndarray, shape (n, 2), or None
        Particles of the nominal body, for which the equations are numbered once. Without them the
        equations are numbered for every design.
    basis_order : int
        1 linear, 2 quadratic.
    n_gauss : int, or pair of int
        Gauss points along both directions of a cell, or along each (``rkpm.cells.cell_map``); a triangle
        has as many points as a quadrilateral.
    hidden_pairs : ndarray of int, shape (m, 2)
        Pairs of particles whose supports must not reach each other across a void, round a corner or
        across an interface (``rkpm.visibility.hidden_pairs`` of the nominal body).
    parts : ndarray of int, shape (n_cells,), or None
        Number of the region (``structure.region``) of every cell, at whose interfaces shape functions
        end; None for one region, or shape functions that do not end there.
    support_axes : ndarray, shape (n, 2, 2), or None
        Inverse half-widths of product kernels along the two directions of the cells
        (``rkpm.cells.support_axes``); None for round kernels.
    column : int
        Cells in succession through which the pressure is continuous (``structure.pressure_functions``);
        1: one value a cell.
    axisymmetric : bool
        Whether the body is one of revolution about x = 0 (``rkpm.axisymmetry``), in place of plane
        strain.
    """

    cells: np.ndarray
    support_radius: np.ndarray
    fixed: np.ndarray
    edges: dict = field(default_factory=dict)
    nominal: np.ndarray | None = None
    basis_order: int = 1
    n_gauss: int | tuple[int, int] = 2
    hidden_pairs: np.ndarray = field(default_factory=lambda: NOTHING_HIDDEN)
    parts: np.ndarray | None = None
    support_axes: np.ndarray | None = None
    column: int = 1
    axisymmetric: bool = False

    @property
    def n_particles(self) -> int:
        return len(self.support_radius)

    @property
    def strains(self) -> int:
        """Components of F at a point: 11, 12, 21, 22, and h in a body of revolution."""
        return 5 if self.axisymmetric else 4

    @property
    def constrained(self) -> np.ndarray:
        """Sorted particles with a prescribed component."""
        return np.flatnonzero(self.fixed.any(axis=1))

    def edge(self, name: str) -> Edge:
        """Return the boundary ``name``.

        Raises
        ------
        ValueError
            For a name that no boundary has.
        """
        if name not in self.edges:
            known = ", ".join(self.edges) or "none"
            raise ValueError(f"the body has no edge {name!r}; its edges are: {known}")
        return self.edges[name]

    def edge_points(self, name: str) -> MaterialPoints:
        """Return the free particles of an edge as contact points, with their tributary lengths."""
        edge = self.edge(name)
        # fully fixed particles carry no unknown; tributary length: half of both adjacent sides
        movable = ~self.fixed[edge.particles].all(axis=1)
        points = boundary_particles(edge.particles[movable], edge.neighbours[movable])
        return points.around_axis() if self.axisymmetric else points

    @cached_property
    def cell_map(self) -> CellMap:
        return cell_map(self.cells, self.n_gauss)

    @cached_property
    def pressure(self) -> PressureSpace:
        """Interpolation functions of the pressure in every column of cells."""
        return through_column(self.column, self.n_gauss, self.axisymmetric)

    @cached_property
    def samples(self) -> PointSet:
        """Sample points: particles, midpoints of the sides of cells, centres of cells, where those on
        interfaces belong to the last part; then those on interfaces once more for every other part."""
        sides = self._sides
        # each point is the mean of four anchors: X = 1/4 sum_a X_a (repeated where it has fewer)
        particles = np.repeat(np.arange(self.n_particles)[:, None], 4, axis=1)
        anchors = np.vstack([particles, np.tile(sides, 2), self.cells])
        parts = None
        if self.parts is not None:
            last = np.zeros(self.n_particles, int)
            np.maximum.at(last, self.cells, self.parts[:, None])
            _, at_sides = parts_of_sides(self.cells, self.parts, sides)
            others, of_others = self.on_interfaces
            anchors = np.vstack([anchors, others])
            parts = np.concatenate([last, at_sides, self.parts, of_others])
        return PointSet(anchors, np.full(anchors.shape, 0.25), 1, parts=parts)

    @cached_property
    def _sides(self) -> np.ndarray:
        """Particles at the ends of every side of the cells, each side once, shape (m, 2)."""
        pairs = np.stack([self.cells, np.roll(self.cells, -1, axis=1)], axis=2).reshape(-1, 2)
        # the repeated corner of a triangle gives no side
        return np.unique(np.sort(pairs[pairs[:, 0] != pairs[:, 1]], axis=1), axis=0)

    @cached_property
    def on_interfaces(self) -> tuple[np.ndarray, np.ndarray]:
        """Anchors (k, 4) of the particles and midpoints of sides on interfaces, for every part but the
        last one at each, and these parts (k,)."""
        if self.parts is None:
            return np.empty((0, 4), int), np.empty(0, int)
        particle, of_particle = np.nonzero(self._in_parts)
        # the last part is followed by that of the next particle
        last = np.append(particle[1:] != particle[:-1], True)
        # the other part of a side between two is the first one
        first, at_sides = parts_of_sides(self.cells, self.parts, self._sides)
        between = first != at_sides
        anchors = np.vstack([
            np.repeat(particle[~last, None], 4, axis=1), np.tile(self._sides[between], 2)
        ])  # fmt: skip
        return anchors, np.concatenate([of_particle[~last], first[between]])

    @cached_property
    def _in_parts(self) -> np.ndarray:
        if self.parts is None:
            return NO_INTERFACE
        return particles_in_parts(self.cells, self.parts, self.n_particles)

    @cached_property
    def edge_rule(self) -> EdgeRule:
        return edge_rule(self.cells, self.constrained, self.pressure.cells)

    def equations(self, averages=()) -> np.ndarray | None:
        """Number the equations (n, 2) of the nominal body, once for all designs; None without it.

        Parameters
        ----------
        averages : sequence of EdgeAverages
            Points that couple more particles than the cells do.
        """
        if self.nominal is None:
            return None
        key = tuple(points.edges.tobytes() for points in averages)
        if key not in self._equations:
            cloud, transformation, _ = _essential(self, self.nominal)
            tables = [self.cell_table(cloud, transformation)]
            tables += [_table_of(points, cloud, transformation) for points in averages]
            self._equations[key] = equation_numbers(
                self.fixed, [table.raw for table in tables], transformation
            )
        return self._equations[key]

    @cached_property
    def _equations(self) -> dict:
        return {}

    def cell_table(self, cloud: Cloud, transformation: EssentialTransformation) -> CellTable:
        """Compute weights and shape functions of one design at the quadrature points.

        Raises
        ------
        GeometryError
            A folded cell, or a point that too few supports cover.
        """
        # w = w_g det(dX/d eta) of the Gauss points of every cell
        weights = quadrature_weights(self.cell_map, cloud.particles)
        return build_cell_table(
            cloud, self.cell_map, self.edge_rule, weights, transformation, self.axisymmetric,
            self.parts,
        )  # fmt: skip

    def cloud(self, particles: np.ndarray) -> Cloud:
        """Combine particles of one design, copied, with the kernels of the body."""
        return Cloud(
            np.array(particles, float, order="C"),
            self.support_radius,
            float(self.support_radius.max()),
            BASIS_SIZE[self.basis_order],
            self.hidden_pairs,
            self._in_parts,
            self.support_axes,
        )


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
    tables : tuple of PointTable or None
        Shape functions at the points of every term.
    couples : tuple of bool
        Whether the points of each term couple the equations.
    layout : TangentLayout
        Equation numbers and slots of the entries of the tangent.
    first_column : tuple of int
        Index of the first rank-one part of the tangent of each term.
    """

    body: Body
    cloud: Cloud
    transformation: EssentialTransformation
    constrained_rows: PointTable
    cells: CellTable
    tables: tuple
    couples: tuple
    layout: TangentLayout
    first_column: tuple = ()

    @cached_property
    def scatters(self) -> tuple:
        """Scatter maps of every term's points; None for a term without points."""
        # scatter[0] is that of the cells; then one map for each coupling table, in order of the terms
        found = iter(self.layout.scatter[1:])
        return tuple(
            None if table is None else next(found) if couples else self.layout.uncoupled
            for table, couples in zip(self.tables, self.couples, strict=True)
        )

    @property
    def weights(self) -> np.ndarray:
        """Quadrature weights, area unit, shape (n_cells, q)."""
        return self.cells.weights

    @property
    def particles(self) -> np.ndarray:
        return self.cloud.particles

    @property
    def depth(self) -> float:
        """Largest circumference of a quadrature point, m; 1 in plane strain."""
        return float(self.cells.circumferences.max())

    @one_blas_thread
    def table_at(self, which: np.ndarray) -> PointTable:
        """Evaluate shape functions at the particles ``which``, or at ``Body.samples`` beyond them.

        Cached, for measures need the same points again.
        """
        which = np.asarray(which, int)
        key = which.tobytes()
        if key not in self._tables_at:
            points = single_points(which)
            if which.max(initial=0) >= self.body.n_particles:
                every = self.body.samples
                # beyond the particles: midpoints of sides and centres of cells
                points = PointSet(every.anchors[which], every.weights[which], 1)
            if self.body.parts is not None:
                points = points._replace(parts=self.body.samples.parts[which])
            self._tables_at[key] = self.sloped_table(points)
        return self._tables_at[key]

    def sloped_table(self, points: PointSet) -> PointTable:
        """Evaluate shape functions and their gradients, with the hoop rows of a body of revolution, at
        points of the section."""
        hooped = points._replace(hooped=self.body.axisymmetric)
        return build_table(self.cloud, hooped, self.transformation)

    @cached_property
    def _tables_at(self) -> dict:
        return {}

    @cached_property
    def everywhere(self) -> PointTable:
        """Shape functions at all particles, for physical displacements and stresses."""
        return self.table_at(np.arange(self.body.n_particles))


@one_blas_thread
def discretize(body: Body, particles: np.ndarray, terms=()) -> Discretization:
    """Discretise ``body`` with given particles: shape functions, weights, equations.

    Parameters
    ----------
    terms : sequence of TermDefinition
        Definitions of the terms of the residual.
    particles : ndarray, shape (n, 2)
        Undeformed coordinates.

    Raises
    ------
    ValueError
        Coordinates of a wrong shape, or not finite.
    GeometryError
        A folded cell, a particle beyond the axis of revolution, or a point that too few supports cover.
    """
    particles = np.asarray(particles, float)
    if particles.shape != (body.n_particles, 2):
        raise ValueError(
            f"the positions of the particles must have shape ({body.n_particles}, 2), got "
            f"{particles.shape}"
        )
    if not np.isfinite(particles).all():
        where = int(np.argwhere(~np.isfinite(particles))[0, 0])
        raise ValueError(f"the particle with the index {where} has a coordinate that is not finite")
    if body.axisymmetric:
        _check_radii(body, particles)
    # u = Phi T d with T of the constrained particles, then Phi, grad Phi and w at all points
    cloud, transformation, rows = _essential(body, particles)
    cells = body.cell_table(cloud, transformation)
    point_sets = [term.point_set() for term in terms]
    tables = tuple(_table_of(points, cloud, transformation) for points in point_sets)
    couples = tuple(term.couples for term in terms)
    # the pattern of the tangent: cells first, then the points that have a tangent of their own
    coupling = zip(tables, couples, strict=True)
    coupled = [cells.raw, *(table.raw for table, own in coupling if own and table is not None)]
    # one numbering for all designs where the nominal body is known: same bits, same cost
    equations = body.equations([own for own in point_sets if isinstance(own, EdgeAverages)])
    if equations is None:
        equations = equation_numbers(body.fixed, coupled, transformation)
    layout = tangent_layout(
        equations, coupled, transformation, _links(terms, tables),
        sum(term.n_columns for term in terms),
    )  # fmt: skip
    return Discretization(
        body, cloud, transformation, rows, cells, tables, couples, layout,
        tuple(accumulate((term.n_columns for term in terms), initial=0)),
    )  # fmt: skip


def _check_radii(body: Body, particles: np.ndarray) -> None:
    """Refuse particles of a body of revolution beyond the axis, or on it without being held there."""
    radii = particles[:, 0]
    # R > 0, or R = 0 with u_r = 0; up to rounding
    inside = radii > zero_radius(particles)
    inside |= (radii == 0.0) & body.fixed[:, 0]
    if not inside.all():
        number = int(np.where(inside, np.inf, radii).argmin())
        x, y = particles[number]
        raise GeometryError(
            "the section reaches the axis of revolution x = 0 or lies beyond it: a particle that is "
            f"not on the axis of the nominal section is at ({x:.4g}, {y:.4g}); use smaller boundary "
            "offsets"
        )


def _table_of(points, cloud, transformation) -> PointTable | None:
    """Evaluate shape functions, without gradients, at the points of a term."""
    if points is None:
        return None
    if isinstance(points, EdgeAverages):
        return averaged_table(cloud, points, transformation)
    return build_table(cloud, points._replace(sloped=False), transformation)


def _links(terms, tables) -> list:
    """List the pairs of points that act on each other, of all terms that have some."""
    pairs = [term.pairs() for term in terms]
    linked = zip(tables, pairs, strict=True)
    return [Link(table.raw, own) for table, own in linked if own is not None]


def _essential(body: Body, particles: np.ndarray):
    """Build the cloud, the essential transformation T, and the shape functions that T is made of."""
    cloud = body.cloud(particles)
    # raw Phi_I(X_J) at the constrained particles J: u(X_J) = sum_I Phi_I(X_J) d_I is prescribed
    (rows,) = raw_tables(cloud, single_points(body.constrained)._replace(sloped=False))
    return cloud, essential_transformation(body.constrained, rows.raw), rows
