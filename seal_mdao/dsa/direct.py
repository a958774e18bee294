"""Direct differentiation, Eq. (70), through the whole load path.

    K_n d'_n = -(dR_n/dX) V - (dR_n/dh_{n-1}) h'_{n-1},    n = 1..N

with h the histories of the terms. K_n is the tangent of the converged step, its factor the one that
the predictor used. Only the steps at which something is measured are solved for all of d'; of the
others no more than what they hand on, see ``seal_mdao.terms.handed_on``.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.result import PathResult
from seal_mdao.dsa.factors import converged_factor, solve_transposed
from seal_mdao.dsa.parameters import ParameterRates
from seal_mdao.dsa.shape_rates import discretization_rates
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.terms.blocks import blocks


@dataclass(frozen=True, eq=False)
class StepRates:
    """Material derivatives at one converged step for P parameters.

    Attributes
    ----------
    solution : ndarray, shape (n_equations, P)
        d'.
    outputs : tuple
        Rates of what measures may take from every term.
    history : tuple
        Rates of the history that every term hands on.
    """

    solution: np.ndarray
    outputs: tuple
    history: tuple


def imposed_rates(imposed, fraction: float, rates: ParameterRates) -> np.ndarray | None:
    """Rates of the imposed displacements (n, 2, P); None where no parameter moves them."""
    if imposed is None or not imposed.names:
        return None
    return np.einsum("sni,sp->nip", imposed.rates_at(fraction), rates.of(imposed.names))


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
        self.forwards = [term.forward(self.shape, rates) for term in self.problem.terms]

    def start(self) -> tuple:
        """Rates of the histories in the undeformed state, which moves with the design."""
        return tuple(forward.start(self.path.start) for forward in self.forwards)

    def explicit_loads(self, steps) -> np.ndarray:
        """Fictitious loads of a block of steps without those of the history, (K, n_equations + 1, P)."""
        size = self.path.discretization.layout.n_equations + 1
        loads = np.zeros((len(steps), size, self.rates.count))
        for forward in self.forwards:
            forward.add_explicit(steps, loads)
        return loads

    def _linearized(self, step, following, history, load) -> list:
        """Complete the fictitious load of (70); what every term keeps for afterwards."""
        held = imposed_rates(self.problem.imposed, step.fraction, self.rates)
        return [
            forward.linearize(step, following, rates, held, load)
            for forward, rates in zip(self.forwards, history, strict=True)
        ]

    def _solve(self, step, kept, load) -> np.ndarray:
        """All of d', which every term takes."""
        solution = -converged_factor(self.problem, step).solve(load[:-1])
        for forward, own in zip(self.forwards, kept, strict=True):
            forward.follow_solution(own, solution)
        return solution

    def _history(self, kept) -> tuple:
        return tuple(forward.history(own) for forward, own in zip(self.forwards, kept, strict=True))

    def step(self, step, history, load) -> StepRates:
        """Solve (70) at one converged step; ``load`` is its row of ``explicit_loads``, added to."""
        kept = self._linearized(step, None, history, load)
        solution = self._solve(step, kept, load)
        outputs = tuple(
            forward.outputs(own) for forward, own in zip(self.forwards, kept, strict=True)
        )
        return StepRates(solution, outputs, self._history(kept))

    def pass_by(self, step, following, history, load) -> tuple:
        """Rates of the histories that one step hands on; right where ``following`` uses them."""
        kept = self._linearized(step, following, history, load)
        columns = [
            forward.handed_on(own, following)
            for forward, own in zip(self.forwards, kept, strict=True)
        ]
        if sum(own.shape[1] for own in columns) > self.rates.count:
            self._solve(step, kept, load)
            return self._history(kept)
        for forward, own, column in zip(self.forwards, kept, columns, strict=True):
            if column.shape[1]:
                forward.follow(own, -solve_transposed(self.problem, step, column).T @ load)
        return self._history(kept)

    @one_blas_thread
    def run(self, measured=None) -> dict:
        """Sweep the path; return ``StepRates`` by place in ``path.steps``.

        Parameters
        ----------
        measured : collection of int, optional
            Places of the steps to return; the last one when left out.
        """
        every = self.path.steps
        measured = {len(every) - 1} if measured is None else set(measured)
        last = max(measured, default=-1)
        places = range(last + 1) if self.problem.remembers else sorted(measured)
        history, wanted = self.start(), {}
        size = self.path.discretization.layout.n_equations
        for block in blocks(places, size, self.rates.count):
            loads = self.explicit_loads([every[place] for place in block])
            for place, load in zip(block, loads, strict=True):
                if place in measured:
                    wanted[place] = self.step(every[place], history, load)
                    history = wanted[place].history
                else:
                    history = self.pass_by(every[place], every[place + 1], history, load)
        return wanted
