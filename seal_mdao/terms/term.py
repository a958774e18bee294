"""Base class of a term: one contribution to the equilibrium equations R = sum of terms = 0.

The path solver, the predictor and both sensitivity sweeps loop over terms and never ask which. A term
is defined once, by a frozen ``TermDefinition``, and bound to one discretised design with its method
``on``, which gives a ``Term``. Terms that act at single material points, rigid contact among them, are
short: see ``point_term``.
"""

import math
from typing import NamedTuple, Protocol

import numpy as np

from seal_mdao.rkpm.shape_functions import PointSet
from seal_mdao.terms.linearized_term import Basis, LinearizedBlock, LinearizedTerm


class Scalar(NamedTuple):
    """Scalar parameter.

    Attributes
    ----------
    value : float
    units : str or None
        As OpenMDAO writes them.
    text : str
        One line for documentation.
    """

    value: float
    units: str | None
    text: str


class ReleasedEnergy(NamedTuple):
    """Bounds of the energy that is released in an increment: work of the loading, minus the change of
    the stored energy, minus the work of friction.

    Attributes
    ----------
    least, most : float
        Bounds, mJ/m; infinite where nothing is known. ``most`` is negative where more energy is stored
        than the loading supplies.
    work : float
        Largest amount of the work of the loading, mJ/m.
    """

    least: float
    most: float
    work: float


class Response(Protocol):
    """Response of a term at one state of the body.

    Attributes
    ----------
    history : object
        History carried to the next step; None for a term that is not history dependent.
    branch : ndarray of int
        Which branch of its law every point is on (stick, slip, open); empty where there is one.
    unconverged : int
        Places at which it has not answered with its own law yet; equilibrium wants none.
    """

    def copied(self) -> "Response":
        """Return a copy that later assemblies do not overwrite."""


class TermDefinition:
    """Base class of a term before it is bound to a design; a subclass is a frozen dataclass.

    Attributes
    ----------
    label : str
        Unique among the terms of a problem; measures find the term by it.
    couples : bool
        Whether its force depends on displacements: the equations of its points are coupled then.
    n_columns : int
        Parts of rank one of its tangent, which couple all of its points through one number.
    """

    couples = True
    n_columns = 0

    @property
    def scalars(self) -> dict:
        """Scalar parameters of the term, ``Scalar`` by name."""
        return {}

    def with_parameters(self, values: dict) -> "TermDefinition":
        """Return a copy with some of the ``scalars`` changed."""
        return self

    def among(self, definitions) -> "TermDefinition":
        """Return the term of a seal with these definitions: one that depends on contacts of the seal, as
        a fluid does, takes them from there, so that both change together."""
        return self

    def with_ends(self, ends) -> "TermDefinition":
        """Return the term for a load path with other load steps, whose ``ends`` are in present
        nominal steps.

        What grows or moves along the path overrides it.

        Raises
        ------
        ValueError
            For ends that leave out the end of a stage.
        """
        return self

    def point_set(self) -> PointSet | None:
        """Points through whose shape functions it acts, those of a group all coupled; or None."""

    def pairs(self) -> np.ndarray | None:
        """Pairs (m, 2) of its points that may act on each other, both ways; or None."""

    def on(self, discretization, index: int) -> "Term":
        """Build the term for one design; ``discretization.tables[index]`` holds the shape functions
        at its points."""
        raise NotImplementedError


