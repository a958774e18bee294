"""Structural form for one design: internal force, tangent, energy, and data for sensitivities."""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.materials import hoop_stretch, stretch_and_growth
from seal_mdao.rkpm.visibility import parts_of_sides
from seal_mdao.structure.column_law import BodyStates
from seal_mdao.structure.deformation import (
    Deformation,
    deform,
    determinants,
    fill_deformations,
    no_deformation,
)
from seal_mdao.structure.energy_gradient import BodySeeds
from seal_mdao.structure.environment import (
    NO_CONDITIONS,
    RegionConditions,
    at_points,
    region_conditions,
)
from seal_mdao.structure.internal_force import assemble_internal
from seal_mdao.structure.linearized_body import BodyBlock, CellBasis, LinearizedBody
from seal_mdao.structure.linearized_relaxation import LinearizedRelaxation
from seal_mdao.structure.linearized_softening import LinearizedSoftening
from seal_mdao.structure.region import Region
from seal_mdao.structure.relaxation import Relaxation
from seal_mdao.structure.softening import Softening
from seal_mdao.terms.term import ReleasedEnergy, Term

_NO_BRANCH = np.empty(0, int)
_NOTHING = np.empty((0, 0, 0))


class StructuralResponse(NamedTuple):
    """Response of the structural form; its force is in the buffers.

    Attributes
    ----------
    fraction : float
        Path parameter of the environment.
    """

    fraction: float = 0.0
    history: None = None
    branch: np.ndarray = _NO_BRANCH
    unconverged: int = 0

    def copied(self):
        """Return the response itself."""
        return self


class GivenVolumeStrain(NamedTuple):
    """Volumetric strain (1, n_columns, m) with the pressure of the first mixed tangent."""

    volume_strain: np.ndarray


class ColumnsVolumetric(NamedTuple):
    """Volumetric energy K*/2 (s + c)^2 of the columns of cells at K path parameters.

    Attributes
    ----------
    bulk, offset : ndarray, shape (K, n_columns)
        K* over K, and c.
    rates : dict of str to ndarray, shape (2, K, n_columns)
        Derivatives of both in the parameters of the environment.
    """

    bulk: np.ndarray
    offset: np.ndarray
    rates: dict


