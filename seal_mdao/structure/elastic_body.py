"""The structural form as a term: regions of hyperelastic materials, internal force, energy."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.materials import hoop_stretch
from seal_mdao.structure.column_law import BodyStates
from seal_mdao.structure.deformation import (
    Deformation,
    deform,
    deformations,
    no_deformation,
)
from seal_mdao.structure.energy_gradient import BodySeeds
from seal_mdao.structure.internal_force import assemble_internal, plane_jacobian
from seal_mdao.structure.linearized_body import BodyBlock, CellBasis, LinearizedBody
from seal_mdao.terms.term import Scalar, Term, TermDefinition

_NO_BRANCH = np.empty(0, int)


class Region(NamedTuple):
    """Cells of one material.

    Attributes
    ----------
    material : Isotropic
    cells : ndarray of int, or None
        Places of the cells; None for all of them.
    prefix : str
        Put before the names of the material's constants.
    density : float or None
        kg/m^3; the measure ``mass`` alone needs it.
    """

    material: object
    cells: np.ndarray | None = None
    prefix: str = ""
    density: float | None = None

    @property
    def name(self) -> str:
        """Name of the material, empty where it is the only one."""
        return self.prefix.rstrip("_")

    @property
    def names(self) -> tuple:
        """Names of the constants as parameters."""
        return tuple(self.prefix + name for name in self.material.names)

    def with_parameters(self, values: dict) -> "Region":
        """The region with some constants changed; names of others are passed over."""
        pairs = zip(self.names, self.material.names, strict=True)
        own = {constant: values[name] for name, constant in pairs if name in values}
        return self._replace(material=self.material.with_(**own)) if own else self

    @property
    def at(self):
        """Index of the region's cells."""
        return slice(None) if self.cells is None else self.cells


@dataclass(frozen=True, eq=False)
class ElasticBody(TermDefinition):
    """Internal force of a body of one or several hyperelastic materials.

    Attributes
    ----------
    regions : tuple of Region
        They divide the cells.
    """

    regions: tuple
    label = "structure"

    @property
    def scalars(self) -> dict:
        """Constants of all regions; equal names are one parameter."""
        return {
            region.prefix + name: Scalar(
                value,
                "kPa" if name in region.material.moduli else None,
                f"Material constant {name}.",
            )
            for region in self.regions
            for name, value in region.material.constants.items()
        }

    def with_parameters(self, values: dict) -> "ElasticBody":
        """The body with some constants changed."""
        return replace(self, regions=tuple(r.with_parameters(values) for r in self.regions))

    def on(self, discretization, index) -> "StructuralTerm":
        """The term on one design."""
        return StructuralTerm(self, discretization)

    def per_cell(self, values, n_cells: int, dtype=float) -> np.ndarray:
        """A value of each region spread to its cells."""
        out = np.empty(n_cells, dtype)
        for region, value in zip(self.regions, values, strict=True):
            out[region.at] = value
        return out


def elastic_body(material, prefix: str = "") -> ElasticBody:
    """A body of one material."""
    return ElasticBody((Region(material, None, prefix),))


class StructuralResponse(NamedTuple):
    """What the structural form answers: nothing but its force, which is in the buffers."""

    history: None = None
    branch: np.ndarray = _NO_BRANCH
    unconverged: int = 0

    def copied(self):
        """Itself."""
        return self


