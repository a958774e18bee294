"""Adjoint sensitivities through the friction history: the transposes of ``direct``, swept backwards.

    K_n^T lambda_n = (dm/dd_n)^T + (dx_n/dd)^T (dh_n/dx)^T h-bar_n,    n = N..1

with h-bar_n the seed on the history that step n hands on. The explicit part of a parameter's
influence is collected as seeds on B, w, Phi, ... and pulled back to the particles once at the end.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.body import add_tributary_seeds
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import PathResult
from seal_mdao.analysis.threads import one_blas_thread
from seal_mdao.contact.friction import (
    CARRIED,
    FORCE_X,
    GAP,
    LENGTH,
    RADIUS,
    XI,
    XI_0,
    X,
)
from seal_mdao.dsa.internal_rates import add_internal_seeds
from seal_mdao.dsa.linearization import converged_factor, local_contact, profile_share
from seal_mdao.dsa.point_rates import (
    add_displacement_seeds,
    add_gradient_seeds,
    add_shape_seeds,
    point_adjoint,
)
from seal_mdao.rkpm.cells import add_weight_seeds
from seal_mdao.rkpm.essential import transformation_seeds
from seal_mdao.rkpm.integration import cell_table_seeds
from seal_mdao.rkpm.tables import PointTable, table_seeds


@dataclass(frozen=True, eq=False)
class Seeds:
    """What M measures take from one converged step.

    Attributes
    ----------
    gap : ndarray, shape (M, k)
    force : ndarray, shape (M, k, 2)
    gradient : ndarray, shape (M, s, 4)
        On F at the stress particles.
    """

    gap: np.ndarray
    force: np.ndarray
    gradient: np.ndarray


@dataclass(frozen=True, eq=False)
class AdjointGradient:
    """Derivatives of M measures.

    Attributes
    ----------
    particles : ndarray, shape (M, n, 2)
    contact : ndarray, shape (M, 4)
        With respect to door radius, w_n, w_t and mu.
    constants : ndarray, shape (M, 3)
        With respect to C10, C01 and the bulk modulus, through the path.
    motion : ndarray, shape (M, 2)
        With respect to the final position of the profile.
    """

    particles: np.ndarray
    contact: np.ndarray
    constants: np.ndarray
    motion: np.ndarray


class AdjointSweep:
    """Backward sweep through a converged path for all measures at once.

    Parameters
    ----------
    path : PathResult
    problem : PathProblem
        The problem that the path solved.
    stress : PointTable
        The particles at which F is measured.
    n_measures : int
    """

    def __init__(self, path: PathResult, problem: PathProblem, stress: PointTable, n_measures: int):
        self.path, self.problem, self.stress, self.m = path, problem, stress, n_measures
        self.disc = disc = path.discretization
        k, m = len(disc.body.contact), n_measures
        self.n_steps = round(path.steps[-1].fraction)
        self.grad_bar = np.zeros((m, disc.cells.table.grad.size))
        self.weight_bar = np.zeros((m, *disc.weights.shape))
        self.phi_bar = np.zeros((m, disc.contact.table.phi.size))
        self.stress_bar = np.zeros((m, stress.table.grad.size))
        self.x_bar, self.length_bar = np.zeros((m, k, 2)), np.zeros((m, k))
        self.contact, self.constants = np.zeros((m, 4)), np.zeros((m, 3))
        self.motion = np.zeros((m, 2))

    def step(self, step, seeds: Seeds | None, history_bar) -> np.ndarray:
        """One backward step; returns the seed on the history with which the step began."""
        disc, problem = self.disc, self.problem
        layout, table = disc.layout, disc.contact.table
        local = local_contact(problem, step)
        out_bar = np.zeros((self.m, len(step.gap), 6))
        out_bar[:, :, XI : CARRIED + 1] = history_bar
        d_bar = np.zeros((layout.n_equations + 1, self.m))
        if seeds is not None:
            out_bar[:, :, GAP] += seeds.gap
            out_bar[:, :, FORCE_X:XI] += seeds.force
            add_gradient_seeds(
                self.stress.table, seeds.gradient, step.d, layout.equations, d_bar, self.stress_bar
            )
        through_x = _contract(out_bar, local[:, :, X:XI_0])
        add_displacement_seeds(table, through_x, layout.equations, d_bar)
        solution = converged_factor(problem, step).solve(d_bar[:-1], transposed=True)
        adjoint = np.ascontiguousarray(np.moveaxis(layout.gather(solution), 2, 0))
        at_points = np.empty((self.m, len(step.gap), 2))
        point_adjoint(table, adjoint, at_points)
        out_bar[:, :, FORCE_X:XI] -= at_points
        return self._collect(step, local, out_bar, adjoint)

    def _collect(self, step, local, out_bar, adjoint) -> np.ndarray:
        """Add the explicit parts of one step to the seeds."""
        disc, problem = self.disc, self.problem
        in_bar = _contract(out_bar, local)
        x_bar = np.ascontiguousarray(in_bar[:, :, X:XI_0])
        self.x_bar += x_bar
        self.motion -= profile_share(step, self.n_steps) * x_bar.sum(axis=1)
        self.length_bar += in_bar[:, :, LENGTH]
        self.contact += in_bar[:, :, RADIUS:].sum(axis=1)
        add_shape_seeds(disc.contact.table, x_bar, step.force, step.d, adjoint, self.phi_bar)
        add_internal_seeds(
            disc.cells.table, disc.weights, problem.constants, step.d, adjoint, self.grad_bar,
            self.weight_bar, self.constants,
        )  # fmt: skip
        return in_bar[:, :, XI_0:LENGTH]

    @one_blas_thread
    def run(self, seeds: dict) -> AdjointGradient:
        """Sweep back from the last measured step.

        Parameters
        ----------
        seeds : dict of int to Seeds
            By place in ``path.steps``.
        """
        history_bar = np.zeros((self.m, len(self.disc.body.contact), 3))
        frictionless = self.problem.law.friction == 0.0
        for place in range(max(seeds), -1, -1):
            if frictionless and place not in seeds:
                continue
            history_bar = self.step(self.path.steps[place], seeds.get(place), history_bar)
        self._collect_start(history_bar)
        return AdjointGradient(
            self._pull_back(), self.contact.copy(), self.constants.copy(), self.motion.copy()
        )

    def _collect_start(self, history_bar):
        """Seeds on the history of the undeformed state, which moves with the design."""
        out_bar = np.zeros((self.m, history_bar.shape[1], 6))
        out_bar[:, :, XI : CARRIED + 1] = history_bar
        in_bar = _contract(out_bar, local_contact(self.problem, self.path.start))
        self.x_bar += in_bar[:, :, X:XI_0]
        self.contact += in_bar[:, :, RADIUS:].sum(axis=1)

    def _pull_back(self) -> np.ndarray:
        """All collected seeds to the particles, (M, n, 2)."""
        disc = self.disc
        body, cloud, transformation = disc.body, disc.cloud, disc.transformation
        particles_bar = np.zeros((self.m, *disc.particles.shape))
        tables = (
            (disc.contact, self.phi_bar, np.zeros((self.m, disc.contact.table.grad.size))),
            (self.stress, np.zeros((self.m, self.stress.table.phi.size)), self.stress_bar),
        )
        matrix_bar = cell_table_seeds(
            cloud, disc.cells, self.grad_bar, self.weight_bar, particles_bar, transformation
        )
        for table, phi_bar, grad_bar in tables:
            matrix_bar = matrix_bar + table_seeds(
                cloud, table, phi_bar, grad_bar, particles_bar, transformation
            )
        self._pull_back_matrix(matrix_bar, particles_bar)
        add_weight_seeds(body.cell_map, disc.particles, self.weight_bar, particles_bar)
        add_tributary_seeds(body, disc.particles, self.length_bar, particles_bar)
        np.add.at(particles_bar, (slice(None), body.contact), self.x_bar)
        return particles_bar

    def _pull_back_matrix(self, matrix_bar, particles_bar):
        """Seeds on the essential transformation to the particles."""
        rows, transformation = self.disc.constrained_rows, self.disc.transformation
        rows_bar = transformation_seeds(transformation, matrix_bar)
        raw = rows.raw
        point = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
        phi_bar = rows_bar[:, point, np.searchsorted(transformation.union, raw.neighbours)]
        table_seeds(
            self.disc.cloud, rows, np.ascontiguousarray(phi_bar),
            np.zeros((self.m, raw.grad.size)), particles_bar,
        )  # fmt: skip


def _contract(out_bar, local):
    """Seeds (M, k, o) through local derivatives (k, o, i): (M, k, i), as one product per point."""
    return np.matmul(out_bar.transpose(1, 0, 2), local).transpose(1, 0, 2)
