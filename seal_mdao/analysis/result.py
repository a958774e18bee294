"""What a load path leaves behind."""

from dataclasses import dataclass, field
from enum import Enum
from functools import cached_property

import numpy as np

from seal_mdao.terms.point_assembly import interpolate


class Status(Enum):
    """How a load path, or one Newton solution, ended."""

    CONVERGED = "converged"
    NOT_CONVERGED = "Newton did not converge within the allowed iterations"
    DIVERGED = "the residual is not a finite number"
    INVERTED = "a quadrature point is turned inside out (det F <= 0)"
    SINGULAR = "the tangent is singular"
    MOVED_OFF = "the body moves off for ever"
    UNSTABLE = "equilibrium is not stable"
    JUMPED = "the body moved much farther than predicted"


@dataclass(frozen=True, eq=False)
class ConvergedStep:
    """One converged (sub)step: all that the next step and the sensitivities need.

    Attributes
    ----------
    nominal : int
        Number of the nominal step that this one completes, -1 for a cut step.
    fraction : float
        Path parameter: number of nominal steps completed, fractions for cut steps.
    d : ndarray, shape (n, 2)
        Generalised displacements.
    before : tuple
        History of every term with which the step began.
    responses : tuple of Response
        What every term answered.
    iterations : int
        Iterations that were needed, quasi-Newton ones and those of an attempt given up included.
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
        """History of every term that the step hands on."""
        return tuple(response.history for response in self.responses)

    def same_branches(self, other: "ConvergedStep") -> bool:
        """Whether every term is on the branch on which it was at another step."""
        return all(
            np.array_equal(mine.branch, its.branch)
            for mine, its in zip(self.responses, other.responses, strict=True)
        )


@dataclass(frozen=True, eq=False)
class PathResult:
    """A load path, complete or up to where it failed.

    Attributes
    ----------
    problem : PathProblem
        The problem that was solved.
    start : ConvergedStep
        The undeformed state, in which the history begins.
    steps : list of ConvergedStep
        All converged steps in order, with the parts of those that could not be solved as one.
    status : Status
        CONVERGED, or why the last attempt failed.
    step_cuts : int
        How often a step was halved.
    failure : str
        Empty, or where the path ended and in what state.
    damped : str
        Empty, or how damped motion ended there; a sentence without its full stop.
    critical_points : tuple of CriticalPoint
        Where equilibrium lost its stability, in order.
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

    @property
    def newton_iterations(self) -> np.ndarray:
        """Iterations of every nominal step, those of its cut parts included, shape (n_steps,)."""
        counts, running = [], 0
        for step in self.steps:
            running += step.iterations
            if step.nominal >= 0:
                counts.append(running)
                running = 0
        return np.array(counts, int)

    def place(self, label: str) -> int:
        """Which of the responses of a step is that of the term ``label``."""
        return self.problem.terms.index(self.problem.term(label))

    def responses(self, label: str) -> list:
        """Answers of one term at all converged steps, cut ones included."""
        place = self.place(label)
        return [step.responses[place] for step in self.steps]

    def at_nominal(self, label: str) -> list:
        """Answers of one term at the nominal steps."""
        place = self.place(label)
        return [step.responses[place] for step in self.nominal_steps]

    def reaction(self, label: str) -> np.ndarray:
        """Sum of the forces of a term's points at every nominal step, shape (n_steps, 2), N/m."""
        return np.array([response.total for response in self.at_nominal(label)]).reshape(-1, 2)

    def displacement(self, step: int = -1) -> np.ndarray:
        """Physical displacements u(X_J) at all particles of a nominal step, shape (n, 2)."""
        out = np.empty_like(self.discretization.particles)
        interpolate(self.discretization.everywhere.table, self.nominal_steps[step].d, out)
        return out

    @cached_property
    def largest_displacement(self) -> float:
        """Largest displacement of a particle at a nominal step, mm: how far the body was squeezed."""
        steps = range(len(self.nominal_steps))
        return max((float(np.hypot(*self.displacement(k).T).max()) for k in steps), default=0.0)
