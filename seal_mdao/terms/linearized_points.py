"""Linearisation of a term at points at one converged step: B, the law's L, and their products.

With the rows B = Phi of the points, the force of a term, the history h+ that it passes to the next step
and its outputs o are

    f = B^T s,    (s, h+, o) = law(x, h, w, theta, X),    x = X + B d.

direct     x' = X' + B' d + B d'
           (s', h+', o') = L (x', h', w', theta', X')             Eqs. (57), (63), (66) of contact
           f' = B^T s' + B'^T s

adjoint    s_bar = -B lambda
           (x_bar, h_bar, w_bar, theta_bar, X_bar) = L^T (s_bar, h+_bar, o_bar)
           B_bar = x_bar d^T - s (B lambda)^T,    d_bar = B^T x_bar
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.rkpm.transformed import TableRates
from seal_mdao.terms.linearization import Inputs, Linearization, Outputs, PassedOn
from seal_mdao.terms.linearized_term import LinearizedTerm
from seal_mdao.terms.point_rates import (
    add_displacement_rates,
    add_field,
    add_force_rates,
    add_shape_seeds,
    add_transposed,
)


class PointDesign(NamedTuple):
    """Rates of design dependent quantities at k points, in P columns.

    Attributes
    ----------
    phi : TableRates
        B'.
    x : ndarray, shape (k, 2, P)
        X' of the undeformed places.
    measure : ndarray, shape (k, 1, P)
        w' of the weights.
    parameters : ndarray, shape (n, P)
        theta' of the scalar parameters.
    """

    phi: TableRates
    x: np.ndarray
    measure: np.ndarray
    parameters: np.ndarray


class PointDesignSeeds(NamedTuple):
    """Seeds of M measures on design dependent quantities at k points, summed over the steps.

    Attributes
    ----------
    phi : ndarray, shape (phi.size, M)
        On B.
    law : Inputs
        On what the law takes.
    """

    phi: np.ndarray
    law: Inputs

    @property
    def parameters(self) -> np.ndarray:
        """On the scalar parameters, shape (n, M)."""
        return self.law.parameters.sum(axis=0)


class PointRows:
    """Rows B of the points of a term, and their design derivatives.

    Parameters
    ----------
    term : TermAtPoints
    """

    def __init__(self, term):
        self.term, self.where, self.table = term, term.where, term.table
        self.discretization = term.discretization

    def rates(self, shape, rates) -> PointDesign:
        """Rates for the parameters of ``rates``; ``shape`` are the ``DiscretizationRates``."""
        particles, velocity = self.discretization.particles, rates.velocity
        # w', X' and theta'
        measure = self.where.measure_rates(particles, velocity)[:, None]
        x, parameters = self.where.moving.rates(particles, velocity), rates.of(self.term.names)
        return PointDesign(shape.tables[self.term.index], x, measure, parameters)

    def no_seeds(self, count: int, wanted=()) -> PointDesignSeeds:
        """Zero seeds of ``count`` measures, to be added to."""
        phi = np.zeros((self.table.table.phi.size, count))
        return PointDesignSeeds(phi, self.term.spaces[1].zeros(len(self.where), count))

    def pull_back(self, seeds: PointDesignSeeds, particles_bar):
        """Transpose of ``rates``: add to ``particles_bar`` (n, 2, M) what the seeds come to there.

        Returns
        -------
        ndarray, shape (c, u, M)
            Seeds on the essential transformation.
        """
        disc, none, law = self.discretization, np.empty((0, particles_bar.shape[2])), seeds.law
        # x = X + B d, and X itself
        x_bar = law.x + law.reference if law.reference.shape[1] else law.x
        # w = length of the boundary at the point,  x = X + B d
        self.where.add_measure_seeds(disc.particles, law.measure[:, 0], particles_bar)
        self.where.moving.add_seeds(disc.particles, x_bar, particles_bar)
        # B_bar to the particles and to T
        return self.table.pull_back(seeds.phi, none, particles_bar)


@dataclass(frozen=True, eq=False)
class PointSeeds:
    """Seeds of M measures on the results of a term at points.

    Attributes
    ----------
    force : ndarray, shape (M, k, 2)
    outputs : ndarray, shape (M, k, o)
    """

    force: np.ndarray
    outputs: np.ndarray

    @property
    def used(self) -> np.ndarray:
        """Measures with seeds that are not zero, shape (M,)."""
        return self.force.any(axis=(1, 2)) | self.outputs.any(axis=(1, 2))

    def put(self, rows, other: "PointSeeds") -> None:
        """Set the ``rows`` of measures to ``other``."""
        self.force[rows], self.outputs[rows] = other.force, other.outputs

    def times(self, rates: Outputs) -> np.ndarray:
        """The rates of the measures, (M, P)."""
        return np.tensordot(self.force, rates.force, 2) + np.tensordot(
            self.outputs, rates.outputs, 2
        )


class LinearizedPoints(LinearizedTerm):
    """A term at points at one converged step.

    Parameters
    ----------
    term : TermAtPoints
    step : ConvergedStep
    law : Linearization
        At the points that matter at the step.
    used : ndarray of int
        Points, or variables of the history, that the next step uses.
    """

    def __init__(self, term, step, law: Linearization, used: np.ndarray):
        self.term, self.step, self.law, self.used = term, step, law, used
        self.points, self.layout = law.points, term.discretization.layout
        self.response, self.table = step.responses[term.index], term.table.table
        self.equations = self.layout.equations

    # ---- products with rates ----

    def rates(self, design: PointDesign, history, prescribed, load) -> Outputs:
        points, x = self.points, design.x[self.points]
        # x' = V + z' with V = X', z' = B' d + B d'   Eq. (48): at fixed d, B d' of imposed displacements
        add_displacement_rates(self.table, points, design.phi, self.step.d, x)
        if prescribed is not None:
            add_field(self.table, points, self.layout.every_component.equations, prescribed, x)
        # (x', h', w', theta', X') of the law
        self.given = Inputs(
            x, history[points], design.measure[points], design.parameters, design.x[points]
        )
        # (s', h+', o') = L (x', h', w', theta', X'), Eqs. (57), (63), (66) of contact
        found = self.law @ self.given
        # f' = B^T s' + B'^T s
        add_force_rates(
            self.table, points, design.phi, self.response.force,
            np.ascontiguousarray(found.force), self.term.acting(self.response),
            self.equations, load,
        )  # fmt: skip
        return found

    def solved(self, found: Outputs, solution: np.ndarray) -> Outputs:
        # x' += B d'   Eq. (48), complete before L: what moves with the body cancels in it, and not in
        # products with large penalties
        add_field(self.table, self.points, self.equations, solution, self.given.x)
        return self.law @ self.given

    def passed(self, found: Outputs, passed: PassedOn, values: np.ndarray) -> Outputs:
        if passed.are_indices:
            # as in ``solved``: h+' = L_h (x' + G z, ...)
            self.given.x[:] += passed.directions @ values
            return self.law @ self.given
        # h+' += H z
        found.history[:] += passed.history @ values
        return found

    def history_rates(self, found: Outputs) -> np.ndarray:
        out = np.zeros((len(self.term.where), *found.history.shape[1:]))
        out[self.points] = found.history
        return out

    # ---- what the next step uses ----

    def passed_on(self, following) -> PassedOn | None:
        if not self.used.size:
            return None
        return self.term.passed_on(self.law, self.used, self.step, following)

    def loads_of(self, passed: PassedOn) -> np.ndarray:
        return self._spread(passed.directions)

    def _spread(self, x_bar) -> np.ndarray:
        """B^T x_bar, shape (n_equations + 1, M)."""
        out = np.zeros((self.layout.n_equations + 1, x_bar.shape[2]))
        add_transposed(self.table, self.points, self.equations, np.ascontiguousarray(x_bar), out)
        return out

    # ---- products with seeds ----

    def seeds(self, history_bar, taken: PointSeeds | None = None) -> Outputs:
        # (s_bar, h+_bar, o_bar), s_bar = 0 yet
        seeds = self.law.rows.zeros(self.points.size, history_bar.shape[2])
        seeds.history[:] = history_bar[self.points]
        if taken is not None:
            _fill(seeds, taken, slice(None))
        return seeds

    def measured_loads(self, taken: PointSeeds, which) -> np.ndarray:
        seeds = self.law.rows.zeros(self.points.size, which.size)
        _fill(seeds, taken, which)
        # d_bar = B^T x_bar of what is measured
        return self._spread((self.law.T @ seeds).x)

    def pull_back(self, seeds: Outputs, adjoints, mix, design: PointDesignSeeds, prescribed_bar):
        points, table = self.points, self.table
        history_bar = np.zeros((len(self.term.where), *seeds.history.shape[1:]))
        if not points.size:
            return history_bar
        # s_bar = -B lambda
        at_points = np.zeros((points.size, 2, len(mix)))
        add_field(table, points, self.equations, adjoints, at_points)
        seeds.force[:] -= at_points @ mix
        # (x_bar, h_bar, w_bar, theta_bar, X_bar) = L^T (s_bar, h+_bar, o_bar)
        taken = self.law.T @ seeds
        self.law.columns.add(taken, points, design.law)
        # B_bar = x_bar d^T - s (B lambda)^T
        x_bar = np.ascontiguousarray(taken.x)
        add_shape_seeds(
            table, points, x_bar, self.response.force, self.step.d, adjoints, mix, self.equations,
            design.phi,
        )  # fmt: skip
        if prescribed_bar is not None:
            add_transposed(
                table, points, self.layout.every_component.equations, x_bar, prescribed_bar
            )
        history_bar[points] = taken.history
        return history_bar


def _fill(seeds: Outputs, taken: PointSeeds, which) -> None:
    """Set the seeds on forces and outputs to those of the measures ``which``."""
    seeds.force[:] = np.moveaxis(taken.force[which], 0, 2)
    seeds.outputs[:] = np.moveaxis(taken.outputs[which], 0, 2)