class StructuralTerm(Term):
    """An ``ElasticBody`` on one design."""

    label = ElasticBody.label
    conservative = True

    def __init__(self, definition: ElasticBody, discretization):
        self.definition, self.names = definition, tuple(definition.scalars)
        self.discretization, self.cells = discretization, discretization.cells
        self.functions, self._before = discretization.body.pressure.functions, None
        self.bulk = self._per_column([r.material.bulk_modulus for r in definition.regions])
        self.deformation = no_deformation(1, self.cells, len(self.functions))
        size = discretization.body.support_radius.max() * discretization.depth
        self.rounding = float(self.bulk.max() * size)

    def _per_column(self, values, dtype=float) -> np.ndarray:
        """A value of each region spread to the columns of cells, shape (n_columns,).

        Raises
        ------
        ValueError
            When two materials with different ones meet in a column.
        """
        cells = self.definition.per_cell(values, len(self.cells.weights), dtype)
        columns = cells.reshape(self.cells.raw.n_groups, -1)
        # all cells of a column must have the value of its first
        mixed = np.flatnonzero((columns != columns[:, :1]).any(axis=1))
        if mixed.size:
            raise ValueError(
                f"column {mixed[0]} of {columns.shape[1]} cells, through which the pressure is "
                "continuous, has two bulk moduli; use one there, or one pressure a cell"
            )
        return columns[:, 0].copy()

    def _by_cell(self, values: np.ndarray) -> np.ndarray:
        """Values (..., n_columns, q of a column) as a view (..., n_cells, q of a cell)."""
        return values.reshape(*values.shape[:-2], *self.cells.weights.shape)

    # ---- the material at the quadrature points ----

    def _by_region(self, deformation: Deformation):
        """Every region with its state (T, J), and h in a body of revolution, as views by cell."""
        states = [deformation.square, deformation.jacobian]
        if deformation.hoop is not None:
            states.append(deformation.hoop)
        states = [self._by_cell(state) for state in states]
        for region in self.definition.regions:
            yield region, [state[..., region.at, :] for state in states]

    def energy_derivatives(self, deformation: Deformation) -> np.ndarray:
        """W_T, W_J, W_TT, W_TJ, W_JJ of K fields, shape (5, K, n_columns, q); in a body of revolution
        also W_h, W_Th, W_Jh, W_hh, shape (9, ...)."""
        around = deformation.hoop is not None
        # one material: no copies
        if len(self.definition.regions) == 1 and not around:
            material = self.definition.regions[0].material
            return material.derivatives(deformation.square, deformation.jacobian)
        out = np.empty((hoop_stretch.ROWS if around else 5, *deformation.square.shape))
        rows = self._by_cell(out)
        # every region by its own law
        for region, state in self._by_region(deformation):
            rows[:, :, region.at] = hoop_stretch.derivatives(region.material, *state)
        return out

    def constant_derivatives(self, deformation: Deformation) -> np.ndarray:
        """d(W_T, W_J) / d(every parameter) of K fields, shape (C, 2, K, n_columns, q); in a body of
        revolution d(W_T, W_J, W_h), shape (C, 3, ...)."""
        around = deformation.hoop is not None
        out = np.zeros((len(self.names), 3 if around else 2, *deformation.square.shape))
        by_cell = self._by_cell(out)
        for region, state in self._by_region(deformation):
            # d(W_T, W_J)/dc; equal names are one parameter
            rows = hoop_stretch.constant_derivatives(region.material, *state)
            for name, row in zip(region.names, rows, strict=True):
                by_cell[self.names.index(name)][:, :, region.at] = row
        return out

    @cached_property
    def bulk_row(self) -> np.ndarray:
        """Which parameter is the bulk modulus of every column, -1 for none, shape (n_columns,)."""
        rows = [
            self.names.index(region.prefix + "bulk_modulus")
            if "bulk_modulus" in region.material.names
            else -1
            for region in self.definition.regions
        ]
        return self._per_column(rows, int)

    @cached_property
    def particle_regions(self) -> np.ndarray:
        """Number of the region of every particle, shape (n,)."""
        regions, body = self.definition.regions, self.discretization.body
        out = np.zeros(body.n_particles, int)
        for number, region in enumerate(regions):
            out[body.cells[region.at]] = number
        return out

    @cached_property
    def sample_regions(self) -> np.ndarray:
        """Number of the region of every one of ``Body.samples``; between two regions the last one."""
        regions, body = self.definition.regions, self.discretization.body
        cell_regions = np.zeros(len(body.cells), int)
        for number, region in enumerate(regions):
            cell_regions[region.at] = number
        n, m = body.n_particles, len(body.cells)
        # midpoints of sides follow the particles, centres of cells come last
        ends = np.sort(body.samples.anchors[n:-m, :2], axis=1)
        sides = np.zeros(len(ends), int)
        # sides are in the order of their two particles
        pair_number = ends[:, 0] * n + ends[:, 1]
        for corner in range(4):
            pair = np.sort(
                np.column_stack([body.cells[:, corner], body.cells[:, corner - 3]]), axis=1
            )
            real = pair[:, 0] != pair[:, 1]
            which = np.searchsorted(pair_number, pair[real, 0] * n + pair[real, 1])
            np.maximum.at(sides, which, cell_regions[real])
        return np.concatenate([self.particle_regions, sides, cell_regions])

    def deformation_of(self, d: np.ndarray) -> Deformation:
        """Deformation at displacement fields (K, n, 2) that are known to be admissible."""
        return deformations(self.cells, self.functions, d)

    def pressure(self, deformation: Deformation) -> np.ndarray:
        """K sum_h N_h s_h at the quadrature points of K fields, shape (K, n_columns, q)."""
        # p = K sum_h N_h s_h
        return self.bulk[:, None] * (deformation.swelling @ self.functions)

    def squared_swelling(self, deformation: Deformation) -> np.ndarray:
        """sum_h N_h s_h^2 at the quadrature points of one field, shape (n_columns, q)."""
        # sum_h N_h s_h^2
        return deformation.swelling[0] ** 2 @ self.functions

    # ---- the contract of a term ----

    def add(self, d, raw, fraction, history, force, values):
        scatter = self.discretization.layout.scatter[0]
        if not self._assemble(self.cells.raw, raw, scatter, force, values):
            return None
        return StructuralResponse()

    def _assemble(self, table, d, scatter, force, values, before=None) -> bool:
        """Assemble at displacements ``d``; the tangent of a mixed iteration where the displacements
        ``before`` of the last one are given. False where a point is inverted."""
        weights, functions = self.cells.column_weights, self.functions
        if deform(table, weights, functions, d, self.deformation) >= 0:
            return False
        # W_T, W_J, W_TT, W_TJ, W_JJ at F
        w, now = self.energy_derivatives(self.deformation)[:, 0], self.deformation
        quadrature, law = (table, weights, functions), (0, w, self.bulk, scatter)
        if before is None:
            assemble_internal(*quadrature, now, *law, force, values)
            return True
        # tangent with the pressure of the linearised swelling, force with the exact one
        expected = now._replace(swelling=now.swelling - self._beyond_linear(table, d - before))
        assemble_internal(*quadrature, now, *law, force, np.empty(0))
        assemble_internal(*quadrature, expected, *law, np.empty_like(force), values)
        return True

    def _beyond_linear(self, table, du) -> np.ndarray:
        """Part of the swelling (n_columns, m) that is quadratic in an increment ``du`` (n, 2):
        det(F + G) - det F - cof F : G = det G with G = grad du, and what the hoop stretch adds. 0
        where an increment inverts a cell."""
        weights, functions = self.cells.column_weights, self.functions
        increment = no_deformation(1, self.cells, len(functions))
        if deform(table, weights, functions, du, increment) >= 0:
            return np.zeros(self.deformation.swelling.shape[1:])
        f, now = increment.f[0], self.deformation.f[0]
        change, around = f[..., 4], increment.hoop is not None
        if around:
            # J - 1 of the increment = (det(1 + G) - 1) (1 + g) + g
            g = f[..., 5] - 1.0
            change = (change - g) / f[..., 5]
        # f is 1 + G: det G = det(1 + G) - 1 - tr G
        beyond = change - (f[..., 0] - 1.0) - (f[..., 3] - 1.0)
        if around:
            # of J = h det F, h = h0 + g: h0 det G + g (det(F0 + G) - det F0)
            now, before = now[..., :4], now[..., :4] - f[..., :4] + (1.0, 0.0, 0.0, 1.0)
            grown = plane_jacobian(np.moveaxis(now, -1, 0))
            grown -= plane_jacobian(np.moveaxis(before, -1, 0))
            beyond = (self.deformation.hoop[0] - g) * beyond + g * grown
        # sum_q N_h w det G / V_h
        return (weights * beyond) @ functions.T / (weights @ functions.T)

    # ---- mixed iterations ----

    def begin(self, iteration=None):
        # coefficients of the last linearisation of mixed iterations
        self._before = iteration

    @property
    def iteration(self):
        return self._before

    def begin_mixed(self, step, response, target):
        self._before = self.discretization.transformation.coefficients(step.d)

    def add_mixed(self, d, raw, fraction, history, force, values):
        """The pressure in the tangent is K times the linearised swelling: what a linearised rotation
        adds to det F is of second order, but not when the bulk modulus multiplies it."""
        scatter, before = self.discretization.layout.scatter[0], self._before
        if not self._assemble(self.cells.raw, raw, scatter, force, values, before):
            return None
        self._before = raw
        return StructuralResponse()

    def forces(self, d: np.ndarray) -> np.ndarray | None:
        """Internal forces of all components, imposed ones included, shape (n, 2); None if inverted.

        At an imposed component of a converged step this is the force that holds it there.
        """
        every = self.discretization.layout.every_component
        force = np.zeros(2 * len(d) + 1)
        if not self._assemble(self.cells.table, d, every, force, np.empty(0)):
            return None
        return force[:-1].reshape(-1, 2)

    def potential(self, d, response) -> float:
        return self.energy(d)

    def energy(self, d: np.ndarray) -> float:
        """Strain energy per unit depth, mJ/m."""
        deformation, weights = self.deformation_of(d[None]), self.cells.column_weights
        # W = sum_q w W(T, J) + sum_h K/2 V_h s_h^2, V_h = sum_q N_h w
        volumetric = 0.5 * self.bulk[:, None] * self.squared_swelling(deformation)
        return float((weights * (self.density(deformation) + volumetric)).sum())

    def density(self, deformation: Deformation) -> np.ndarray:
        """W at the quadrature points of one field, shape (n_columns, q)."""
        out = np.empty(deformation.square.shape)
        by_cell = self._by_cell(out)
        for region, state in self._by_region(deformation):
            by_cell[:, region.at] = region.material.energy(*hoop_stretch.plane_state(*state))
        return out[0]

    def constant_densities(self, deformation: Deformation) -> np.ndarray:
        """dW / d(every parameter) of one field, but for what is projected, shape (C, n_columns, q)."""
        out = np.zeros((len(self.names), *deformation.square.shape))
        by_cell = self._by_cell(out)
        for region, state in self._by_region(deformation):
            rows = region.material.constant_energies(*hoop_stretch.plane_state(*state))
            for name, row in zip(region.names, rows, strict=True):
                by_cell[self.names.index(name)][:, region.at] = row
        return out[:, 0]

    # ---- sensitivities ----

    @cached_property
    def basis(self) -> CellBasis:
        return CellBasis(self.names, self.discretization)

    def linearization(self, step, following=None, measured=True) -> LinearizedBody:
        return LinearizedBody(self, step)

    def states(self, d: np.ndarray) -> BodyStates:
        """The body at displacement fields (K, n, 2) of converged steps, and its derivatives W_T, ..."""
        deformation = self.deformation_of(d)
        return BodyStates(
            self.cells.table, self.cells.column_weights, self.functions, self.bulk, d, deformation,
            self.energy_derivatives(deformation),
        )  # fmt: skip

    def linearization_of_block(self, steps) -> BodyBlock:
        return BodyBlock(self, steps)

    def no_seeds(self, n_measures) -> BodySeeds:
        nodal = n_measures, *self.discretization.particles.shape
        return BodySeeds(np.zeros(n_measures), np.zeros(nodal))
