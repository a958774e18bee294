"""Adjoint sensitivities through the histories: the transpose of ``direct``, from the last step to
the first.

    K_n^T lambda_n = sum over terms of B^T L_x^T (h+_bar, o_bar) + what is measured of d,    n = N..1
    (x_bar, h_bar, w_bar, theta_bar, X_bar) = L^T (-B lambda, h+_bar, o_bar)
    B_bar = x_bar d^T - s (B lambda)^T

with h+_bar the seed on the history that step n passes on: h_bar of step n + 1. Of all measures together
no more than a few right-hand sides are needed for a step: what is measured there, and what is passed on,
B^T G of ``direct``. lambda_n = Lambda_n C_n mixes their solutions. The seeds on B, w, theta and X are
summed over the steps and pulled back to the particles once at the end.
"""

from dataclasses import dataclass
from itertools import accumulate, pairwise

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.dsa.factors import is_full, solve_transposed
from seal_mdao.dsa.probe import Probe
from seal_mdao.equilibrium.matrix_seeds import add_matrix_seeds
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
        """Return the derivatives with respect to requested scalar parameters, shape (M,
        len(names)).

        Zero for those that no term depends on (the corner radius of a flat door).
        """
        index = {name: row for row, name in enumerate(self.names)}
        out = np.zeros((len(self.particles), len(names)))
        for column, name in enumerate(names):
            if name in index:
                out[:, column] = self.scalars[index[name]]
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
        self.designs = [term.basis.no_seeds(n_measures, wanted) for term in self.problem.terms]
        self.probe = Probe(path.discretization, probe, n_measures)
        imposed = self.problem.imposed
        self.prescribed = np.zeros((0 if imposed is None else len(imposed.names), n_measures))
        self.places_bar = np.zeros((*path.discretization.particles.shape, n_measures))
        self.swept, self.size = [], 0

    def step(self, step, following, seeds: Seeds | None, history_bar):
        """Compute one backward step.

        Parameters
        ----------
        step, following : ConvergedStep
            The one before, and the one whose history seeds come in; None at the end.
        seeds : Seeds, optional
            Of what is measured at the step.
        history_bar : tuple
            Seeds on the histories that the step passes on.

        Returns
        -------
        tuple
            Seeds on the histories with which the step began.
        """
        which = np.empty(0, int) if seeds is None else np.flatnonzero(seeds.used)
        # seeds may all be zero, as those of work where a profile turns back
        taken = seeds.terms if which.size else {}
        # L of every term at the step
        terms = [term.linearization(step, following, which.size > 0) for term in self.problem.terms]
        # (h+_bar, o_bar) of every term
        bars = [
            linearized.seeds(own, taken.get(term.label))
            for term, linearized, own in zip(self.problem.terms, terms, history_bar, strict=True)
        ]
        # K^T Lambda = columns,  lambda = Lambda C
        loads, mix = self._columns(step, following, seeds, which, terms, bars)
        # what terms pass on that depends on all of d
        for linearized, bar in zip(terms, bars, strict=True):
            on_all = linearized.history_loads(bar)
            if on_all is not None:
                loads, mix = loads @ mix + on_all, np.eye(self.m)
        # no more right-hand sides than measures
        if len(mix) > self.m:
            loads, mix = loads @ mix, np.eye(self.m)
        # Lambda = K^-T (...)
        adjoints = solve_transposed(self.problem, step, loads)
        if len(mix):
            self._collect(step, adjoints, mix)
        prescribed_bar = self._no_prescribed()
        # (x_bar, h_bar, w_bar, theta_bar, X_bar) = L^T (-B lambda, h+_bar, o_bar)
        history = self._pull_back(terms, bars, adjoints, mix, prescribed_bar)
        if prescribed_bar is not None:
            self._collect_prescribed(step, seeds, which, prescribed_bar)
        return history

    def _columns(self, step, following, seeds, which, terms, bars):
        """Right-hand sides: what is measured, then what every term passes on; and their mix."""
        passed = [None if following is None else term.passed_on(following) for term in terms]
        counts = [0 if own is None else own.count for own in passed]
        ends = list(accumulate(counts, initial=which.size))
        size = self.path.discretization.layout.n_equations + 1
        loads, mix = np.zeros((size, ends[-1])), np.zeros((ends[-1], self.m))
        for term, own, bar, (first, last) in zip(terms, passed, bars, pairwise(ends), strict=True):
            if first < last:
                # B^T G and H^T h+_bar
                loads[:, first:last], mix[first:last] = term.loads_of(own), own.seeds(bar.history)
        if which.size:
            # what is measured belongs to its own measure
            mix[np.arange(which.size), which] = 1.0
            measured = loads[:, : which.size]
            for term, linearized in zip(self.problem.terms, terms, strict=True):
                if term.label in seeds.terms:
                    measured += linearized.measured_loads(seeds.terms[term.label], which)
            self.probe.add_measured(step, seeds, which, measured)
        return loads, mix

    def _pull_back(self, terms, bars, adjoints, mix, prescribed_bar) -> tuple:
        """Add what the parameters do at the step; returns the seeds on the histories before it."""
        return tuple(
            term.pull_back(bar, adjoints, mix, design, prescribed_bar)
            for term, bar, design in zip(terms, bars, self.designs, strict=True)
        )

    # ---- what is taken in blocks of steps ----

    def _collect(self, step, adjoints, mix) -> None:
        self.swept.append((step, adjoints, mix))
        self.size += adjoints.nbytes
        if is_full(self.size):
            self._flush()

    def _flush(self) -> None:
        """Seeds of forces without history at the steps that were collected."""
        if not self.swept:
            return
        steps, adjoints, mixes = zip(*self.swept, strict=True)
        for term, design in zip(self.problem.terms, self.designs, strict=True):
            block = term.linearization_of_block(steps)
            if block is not None:
                block.pull_back(adjoints, mixes, design)
        self.swept, self.size = [], 0

    # ---- imposed displacements ----

    def _no_prescribed(self) -> np.ndarray | None:
        """Return zero seeds on imposed displacements; None where they do not vary."""
        imposed = self.problem.imposed
        if imposed is None or not imposed.varies:
            return None
        return np.zeros((self.path.discretization.particles.size + 1, self.m))

    def _collect_prescribed(self, step, seeds, which, prescribed_bar) -> None:
        """Add what imposed displacements do, directly and through equilibrium, to the parameters."""
        layout, imposed = self.path.discretization.layout, self.problem.imposed
        if which.size:
            every = layout.every_component.equations
            prescribed_bar[:, which] += self.probe.nodal_seeds(
                step, seeds, which, every, len(prescribed_bar)
            )
        # (dd/dp)^T d_bar of the imposed components
        nodal = prescribed_bar[:-1] * (layout.equations < 0).reshape(-1, 1)
        self.prescribed += imposed.linearization(step.fraction).T @ nodal
        # (dd/dX)^T d_bar
        by_place = imposed.by_particles(step.fraction)
        self.places_bar += np.einsum("nij,nim->njm", by_place, nodal.reshape(self.places_bar.shape))

    # ---- the path ----

    @one_blas_thread
    def run(self, seeds: dict) -> AdjointGradient:
        """Sweep back from the last measured step.

        Parameters
        ----------
        seeds : dict of int to Seeds
            by index in ``path.steps``.
        """
        # h+_bar = 0 at the last measured step
        history_bar = tuple(term.no_rates(self.m) for term in self.problem.terms)
        following, indices = None, range(max(seeds, default=-1), -1, -1)
        # steps without history do not depend on each other
        if not self.problem.history_dependent:
            indices = sorted(seeds, reverse=True)
        for index in indices:
            step = self.path.steps[index]
            history_bar = self.step(step, following, seeds.get(index), history_bar)
            following = step
        self._flush()
        return self._pulled_back(history_bar)

    def _pulled_back(self, history_bar) -> AdjointGradient:
        """All collected seeds, and those on the first history, to the particles and the parameters."""
        disc, names = self.path.discretization, self.problem.names
        # the first history moves with X
        terms = [term.linearization(self.path.start) for term in self.problem.terms]
        bars = [term.seeds(own) for term, own in zip(terms, history_bar, strict=True)]
        no_adjoints = np.zeros((disc.layout.n_equations + 1, 0)), np.zeros((0, self.m))
        self._pull_back(terms, bars, *no_adjoints, None)
        particles_bar = self.places_bar
        scalars, matrix_bar = np.zeros((len(names), self.m)), self.probe.pull_back(particles_bar)
        owners = [
            (term.names, own.parameters)
            for term, own in zip(self.problem.terms, self.designs, strict=True)
        ]
        for term, design in zip(self.problem.terms, self.designs, strict=True):
            # B_bar, w_bar, X_bar to the particles, T_bar collected
            matrix_bar = matrix_bar + term.basis.pull_back(design, particles_bar)
        if len(self.prescribed):
            owners.append((self.problem.imposed.names, self.prescribed))
        # theta_bar by the names of the parameters
        for own_names, rows in owners:
            for name, row in zip(own_names, rows, strict=True):
                scalars[names.index(name)] += row
        # T_bar to the particles, once for all tables
        add_matrix_seeds(disc, matrix_bar, particles_bar)
        # measures first
        gradient = np.ascontiguousarray(np.moveaxis(particles_bar, -1, 0))
        return AdjointGradient(gradient, names, scalars)
