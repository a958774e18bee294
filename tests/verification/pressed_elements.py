"""The nominal door seal under its door by biquadratic elements: an independent reference.

Section, rubber, door and contact law are those of ``door_seal``, with the same penalties; the elements
are those of ``biquadratic``, with the contact at three Gauss points of every edge.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from seal_mdao.contact.friction import ContactHistory, no_history
from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.contact.rigid_forces import contact_points
from seal_mdao.measures.selection import contact_range
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.seal import Seal
from seal_mdao.seals.wall_grid import ray_directions
from verification.biquadratic import (
    Elements,
    changed_pressures,
    components,
    condensed,
    entry_places,
    lagrange,
    mapped_elements,
)
from verification.flat_door_reference import at_its_travels

# 16 x 464 elements, 105 steps; 8 x 232 differ by up to 0.016 %, 12 x 348 by 0.005 % and in the gap
# by 1e-5 mm; twice as many steps, or five points an edge, by 0.005 %
FLAT = np.array([13.6517, 24.2082, 35.6499, 49.4227, 64.4268])
CORNER = np.array([13.6517, 24.2082, 34.7674, 45.8879, 57.4105])
"""Vertical reaction at 2, 4, 6, 8 and 10 mm, N/m: the limit of ``PressedElements``."""
GAP = 0.1173
"""Largest gap under the corner door, mm."""
TOLERANCE = 1e-9
"""Largest residual over the largest force at a node."""
MOST = 40
PER_EDGE = 3
ALONG = 50
"""Places of an edge where the gap is looked at."""


class EdgePoints(NamedTuple):
    """Points of the free outer edges.

    Attributes
    ----------
    nodes : ndarray of int, shape (k, 3)
    values : ndarray, shape (k, 3)
        Shape functions of the nodes.
    length : ndarray, shape (k,)
        Tributary undeformed lengths, mm.
    """

    nodes: np.ndarray
    values: np.ndarray
    length: np.ndarray

    def at(self, x: np.ndarray) -> np.ndarray:
        """Places (k, 2) of the points for the nodes ``x`` (n, 2)."""
        return np.einsum("ka,kai->ki", self.values, x[self.nodes])


class Pressed(NamedTuple):
    """Path of the elements.

    Attributes
    ----------
    travel : ndarray, shape (n_steps,)
        Of the door since it touched the nominal seal, mm.
    reaction : ndarray, shape (n_steps, 2)
        N/m.
    largest_gap : float
        Between the first and the last place in contact at the end, mm.
    """

    travel: np.ndarray
    reaction: np.ndarray
    largest_gap: float

    @property
    def curve(self) -> np.ndarray:
        """Vertical reaction at the travels of the flat door's reference, N/m."""
        return at_its_travels(self.travel, self.reaction[:, 1])


def ring_elements(seal: Seal, across: int, around: int) -> Elements:
    """``across`` x ``around`` elements of the nominal section; nodes by circles, from straight down."""

    section = options_of(seal).section

    def ring(reference):
        t, angle = reference[:, 0], 2.0 * np.pi * reference[:, 1]
        radius = (1.0 - t) * section.inner(angle) + t * section.outer(angle)
        return radius[:, None] * ray_directions(angle)

    mesh, rows = mapped_elements(across, around, ring), 2 * around + 1
    circle, ray = np.divmod(mesh.connectivity, rows)  # the last ray is the first one
    return mesh._replace(
        nodes=mesh.nodes.reshape(-1, rows, 2)[:, :-1].reshape(-1, 2),
        connectivity=circle * (rows - 1) + ray % (rows - 1),
    )


def _outer_edges(mesh: Elements, around: int, base: int) -> np.ndarray:
    """Nodes (m, 3) of the edges outside the base, which is 2 ``base`` edges long."""
    first = len(mesh.nodes) - 2 * around
    return first + (2 * np.arange(base, around - base)[:, None] + np.arange(3)) % (2 * around)


def _edge_points(mesh: Elements, edges: np.ndarray, places, weights) -> EdgePoints:
    values, slopes = lagrange(places)
    tangents = np.einsum("ga,mai->mgi", slopes, mesh.nodes[edges])
    return EdgePoints(
        np.repeat(edges, len(places), axis=0), np.tile(values, (len(edges), 1)),
        (weights * np.linalg.norm(tangents, axis=2)).ravel(),
    )  # fmt: skip


