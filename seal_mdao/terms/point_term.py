"""Terms that act at single material points, each with its own row of shape functions.

A term of this kind gives the force of its points and the derivatives of that force with respect to
the point's inputs; everything else (assembly, tangent, history, direct and adjoint sensitivities with
respect to shape and parameters) is done here, once for rigid contact, loads, foundations and others.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.terms.linearization import (
    CarriedDirections,
    Inputs,
    Linearization,
    Outputs,
    PassedOn,
    PointByPoint,
    directions_of,
)
from seal_mdao.terms.linearized_points import LinearizedPoints
from seal_mdao.terms.point_assembly import assemble_points, interpolate
from seal_mdao.terms.term_at_points import TermAtPoints


class PointResponse(NamedTuple):
    """Response of a term at k points.

    Attributes
    ----------
    x, force : ndarray, shape (k, 2)
        Deformed places, and forces that join the residual as they are.
    tangent : ndarray, shape (k, 2, 2)
        d force / d x.
    branch : ndarray of int, shape (k,)
        Zero where a point carries no force.
    history : object
        passed to the next step.
    outputs : ndarray, shape (k, o)
        What measures may take besides the force.
    unconverged : int
        Points that have not answered with the term's own law yet.
    """

    x: np.ndarray
    force: np.ndarray
    tangent: np.ndarray
    branch: np.ndarray
    history: object
    outputs: np.ndarray
    unconverged: int = 0

    def copied(self):
        """Return a copy that later assemblies do not overwrite."""
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


class PointTerm(TermAtPoints):
    """Base class of a term at single points. A subclass defines ``respond`` and ``linearize``.

    Attributes
    ----------
    uses_reference : bool
        Whether ``linearize`` has columns for the undeformed place too.
    """

    couples_points = False
    uses_reference = False

    def __init__(self, label, names, where, discretization, index: int):
        super().__init__(label, names, where, discretization, index)
        self.scatter = discretization.scatters[index]

    # ---- what a subclass gives ----

    def respond(self, x, fraction, history) -> PointResponse:
        """Compute the forces at the deformed positions ``x`` (k, 2) and the path parameter
        ``fraction``."""
        raise NotImplementedError

    def linearize(self, response, fraction, history, points) -> np.ndarray:
        """Compute the derivatives at the ``points`` (s,) of a converged step that began with
        ``history``.

        Returns
        -------
        ndarray, shape (s, 2 + history_size + o, 2 + history_size + 1 + len(names) [+ 2])
            Rows: force, new history, outputs. Columns: x, history, measure, parameters (and X).
        """
        raise NotImplementedError

    def carried_directions(
        self, response, following: PointResponse, local, used
    ) -> CarriedDirections:
        """Directions in which the step ``following`` depends on displacements of the step of
        ``response``, at the points ``used`` (s,), linearised in ``local`` (s, rows, columns)."""
        # both components
        return directions_of(used, np.broadcast_to(np.eye(2), (used.size, 2, 2)))

    def uses_history(self, following: PointResponse) -> np.ndarray:
        """Return the points whose history a step used."""
        # points that carry a force in the next step
        return np.flatnonzero(following.branch) if self.history_size else np.empty(0, int)

    # ---- the contract of a term ----

    @cached_property
    def spaces(self) -> tuple:
        """Return the layout of rows and columns of a local linearisation."""
        h, reference = self.history_size, 2 if self.uses_reference else 0
        return (
            PointByPoint(Outputs, (2, h, len(self.output_names))),
            PointByPoint(Inputs, (2, h, 1, len(self.names), reference)),
        )

    @property
    def local_shape(self) -> tuple:
        """Rows and columns of a local linearisation."""
        return tuple(space.size for space in self.spaces)

    def add(self, d, raw, fraction, history, force, values):
        return self.assembled(self.respond(self.deformed(raw), fraction, history), force, values)

    def deformed(self, raw) -> np.ndarray:
        """Compute the deformed positions (k, 2) of the points, in a buffer."""
        interpolate(self.table.raw, raw, self._x)
        # x = X + Phi d
        self._x += self.reference
        return self._x

    def assembled(self, response: PointResponse, force, values) -> PointResponse:
        """Add the forces and tangents of a ``response`` to the buffers, and return it."""
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

    # ---- sensitivities ----

    def linearization(self, step, following=None, measured=True) -> LinearizedPoints:
        response, used = step.responses[self.index], np.empty(0, int)
        if following is not None:
            used = self.uses_history(following.responses[self.index])
        # what is not measured matters at loaded points and at those used next alone
        matters = np.ones(len(self.where), bool) if measured else response.branch != 0
        matters[used] = True
        points, local = np.flatnonzero(matters), np.empty((0, *self.local_shape))
        if points.size:
            # L of these points at the converged step
            local = self.linearize(response, step.fraction, step.before[self.index], points)
        return LinearizedPoints(self, step, Linearization(points, local, *self.spaces), used)

    def acting(self, response) -> np.ndarray:
        return response.branch

    def passed_on(self, law: Linearization, used, step, following) -> PassedOn | None:
        """G: the directions in which the next step uses displacements of a point, at most two each; of
        all displacements of a step no more is wanted. H = (dh+/dx) G."""
        responses = step.responses[self.index], following.responses[self.index]
        local = law.matrix[np.searchsorted(law.points, used)]
        points, directions = self.carried_directions(*responses, local, used)
        if not points.size:
            return None
        # G, a unit vector of one point in every column
        at_points = np.zeros((law.points.size, 2, points.size))
        at_points[np.searchsorted(law.points, points), :, np.arange(points.size)] = directions
        # dh+/dx;  H = (dh+/dx) G
        of_history = law.rows.split(law.matrix[:, :, :2]).history
        return PassedOn(at_points, of_history @ at_points, are_indices=True)
