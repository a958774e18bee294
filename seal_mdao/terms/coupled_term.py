"""Terms at material points whose forces depend on the positions of other points: trapped air,
self-contact.

A term of this kind gives the forces at its points, their derivatives for pairs of points, and one
sparse matrix of all derivatives of a converged step. Assembly, tangent, history, and both kinds of
sensitivities are done here. What couples all points through one number, such as a pressure, is a part
of rank one.
"""

from functools import cached_property
from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.terms.linearization import (
    AllPoints,
    Inputs,
    Linearization,
    LocalMap,
    Outputs,
    PassedOn,
)
from seal_mdao.terms.linearized_points import LinearizedPoints
from seal_mdao.terms.point_assembly import assemble_points, interpolate
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.term_at_points import TermAtPoints


class CoupledResponse(NamedTuple):
    """Response of a term at k points.

    Attributes
    ----------
    x, force : ndarray, shape (k, 2)
        Deformed places, and forces that join the residual as they are.
    loaded : ndarray of int, shape (k,)
        Zero where neither a force nor its rates can be.
    pairs : ndarray of int, shape (m, 2)
        Points of which the force of the first depends on the place of the second.
    tangent : ndarray, shape (m, 2, 2)
        d force / d x of the pairs.
    columns, sizes : ndarray, shapes (r, k, 2), (r,)
        Further parts of rank one, sum of size g g^T.
    branch : ndarray of int
        Which branch of its law every point is on.
    history : object
        passed to the next step.
    outputs : ndarray, shape (places, o)
        What measures may take besides the force.
    unconverged : int
        Points that have not answered with the term's own law yet.
    """

    x: np.ndarray
    force: np.ndarray
    loaded: np.ndarray
    pairs: np.ndarray
    tangent: np.ndarray
    columns: np.ndarray
    sizes: np.ndarray
    branch: np.ndarray
    history: object
    outputs: np.ndarray
    unconverged: int = 0

    def copied(self):
        """Return the response itself, whose arrays are not overwritten."""
        return self

    @property
    def total(self) -> np.ndarray:
        """Sum of the forces, shape (2,)."""
        return self.force.sum(axis=0)