class Term:
    """Term for one discretised design. By default it has no history, no parameters and no motion.

    Attributes
    ----------
    label : str
    names : tuple of str
    rounding : float
        Rounding error of its forces over 10 eps, N/m.
    rounding_by_displacement : float
        Its increase with the largest displacement, N/m for every mm.
    history_dependent : bool
        Whether a step depends on the one before.
    passes_all : bool
        Whether it does so through all displacements, and not a few functions of them (``PassedOn``).
    conservative : bool
        Whether its force is the derivative of its ``potential``, so that its tangent is symmetric.
    couples_points : bool
        Whether the force at one of its points depends on where others are.
    touches_itself : bool
        Whether it has a ``linear_contact``: walls of the body that may face each other.
    begins_at : float
        Path parameter of the undeformed state, negative with preliminary increments
        (``Motion.retraction``).
    """

    label = ""
    names: tuple = ()
    rounding = 0.0
    rounding_by_displacement = 0.0
    history_dependent = False
    passes_all = False
    conservative = False
    couples_points = True
    touches_itself = False
    begins_at = 0.0

    # ---- analysis ----

    def begin(self, iteration=None) -> None:
        """Begin a solution, or continue one from the state ``iteration`` of its iterations."""

    @property
    def iteration(self):
        """State of the iterations of a solution that the next one uses, beside the displacements; later
        evaluations must not change it. None for a term that uses nothing."""
        return None

    def through_slip(self, cycle: list):
        """Return the state of iterations in which points pass through slip between open and stick.

        Parameters
        ----------
        cycle : list
            ``iteration`` of the iterations of one cycle, the last of which is continued.

        Returns
        -------
        object
            None where no point passed over slip.
        """

    def no_history(self):
        """Return the history of the undeformed state."""

    def add(self, d, raw, fraction, history, force, values) -> Response | None:
        """Add force and tangent at displacements ``d``.

        Parameters
        ----------
        d, raw : ndarray, shape (n, 2)
            Coefficients after and before the essential transformation.
        fraction : float
            Path parameter, in nominal load steps.
        history : object
            History at the end of the previous converged step.
        force : ndarray, shape (force_size,)
            Added to through the scatter map of the term's raw table.
        values : ndarray
            The tangent's buffer, added to; empty where the force alone is wanted.

        Returns
        -------
        Response or None
            None where the term cannot be evaluated (an inverted point).
        """
        raise NotImplementedError

    def begin_mixed(self, step, response: Response, target: float) -> None:
        """Take a converged step as the first linearisation of ``add_mixed`` at ``target``."""

    def begin_near(self, d, target: float, known) -> None:
        """Begin mixed iterations at displacements ``d`` (n, 2) near a solution at ``target``.

        Parameters
        ----------
        known : ndarray or None
            What of the solution is known to the term: the volumetric strain of the body, the gaps of a
            contact.
        """
        self.begin(None)

    def add_mixed(self, d, raw, fraction, history, force, values) -> Response | None:
        """As ``add``, for mixed iterations (``analysis.mixed_newton``): stresses and contact forces in
        the tangent are those that the last linearisation led to. Same as ``add`` where d has converged.
        """
        return self.add(d, raw, fraction, history, force, values)

    def linear_contact(self, iteration, history):
        """Return the contact of points whose law a linear step from the linearisation of a mixed
        ``iteration`` has to satisfy (``contact.self_linear``); None without any."""
        return None

    def forces(self, d, fraction: float, history=None) -> np.ndarray | None:
        """Compute the forces (n, 2) on all components at a path parameter, prescribed ones too, with the
        history of the step before; None for a term that does not act on these."""
        return None

    def check_start(self, response: Response) -> None:
        """Raise GeometryError where the undeformed state is not admissible."""

    def changes(self, step, response: Response, target: float) -> list:
        """Compute the change of the force between a converged step and ``target`` at fixed
        displacements.

        Returns
        -------
        list of ndarray, shape (force_size,)
            One estimate, or two of which the path takes the better one; none for no change.
        """
        return []

    def potential(self, d, response: Response) -> float:
        """Compute the potential of a conservative term at displacements ``d`` with ``response``,
        mJ/m."""
        raise NotImplementedError

    def released_energy(
        self, step, before: Response, d, response: Response, target: float
    ) -> ReleasedEnergy:
        """Compute bounds of the energy that the term releases in an increment.

        They are the smallest and the largest value that the forces at both ends of the increment allow:
        by default from the potential, or from the forces where there is none or its loading grows;
        infinite where neither is known.

        Parameters
        ----------
        step : ConvergedStep
            Where the increment began, with the term's response ``before``.
        d : ndarray, shape (n, 2)
            Equilibrium at ``target``, with ``response``.
        """
        # fixed loading and a potential: E_0 - E
        if self.conservative and not self.changes(step, before, target):
            released = self.potential(step.d, before) - self.potential(d, response)
            return ReleasedEnergy(released, released, 0.0)
        if hasattr(response, "x"):
            return work_of_forces(before, response)
        return ReleasedEnergy(-math.inf, math.inf, 0.0)

    def describe(self, response: Response, fraction: float) -> str:
        """Describe a state in a few words, for messages."""
        return ""

    def kinks(self, response: Response, fraction: float, history, following=None):
        """Find points at which the force is not differentiable at a converged step.

        Parameters
        ----------
        history : object
            With which the step began.
        following : Response, optional
            Of the next step.

        Returns
        -------
        Kinks or None
            Those of ``contact.kinks``; None for a term whose force is smooth.
        """

    # ---- sensitivities ----

    basis: Basis

    def linearization(self, step, following=None, measured=True) -> LinearizedTerm:
        """Linearise the term at a converged step.

        Parameters
        ----------
        step, following : ConvergedStep
            ``following`` is the next one, whose history comes from here; None at the end.
        measured : bool
            Whether all of the step is wanted, and not only what ``following`` uses.
        """
        raise NotImplementedError

    def linearization_of_block(self, steps) -> LinearizedBlock | None:
        """Linearise a force without history at several converged steps at once; None for a term
        whose ``linearization`` has all of it."""

    def no_rates(self, count: int):
        """Return zero rates of its history, or seeds on it, in ``count`` columns."""

    def no_seeds(self, n_measures: int):
        """Zero seeds of measures on what they may take from the term: an object with ``used``, ``put``
        and ``times``, as ``PointSeeds``."""
        raise ValueError(
            f"a measure uses the force or an output of the load or contact (term) {self.label!r}, "
            f"but the class {type(self).__name__} does not define the method no_seeds, which "
            "derivatives of such a measure need; define no_seeds (as PointTerm does), or leave out "
            "the measure"
        )


def work_of_forces(before, response) -> ReleasedEnergy:
    """Compute bounds of the work of forces at points on the body; their difference is its ``work``.

    With the forces before and after the increment, where nothing is known of what lies between.
    """
    # W = -f . du with the forces of the beginning and of the end
    moved = response.x - before.x
    works = [-float(np.sum(forces * moved)) for forces in (before.force, response.force)]
    return ReleasedEnergy(min(works), max(works), abs(works[1] - works[0]))
