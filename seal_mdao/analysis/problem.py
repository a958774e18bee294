"""The problem of a load path: a sum of terms on one discretised body, Eq. (43)."""

import numpy as np

from seal_mdao.analysis.assembly import Assembly, relative_residual
from seal_mdao.analysis.path_result import ConvergedStep
from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.terms.point_rates import add_transposed

_NO_TANGENT = np.empty(0)


class PathProblem:
    """One discretised body with its terms; ``evaluate`` returns residual and tangent.

    Parameters
    ----------
    discretization : Discretization
    definitions : sequence of TermDefinition
        Terms that the discretisation was made for, in that order.
    imposed : ImposedDisplacements or ImposedMotions, optional
        Displacements of the fixed components; zero when left out.
    """

    def __init__(self, discretization: Discretization, definitions, imposed=None):
        self.discretization = discretization
        self.imposed = None if imposed is None else imposed.on(discretization.particles)
        self.terms = tuple(
            definition.on(discretization, index) for index, definition in enumerate(definitions)
        )
        # rounding error of a residual: 10 eps times the forces (N/m) that strains, and penetrations
        # over the size of the body, of order one would give, and an increase with displacements
        unit = 10 * np.finfo(float).eps
        self.rounding = unit * sum(term.rounding for term in self.terms)
        self._by_displacement = unit * sum(term.rounding_by_displacement for term in self.terms)

    def term(self, label: str):
        """Return the term with that label."""
        for term in self.terms:
            if term.label == label:
                return term
        raise ValueError(
            f"the analysis has no load or contact (term) with the label {label!r}; the labels are "
            f"{[term.label for term in self.terms]}"
        )

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

    @property
    def history_dependent(self) -> bool:
        """Whether a step depends on the previous one."""
        return any(term.history_dependent for term in self.terms)

    @property
    def begins_at(self) -> float:
        """Path parameter of the undeformed state: 0, or minus the number of preliminary increments."""
        return min(term.begins_at for term in self.terms)

    def no_history(self) -> tuple:
        """Return the history of the undeformed state, one entry a term."""
        return tuple(term.no_history() for term in self.terms)

    # ---- residual and tangent ----

    def evaluate(
        self, d, fraction: float, history, iteration=None, *, tangent=True, mixed=False
    ) -> Assembly | None:
        """Evaluate residual and tangent at displacements ``d``: a function of the arguments alone.

        Parameters
        ----------
        d : ndarray, shape (n, 2)
        fraction : float
            Path parameter, in nominal load steps.
        history : tuple
            What every term carries from the converged step before.
        iteration : tuple, optional
            ``Assembly.iteration`` of the iteration before, or ``begin_mixed``; None where a new solution
            begins.
        tangent : bool
            Whether the tangent is wanted, and not the forces alone.
        mixed : bool
            Whether the tangent is that of ``mixed`` iterations.

        Returns
        -------
        Assembly or None
            None where a term cannot be evaluated, such as with det F <= 0.
        """
        layout = self.discretization.layout
        values = np.zeros(layout.size) if tangent else _NO_TANGENT
        forces, responses = np.zeros((len(self.terms), layout.force_size)), []
        self._begin(iteration)
        # raw coefficients c = N d, with which the raw shape functions give u(X) = sum_I Phi_I(X) c_I
        raw = self.discretization.transformation.coefficients(d)
        for term, force, own in zip(self.terms, forces, history, strict=True):
            add = term.add_mixed if mixed else term.add
            response = add(d, raw, fraction, own, force, values)
            if response is None:
                return None
            # f~ = N^T f
            layout.condense_force(force)
            responses.append(response.copied())
        if tangent:
            # K~ = N^T K N, Eq. (44)
            layout.condense_tangent(values)
        # with prescribed displacements |r| is relative to the forces on all components, too
        prescribed = 0.0
        if self.imposed is not None:
            prescribed = float(np.linalg.norm(self.forces_on_all(d, fraction, history)))
        residual, size, relative = relative_residual(forces[:, : layout.n_equations], prescribed)
        noise = self.rounding + self._by_displacement * np.abs(d).max(initial=0.0)
        return Assembly(
            self, d, forces, tuple(responses), values, tuple(term.iteration for term in self.terms),
            residual, relative, size <= self.rounding, bool(size <= noise),
        )  # fmt: skip

    def _begin(self, iteration) -> None:
        """Give every term the state of the iterations with which the next one begins."""
        for term, own in zip(self.terms, iteration or [None] * len(self.terms), strict=True):
            term.begin(own)

    def through_slip(self, cycle: tuple) -> tuple | None:
        """Return the state that continues the iterations of one ``cycle``, a tuple of
        ``Assembly.iteration``, with contact points that pass through slip between open and stick; None
        where no point passed over slip."""
        found = [
            term.through_slip(list(own))
            for term, own in zip(self.terms, zip(*cycle, strict=True), strict=True)
        ]
        if all(own is None for own in found):
            return None
        both = zip(found, cycle[-1], strict=True)
        return tuple(last if own is None else own for own, last in both)

    def begin_mixed(self, step: ConvergedStep, target: float) -> tuple:
        """Return the state of mixed iterations at ``target`` whose first linearisation is ``step``."""
        self._begin(None)
        for term, response in zip(self.terms, step.responses, strict=True):
            term.begin_mixed(step, response, target)
        return tuple(term.iteration for term in self.terms)

    def begin_near(self, d, target: float, known: tuple) -> tuple:
        """Return the state of mixed iterations that begin at displacements ``d`` near a solution, with
        what is ``known`` of it, one entry a term."""
        for term, own in zip(self.terms, known, strict=True):
            term.begin_near(d, target, own)
        return tuple(term.iteration for term in self.terms)

    @property
    def touches_itself(self) -> bool:
        """Whether walls of the body may touch each other."""
        return any(term.touches_itself for term in self.terms)

    def linear_contacts(self, iteration: tuple, history: tuple) -> list:
        """List the contacts whose law a linear step has to satisfy (``analysis.linear_contact``)."""
        found = [
            term.linear_contact(own, before)
            for term, own, before in zip(self.terms, iteration, history, strict=True)
        ]
        return [contact for contact in found if contact is not None]

    def assemble_at(self, step: ConvergedStep) -> Assembly:
        """Evaluate residual and tangent at a converged step."""
        return self.evaluate(step.d, step.fraction, step.before)

    def factorize_at(self, step: ConvergedStep):
        """Assemble and factorise the tangent at a converged step."""
        return self.assemble_at(step).factorize()

    # ---- prescribed displacements ----

    def forces_on_all(self, d, fraction: float, history: tuple) -> np.ndarray:
        """Sum the forces of the terms that act on prescribed components, at all components, (n, 2)."""
        both = zip(self.terms, history, strict=True)
        found = (term.forces(d, fraction, own) for term, own in both)
        return sum(forces for forces in found if forces is not None)

    def support_forces(self, step: ConvergedStep) -> np.ndarray:
        """Compute the forces of the body on its supports at a converged step, shape (n, 2), N/m.

        Zero at free components.
        """
        every = self.discretization.layout.every_component.equations
        # R = sum of the forces f~ of all terms at prescribed components; the body exerts -R
        total = np.zeros((every.size + 1, 1))
        total[:-1, 0] = self.forces_on_all(step.d, step.fraction, step.before).ravel()
        tables = self.discretization.tables
        for table, response in zip(tables, step.responses, strict=True):
            if table is not None:
                points, force = np.arange(table.table.n_groups), response.force[:, :, None]
                add_transposed(table.table, points, every, np.ascontiguousarray(force), total)
        fixed = self.discretization.layout.equations < 0
        return np.where(fixed, -total[:-1].reshape(every.shape), 0.0)

    def supports_of(self, label: str) -> np.ndarray:
        """Return the components that edges of that name prescribe, a mask (n, 2)."""
        if self.imposed is None or label not in self.imposed.labels:
            return np.zeros(self.discretization.particles.shape, bool)
        return self.imposed.prescribed(label)

    def prescribed_increment(self, fraction: float, target: float) -> np.ndarray:
        """Return the increment of the prescribed displacements (n, 2), zero at free components."""
        increment = self.imposed.at(target) - self.imposed.at(fraction)
        return np.where(self.discretization.layout.equations < 0, increment, 0.0)

    def prescribed_work(self, d, last: ConvergedStep, target: float) -> float:
        """Compute the work of the forces at ``d``, with the loading of the step ``last``, on prescribed
        displacements between this step and ``target``, mJ/m."""
        if self.imposed is None:
            return 0.0
        # W = f_p . (u_p(target) - u_p(fraction)), sum over the prescribed components p
        forces = self.forces_on_all(d, last.fraction, last.before)
        return float(np.sum(forces * self.prescribed_increment(last.fraction, target)))
