"""Results of a load path: converged steps and status."""

from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property

import numpy as np

from seal_mdao.terms.point_assembly import interpolate

NO_STRAIN = 1e-9
"""Strain whose stresses count as zero."""


class Status(Enum):
    """Status at the end of a load path or of one Newton solution."""

    CONVERGED = "converged"
    NOT_CONVERGED = "Newton's method did not converge within the allowed iterations"
    CYCLED = "Newton's iterations return to the same states again and again"
    DIVERGED = "the residual is not a finite number"
    INVERTED = "a quadrature point is inverted (det F <= 0)"
    SINGULAR = "the tangent is singular"
    MOVED_OFF = "the seal moves away without reaching equilibrium"
    UNSTABLE = "the equilibrium is not stable"
    JUMPED = "the seal moved much farther than predicted"
    GAINED = "the equilibrium stores more energy than the loading supplies"


@dataclass(frozen=True, eq=False)
class ConvergedStep:
    """One converged step or substep: data for the next step and for sensitivities.

    Attributes
    ----------
    nominal : int
        Number of the nominal step that this one completes, -1 for a cut step and preliminary
        increments.
    fraction : float
        Path parameter: number of nominal steps completed, fractions for cut steps; not above 0 in
        preliminary increments.
    d : ndarray, shape (n, 2)
        Generalised displacements.
    before : tuple
        History of every term at the beginning of the step.
    responses : tuple of Response
        Response of every term at ``d``.
    iterations : int
        Number of iterations, those of attempts given up included.
    residuals : tuple of float
        Relative residual before each iteration, and at the end.
    factor : object
        Factor of the converged tangent, or None when not kept.
    stable : bool
        Whether the tangent is positive definite; its determinant positive where it is unsymmetric.
    """

    nominal: int
    fraction: float
    d: np.ndarray
    before: tuple
    responses: tuple
    iterations: int
    residuals: tuple
    factor: object = None
    stable: bool = True

    @property
    def after(self) -> tuple:
        """History of every term that passes to the next step."""
        return tuple(response.history for response in self.responses)

    @property
    def touched(self) -> bool:
        """Whether any point of any term is in contact."""
        return any(np.any(response.branch) for response in self.responses)

    def same_branches(self, other: "ConvergedStep") -> bool:
        """Return whether every term is on the same branch (contact state) as at another step."""
        return all(
            np.array_equal(mine.branch, its.branch)
            for mine, its in zip(self.responses, other.responses, strict=True)
        )


@dataclass(frozen=True, eq=False)
class PathResult:
    """Load path, complete or up to the step at which it failed.

    Attributes
    ----------
    problem : PathProblem
        The problem that was solved.
    start : ConvergedStep
        The undeformed state, in which the history begins.
    steps : list of ConvergedStep
        All converged steps in order, those of cut steps included.
    status : Status
        CONVERGED, or why the last attempt failed.
    step_cuts : int
        Number of times a step was halved.
    failure : str
        Empty, or the path parameter and state at which the path ended.
    damped : str
        Empty, or how damped motion ended there; a sentence without full stop.
    critical_points : tuple of CriticalPoint
        Points at which equilibrium lost its stability, in order.
    """

    problem: object = field(repr=False)
    start: ConvergedStep = field(repr=False)
    steps: list = field(repr=False)
    status: Status
    step_cuts: int
    failure: str = ""
    damped: str = ""
    critical_points: tuple = ()

    @property
    def discretization(self):
        return self.problem.discretization

    @property
    def converged(self) -> bool:
        return self.status is Status.CONVERGED

    @cached_property
    def nominal_steps(self) -> list:
        return [step for step in self.steps if step.nominal >= 0]

    @cached_property
    def preliminary(self) -> list:
        """Converged steps of the preliminary increments, the last one where the load steps begin."""
        return [step for step in self.steps if step.fraction <= 0.0]

    @property
    def newton_iterations(self) -> np.ndarray:
        """Iterations of every nominal step, those of its cut parts included, shape (n_steps,)."""
        # cut steps (nominal = -1) count towards the nominal step that completes them
        counts, running = [], 0
        for step in self.steps:
            running += step.iterations
            if step.nominal >= 0:
                counts.append(running)
                running = 0
        return np.array(counts, int)

    def index_of(self, label: str) -> int:
        """Return the index of the term ``label`` among the responses of a step."""
        return self.problem.terms.index(self.problem.term(label))

    def responses(self, label: str) -> list:
        """List the responses of one term at all converged steps, cut ones included."""
        index = self.index_of(label)
        return [step.responses[index] for step in self.steps]

    def at_nominal(self, label: str) -> list:
        """List the responses of one term at the nominal steps."""
        index = self.index_of(label)
        return [step.responses[index] for step in self.nominal_steps]

    def reaction(self, label: str) -> np.ndarray:
        """Sum the forces on a profile or on moved edges at every nominal step, shape (n_steps, 2), N/m.

        As of ``force``.
        """
        return np.array([self.force(label, step) for step in self.nominal_steps]).reshape(-1, 2)

    def force(self, label: str, step: ConvergedStep) -> np.ndarray:
        """Compute the force on a profile or on moved edges at a converged step, shape (2,), N/m.

        That of the points of the term ``label``, and of the edges of that name that move with it.
        """
        problem, total = self.problem, np.zeros(2)
        mask = problem.supports_of(label)
        # moved edges without a profile have no term
        if any(term.label == label for term in problem.terms) or not mask.any():
            # sum of the forces at contact points, then of the reactions of prescribed components
            total += step.responses[self.index_of(label)].total
        return total + self.support_force(mask, step) if mask.any() else total

    def initial_force(self, label: str) -> np.ndarray:
        """Compute the force as of ``force`` where the load steps begin, shape (2,), N/m: zero without
        preliminary increments."""
        return self.force(label, self.preliminary[-1]) if self.preliminary else np.zeros(2)

    def support_force(self, mask: np.ndarray, step: ConvergedStep) -> np.ndarray:
        """Compute the force on the supports at prescribed components, a mask (n, 2), shape (2,), N/m."""
        return np.where(mask, self.problem.support_forces(step), 0.0).sum(axis=0)

    def displacement(self, step: int = -1) -> np.ndarray:
        """Compute physical displacements u(X_J) at all particles of a nominal step, shape (n, 2), mm."""
        return self.displacement_at(self.nominal_steps[step])

    def displacement_at(self, step: ConvergedStep) -> np.ndarray:
        """Compute displacements as of ``displacement`` at a converged step."""
        # u(X_J) = sum_I Phi_I(X_J) d_I
        out = np.empty_like(self.discretization.particles)
        interpolate(self.discretization.everywhere.table, step.d, out)
        return out

    @cached_property
    def largest_displacement(self) -> float:
        """Largest displacement of a particle over all nominal steps, mm."""
        steps = range(len(self.nominal_steps))
        return max((float(np.hypot(*self.displacement(k).T).max()) for k in steps), default=0.0)

    @cached_property
    def least_force(self) -> float:
        """Force that counts as zero, of a shear strain ``NO_STRAIN`` over the section, N/m."""
        # F = gamma G L depth
        disc = self.discretization
        regions = self.problem.term("structure").definition.regions
        shear = max(own.material.shear_modulus for own in regions)
        return NO_STRAIN * shear * float(np.ptp(disc.particles, axis=0).max()) * disc.depth
