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
from seal_mdao.dsa.blocks import blocks
from seal_mdao.dsa.internal_rates import add_internal_seeds
from seal_mdao.dsa.linearization import converged_factor, local_contact, profile_share
from seal_mdao.dsa.point_rates import (
    add_displacement_seeds,
    add_gradient_seeds,
    add_shape_seeds,
    point_adjoint,
)
from seal_mdao.measures.functional import Seeds
from seal_mdao.rkpm.cells import add_weight_seeds
from seal_mdao.rkpm.essential import transformation_seeds
from seal_mdao.rkpm.integration import cell_table_seeds
from seal_mdao.rkpm.tables import PointTable, table_seeds


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
        self.grad_bar = np.zeros((disc.cells.table.grad.size, m))
        self.weight_bar = np.zeros((*disc.weights.shape, m))
        self.phi_bar = np.zeros((disc.contact.table.phi.size, m))
        self.stress_bar = np.zeros((stress.table.grad.size, m))
        self.x_bar, self.length_bar = np.zeros((k, 2, m)), np.zeros((k, m))
        self.contact, self.constants = np.zeros((4, m)), np.zeros((3, m))
        self.motion = np.zeros((2, m))

    def step(self, step, seeds: Seeds | None, history_bar, adjoint) -> np.ndarray:
        """One backward step.

        Parameters
        ----------
        history_bar : ndarray, shape (k, 3, M)
            Seeds on the history that the step hands on.
        adjoint : ndarray, shape (n_equations + 1, M)
            Zero; written: the adjoint displacements, the last row zero.

        Returns
        -------
        ndarray, shape (k, 3, M)
            Seeds on the history with which the step began.
        """
        disc, problem = self.disc, self.problem
        equations, table = disc.layout.equations, disc.contact.table
        local = local_contact(problem, step)
        out_bar = np.zeros((len(step.gap), 6, self.m))
        out_bar[:, XI : CARRIED + 1] = history_bar
        if seeds is not None:
            out_bar[:, GAP] += seeds.gap.T
            out_bar[:, FORCE_X:XI] += np.moveaxis(seeds.force, 0, 2)
            add_gradient_seeds(
                self.stress.table, np.moveaxis(seeds.gradient, 0, 2), step.d, equations, adjoint,
                self.stress_bar,
            )  # fmt: skip
        through_x = local[:, :, X:XI_0].transpose(0, 2, 1) @ out_bar
        add_displacement_seeds(table, through_x, equations, adjoint)
        adjoint[:-1] = converged_factor(problem, step).solve(adjoint[:-1], transposed=True)
        adjoint[-1] = 0.0
        at_points = np.empty((len(step.gap), 2, self.m))
        point_adjoint(table, adjoint, equations, at_points)
        out_bar[:, FORCE_X:XI] -= at_points
        return self._collect_contact(step, local, out_bar, adjoint)

    def _collect_contact(self, step, local, out_bar, adjoint) -> np.ndarray:
        """Add what the contact points of one step see of the parameters."""
        in_bar = local.transpose(0, 2, 1) @ out_bar
        x_bar = in_bar[:, X:XI_0]
        self.x_bar += x_bar
        self.motion -= profile_share(step, self.n_steps) * x_bar.sum(axis=0)
        self.length_bar += in_bar[:, LENGTH]
        self.contact += in_bar[:, RADIUS:].sum(axis=0)
        add_shape_seeds(
            self.disc.contact.table, x_bar, step.force, step.d, adjoint,
            self.disc.layout.equations, self.phi_bar,
        )  # fmt: skip
        return in_bar[:, XI_0:LENGTH]

    def _collect_internal(self, steps, adjoints) -> None:
        """Add the explicit terms of the internal force over a block of steps."""
        disc = self.disc
        add_internal_seeds(
            disc.cells.table, disc.weights, self.problem.constants,
            np.array([step.d for step in steps]), adjoints, disc.layout.equations, self.grad_bar,
            self.weight_bar, self.constants,
        )  # fmt: skip

    @one_blas_thread
    def run(self, seeds: dict) -> AdjointGradient:
        """Sweep back from the last measured step.

        Parameters
        ----------
        seeds : dict of int to Seeds
            By place in ``path.steps``.
        """
        n_equations = self.disc.layout.n_equations
        history_bar = np.zeros((len(self.disc.body.contact), 3, self.m))
        places = range(max(seeds), -1, -1)
        if self.problem.law.friction == 0.0:
            places = sorted(seeds, reverse=True)
        for block in blocks(places, n_equations, self.m):
            steps = [self.path.steps[place] for place in block]
            adjoints = np.zeros((len(block), n_equations + 1, self.m))
            for place, step, adjoint in zip(block, steps, adjoints, strict=True):
                history_bar = self.step(step, seeds.get(place), history_bar, adjoint)
            self._collect_internal(steps, adjoints)
        self._collect_start(history_bar)
        return AdjointGradient(
            self._pull_back(), self.contact.T.copy(), self.constants.T.copy(), self.motion.T.copy()
        )

    def _collect_start(self, history_bar):
        """Seeds on the history of the undeformed state, which moves with the design."""
        out_bar = np.zeros((len(history_bar), 6, self.m))
        out_bar[:, XI : CARRIED + 1] = history_bar
        in_bar = local_contact(self.problem, self.path.start).transpose(0, 2, 1) @ out_bar
        self.x_bar += in_bar[:, X:XI_0]
        self.contact += in_bar[:, RADIUS:].sum(axis=0)

    def _pull_back(self) -> np.ndarray:
        """All collected seeds to the particles, (M, n, 2)."""
        disc = self.disc
        body, cloud, transformation = disc.body, disc.cloud, disc.transformation
        particles_bar = np.zeros((self.m, *disc.particles.shape))
        weight_bar, x_bar = _measures_first(self.weight_bar), _measures_first(self.x_bar)
        tables = (
            (disc.contact, self.phi_bar, np.zeros((disc.contact.table.grad.size, self.m))),
            (self.stress, np.zeros((self.stress.table.phi.size, self.m)), self.stress_bar),
        )
        matrix_bar = cell_table_seeds(
            cloud, disc.cells, _measures_first(self.grad_bar), weight_bar, particles_bar,
            transformation,
        )  # fmt: skip
        for table, phi_bar, grad_bar in tables:
            matrix_bar = matrix_bar + table_seeds(
                cloud, table, _measures_first(phi_bar), _measures_first(grad_bar), particles_bar,
                transformation,
            )  # fmt: skip
        self._pull_back_matrix(matrix_bar, particles_bar)
        add_weight_seeds(body.cell_map, disc.particles, weight_bar, particles_bar)
        add_tributary_seeds(body, disc.particles, self.length_bar.T, particles_bar)
        np.add.at(particles_bar, (slice(None), body.contact), x_bar)
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


def _measures_first(bar) -> np.ndarray:
    """Seeds (..., M) as (M, ...)."""
    return np.ascontiguousarray(np.moveaxis(bar, -1, 0))
