"""Terms that act at single material points, each through its own row of shape functions.

A term of this kind gives the force of its points and the derivatives of that force with respect to
the point's inputs; everything else (assembly, tangent, history, direct and adjoint sensitivities with
respect to shape and parameters) is done here, once for rigid contact, loads, foundations and others.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.terms.handed_on import HandedOn, directions_of
from seal_mdao.terms.point_assembly import assemble_points, interpolate
from seal_mdao.terms.point_forward import PointForward, PointSeeds
from seal_mdao.terms.point_reverse import PointReverse
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.term import Term


class PointResponse(NamedTuple):
    """What a term answers at k points.

    Attributes
    ----------
    x, force : ndarray, shape (k, 2)
        Deformed places, and forces that join the residual as they are.
    tangent : ndarray, shape (k, 2, 2)
        d force / d x.
    branch : ndarray of int, shape (k,)
        Zero where a point carries no force.
    history : object
        Handed on to the next step.
    outputs : ndarray, shape (k, o)
        What measures may take besides the force.
    unsettled : int
        Points that have not answered with the term's own law yet.
    """

    x: np.ndarray
    force: np.ndarray
    tangent: np.ndarray
    branch: np.ndarray
    history: object
    outputs: np.ndarray
    unsettled: int = 0

    def kept(self):
        """A copy that later assemblies do not overwrite."""
        return self._replace(
            x=self.x.copy(), force=self.force.copy(), tangent=self.tangent.copy(),
            branch=self.branch.copy(), history=_copied(self.history), outputs=self.outputs.copy(),
        )  # fmt: skip

    @property
    def total(self) -> np.ndarray:
        """Sum of the forces, shape (2,)."""
        return self.force.sum(axis=0)


def _copied(history):
    if isinstance(history, tuple):
        return type(history)(*(part.copy() for part in history))
    return None if history is None else history.copy()


class PointTerm(Term):
    """Base class of a term at single points. A subclass gives ``respond`` and ``linearize``.

    Parameters
    ----------
    label : str
    names : tuple of str
        Scalar parameters, in the order of their columns in ``linearize``.
    where : MaterialPoints
    discretization : Discretization
    place : int
        Which of the discretisation's tables holds the shape functions at the points.

    Attributes
    ----------
    history_size : int
        Variables that a point hands on.
    output_names : tuple of str
        What measures may take besides the force, the columns of ``PointResponse.outputs``.
    uses_reference : bool
        Whether ``linearize`` has columns for the undeformed place too.
    """

    couples_points = False
    history_size = 0
    output_names: tuple = ()
    uses_reference = False

    def __init__(self, label, names, where: MaterialPoints, discretization, place: int):
        self.label, self.names, self.where, self.place = label, tuple(names), where, place
        self.discretization, self.table = discretization, discretization.tables[place]
        self.scatter = discretization.scatters[place]
        self.reference = self.table.coordinates
        self.length = where.lengths(discretization.particles)
        self._x = np.empty((len(where), 2))

    # ---- what a subclass gives ----

    def respond(self, x, fraction, history) -> PointResponse:
        """Forces at the deformed places ``x`` (k, 2) and the path parameter ``fraction``."""
        raise NotImplementedError

    def linearize(self, response, fraction, history, points) -> np.ndarray:
        """Derivatives at the ``points`` (s,) of a converged step, which began with ``history``.

        Returns
        -------
        ndarray, shape (s, 2 + history_size + o, 2 + history_size + 1 + len(names) [+ 2])
            Rows: force, history handed on, outputs. Columns: x, history, measure, parameters (and X).
        """
        raise NotImplementedError

    def handed_on(self, response, following: PointResponse, local: np.ndarray, points) -> HandedOn:
        """Displacements of the step of ``response`` that ``following`` uses, linearised in ``local``
        (s, ...) at the ``points`` (s,)."""
        used = np.flatnonzero(np.isin(points, self.uses_history(following)))
        both = np.broadcast_to(np.eye(2), (used.size, 2, 2))
        return directions_of(points[used], both)

    def uses_history(self, following: PointResponse) -> np.ndarray:
        """Points whose history a step used."""
        return np.flatnonzero(following.branch) if self.history_size else np.empty(0, int)

    # ---- the contract of a term ----

    @property
    def remembers(self) -> bool:
        """Whether a step depends on the one before at all."""
        return self.history_size > 0

    @property
    def local_shape(self) -> tuple:
        """Rows and columns of a local linearisation."""
        h = self.history_size
        columns = 2 + h + 1 + len(self.names) + (2 if self.uses_reference else 0)
        return 2 + h + len(self.output_names), columns

    def add(self, d, raw, fraction, history, force, values):
        return self.assembled(self.respond(self.deformed(raw), fraction, history), force, values)

    def deformed(self, raw) -> np.ndarray:
        """Deformed places (k, 2) of the points, in a buffer."""
        interpolate(self.table.raw, raw, self._x)
        self._x += self.reference
        return self._x

    def assembled(self, response: PointResponse, force, values) -> PointResponse:
        """Add the forces and tangents of a ``response`` to the buffers; it is returned."""
        assemble_points(
            self.table.raw, response.force, response.tangent, response.branch, self.scatter, force,
            values,
        )  # fmt: skip
        return response

    def point_loads(self, point_force, branch) -> np.ndarray:
        """The force buffer of forces (k, 2) at points whose ``branch`` is not zero."""
        force = np.zeros(self.discretization.layout.force_size)
        unused = np.empty((len(point_force), 2, 2))
        assemble_points(
            self.table.raw, point_force, unused, branch, self.scatter, force, np.empty(0)
        )
        return force

    def forward(self, shape, rates) -> PointForward:
        return PointForward(self, shape, rates)

    def reverse(self, n_measures: int, wanted: set) -> PointReverse:
        return PointReverse(self, n_measures)

    def no_seeds(self, n_measures: int) -> PointSeeds:
        k, o = len(self.where), len(self.output_names)
        return PointSeeds(np.zeros((n_measures, k, 2)), np.zeros((n_measures, k, o)))