class StructuralTerm(Term):
    """``ElasticBody`` for one design."""

    label = "structure"
    conservative = True

    def __init__(self, definition, discretization, index: int):
        self.definition, self.names = definition, tuple(definition.scalars)
        self.discretization, self.cells = discretization, discretization.cells
        self.index, self.material_history, self._linearized = index, None, LinearizedBody
        if any(region.softening is not None for region in definition.regions):
            self.material_history = Softening(definition, self.cells)
            self._linearized = LinearizedSoftening
        elif any(region.prony is not None for region in definition.regions):
            count = discretization.body.strains - 1
            self.material_history = Relaxation(definition, self.cells, count)
            self._linearized = LinearizedRelaxation
        self.history_dependent = self.passes_all = self.material_history is not None
        self.functions, self._before = discretization.body.pressure.functions, None
        self.bulk = self._per_column([r.material.bulk_modulus for r in definition.regions])
        self.deformation = no_deformation(1, self.cells, len(self.functions))
        size = discretization.body.support_radius.max() * discretization.depth
        # of a compressible law its own stiffness
        laws = [region.material for region in definition.regions]
        stiffness = max(law.bulk_modulus or law.initial_bulk_modulus for law in laws)
        # a force K a F' of the rounding error of F: eps where strains are of order one, and eps u / a of
        # displacements u over the radius a
        self.rounding = float(stiffness * size)
        self.rounding_by_displacement = float(stiffness * discretization.depth)

    def _per_column(self, values, dtype=float, what="bulk moduli") -> np.ndarray:
        """A value of each region spread to the columns of cells, shape (n_columns,).

        Raises
        ------
        ValueError
            When two materials with different ones meet in a column, in words for ``what`` they are.
        """
        cells = self.definition.per_cell(values, len(self.cells.weights), dtype)
        columns = cells.reshape(self.cells.raw.n_groups, -1)
        # all cells of a column must have the value of its first
        mixed = np.flatnonzero((columns != columns[:, :1]).any(axis=1))
        if mixed.size:
            raise ValueError(
                f"column {mixed[0]} of {columns.shape[1]} background cells across the wall has two "
                f"{what}, but its pressure is continuous; use the same in all cells of a column, "
                "or one pressure per cell"
            )
        return columns[:, 0].copy()

    def by_cell(self, values: np.ndarray) -> np.ndarray:
        """Values (..., n_columns, q of a column) as a view (..., n_cells, q of a cell)."""
        return values.reshape(*values.shape[:-2], *self.cells.weights.shape)

    # ---- the material at the quadrature points ----

    def by_region(self, deformation: Deformation):
        """Every region with its state (T, J), and h in a body of revolution, as views by cell."""
        states = [deformation.square, deformation.jacobian]
        if deformation.hoop is not None:
            states.append(deformation.hoop)
        states = [self.by_cell(state) for state in states]
        for region in self.definition.regions:
            yield region, [state[..., region.at, :] for state in states]

    def energy_derivatives(self, deformation: Deformation) -> np.ndarray:
        """W_T, W_J, W_TT, W_TJ, W_JJ of K fields, shape (5, K, n_columns, q); in a body of revolution
        also W_h, W_Th, W_Jh, W_hh, shape (9, ...)."""
        around, environment = deformation.hoop is not None, self.definition.environment
        # one material: no copies
        first = self.definition.regions[0]
        alone = len(self.definition.regions) == 1 and not around
        if alone and (environment is None or not environment.acts_on(first.growth)):
            material = first.material
            return material.derivatives(deformation.square, deformation.jacobian)
        out = np.empty((hoop_stretch.ROWS if around else 5, *deformation.square.shape))
        rows = self.by_cell(out)
        # every region by its own law
        for region, state in self.by_region(deformation):
            own = self.conditions(region, deformation.fractions)
            rows[:, :, region.at] = stretch_and_growth.derivatives(
                region.material, state, own.conditions
            )
        return out

    def law_derivatives(self, deformation: Deformation) -> np.ndarray:
        """d(W_T, W_J) / d(every parameter) of the laws at K fields, shape (C, 2, K, n_columns, q); in a
        body of revolution d(W_T, W_J, W_h), shape (C, 3, ...)."""
        around = deformation.hoop is not None
        out = np.zeros((len(self.names), 3 if around else 2, *deformation.square.shape))
        by_cell = self.by_cell(out)
        for region, state in self.by_region(deformation):
            own = self.conditions(region, deformation.fractions)
            # d(W_T, W_J)/dc; equal names are one parameter
            rows = stretch_and_growth.constant_derivatives(region.material, state, own.conditions)
            for name, row in zip(region.names, rows, strict=True):
                by_cell[self.names.index(name)][:, :, region.at] += row
            # d(W_T, W_J)/dp = d(W_T, W_J)/d(h, theta, m) . d(h, theta, m)/dp
            for name, rates in own.rates.items():
                slopes = stretch_and_growth.rates(region.material, state, own.conditions)
                row = (slopes * rates[:, None]).sum(axis=0)
                by_cell[self.names.index(name)][:, :, region.at] += row
        return out

    def constant_derivatives(self, deformation: Deformation, steps) -> np.ndarray:
        """``law_derivatives`` at K converged steps, with what the history does."""
        out = self.law_derivatives(deformation)
        if self.material_history is not None:
            responses = [step.responses[self.index] for step in steps]
            out = self.material_history.constant_derivatives(self, deformation, out, responses)
        return out

    def conditions(self, region: Region, fractions) -> RegionConditions:
        """Conditions of a region at path parameters (K,); none without an environment."""
        environment = self.definition.environment
        if environment is None or not environment.acts_on(region.growth):
            return NO_CONDITIONS
        return region_conditions(
            self.definition.environment, region.growth, region.prefix, fractions
        )

    # ---- the projected pressure p = K* (s + c) ----

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
    def column_regions(self) -> np.ndarray:
        """Number of the region of every column of cells, shape (n_columns,)."""
        return self._per_column(range(len(self.definition.regions)), int, "materials")

    def _volumetric(self, fractions) -> "ColumnsVolumetric":
        """What the environment does to K and to the volume change, of every column of cells."""
        shape = len(fractions), len(self.bulk)
        if self.definition.environment is None:
            return ColumnsVolumetric(np.ones(shape), np.zeros(shape), {})
        out, rates = np.empty((2, *shape)), {}
        for number, region in enumerate(self.definition.regions):
            own = self.conditions(region, fractions)
            if own.conditions is None:
                out[0][:, self.column_regions == number] = 1.0
                out[1][:, self.column_regions == number] = 0.0
                continue
            law, columns = (
                stretch_and_growth.volumetric(own.conditions),
                self.column_regions == number,
            )
            out[:, :, columns] = np.reshape([law.bulk, law.offset], (2, -1, 1))
            slopes = np.array([law.bulk_rates, law.offset_rates])
            for name, by_name in own.rates.items():
                # d(K*/K, c)/dp = d(K*/K, c)/d(h, theta, m) . d(h, theta, m)/dp
                found = rates.setdefault(name, np.zeros((2, *shape)))
                found[:, :, columns] = (slopes * by_name).sum(axis=1).reshape(2, -1, 1)
        return ColumnsVolumetric(*out, rates)

    def bulk_at(self, fractions) -> np.ndarray:
        """K* of every column at path parameters (K,), shape (K, n_columns)."""
        return self.bulk * self._volumetric(fractions).bulk

    def bulk_rates(self, fractions) -> np.ndarray:
        """dK* / d(every parameter) at path parameters (K,), shape (C, K, n_columns)."""
        own = self._volumetric(fractions)
        out = np.zeros((len(self.names), *own.bulk.shape))
        for number in range(len(self.names)):
            out[number] = np.where(self.bulk_row == number, own.bulk, 0.0)
        for name, (by_name, _) in own.rates.items():
            out[self.names.index(name)] += self.bulk * by_name
        return out

    def pressure_rates(self, deformation: Deformation) -> np.ndarray:
        """Derivatives of the pressures K* s_h in every parameter at K fields of fixed displacements,
        shape (C, K, n_columns, m)."""
        fractions = deformation.fractions
        # K*' s_h + K* c'
        out = self.bulk_rates(fractions)[..., None] * deformation.volume_strain
        bulk = self.bulk_at(fractions)
        for name, (_, offset) in self._volumetric(fractions).rates.items():
            out[self.names.index(name)] += (bulk * offset)[..., None]
        return out

    def _placed(self, deformation: Deformation, fractions) -> Deformation:
        """Set the path parameters of a deformation whose arrays are to be filled."""
        deformation.fractions[:] = fractions
        if self.definition.environment is not None:
            deformation.offset[:] = self._volumetric(fractions).offset
        return deformation

    @cached_property
    def particle_regions(self) -> np.ndarray:
        """Number of the region of every particle, shape (n,)."""
        regions, body = self.definition.regions, self.discretization.body
        out = np.zeros(body.n_particles, int)
        for number, region in enumerate(regions):
            out[body.cells[region.at]] = number
        return out

    @cached_property
    def cell_regions(self) -> np.ndarray:
        """Number of the region of every cell, shape (n_cells,)."""
        numbers = range(len(self.definition.regions))
        return self.definition.per_cell(numbers, len(self.discretization.body.cells), int)

    def side_regions(self, sides: np.ndarray) -> np.ndarray:
        """Number of the region of sides (m, 2) of cells; between two regions the last one."""
        return parts_of_sides(self.discretization.body.cells, self.cell_regions, sides)[1]

    @cached_property
    def sample_regions(self) -> np.ndarray:
        """Number of the region of every one of ``Body.samples``; between two regions the last one where
        the body has no parts."""
        body = self.discretization.body
        if body.parts is not None:
            return body.samples.parts
        # midpoints of sides follow the particles, centres of cells come last
        sides = body.samples.anchors[body.n_particles : -len(body.cells), :2]
        return np.concatenate([
            self.particle_regions, self.side_regions(sides), self.cell_regions
        ])  # fmt: skip

    def deformation_of(self, d: np.ndarray, fractions) -> Deformation:
        """Deformation at displacement fields (K, n, 2) that are known to be admissible, at path
        parameters (K,)."""
        out = no_deformation(len(d), self.cells, len(self.functions))
        return fill_deformations(self.cells, self.functions, d, self._placed(out, fractions))

    def pressure(self, deformation: Deformation) -> np.ndarray:
        """K* sum_h N_h s_h at the quadrature points of K fields, shape (K, n_columns, q)."""
        bulk = self.bulk_at(deformation.fractions)
        return bulk[..., None] * (deformation.volume_strain @ self._at_points)

    def cell_pressure(self, deformation: Deformation) -> np.ndarray:
        """p_c = K* sum_h n_h s_h at the quadrature points of K fields, shape (K, n_columns, q)."""
        bulk = self.bulk_at(deformation.fractions)
        return bulk[..., None] * (deformation.volume_strain @ self._cell_means)

    def squared_volume_strain(self, deformation: Deformation) -> np.ndarray:
        """sum_h N_h s_h^2 at the quadrature points of one field, shape (n_columns, q)."""
        return deformation.volume_strain[0] ** 2 @ self._at_points

    @property
    def _at_points(self) -> np.ndarray:
        """N_h at the quadrature points, without the means n_h at the rows of areas, shape (m, q)."""
        return self.functions[:, : self.cells.column_weights.shape[1]]

    @property
    def _cell_means(self) -> np.ndarray:
        """n_h at the quadrature points, shape (m, q)."""
        # one of the rows of areas of the cell of every point
        points = self.cells.column_weights.shape[1]
        n_areas = self.functions.shape[1] - points
        return self.functions[:, points + np.arange(points) * n_areas // points]

    # ---- stress at points ----

    def von_mises(self, region: Region, state, fraction: float) -> np.ndarray:
        """Von Mises stress at states (T, J), or (T, J, h), of a region, and its derivatives in them,
        shape (3 or 4, ...)."""
        own = at_points(self.conditions(region, [fraction]))
        return stretch_and_growth.von_mises(region.material, state, own.conditions)

    def von_mises_rates(self, region: Region, state, fraction: float):
        """Yield the parameters of a region and d sigma_vm / d(each) at states of it."""
        own = at_points(self.conditions(region, [fraction]))
        rows = stretch_and_growth.von_mises_constants(region.material, state, own.conditions)
        yield from zip(region.names, rows, strict=True)
        # d sigma/dp = d sigma/d(h, theta, m) . d(h, theta, m)/dp
        for name, rates in own.rates.items():
            slopes = stretch_and_growth.von_mises_rates(region.material, state, own.conditions)
            yield name, (slopes * rates).sum(axis=0)

    # ---- the contract of a term ----

    def no_history(self):
        return None if self.material_history is None else self.material_history.no_history()

    def no_rates(self, count):
        return None if self.material_history is None else self.material_history.no_history(count)

    def add(self, d, raw, fraction, history, force, values):
        scatter = self.discretization.layout.scatter[0]
        return self._assemble(self.cells.raw, raw, fraction, history, scatter, force, values)

    def _assemble(self, table, d, fraction, history, scatter, force, values, before=None):
        """Assemble at displacements ``d``; the tangent of a mixed iteration where the displacements
        ``before`` of the last one are given. Returns the response, None where a point is inverted."""
        weights, functions = self.cells.column_weights, self.functions
        self._placed(self.deformation, [fraction])
        if deform(table, weights, functions, d, self.deformation) >= 0:
            return None
        # W_T, W_J, W_TT, W_TJ, W_JJ at F
        w, now = self.energy_derivatives(self.deformation)[:, 0], self.deformation
        response, more = StructuralResponse(fraction), _NOTHING
        if self.material_history is not None:
            response, w, more = self.material_history.respond(self, w, fraction, history)
        law = 0, w, self.bulk_at([fraction])[0], more, scatter
        quadrature = table, weights, functions
        if before is None:
            assemble_internal(*quadrature, now, *law, force, values)
            return response
        # tangent with the pressure of the linearised volumetric strain, force with the exact one
        if isinstance(before, GivenVolumeStrain):
            volume_strain = before.volume_strain
        else:
            volume_strain = now.volume_strain - self._beyond_linear(table, d - before)
        expected = now._replace(volume_strain=volume_strain)
        assemble_internal(*quadrature, now, *law, force, np.empty(0))
        assemble_internal(*quadrature, expected, *law, np.empty_like(force), values)
        return response

    def _beyond_linear(self, table, du) -> np.ndarray:
        """Part of the volumetric strain (n_columns, m) that is quadratic in an increment ``du`` (n, 2):
        det(F + G) - det F - cof F : G = det G with G = grad du, and what the hoop stretch adds. 0
        where an increment inverts a cell."""
        weights, functions = self.cells.column_weights, self.functions
        increment = no_deformation(1, self.cells, len(functions))
        if deform(table, weights, functions, du, increment) >= 0:
            return np.zeros(self.deformation.volume_strain.shape[1:])
        f, own = increment.f[0], self.deformation.f[0]
        change, around = f[..., 4], increment.hoop is not None
        if around:
            # J - 1 of the increment = (det(1 + G) - 1) (1 + g) + g
            g = f[..., 5] - 1.0
            change = (change - g) / f[..., 5]
        # f is 1 + G: det G = det(1 + G) - 1 - tr G
        beyond = change - (f[..., 0] - 1.0) - (f[..., 3] - 1.0)
        if around:
            # of J = h det F, h = h0 + g: h0 det G + g (det(F0 + G) - det F0)
            ends = own[..., :4], own[..., :4] - f[..., :4] + (1.0, 0.0, 0.0, 1.0)
            grown = np.subtract(*map(determinants, ends))
            beyond = (self.deformation.hoop[0] - g) * beyond + g * grown
        # sum_q N_h w det G, of which the part in the plane is that of the rows of areas
        gradients = f[..., :4] - (1.0, 0.0, 0.0, 1.0)
        of_cells = determinants(increment.areas[0]) @ functions[:, weights.shape[1] :].T
        of_cells -= (weights * determinants(gradients)) @ self._cell_means.T
        at_points = self._at_points.T
        return ((weights * beyond) @ at_points + of_cells) / (weights @ at_points)

    def volume_strain_at(self, d: np.ndarray, fraction: float) -> np.ndarray:
        """Compute the projected volume change of the columns of cells at displacements ``d`` (n, 2),
        shape (n_columns, m)."""
        found = self._placed(no_deformation(1, self.cells, len(self.functions)), [fraction])
        deform(self.cells.table, self.cells.column_weights, self.functions, d, found)
        return found.volume_strain[0]

    # ---- mixed iterations ----

    def begin(self, iteration=None):
        # coefficients of the last linearisation of mixed iterations
        self._before = iteration

    @property
    def iteration(self):
        return self._before

    def begin_mixed(self, step, response, target):
        self._before = self.discretization.transformation.coefficients(step.d)

    def begin_near(self, d, target, known):
        # known: volumetric strain (n_columns, m)
        self._before = None if known is None else GivenVolumeStrain(known[None])

    def add_mixed(self, d, raw, fraction, history, force, values):
        """The pressure in the tangent is K times the linearised volumetric strain: what a linearised
        rotation adds to det F is of second order, but not when the bulk modulus multiplies it."""
        scatter, before = self.discretization.layout.scatter[0], self._before
        own = self._assemble(self.cells.raw, raw, fraction, history, scatter, force, values, before)
        self._before = before if own is None else raw
        return own

    def changes(self, step, response, target):
        if self.definition.environment is None:
            return []
        # dR = R(s_target) - R(s) at fixed displacements
        disc, found = self.discretization, []
        begin = step.before[self.index]
        for fraction, history in ((step.fraction, begin), (target, response.history)):
            force = np.zeros(disc.layout.force_size)
            raw = disc.transformation.coefficients(step.d)
            scatter = disc.layout.scatter[0]
            self._assemble(self.cells.raw, raw, fraction, history, scatter, force, np.empty(0))
            found.append(force)
        return [found[1] - found[0]]

    def forces(self, d: np.ndarray, fraction: float, history=None) -> np.ndarray | None:
        """Internal forces of all components, imposed ones included, shape (n, 2); None if inverted.

        At an imposed component of a converged step this is the force that holds it there.
        """
        every = self.discretization.layout.every_component
        force = np.zeros(2 * len(d) + 1)
        table = self.cells.table
        if self._assemble(table, d, fraction, history, every, force, np.empty(0)) is None:
            return None
        return force[:-1].reshape(-1, 2)

    def potential(self, d, response) -> float:
        return self.energy(d, response.fraction, response)

    def released_energy(self, step, before, d, response, target):
        if self.material_history is None:
            return super().released_energy(step, before, d, response, target)
        # the potential of the step does not contain what earlier steps dissipated
        released = self.potential(step.d, response) - self.potential(d, response)
        # relaxation, heat and swelling change the forces at fixed displacements; the work of this change
        # is not released energy
        driving = self.discretization.transformation.coefficients(d - step.d)
        equations = self.discretization.layout.scatter[0].equations
        changes = self.changes(step, before, target)
        work = sum(abs(float((change[equations] * driving).sum())) for change in changes)
        return ReleasedEnergy(released - work, released + work, work)

    def energy(self, d: np.ndarray, fraction: float, response=None) -> float:
        """Strain energy per unit depth, mJ/m; of a body with a history the potential of the step of
        ``response``."""
        deformation = self.deformation_of(d[None], [fraction])
        weights, bulk = self.cells.column_weights, self.bulk_at([fraction])[0]
        # W = sum_q w W(T, J) + sum_h K/2 V_h s_h^2, V_h = sum_q N_h w
        density = self.density(deformation)
        if self.material_history is not None:
            f = deformation.f[0]
            density = self.material_history.step_density(density, f, response)
        volumetric = 0.5 * bulk[:, None] * self.squared_volume_strain(deformation)
        return float((weights * (density + volumetric)).sum())

    def density(self, deformation: Deformation) -> np.ndarray:
        """W at the quadrature points of one field, shape (n_columns, q)."""
        out = np.empty(deformation.square.shape)
        by_cell = self.by_cell(out)
        for region, state in self.by_region(deformation):
            own = self.conditions(region, deformation.fractions)
            by_cell[:, region.at] = stretch_and_growth.energy(
                region.material, state, own.conditions
            )
        return out[0]

    def constant_densities(self, deformation: Deformation) -> np.ndarray:
        """dW / d(every parameter) of one field, but for what is projected, shape (C, n_columns, q)."""
        out = np.zeros((len(self.names), *deformation.square.shape))
        by_cell = self.by_cell(out)
        for region, state in self.by_region(deformation):
            own = self.conditions(region, deformation.fractions)
            rows = stretch_and_growth.constant_energies(region.material, state, own.conditions)
            for name, row in zip(region.names, rows, strict=True):
                by_cell[self.names.index(name)][:, region.at] += row
            # dW/dp = dW/d(h, theta, m) . d(h, theta, m)/dp
            for name, rates in own.rates.items():
                slopes = stretch_and_growth.energy_rates(region.material, state, own.conditions)
                by_cell[self.names.index(name)][:, region.at] += (slopes * rates).sum(axis=0)
        return out[:, 0]

    def energy_by_constants(self, deformation: Deformation) -> np.ndarray:
        """dE / d(every parameter) of one field, shape (C,)."""
        weights, fractions = self.cells.column_weights, deformation.fractions
        # sum_q w dW/dp
        out = np.einsum("ncq,cq->n", self.constant_densities(deformation), weights)
        # dK*/dp sum_h V_h s_h^2 / 2
        squares = (weights * self.squared_volume_strain(deformation)).sum(axis=1)
        out += 0.5 * self.bulk_rates(fractions)[:, 0] @ squares
        # K* c' sum_h V_h s_h
        pressure = (weights * self.pressure(deformation)[0]).sum(axis=1)
        for name, (_, offset) in self._volumetric(fractions).rates.items():
            out[self.names.index(name)] += offset[0] @ pressure
        return out

    # ---- sensitivities ----

    @cached_property
    def basis(self) -> CellBasis:
        return CellBasis(self.names, self.discretization)

    def linearization(self, step, following=None, measured=True) -> LinearizedBody:
        return self._linearized(self, step)

    def states(self, steps) -> BodyStates:
        """The body at converged steps, and its derivatives W_T, ..."""
        d, fractions = np.array([step.d for step in steps]), [step.fraction for step in steps]
        deformation = self.deformation_of(d, fractions)
        w, more = self.energy_derivatives(deformation), _NOTHING[None]
        if self.material_history is not None:
            responses = [step.responses[self.index] for step in steps]
            w, more = self.material_history.at_steps(w, responses)
        return BodyStates(
            self.cells.table, self.cells.column_weights, self.functions, self.bulk_at(fractions), d,
            deformation, w, more,
        )  # fmt: skip

    def linearization_of_block(self, steps) -> BodyBlock:
        return BodyBlock(self, steps)

    def no_seeds(self, n_measures) -> BodySeeds:
        nodal = n_measures, *self.discretization.particles.shape
        return BodySeeds(np.zeros(n_measures), np.zeros(nodal))
