"""What a load path leaves behind."""

from dataclasses import dataclass, field
from enum import Enum

import numpy as np

from seal_mdao.analysis.body import Discretization
from seal_mdao.analysis.loading import LoadPoint
from seal_mdao.contact.assembly import interpolate
from seal_mdao.contact.friction import OPEN, ContactHistory


class Status(Enum):
    """How a load path, or one Newton solution, ended."""

    CONVERGED = "converged"
    NOT_CONVERGED = "Newton did not converge within the allowed iterations"
    DIVERGED = "the residual is not a finite number"
    INVERTED = "a quadrature point is turned inside out (det F <= 0)"
    SINGULAR = "the tangent is singular"


@dataclass(frozen=True, eq=False)
class ConvergedStep:
    """One converged (sub)step: all that the next step and the sensitivities need.

    Attributes
    ----------
    nominal : int
        Number of the nominal step that this one completes, -1 for a cut step.
    fraction : float
        Path parameter: number of nominal steps completed, fractions for cut steps.
    loading : LoadPoint
        Position of the profile, imposed displacements, dead loads.
    d : ndarray, shape (n, 2)
        Generalised displacements.
    before : ContactHistory
        History with which the step began.
    after : ContactHistory
        Contact state of this step and what it hands on.
    contact_x, force : ndarray, shape (k, 2)
        Deformed contact points and their contact forms (force of the body on the profile, N/m).
    gap : ndarray, shape (k,)
    iterations : int
        Iterations that were needed, quasi-Newton ones and those of an attempt given up included.
    residuals : tuple of float
        Relative residual before each iteration, and at the end.
    factor : object
        Factor of the converged tangent, or None when not kept.
    """

    nominal: int
    fraction: float
    loading: LoadPoint
    d: np.ndarray
    before: ContactHistory
    after: ContactHistory
    contact_x: np.ndarray
    force: np.ndarray
    gap: np.ndarray
    iterations: int
    residuals: tuple
    factor: object = None

    @property
    def position(self) -> np.ndarray:
        """Rigid translation of the profile, shape (2,)."""
        return self.loading.position

    @property
    def reaction(self) -> np.ndarray:
        """Force of the body on the profile, shape (2,)."""
        return self.force.sum(axis=0)


@dataclass(frozen=True, eq=False)
class PathResult:
    """A load path, complete or up to where it failed.

    Attributes
    ----------
    discretization : Discretization
    start : ConvergedStep
        The undeformed state, in which the history begins.
    steps : list of ConvergedStep
        All converged steps in order, cut ones included.
    status : Status
        CONVERGED, or why the last attempt failed.
    step_cuts : int
        How often a step was halved.
    failure : str
        Empty, or where the path ended and in what state.
    """

    discretization: Discretization
    start: ConvergedStep = field(repr=False)
    steps: list = field(repr=False)
    status: Status
    step_cuts: int
    failure: str = ""

    @property
    def converged(self) -> bool:
        return self.status is Status.CONVERGED

    @property
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

    @property
    def reaction(self) -> np.ndarray:
        """Force on the profile at every nominal step, shape (n_steps, 2)."""
        return np.array([step.reaction for step in self.nominal_steps]).reshape(-1, 2)

    @property
    def positions(self) -> np.ndarray:
        """Profile translation at every nominal step, shape (n_steps, 2)."""
        return np.array([step.position for step in self.nominal_steps]).reshape(-1, 2)

    @property
    def contact_state(self) -> np.ndarray:
        """Contact states of all converged steps, cut ones included, shape (n, k)."""
        return np.array([step.after.state for step in self.steps])

    @property
    def n_contact(self) -> np.ndarray:
        """Points in contact at every nominal step."""
        return np.array([np.sum(s.after.state != OPEN) for s in self.nominal_steps], int)

    def displacement(self, step: int = -1) -> np.ndarray:
        """Physical displacements u(X_J) at all particles of a nominal step, shape (n, 2)."""
        out = np.empty_like(self.discretization.particles)
        interpolate(self.discretization.everywhere.table, self.nominal_steps[step].d, out)
        return out
