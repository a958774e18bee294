"""Direct differentiation, Eq. (70), through the whole load path.

    K_n d'_n = -(dR_n/dX) V - (dR_n/dh_{n-1}) h'_{n-1},    n = 1..N

with h the contact history (xi, |t|, elastic slip). K_n is the tangent of the converged step, its
factor the one that the predictor used. Only the steps at which something is measured are solved for
all of d'; of the others no more than what they hand on, see ``handed_on``.
"""

from dataclasses import dataclass

import numpy as np

from seal_mdao.analysis.internal_force import assemble_internal
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import PathResult
from seal_mdao.analysis.threads import one_blas_thread
from seal_mdao.contact.friction import CARRIED, FORCE_X, GAP, LENGTH, RADIUS, XI, XI_0, X
from seal_mdao.dsa.blocks import blocks
from seal_mdao.dsa.handed_on import handed_on, handed_on_adjoints, sticking
from seal_mdao.dsa.internal_rates import add_internal_rates
from seal_mdao.dsa.linearization import (
    contact_input_rates,
    converged_factor,
    discretization_rates,
    local_contact,
    profile_share,
)
from seal_mdao.dsa.parameters import ParameterRates
from seal_mdao.dsa.point_rates import (
    add_force_rates,
    add_solution_rates,
    displacement_rates,
    points_velocity,
)


@dataclass(frozen=True, eq=False)
class StepRates:
    """Material derivatives at one converged step for P parameters.

    Attributes
    ----------
    solution : ndarray, shape (n_equations, P)
        d'.
    gap : ndarray, shape (k, P)
        g_n', Eq. (55).
    force : ndarray, shape (k, 2, P)
        Rates of the contact forces.
    history : ndarray, shape (k, 3, P)
        xi', |t|' and elastic slip rate, carried to the next step.
    """

    solution: np.ndarray
    gap: np.ndarray
    force: np.ndarray
    history: np.ndarray

    @property
    def reaction(self) -> np.ndarray:
        """Rate of the force on the profile, shape (2, P)."""
        return self.force.sum(axis=0)


def constants_load(problem: PathProblem, d, constant_rates) -> np.ndarray:
    """df/d(C10, C01, K) times their rates, (n_equations + 1, P); the force is linear in them."""
    disc = problem.discretization
    unit_forces = np.zeros((3, disc.layout.n_equations + 1))
    for unit, force in zip(np.eye(3), unit_forces, strict=True):
        assemble_internal(
            disc.cells.table, disc.weights, tuple(unit), d, disc.layout.force_scatter, force,
            np.empty(0),
        )  # fmt: skip
    return unit_forces.T @ constant_rates.T


class DirectSweep:
    """Forward sweep through a converged path for all parameters at once.

    Parameters
    ----------
    path : PathResult
    problem : PathProblem
        The problem that the path solved.
    rates : ParameterRates
    """

    def __init__(self, path: PathResult, problem: PathProblem, rates: ParameterRates):
        self.path, self.problem, self.rates = path, problem, rates
        self.disc = path.discretization
        self.shape = discretization_rates(self.disc, rates.velocity)
        self.contact_velocity = points_velocity(rates.velocity, self.disc.body.contact)
        self.n_steps = round(path.steps[-1].fraction)
        k = len(self.disc.body.contact)
        self.every = np.arange(k)
        self.inputs = np.zeros((k, 10, rates.count))
        self.inputs[:, LENGTH] = self.shape.length
        self.inputs[:, RADIUS:] = contact_input_rates(rates, k)

    def start(self) -> np.ndarray:
        """Rates of the history in the undeformed state, which moves with the design, (k, 3, P)."""
        inputs = self.inputs
        inputs[:, X:XI_0] = self.contact_velocity
        inputs[:, XI_0:LENGTH] = 0.0
        local = local_contact(self.problem, self.path.start, self.every)
        return local[:, XI : CARRIED + 1] @ inputs

    def explicit_loads(self, steps) -> np.ndarray:
        """Structural fictitious loads of a block of steps, shape (K, n_equations + 1, P)."""
        disc, problem = self.disc, self.problem
        loads = np.zeros((len(steps), disc.layout.n_equations + 1, self.rates.count))
        add_internal_rates(
            disc.cells.table, disc.weights, self.shape.cells, self.shape.weights,
            problem.constants, np.array([step.d for step in steps]), disc.layout.equations, loads,
        )  # fmt: skip
        if self.rates.constants.any():
            for step, load in zip(steps, loads, strict=True):
                load += constants_load(problem, step.d, self.rates.constants)
        return loads

    def _load(self, step, history_rates, load) -> np.ndarray:
        """Complete the fictitious load ``load`` of (70), and return the local derivatives.

        ``inputs`` hold the explicit rates of the contact points' inputs then.
        """
        table, inputs = self.disc.contact.table, self.inputs
        local = local_contact(self.problem, step, self.every)
        explicit = self.contact_velocity.copy()
        displacement_rates(table, self.shape.contact, step.d, explicit)
        explicit -= profile_share(step, self.n_steps) * self.rates.motion.T
        inputs[:, X:XI_0] = explicit
        inputs[:, XI_0:LENGTH] = history_rates
        force_rate = local[:, FORCE_X:XI] @ inputs
        add_force_rates(
            table, self.shape.contact, step.force, force_rate, step.after.state,
            self.disc.layout.equations, load,
        )  # fmt: skip
        return local

    def step(self, step, history_rates, load) -> StepRates:
        """Solve (70) at one converged step; ``load`` is its row of ``explicit_loads``, added to."""
        local = self._load(step, history_rates, load)
        solution = self._solve(step, load)
        out = local @ self.inputs
        history = out[:, XI : CARRIED + 1].copy()
        return StepRates(solution, out[:, GAP].copy(), out[:, FORCE_X:XI].copy(), history)

    def _solve(self, step, load) -> np.ndarray:
        """All of d', also added to the contact points' displacements."""
        solution = -converged_factor(self.problem, step).solve(load[:-1])
        add_solution_rates(
            self.disc.contact.table, self.disc.layout.equations, solution, self.inputs[:, X:XI_0]
        )
        return solution

    def pass_by(self, step, following, history_rates, load) -> np.ndarray:
        """Rates (k, 3, P) of the history that one step hands on; right where ``following`` uses them."""
        local = self._load(step, history_rates, load)
        used = sticking(following)
        handed = handed_on(used, local[used])
        if handed.points.size > self.rates.count:
            self._solve(step, load)
        else:
            moved = -handed_on_adjoints(self.problem, step, handed).T @ load
            for i, direction, rate in zip(*handed, moved, strict=True):
                self.inputs[i, X:XI_0] += np.outer(direction, rate)
        return local[:, XI : CARRIED + 1] @ self.inputs

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
        places = range(max(measured) + 1)
        if self.problem.law.friction == 0.0:
            places = sorted(measured)
        history, wanted = self.start(), {}
        for block in blocks(places, self.disc.layout.n_equations, self.rates.count):
            loads = self.explicit_loads([every[place] for place in block])
            for place, load in zip(block, loads, strict=True):
                if place in measured:
                    wanted[place] = self.step(every[place], history, load)
                    history = wanted[place].history
                else:
                    history = self.pass_by(every[place], every[place + 1], history, load)
        return wanted
