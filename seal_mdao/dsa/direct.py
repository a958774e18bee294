"""Direct differentiation, Eq. (70), over the complete load path.

    K_n d'_n = -f'_n,    f'_n = sum over terms of B^T L_s [B' d, h', w', theta', X'] + B'^T s

for n = 1..N, with h' = h'_{n-1} of the histories of the terms; K_n is the tangent of the converged step,
its factor the one that the predictor used. Only the steps at which something is measured are solved for
all of d'. Of the others no more is solved for than what they pass on, functions of d with derivatives
B^T G that the next step uses:

    K_n^T Lambda_n = B^T G,    (B^T G)^T d'_n = -Lambda_n^T f'_n
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.dsa.factors import blocks, converged_factor, solve_transposed
from seal_mdao.dsa.parameters import ParameterRates
from seal_mdao.dsa.shape_rates import discretization_rates
from seal_mdao.equilibrium.threads import one_blas_thread


@dataclass(frozen=True, eq=False)
class StepRates:
    """Material derivatives at one converged step for P parameters.

    Attributes
    ----------
    solution : ndarray, shape (n_equations, P)
        d'.
    terms : tuple
        Rates of what every term gives, (s', h+', o').
    history : tuple
        Rates of the history that every term passes on.
    """

    solution: np.ndarray
    terms: tuple
    history: tuple


class DirectSweep:
    """Forward sweep through a converged path for all parameters at once.

    Parameters
    ----------
    path : PathResult
    rates : ParameterRates
    """

    def __init__(self, path: PathResult, rates: ParameterRates):
        self.path, self.problem, self.rates = path, path.problem, rates
        self.shape = discretization_rates(path.discretization, rates.velocity)
        self.designs = [term.basis.rates(self.shape, rates) for term in self.problem.terms]

    def start(self) -> tuple:
        """Rates of the histories in the undeformed state, which moves with the design."""
        # h'_0 of the undeformed body: X' alone
        none = tuple(term.no_rates(self.rates.count) for term in self.problem.terms)
        unused = np.zeros((self.path.discretization.layout.n_equations + 1, self.rates.count))
        terms = [term.linearization(self.path.start) for term in self.problem.terms]
        return self._carried(terms, self._at_fixed_displacements(terms, none, None, unused))

    def prescribed(self, step) -> np.ndarray | None:
        """d' of the imposed displacements, (2 n, P); None where they do not vary."""
        imposed = self.problem.imposed
        if imposed is None or not imposed.varies:
            return None
        # d' = (dd/dp) p' + (dd/dX) V of imposed displacements
        by_place = imposed.by_particles(step.fraction)
        moved = np.einsum("nij,pnj->nip", by_place, self.rates.velocity)
        by_names = imposed.linearization(step.fraction) @ self.rates.of(imposed.names)
        # zero at free components, whatever displacements are given there
        fixed = (self.path.discretization.layout.equations < 0).reshape(-1, 1)
        return np.where(fixed, by_names + moved.reshape(by_names.shape), 0.0)

    def explicit_loads(self, steps) -> np.ndarray:
        """f' of a block of steps that no history is in, (K, n_equations + 1, P)."""
        size = self.path.discretization.layout.n_equations + 1
        loads = np.zeros((len(steps), size, self.rates.count))
        for term, design in zip(self.problem.terms, self.designs, strict=True):
            block = term.linearization_of_block(steps)
            if block is not None:
                block.add_rates(design, loads)
        return loads

    def _at_fixed_displacements(self, terms, history, prescribed, load) -> list:
        """Rates (s', h+', o') of every term at fixed d; f' is added to ``load``."""
        return [
            term.rates(design, own, prescribed, load)
            for term, design, own in zip(terms, self.designs, history, strict=True)
        ]

    def _solved(self, step, terms, found, load) -> tuple:
        """d' of Eq. (70), and the rates of every term with it."""
        # (a + b - l)' = a* + a'_V + b* + b'_V - l'_V = 0   Eqs. (46), (47), (67), b_N' by (58), b_T' by
        # (62) or (65): K_n d'_n is a* + b* at z'   Eq. (68), f'_n the rest; K_n d'_n = -f'_n   Eq. (70)
        solution = -converged_factor(self.problem, step).solve(load[:-1])
        # x' = X' + B' d + B d', then L again
        found = [term.solved(own, solution) for term, own in zip(terms, found, strict=True)]
        return solution, found

    def _carried(self, terms, found) -> tuple:
        return tuple(term.history_rates(own) for term, own in zip(terms, found, strict=True))

    def step(self, step, history, load) -> StepRates:
        """Solve (70) at one converged step; ``load`` is its row of ``explicit_loads``, added to."""
        # L of every term at the step
        terms = [term.linearization(step) for term in self.problem.terms]
        # f' and (s', h+', o') at fixed d
        found = self._at_fixed_displacements(terms, history, self.prescribed(step), load)
        solution, found = self._solved(step, terms, found, load)
        return StepRates(solution, tuple(found), self._carried(terms, found))

    def pass_by(self, step, following, history, load) -> tuple:
        """Rates of the histories that one step passes on; right where ``following`` uses them."""
        if any(term.passes_all for term in self.problem.terms):
            return self.step(step, history, load).history
        terms = [term.linearization(step, following, False) for term in self.problem.terms]
        found = self._at_fixed_displacements(terms, history, self.prescribed(step), load)
        passed = [term.passed_on(following) for term in terms]
        # more functions than parameters: all of d' costs less
        if sum(own.count for own in passed if own is not None) > self.rates.count:
            return self._carried(terms, self._solved(step, terms, found, load)[1])
        for index, (term, own) in enumerate(zip(terms, passed, strict=True)):
            if own is not None:
                # Lambda = K^-T B^T G,  z = G^T B d' = -Lambda^T f'
                adjoints = solve_transposed(self.problem, step, term.loads_of(own))
                found[index] = term.passed(found[index], own, -adjoints.T @ load)
        return self._carried(terms, found)

    @one_blas_thread
    def run(self, measured=None) -> dict:
        """Sweep the path; return ``StepRates`` by index in ``path.steps``.

        Parameters
        ----------
        measured : collection of int, optional
            Indices of the steps to return; the last one when left out.
        """
        return dict(self.each({len(self.path.steps) - 1} if measured is None else measured))

    def each(self, measured):
        """Sweep the path; yield index and ``StepRates`` of each of the ``measured`` steps, in order.

        The rates of one step at a time are in memory.
        """
        every, measured = self.path.steps, set(measured)
        # without history the steps do not depend on each other
        last = max(measured, default=-1)
        indices = range(last + 1) if self.problem.history_dependent else sorted(measured)
        history = self.start()
        size = self.path.discretization.layout.n_equations
        # forces without history for a block of steps at once, then step by step
        for block in blocks(indices, size, self.rates.count):
            loads = self.explicit_loads([every[index] for index in block])
            for index, load in zip(block, loads, strict=True):
                if index in measured:
                    found = self.step(every[index], history, load)
                    history = found.history
                    yield index, found
                else:
                    history = self.pass_by(every[index], every[index + 1], history, load)
