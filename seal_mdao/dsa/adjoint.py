"""Adjoint sensitivities through the friction history: the transposes of ``direct``, swept backwards.

    K_n^T lambda_n = (dm/dd_n)^T + (dx_n/dd)^T (dh_n/dx)^T h-bar_n,    n = N..1

with h-bar_n the seed on the history that step n hands on. Of all measures together no more than a
few right-hand sides are needed for a step: what is measured there, and what is handed on (see
``handed_on``). lambda_n = Lambda_n C_n mixes their solutions. The explicit part of a parameter's
influence is collected as seeds on B, w, Phi, ... and pulled back to the particles once at the end.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.body import add_tributary_seeds
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import PathResult
from seal_mdao.analysis.threads import one_blas_thread
from seal_mdao.contact.friction import CARRIED, FORCE_X, GAP, LENGTH, OPEN, RADIUS, XI, XI_0, X
from seal_mdao.dsa.blocks import is_full
from seal_mdao.dsa.handed_on import adjoint_displacements, handed_on, sticking, unit_seeds
from seal_mdao.dsa.internal_seeds import add_internal_seeds
from seal_mdao.dsa.linearization import local_contact, profile_share
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
from seal_mdao.rkpm.scatter import scatter_add
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
        self.every = np.arange(k)
        self.n_steps = round(path.steps[-1].fraction)
        self.grad_bar = np.zeros((disc.cells.table.grad.size, m))
        self.weight_bar = np.zeros((*disc.weights.shape, m))
        self.phi_bar = np.zeros((disc.contact.table.phi.size, m))
        self.stress_bar = np.zeros((stress.table.grad.size, m))
        self.x_bar, self.length_bar = np.zeros((k, 2, m)), np.zeros((k, m))
        self.contact, self.constants = np.zeros((4, m)), np.zeros((3, m))
        self.motion = np.zeros((2, m))

    def step(self, step, following, seeds: Seeds | None, history_bar):
        """One backward step.

        Parameters
        ----------
        step, following : ConvergedStep
            The one before, and the one whose history seeds come in; None at the end.
        seeds : Seeds, optional
            Of what is measured at the step.
        history_bar : ndarray, shape (k, 3, M)
            Seeds on the history that the step hands on.

        Returns
        -------
        adjoints : ndarray, shape (n_equations + 1, c)
            Lambda of c right-hand sides, the last row zero.
        mix : ndarray, shape (c, M)
            C: the adjoint displacements of all measures are ``adjoints @ mix``.
        ndarray, shape (k, 3, M)
            Seeds on the history with which the step began.
        """
        disc, table = self.disc, self.disc.contact.table
        which = np.empty(0, int) if seeds is None else measures_at(seeds)
        used, touched = sticking(following), step.after.state != OPEN
        touched[used] = True
        points = self.every if which.size else np.flatnonzero(touched)
        local = local_contact(self.problem, step, points)
        handed = handed_on(used, local[np.searchsorted(points, used)])
        out_bar = np.zeros((points.size, 6, self.m))
        out_bar[:, XI : CARRIED + 1] = history_bar[points]
        first = which.size
        loads = np.zeros((disc.layout.n_equations + 1, first + handed.points.size))
        mix = np.zeros((loads.shape[1], self.m))
        if handed.points.size:
            at = np.searchsorted(points, handed.points)
            mix[first:] = self._add_handed(handed, local[at], out_bar[at], loads[:, first:])
        if first:
            mix[np.arange(first), which] = 1.0
            self._add_measured(step, seeds, which, local, out_bar, loads[:, :first])
        if len(mix) > self.m:
            loads, mix = loads @ mix, np.eye(self.m)
        adjoints = adjoint_displacements(self.problem, step, loads)
        at_points = np.empty((points.size, 2, len(mix)))
        point_adjoint(table, points, adjoints, disc.layout.equations, at_points)
        out_bar[:, FORCE_X:XI] -= at_points @ mix
        return adjoints, mix, self._collect_contact(step, points, local, out_bar, adjoints, mix)

    def _add_handed(self, handed, local, out_bar, loads) -> np.ndarray:
        """Add a column to ``loads`` for every displacement handed on; its share in all measures."""
        seeds, equations = unit_seeds(handed.directions), self.disc.layout.equations
        add_displacement_seeds(self.disc.contact.table, handed.points, seeds, equations, loads)
        through_x = local[:, :, X:XI_0].transpose(0, 2, 1) @ out_bar
        return (handed.directions[:, :, None] * through_x).sum(axis=1)

    def _add_measured(self, step, seeds, which, local, out_bar, loads) -> None:
        """Add the seeds of the measures ``which`` to ``out_bar`` (k, 6, M), and ``loads``."""
        own = np.zeros((len(local), 6, which.size))
        own[:, GAP] = seeds.gap[which].T
        own[:, FORCE_X:XI] = np.moveaxis(seeds.force[which], 0, 2)
        out_bar[:, :, which] += own
        through_x = local[:, :, X:XI_0].transpose(0, 2, 1) @ own
        equations = self.disc.layout.equations
        add_displacement_seeds(self.disc.contact.table, self.every, through_x, equations, loads)
        grad_bar = np.zeros((len(self.stress_bar), which.size))
        add_gradient_seeds(
            self.stress.table, np.moveaxis(seeds.gradient[which], 0, 2), step.d, equations, loads,
            grad_bar,
        )  # fmt: skip
        self.stress_bar[:, which] += grad_bar

    def _collect_contact(self, step, points, local, out_bar, adjoints, mix) -> np.ndarray:
        """Add what the contact points of one step see of the parameters."""
        in_bar = local.transpose(0, 2, 1) @ out_bar
        x_bar = np.ascontiguousarray(in_bar[:, X:XI_0])
        self.x_bar[points] += x_bar
        self.motion -= profile_share(step, self.n_steps) * x_bar.sum(axis=0)
        self.length_bar[points] += in_bar[:, LENGTH]
        self.contact += in_bar[:, RADIUS:].sum(axis=0)
        add_shape_seeds(
            self.disc.contact.table, points, x_bar, step.force, step.d, adjoints, mix,
            self.disc.layout.equations, self.phi_bar,
        )  # fmt: skip
        history_bar = np.zeros((self.every.size, 3, self.m))
        history_bar[points] = in_bar[:, XI_0:LENGTH]
        return history_bar

    def _collect_internal(self, swept) -> None:
        """Add the explicit terms of the internal force over some steps, given with their adjoints."""
        disc, (steps, adjoints, mixes) = self.disc, zip(*swept, strict=True)
        add_internal_seeds(
            disc.cells.table, disc.weights, self.problem.constants,
            np.array([step.d for step in steps]),
            np.cumsum([0, *map(len, mixes)]), np.hstack(adjoints), np.vstack(mixes),
            disc.layout.equations, self.grad_bar, self.weight_bar, self.constants,
        )  # fmt: skip

    @one_blas_thread
    def run(self, seeds: dict) -> AdjointGradient:
        """Sweep back from the last measured step.

        Parameters
        ----------
        seeds : dict of int to Seeds
            By place in ``path.steps``.
        """
        history_bar, following = np.zeros((self.every.size, 3, self.m)), None
        places = range(max(seeds), -1, -1)
        if self.problem.law.friction == 0.0:
            places = sorted(seeds, reverse=True)
        swept, size = [], 0
        for place in places:
            step = self.path.steps[place]
            adjoints, mix, history_bar = self.step(step, following, seeds.get(place), history_bar)
            following = step
            if len(mix):
                swept.append((step, adjoints, mix))
                size += adjoints.nbytes
            if is_full(size):
                self._collect_internal(swept)
                swept, size = [], 0
        if swept:
            self._collect_internal(swept)
        self._collect_start(history_bar)
        return AdjointGradient(
            self._pull_back(), self.contact.T.copy(), self.constants.T.copy(), self.motion.T.copy()
        )

    def _collect_start(self, history_bar):
        """Seeds on the history of the undeformed state, which moves with the design."""
        out_bar = np.zeros((len(history_bar), 6, self.m))
        out_bar[:, XI : CARRIED + 1] = history_bar
        in_bar = (
            local_contact(self.problem, self.path.start, self.every).transpose(0, 2, 1) @ out_bar
        )
        self.x_bar += in_bar[:, X:XI_0]
        self.contact += in_bar[:, RADIUS:].sum(axis=0)

    def _pull_back(self) -> np.ndarray:
        """All collected seeds to the particles, (M, n, 2)."""
        disc = self.disc
        body, cloud, transformation = disc.body, disc.cloud, disc.transformation
        particles_bar = np.zeros((*disc.particles.shape, self.m))
        tables = (
            (disc.contact, self.phi_bar, np.zeros((disc.contact.table.grad.size, self.m))),
            (self.stress, np.zeros((self.stress.table.phi.size, self.m)), self.stress_bar),
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
        scatter_add(particles_bar, body.contact, self.x_bar)
        return np.ascontiguousarray(np.moveaxis(particles_bar, -1, 0))

    def _pull_back_matrix(self, matrix_bar, particles_bar):
        """Seeds on the essential transformation to the particles."""
        rows, transformation = self.disc.constrained_rows, self.disc.transformation
        rows_bar = transformation_seeds(transformation, matrix_bar)
        raw = rows.raw
        point = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
        phi_bar = rows_bar[point, np.searchsorted(transformation.union, raw.neighbours)]
        table_seeds(
            self.disc.cloud, rows, np.ascontiguousarray(phi_bar),
            np.zeros((raw.grad.size, self.m)), particles_bar,
        )  # fmt: skip


def measures_at(seeds: Seeds) -> np.ndarray:
    """The measures that take something from a step."""
    return np.flatnonzero(
        seeds.gap.any(axis=1) | seeds.force.any(axis=(1, 2)) | seeds.gradient.any(axis=(1, 2))
    )
