"""Residual and tangent of the incremental equation (44) as a sum of terms, and the predictors."""

from math import sqrt

import numpy as np

from seal_mdao.analysis.result import ConvergedStep
from seal_mdao.equilibrium.discretization import Discretization


def _norm(vector) -> float:
    """Compute the Euclidean norm with less overhead for short vectors than ``numpy.linalg.norm``."""
    return sqrt(vector.dot(vector))


class PathProblem:
    """Residual and tangent of one discretised body under its terms.

    The buffers are reused between iterations; their content is valid until the next assembly.
    ``factor`` is that of the tangent factorised last, or None.

    Parameters
    ----------
    discretization : Discretization
    definitions : sequence of TermDefinition
        Terms that the discretisation was made for, in that order.
    imposed : ImposedDisplacements, optional
        Displacements of the fixed components; zero when left out.
    """

    def __init__(self, discretization: Discretization, definitions, imposed=None):
        self.discretization, self.imposed = discretization, imposed
        self.terms = tuple(
            definition.on(discretization, index) for index, definition in enumerate(definitions)
        )
        layout = discretization.layout
        self.forces = np.empty((len(self.terms), layout.force_size))
        self.values, self.factor = np.empty(layout.size), None
        self.responses, self.held = [], 0.0
        # rounding error of a residual: 10 eps times the forces (N/m) that strains, and penetrations
        # over the size of the body, of order one would give
        self.rounding = 10 * np.finfo(float).eps * sum(term.rounding for term in self.terms)

    def term(self, label: str):
        """Return the term with that label."""
        for term in self.terms:
            if term.label == label:
                return term
        raise ValueError(f"no term {label!r}; known are {[term.label for term in self.terms]}")

    @property
    def names(self) -> tuple:
        """Names of the scalar parameters of all terms, each once."""
        imposed = () if self.imposed is None else self.imposed.names
        return tuple(
            dict.fromkeys([*(name for term in self.terms for name in term.names), *imposed])
        )

    @property
    def symmetric(self) -> bool:
        """Whether all terms have a potential: the tangent is symmetric then."""
        return all(term.conservative for term in self.terms)

    def potential(self, d, fraction: float, history) -> float:
        """Evaluate the potential of all terms of a ``symmetric`` problem at ``d``, mJ/m.

        Forces and responses of the terms at ``d`` remain in the buffers.
        """
        self.begin()
        self.assemble_forces(d, fraction, history)
        return sum(
            term.potential(d, response)
            for term, response in zip(self.terms, self.responses, strict=True)
        )

    @property
    def history_dependent(self) -> bool:
        """Whether the problem is history dependent: a step depends on the one before."""
        return any(term.history_dependent for term in self.terms)

    def no_history(self) -> tuple:
        """Return the history of the undeformed state, one entry a term."""
        return tuple(term.no_history() for term in self.terms)

    # ---- residual and tangent ----

    def begin(self) -> None:
        """Reset the state of the iterations of all terms: a new solution begins."""
        for term in self.terms:
            term.begin()

    def begin_mixed(self, step: ConvergedStep, target: float) -> None:
        """Take a converged step as the first linearisation of mixed iterations at ``target``."""
        self.begin()
        for term, response in zip(self.terms, step.responses, strict=True):
            term.begin_mixed(step, response, target)

    def assemble(self, d, fraction: float, history, mixed: bool = False) -> bool:
        """Assemble forces and tangent at displacements ``d``, those of ``mixed`` iterations if wanted.

        False where a term cannot be evaluated, such as with det F <= 0.
        """
        self.values[:] = 0.0
        evaluated = self._add_to(self.values, d, fraction, history, mixed)
        if evaluated:
            # K~ = N^T K N; the forces are transformed term by term
            self.discretization.layout.condense_tangent(self.values)
        return evaluated

    def assemble_forces(self, d, fraction: float, history) -> bool:
        """Assemble the forces as ``assemble`` does, and leave the tangent unchanged."""
        return self._add_to(np.empty(0), d, fraction, history)

    def _add_to(self, values, d, fraction, history, mixed=False) -> bool:
        """Assemble the forces and, where ``values`` is not empty, add the tangent to it."""
        disc = self.discretization
        self.forces[:] = 0.0
        # raw coefficients c = N d, with which the raw shape functions give u(X) = sum_I Phi_I(X) c_I
        raw, responses = disc.transformation.coefficients(d), []
        for term, force, own in zip(self.terms, self.forces, history, strict=True):
            add = term.add_mixed if mixed else term.add
            response = add(d, raw, fraction, own, force, values)
            if response is None:
                return False
            # f~ = N^T f
            disc.layout.condense_force(force)
            responses.append(response)
        self.responses = responses
        self.held = 0.0 if self.imposed is None else self._force_norm(d)
        return True

    def _force_norm(self, d) -> float:
        """Compute the norm of the internal forces of all components, prescribed ones included."""
        return float(np.linalg.norm(self.term("structure").forces(d)))

    @property
    def unsettled(self) -> int:
        """Number of points not converged in contact state."""
        return sum(response.unsettled for response in self.responses)

    def factorize(self, check: bool = False):
        """Factorise the assembled tangent; the factor before is freed first, to save its memory.

        With ``check`` the factor of a symmetric tangent knows whether it is definite.

        Raises
        ------
        LinAlgError
            The tangent is singular.
        """
        self.factor = None
        self.factor = self.discretization.layout.factorize(self.values, check and self.symmetric)
        return self.factor

    def factorize_roughly(self):
        """Factorise in the precision that a predictor and quasi-Newton iterations need."""
        self.factor = None
        self.factor = self.discretization.layout.factorize_roughly(self.values)
        return self.factor

    def assemble_at(self, step: ConvergedStep) -> None:
        """Assemble forces and tangent at a converged step."""
        self.begin()
        self.assemble(step.d, step.fraction, step.before)

    def factorize_at(self, step: ConvergedStep):
        """Assemble and factorise the tangent at a converged step."""
        self.assemble_at(step)
        return self.factorize()

    def residual(self):
        """Compute the residual, its norm relative to the forces, and whether it is a rounding error."""
        forces = self.forces[:, : self.discretization.layout.n_equations]
        # r = sum of the terms' forces; |r| relative to the largest of them, and with prescribed
        # displacements to the internal forces of all components
        residual = forces[0].copy()
        for force in forces[1:]:
            residual += force
        size = _norm(residual)
        scale = max(self.held, *(_norm(force) for force in forces))
        return residual, size / scale if scale > 0.0 else 0.0, size <= self.rounding

    # ---- the predictors ----

    def predict(self, step: ConvergedStep, factor, target: float) -> np.ndarray:
        """Compute Euler predictors (1 or 2, n, 2) from a converged step, reusing its factorisation."""
        # each term gives the change of its force with the loading at fixed d: none, one, or two
        # estimates (slip continues, or stops); combine all first ones, and all second ones
        loads = [np.zeros(self.discretization.layout.force_size)]
        for term, response in zip(self.terms, step.responses, strict=True):
            changes = term.changes(step, response, target)
            if changes:
                pairs = max(len(loads), len(changes))
                loads = [loads[min(i, len(loads) - 1)] + changes[min(i, len(changes) - 1)]
                         for i in range(pairs)]  # fmt: skip
        return np.stack([self._euler(step, factor, target, load) for load in loads])

    def _euler(self, step: ConvergedStep, factor, target: float, load) -> np.ndarray:
        """Compute d_n - K^-1 load, with ``load`` the change of the forces at fixed displacements."""
        layout, d = self.discretization.layout, step.d
        layout.condense_force(load)
        load = load[: layout.n_equations]
        if self.imposed is not None:
            # prescribed increment du_p: its forces K_fp du_p on the free components are part of the load
            increment = self.imposed.at(target) - self.imposed.at(step.fraction)
            increment = np.where(layout.equations < 0, increment, 0.0)
            load = load + self._prescribed_rate(d, increment)
            d = d + increment
        return d - layout.gather(factor.solve(load))

    def held_work(self, d, fraction: float, target: float) -> float:
        """Compute the work of the forces at ``d`` on prescribed displacements, mJ/m.

        Between the path parameters ``fraction`` and ``target``.
        """
        if self.imposed is None:
            return 0.0
        # W = f_p . (u_p(target) - u_p(fraction)), sum over the prescribed components p
        increment = self.imposed.at(target) - self.imposed.at(fraction)
        prescribed = self.discretization.layout.equations < 0
        return float(np.sum((self.term("structure").forces(d) * increment)[prescribed]))

    def _prescribed_rate(self, d, increment, step=1e-6) -> np.ndarray:
        """Compute the change K_fp du_p of the internal force with prescribed displacements.

        By a forward difference, which suffices for the predictor.
        """
        structure, layout = self.term("structure"), self.discretization.layout
        change = structure.forces(d + step * increment) - structure.forces(d)
        return layout.reduce(change / step)

    def closest(self, guesses, target: float, history) -> np.ndarray:
        """Select the displacements with the smallest relative residual."""
        if len(guesses) == 1:
            return guesses[0]
        sizes = []
        for d in guesses:
            self.begin()
            evaluated = self.assemble_forces(d, target, history)
            sizes.append(self.residual()[1] if evaluated else np.inf)
        return guesses[int(np.argmin(sizes))]