class CoupledTerm(TermAtPoints):
    """Base class of coupled terms. A subclass defines ``respond`` and ``linearize``; ``where`` are
    points at particles or between them, one a group.

    Attributes
    ----------
    output_indices : int
        Rows of ``CoupledResponse.outputs``.
    """

    output_indices = 1

    def __init__(self, label, names, where: MaterialPoints, discretization, index: int):
        super().__init__(label, names, where, discretization, index)
        self._slots = None

    # ---- what a subclass gives ----

    def respond(self, x, fraction, history) -> CoupledResponse | None:
        """Compute the forces at the deformed positions ``x`` (k, 2); None if the term cannot be
        evaluated."""
        raise NotImplementedError

    def linearize(self, response, fraction, history) -> LocalMap:
        """Compute the derivatives at a converged step that began with ``history``."""
        raise NotImplementedError

    def uses_history(self, following: CoupledResponse) -> np.ndarray:
        """Return which history variables of each point a step used."""
        return np.empty(0, int)

    # ---- the contract of a term ----

    @property
    def rows(self) -> list:
        """Ranges of force, history and outputs among the rows of a ``LocalMap``."""
        return self.spaces[0].slices

    @property
    def inputs(self) -> list:
        """Ranges of x, history, measure, parameters and X among its columns."""
        return self.spaces[1].slices

    def deformed(self, raw) -> np.ndarray:
        """Compute the deformed positions of the points (k, 2)."""
        x = np.empty((len(self.where), 2))
        # x = X + Phi d
        interpolate(self.table.raw, raw, x)
        return x + self.reference

    def add(self, d, raw, fraction, history, force, values):
        response = self.respond(self.deformed(raw), fraction, history)
        return None if response is None else self.assembled(response, force, values)

    def assembled(self, response: CoupledResponse, force, values) -> CoupledResponse:
        """Add a response to the forces and, where ``values`` is not empty, to the tangent."""
        layout = self.discretization.layout
        # f += Phi^T s
        self._add_force(response.force, response.loaded, force)
        if values.size:
            # K += Phi_i^T (ds_i/dx_j) Phi_j of every pair
            slots = self._pair_slots(response.pairs)
            assemble_pairs(self.table.raw, response.pairs, response.tangent, *slots, values)
            # K += size (Phi^T g)(Phi^T g)^T of every part of rank one
            columns, sizes = layout.columns(values)
            first = self.discretization.first_column[self.index]
            for i, (column, size) in enumerate(zip(response.columns, response.sizes, strict=True)):
                self._add_force(column, response.loaded, columns[first + i])
                sizes[first + i] = size
        return response

    def point_loads(self, point_force, loaded) -> np.ndarray:
        """The force buffer of forces (k, 2) at points whose ``loaded`` is not zero."""
        force = np.zeros(self.discretization.layout.force_size)
        self._add_force(point_force, loaded, force)
        return force

    def _add_force(self, point_force, loaded, force) -> None:
        uncoupled, unused = self.discretization.layout.uncoupled, np.empty((0, 2, 2))
        assemble_points(self.table.raw, point_force, unused, loaded, uncoupled, force, np.empty(0))

    def _pair_slots(self, pairs) -> tuple:
        """Slots of pairs, kept as long as the pairs are the same."""
        if self._slots is None or not np.array_equal(self._slots[0], pairs):
            self._slots = pairs, self.discretization.layout.pair_slots(self.table.raw, pairs)
        return self._slots[1]

    # ---- sensitivities ----

    @property
    def output_count(self) -> int:
        return self.output_indices

    @cached_property
    def spaces(self) -> tuple:
        """Return the layout of rows and columns of a ``LocalMap``."""
        k, h, o = len(self.where), self.history_size, len(self.output_names)
        return (
            AllPoints(Outputs, ((k, 2), (k, h), (self.output_indices, o))),
            AllPoints(Inputs, ((k, 2), (k, h), (k, 1), (1, len(self.names)), (k, 2))),
        )

    def linearization(self, step, following=None, measured=True) -> LinearizedPoints:
        response, before = step.responses[self.index], step.before[self.index]
        # L of all points: they depend on each other
        matrix, every = self.linearize(response, step.fraction, before), np.arange(len(self.where))
        law = Linearization(every, matrix, *self.spaces)
        used = np.empty(0, int)
        if following is not None:
            used = self.uses_history(following.responses[self.index])
        return LinearizedPoints(self, step, law, used)

    def acting(self, response) -> np.ndarray:
        return response.loaded

    def passed_on(self, law: Linearization, used, step, following) -> PassedOn:
        """H: the variables of the history that the next step uses; G = (dh+/dx)^T H."""
        # H: unit vectors of the variables that are used;  G = (dh+/dx)^T H
        chosen = law.rows.zeros(len(self.where), used.size)
        chosen.history.reshape(-1, used.size)[used, np.arange(used.size)] = 1.0
        return PassedOn((law.T @ chosen).x, chosen.history)


@compiled
def assemble_pairs(table, pairs, tangent, start, slots, values):
    """Add the tangents (m, 2, 2) of pairs of points (m, 2) through their rows of Phi."""
    for m in range(len(pairs)):
        # rows of Phi of both points
        i, j, at = table.start[pairs[m, 0]], table.start[pairs[m, 1]], start[m]
        rows, columns = table.start[pairs[m, 0] + 1] - i, table.start[pairs[m, 1] + 1] - j
        for e in range(2):
            for b in range(columns):
                for c in range(2):
                    # K_(Ic)(Je) += Phi_I T_ce Phi_J
                    weight = tangent[m, c, e] * table.phi[j + b]
                    for a in range(rows):
                        values[slots[at]] += weight * table.phi[i + a]
                        at += 1
