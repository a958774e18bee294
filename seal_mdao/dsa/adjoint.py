"""Adjoint sensitivities through the histories: the transposes of ``direct``, swept backwards.

    K_n^T lambda_n = (dm/dd_n)^T + (dx_n/dd)^T (dh_n/dx)^T h-bar_n,    n = N..1

with h-bar_n the seed on the history that step n hands on. Of all measures together no more than a
few right-hand sides are needed for a step: what is measured there, and what is handed on (see
``seal_mdao.terms.handed_on``). lambda_n = Lambda_n C_n mixes their solutions. The explicit part of a
parameter's influence is collected as seeds on B, w, Phi, ... and pulled back to the particles once at
the end.
"""

from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from seal_mdao.analysis.result import PathResult
from seal_mdao.dsa.factors import solve_transposed
from seal_mdao.dsa.probe import ProbeReverse
from seal_mdao.dsa.shape_rates import add_matrix_seeds
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.measures.measure import Seeds


@dataclass(frozen=True, eq=False)
class AdjointGradient:
    """Derivatives of M measures.

    Attributes
    ----------
    particles : ndarray, shape (M, n, 2)
    names : tuple of str
        Scalar parameters of the terms.
    scalars : ndarray, shape (len(names), M)
    """

    particles: np.ndarray
    names: tuple
    scalars: np.ndarray

    def of(self, names) -> np.ndarray:
        """Derivatives with respect to scalar parameters that were wanted, shape (M, len(names)).

        Zero for those that no term depends on (the corner radius of a flat door).
        """
        place = {name: row for row, name in enumerate(self.names)}
        out = np.zeros((len(self.particles), len(names)))
        for column, name in enumerate(names):
            if name in place:
                out[:, column] = self.scalars[place[name]]
        return out


class AdjointSweep:
    """Backward sweep through a converged path for all measures at once.

    Parameters
    ----------
    path : PathResult
    probe : PointTable
        The points at which displacements and F are measured.
    n_measures : int
    names : sequence of str, optional
        The scalar parameters that are wanted; all of them when left out.
    """

    def __init__(self, path: PathResult, probe, n_measures: int, names=None):
        self.path, self.problem, self.m = path, path.problem, n_measures
        wanted = set(path.problem.names if names is None else names)
        self.reverses = [term.reverse(n_measures, wanted) for term in self.problem.terms]
        self.probe = ProbeReverse(path.discretization, probe, n_measures)
        imposed = self.problem.imposed
        self.held = np.zeros((0 if imposed is None else len(imposed.names), n_measures))

    def step(self, step, following, seeds: Seeds | None, history_bar):
        """One backward step.

        Parameters
        ----------
        step, following : ConvergedStep
            The one before, and the one whose history seeds come in; None at the end.
        seeds : Seeds, optional
            Of what is measured at the step.
        history_bar : tuple
            Seeds on the histories that the step hands on.

        Returns
        -------
        tuple
            Seeds on the histories with which the step began.
        """
        which = np.empty(0, int) if seeds is None else np.flatnonzero(seeds.used)
        plans = [
            reverse.prepare(step, following, which.size > 0, own)
            for reverse, own in zip(self.reverses, history_bar, strict=True)
        ]
        loads, mix = self._columns(step, seeds, which, plans)
        if len(mix) > self.m:
            loads, mix = loads @ mix, np.eye(self.m)
        adjoints = solve_transposed(self.problem, step, loads)
        held_bar = self._no_held()
        history = tuple(
            reverse.collect(plan, step, adjoints, mix, held_bar)
            for reverse, plan in zip(self.reverses, plans, strict=True)
        )
        if held_bar is not None:
            self._collect_held(step, seeds, which, held_bar)
        return history

    def _no_held(self) -> np.ndarray | None:
        """Room for seeds on imposed displacements; None where no parameter moves them."""
        imposed = self.problem.imposed
        if imposed is None or not imposed.names:
            return None
        return np.zeros((self.path.discretization.particles.size + 1, self.m))

    def _collect_held(self, step, seeds, which, held_bar) -> None:
        """Add what imposed displacements do, directly and through equilibrium, to the parameters."""
        layout, imposed = self.path.discretization.layout, self.problem.imposed
        if which.size:
            every = layout.every_component.equations
            held_bar[:, which] += self.probe.nodal_seeds(step, seeds, which, every, len(held_bar))
        nodal = held_bar[:-1].reshape(-1, 2, self.m) * (layout.equations < 0)[..., None]
        self.held += np.einsum("sni,nim->sm", imposed.rates_at(step.fraction), nodal)

    def _columns(self, step, seeds, which, plans):
        """Right-hand sides: what is measured, then what every term has handed on; and their mix."""
        size = self.path.discretization.layout.n_equations + 1
        ends = list(accumulate((plan.count for plan in plans), initial=which.size))
        loads, mix = np.zeros((size, ends[-1])), np.zeros((ends[-1], self.m))
        for reverse, plan, (first, last) in zip(self.reverses, plans, pairwise(ends), strict=True):
            if first < last:
                reverse.add_handed(plan, loads[:, first:last], mix[first:last])
        if which.size:
            mix[np.arange(which.size), which] = 1.0
            measured = loads[:, : which.size]
            for term, reverse, plan in zip(self.problem.terms, self.reverses, plans, strict=True):
                if term.label in seeds.terms:
                    reverse.add_measured(plan, seeds.terms[term.label], which, measured)
            self.probe.add_measured(step, seeds, which, measured)
        return loads, mix

    @one_blas_thread
    def run(self, seeds: dict) -> AdjointGradient:
        """Sweep back from the last measured step.

        Parameters
        ----------
        seeds : dict of int to Seeds
            By place in ``path.steps``.
        """
        history_bar = tuple(reverse.no_history() for reverse in self.reverses)
        following, places = None, range(max(seeds, default=-1), -1, -1)
        if not self.problem.remembers:
            places = sorted(seeds, reverse=True)
        for place in places:
            step = self.path.steps[place]
            history_bar = self.step(step, following, seeds.get(place), history_bar)
            following = step
        return self._pulled_back(history_bar)

    def _pulled_back(self, history_bar) -> AdjointGradient:
        """All collected seeds to the particles and the parameters."""
        disc, names = self.path.discretization, self.problem.names
        particles_bar = np.zeros((*disc.particles.shape, self.m))
        scalars, matrix_bar = np.zeros((len(names), self.m)), 0.0
        for term, reverse, own in zip(self.problem.terms, self.reverses, history_bar, strict=True):
            parameters, on_matrix = reverse.finish(self.path.start, own, particles_bar)
            matrix_bar = matrix_bar + on_matrix
            for name, row in zip(term.names, parameters, strict=True):
                scalars[names.index(name)] += row
        if len(self.held):
            for name, row in zip(self.problem.imposed.names, self.held, strict=True):
                scalars[names.index(name)] += row
        matrix_bar = matrix_bar + self.probe.finish(particles_bar)
        add_matrix_seeds(disc, matrix_bar, particles_bar)
        gradient = np.ascontiguousarray(np.moveaxis(particles_bar, -1, 0))
        return AdjointGradient(gradient, names, scalars)
