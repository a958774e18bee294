"""Residual and tangent of the incremental equation (44) as a sum of terms, and the predictors."""

from math import sqrt

import numpy as np

from seal_mdao.analysis.result import ConvergedStep
from seal_mdao.equilibrium.discretization import Discretization


def _norm(vector) -> float:
    """Euclidean norm; of short vectors ``numpy.linalg.norm`` mostly measures its own arguments."""
    return sqrt(vector.dot(vector))


class PathProblem:
    """Residual and tangent of one discretised body under its terms.

    The buffers are reused between iterations; nothing in them outlives a call. ``factor`` is that of
    the tangent factorised last, or None.

    Parameters
    ----------
    discretization : Discretization
    definitions : sequence of TermDefinition
        Those that the discretisation was made for, in that order.
    imposed : ImposedDisplacements, optional
        Displacements of the fixed components; zero when left out.
    """

    def __init__(self, discretization: Discretization, definitions, imposed=None):
        self.discretization, self.imposed = discretization, imposed
        self.terms = tuple(
            definition.on(discretization, place) for place, definition in enumerate(definitions)
        )
        layout = discretization.layout
        self.forces = np.empty((len(self.terms), layout.force_size))
        self.values, self.factor = np.empty(layout.size), None
        self.responses, self.held = [], 0.0
        # what rounding leaves of a residual: large moduli multiply differences of order one
        self.rounding = 10 * np.finfo(float).eps * sum(term.rounding for term in self.terms)

    def term(self, label: str):
        """The term with that label."""
        for term in self.terms:
            if term.label == label:
                return term
        raise ValueError(f"no term {label!r}; known are {[term.label for term in self.terms]}")

    @property
    def names(self) -> tuple:
        """Scalar parameters of all terms."""
        imposed = () if self.imposed is None else self.imposed.names
        return tuple(
            dict.fromkeys([*(name for term in self.terms for name in term.names), *imposed])
        )

    @property
    def symmetric(self) -> bool:
        """Whether all terms have a potential: the tangent is symmetric then."""
        return all(term.conservative for term in self.terms)

    def potential(self, d, fraction: float, history) -> float:
        """Potential of all terms of a ``symmetric`` problem at displacements ``d``, mJ/m.

        It leaves the forces and the answers of the terms there.
        """
        self.begin()
        self.assemble_forces(d, fraction, history)
        return sum(
            term.potential(d, response)
            for term, response in zip(self.terms, self.responses, strict=True)
        )

    @property
    def remembers(self) -> bool:
        """Whether a step depends on the one before."""
        return any(term.remembers for term in self.terms)

    def no_history(self) -> tuple:
        """History of the undeformed state."""
        return tuple(term.no_history() for term in self.terms)

    # ---- residual and tangent ----

    def begin(self) -> None:
        """Forget what earlier iterations left behind: a new solution begins."""
        for term in self.terms:
            term.begin()

    def begin_mixed(self, step: ConvergedStep, target: float) -> None:
        """Take a converged step as the first linearisation of mixed iterations at ``target``."""
        self.begin()
        for term, response in zip(self.terms, step.responses, strict=True):
            term.begin_mixed(step, response, target)

    def assemble(self, d, fraction: float, history, mixed: bool = False) -> bool:
        """Fill forces and tangent at displacements ``d``, those of a ``mixed`` iteration on demand;
        False where a term has no answer."""
        self.values[:] = 0.0
        answered = self._add_to(self.values, d, fraction, history, mixed)
        if answered:
            self.discretization.layout.condense_tangent(self.values)
        return answered

    def assemble_forces(self, d, fraction: float, history) -> bool:
        """Fill the forces as ``assemble`` does, and leave the tangent as it is."""
        return self._add_to(np.empty(0), d, fraction, history)

    def _add_to(self, values, d, fraction, history, mixed=False) -> bool:
        """Fill the forces and, where ``values`` is not empty, add the tangent to it."""
        disc = self.discretization
        self.forces[:] = 0.0
        raw, responses = disc.transformation.coefficients(d), []
        for term, force, own in zip(self.terms, self.forces, history, strict=True):
            add = term.add_mixed if mixed else term.add
            response = add(d, raw, fraction, own, force, values)
            if response is None:
                return False
            disc.layout.condense_force(force)
            responses.append(response)
        self.responses = responses
        self.held = 0.0 if self.imposed is None else self._held_force(d)
        return True

    def _held_force(self, d) -> float:
        """Norm of the internal forces of all components: what imposed displacements are held with."""
        return float(np.linalg.norm(self.term("structure").forces(d)))

    @property
    def unsettled(self) -> int:
        """Places at which a term has not answered with its own law."""
        return sum(response.unsettled for response in self.responses)

    def factorize(self, check: bool = False):
        """Factor of the assembled tangent; the one before is let go first, to save its memory.

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
        """As ``factorize``, good to the digits that a predictor and quasi-Newton iterations need."""
        self.factor = None
        self.factor = self.discretization.layout.factorize_roughly(self.values)
        return self.factor

    def assemble_at(self, step: ConvergedStep) -> None:
        """Fill forces and tangent at a converged step."""
        self.begin()
        self.assemble(step.d, step.fraction, step.before)

    def factorize_at(self, step: ConvergedStep):
        """Assemble and factorise the tangent at a converged step."""
        self.assemble_at(step)
        return self.factorize()

    def residual(self):
        """Residual vector, its norm relative to the acting forces, and whether it is mere rounding."""
        forces = self.forces[:, : self.discretization.layout.n_equations]
        residual = forces[0].copy()
        for force in forces[1:]:
            residual += force
        size = _norm(residual)
        scale = max(self.held, *(_norm(force) for force in forces))
        return residual, size / scale if scale > 0.0 else 0.0, size <= self.rounding

    # ---- the predictors ----

    def predict(self, step: ConvergedStep, factor, target: float) -> np.ndarray:
        """Euler predictors (1 or 2, n, 2) from a converged step, reusing its factorisation."""
        loads = [np.zeros(self.discretization.layout.force_size)]
        for term, response in zip(self.terms, step.responses, strict=True):
            changes = term.changes(step, response, target)
            if changes:
                pairs = max(len(loads), len(changes))
                loads = [loads[min(i, len(loads) - 1)] + changes[min(i, len(changes) - 1)]
                         for i in range(pairs)]  # fmt: skip
        return np.stack([self._euler(step, factor, target, load) for load in loads])

    def _euler(self, step: ConvergedStep, factor, target: float, load) -> np.ndarray:
        """Displacements after the forces have changed by ``load`` at fixed displacements."""
        layout, d = self.discretization.layout, step.d
        layout.condense_force(load)
        load = load[: layout.n_equations]
        if self.imposed is not None:
            increment = self.imposed.at(target) - self.imposed.at(step.fraction)
            increment = np.where(layout.equations < 0, increment, 0.0)
            load = load + self._held_rate(d, increment)
            d = d + increment
        return d - layout.gather(factor.solve(load))

    def held_work(self, d, fraction: float, target: float) -> float:
        """Work of the forces at ``d`` on imposed displacements from one loading to another, mJ/m."""
        if self.imposed is None:
            return 0.0
        moved = self.imposed.at(target) - self.imposed.at(fraction)
        held = self.discretization.layout.equations < 0
        return float(np.sum((self.term("structure").forces(d) * moved)[held]))

    def _held_rate(self, d, increment, share=1e-6) -> np.ndarray:
        """Change of the internal force with imposed displacements; only the predictor uses it."""
        structure, layout = self.term("structure"), self.discretization.layout
        change = structure.forces(d + share * increment) - structure.forces(d)
        return layout.reduce(change / share)

    def closest(self, guesses, target: float, history) -> np.ndarray:
        """Those of the displacements that leave the smallest residual."""
        if len(guesses) == 1:
            return guesses[0]
        sizes = []
        for d in guesses:
            self.begin()
            answered = self.assemble_forces(d, target, history)
            sizes.append(self.residual()[1] if answered else np.inf)
        return guesses[int(np.argmin(sizes))]