class PressedElements:
    """Equilibria of a ring of elements under its door.

    Parameters
    ----------
    seal : Seal
        Its nominal section, material, door, contact law and motion.
    across, around : int
        Elements; ``around`` a multiple of 58.

    Attributes
    ----------
    history : ContactHistory
        History at the end of the last step.
    end : ndarray, shape (n, 2)
        Displacements at the end of the path.
    """

    def __init__(self, seal: Seal, across: int, around: int):
        self.options = options_of(seal)
        self.seal, self.mesh = seal, ring_elements(seal, across, around)
        base = round(self.options.section.base_angle * around / (2.0 * np.pi))
        self.edges = _outer_edges(self.mesh, around, base)
        self.where = _edge_points(self.mesh, self.edges, *np.polynomial.legendre.leggauss(PER_EDGE))
        self.curve = self.options.shape.profile().curve
        self.history = no_history(len(self.where.length))
        self.end, n = np.zeros_like(self.mesh.nodes), self.n_nodes
        fixed = np.zeros((n, 2), bool)
        fixed[n - 2 * around + np.arange(-2 * base, 2 * base + 1) % (2 * around)] = True
        self.free = np.flatnonzero(~fixed.ravel())
        number = np.full(2 * n, -1)
        number[self.free] = np.arange(self.free.size)
        self.dofs = [components(nodes) for nodes in (self.mesh.connectivity, self.where.nodes)]
        places = number[np.hstack([entry_places(own) for own in self.dofs])]
        self.kept = np.all(places >= 0, axis=0)
        self.places = places[:, self.kept]

    def contact(self, x, pose, direction):
        """Forces, tangents, the new history, and how many points were forced to stick."""
        k = len(self.where.length)
        force, tangent, gap = np.empty((k, 2)), np.empty((k, 2, 2)), np.empty(k)
        state, kept = np.empty(k, np.int64), np.empty((k, 3))
        made = contact_points(
            self.curve, self.options.law, pose, self.where.at(x), self.where.length,
            self.history, direction, False, force, tangent, state, kept, gap,
        )  # fmt: skip
        return force, tangent, ContactHistory(state, kept), made

    def system(self, u, p, pose, direction):
        """Residual, its tangent in the free components, and what gives pressures, forces and history."""
        mesh, values = self.mesh, self.where.values
        r, k, shift, back = condensed(mesh, self.options.material, u, p)
        force, tangent, history, made = self.contact(mesh.nodes + u, pose, direction)
        on_nodes = np.einsum("ka,ki->kai", values, force).reshape(len(force), -1)
        of_nodes = np.einsum("ka,kij,kb->kaibj", values, tangent, values)
        inner, outer = (
            np.bincount(dofs.ravel(), own.ravel(), 2 * self.n_nodes)
            for dofs, own in zip(self.dofs, (r, on_nodes), strict=True)
        )
        entries = np.concatenate([k.ravel(), of_nodes.ravel()])[self.kept]
        matrix = csc_array((entries, tuple(self.places)), shape=(self.free.size, self.free.size))
        small = np.abs(inner + outer)[self.free].max() < TOLERANCE * max(np.abs(inner).max(), 1e-3)
        return inner + outer, matrix, (shift, back), force, history, small and made == 0

    @property
    def n_nodes(self) -> int:
        return len(self.mesh.nodes)

    def no_direction(self) -> np.ndarray:
        """Slip directions before the first iteration."""
        return np.zeros(len(self.where.length), np.int64)

    def solved(self, matrix, residual) -> np.ndarray:
        """Newton's change of all components."""
        change = np.zeros(residual.size)
        factor = splu(
            matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.01,
            options={"SymmetricMode": True},
        )  # fmt: skip
        change[self.free] = factor.solve(-residual[self.free])
        return change

    def pressures(self, p, shift, back, change) -> np.ndarray:
        """The pressures that belong to a change of the displacements."""
        return changed_pressures(p, shift, back, change[self.dofs[0]])

    def step(self, u, p, pose):
        """Newton's method from ``u``, ``p``; returns the new history.

        Raises
        ------
        RuntimeError
            When it does not converge.
        """
        direction = self.no_direction()
        for _ in range(MOST):
            residual, matrix, (shift, back), force, history, done = self.system(
                u, p, pose, direction
            )
            if done:
                self.history = history
                return u, p, force.sum(axis=0)
            change = self.solved(matrix, residual)
            u, p = u + change.reshape(u.shape), self.pressures(p, shift, back, change)
        raise RuntimeError(f"the elements found no equilibrium at y = {pose.position[1]:.4g}")

    def press(self) -> Pressed:
        """All load steps of the seal's motion."""
        motion, top = self.options.motion, self.options.section.outer_radius
        u, p = np.zeros_like(self.mesh.nodes), np.zeros((len(self.mesh.connectivity), 3))
        poses = [motion.pose(step) for step in range(motion.n_steps + 1)]
        self.history = self.contact(self.mesh.nodes, poses[0], self.no_direction())[2]
        before, reaction = u, []
        for pose in poses[1:]:
            start, before = 2.0 * u - before, u
            u, p, force = self.step(start, p, pose)
            reaction.append(force)
        travel = np.array([top - pose.position[1] for pose in poses[1:]])
        self.end = u
        return Pressed(travel, np.array(reaction), self._largest_gap(u, poses[-1]))

    def _largest_gap(self, u, pose) -> float:
        places = np.linspace(-1.0, 1.0, ALONG, endpoint=False)
        along = _edge_points(self.mesh, self.edges, places, np.ones(ALONG))
        gap = np.empty(len(along.length))
        normal_gaps(self.curve, pose, along.at(self.mesh.nodes + u), gap)
        stretch = contact_range(gap < 0.0)
        return float(gap[stretch].max()) if stretch.size else float("nan")
