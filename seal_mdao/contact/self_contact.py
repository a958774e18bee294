"""Self-contact of a section with friction, between any of its boundaries or within one.

Symmetric two-pass formulation: every boundary point is a slave and every segment of the deformed
boundary a master, so each pair of touching walls is evaluated twice, with half of the penalties and
half of the friction limit each. The result does not depend on the choice of slave and master.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.sparse import coo_array

from seal_mdao.contact.boundary_curve import (
    BENT,
    N_PLACES,
    NODES,
    Rings,
    kinematics,
    masters,
    outward,
    project,
    rings,
)
from seal_mdao.contact.friction import OPEN, SLIP, STICK, UNKNOWN, ContactHistory, ContactLaw
from seal_mdao.contact.kinks import LIMIT, TOUCHING, Kinks, find_kinks, no_kinks, rounding_of
from seal_mdao.contact.self_friction import (
    NORMAL_PENALTY,
    Before,
    Touch,
    forces,
    linearized,
    resultants,
    touch,
)
from seal_mdao.contact.self_linear import LinearContact
from seal_mdao.contact.self_mixed import Linearization
from seal_mdao.errors import GeometryError
from seal_mdao.terms.averaged_points import SMOOTH, averaged_points, sharp_corners
from seal_mdao.terms.coupled_term import CoupledResponse, CoupledTerm, LocalMap
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.term import ReleasedEnergy, TermDefinition

SHARED = 0.5
"""Fraction of the penalties of each of the two passes."""

NEIGHBOURS = 3
"""Points up to so many sides apart along one boundary do not touch each other: they are always close."""

LARGEST_CHANGE = 3.0
"""Largest slip in an increment, in segments, with which a point keeps its history."""


@dataclass(frozen=True, eq=False)
class SelfContact(TermDefinition):
    """Boundaries of a section that may touch each other.

    Attributes
    ----------
    label : str
        Before the names of its parameters.
    loops : tuple of ndarray of int
        Particles of closed boundaries, each walked with the body on the left.
    touching : ndarray of bool, shape (k,)
        Which of the particles of all loops, one after the other, may touch.
    nominal : ndarray, shape (n, 2)
        Particles of the nominal body, whose walls limit the penetration.
    law : ContactLaw
    edge_of : ndarray of int, shape (k,), or None
        Edge of every point, e for none, for friction by pairs of edges.
    pair_of : ndarray of int, shape (e + 1, e + 1), or None
        Group of the friction law by the edges of both sides, -1 where they do not touch each other.
    axisymmetric : bool
        Whether the boundaries are those of the section of a body of revolution.

    Raises
    ------
    ValueError
        For a law or arrays that are not admissible.
    """

    label: str
    loops: tuple
    touching: np.ndarray
    nominal: np.ndarray
    law: ContactLaw
    edge_of: np.ndarray | None = None
    pair_of: np.ndarray | None = None
    axisymmetric: bool = False

    def __post_init__(self):
        self.law.check(self.label)
        if min(map(len, self.loops), default=0) < NODES:
            raise ValueError(
                f"every closed boundary (loop) of the self-contact {self.label!r} needs at least "
                f"{NODES} particles; use a smaller particle spacing there"
            )
        if len(self.touching) != sum(map(len, self.loops)):
            raise ValueError(
                f"the flags touching of the self-contact {self.label!r} must have one entry for "
                f"each of the {sum(map(len, self.loops))} particles of its loops, got "
                f"{len(self.touching)}"
            )

    @cached_property
    def where(self) -> MaterialPoints:
        """Points: averages at the particles of all loops (``terms.averaged_points``), two at a sharp
        corner. Tributary lengths are those of sides whose two particles may touch."""
        particles = np.concatenate(self.loops)
        neighbours = np.concatenate(
            [np.column_stack([np.roll(p, 1), np.roll(p, -1)]) for p in self.loops]
        )
        points = averaged_points(particles, neighbours, self.nominal, self.axisymmetric, SMOOTH)
        return replace(points, fractions=points.fractions * self._touching_sides(points))

    def _touching_sides(self, points: MaterialPoints) -> np.ndarray:
        """Which sides of the points may touch, shape (k, 2): those between two particles that may."""
        return self._touching_particles[points.edges].all(axis=2)

    @property
    def _touching_particles(self) -> np.ndarray:
        """Which particles of the body may touch, shape (n,)."""
        found = np.zeros(len(self.nominal), bool)
        found[np.concatenate(self.loops)] = self.touching
        return found

    @cached_property
    def may(self) -> np.ndarray:
        """Which points may touch: those at particles that may, at a sharp corner by their own side."""
        where = self.where
        sides = where.edges[..., 0] != where.edges[..., 1]
        by_side = (self._touching_sides(where) & sides).any(axis=1)
        return np.where(sides.all(axis=1), self._touching_particles[where.of_particles], by_side)

    @cached_property
    def ring(self) -> Rings:
        """The closed boundaries of the points."""
        corner = self.where.edges[:, 1, 0] == self.where.edges[:, 1, 1]
        sizes = [int(np.isin(self.where.of_particles, loop).sum()) for loop in self.loops]
        bent = sharp_corners(self.where.edges, self.nominal, BENT)
        return rings(sizes, corner, bent)

    @property
    def scalars(self) -> dict:
        """Penalties and constants of the friction law."""
        return {f"{self.label}_{name}": scalar for name, scalar in self.law.scalars.items()}

    def with_parameters(self, values: dict) -> "SelfContact":
        """Return the contact with other parameters of its law."""
        own = {name.removeprefix(f"{self.label}_"): value for name, value in values.items()}
        return replace(self, law=self.law.with_parameters(own))

    def point_set(self):
        """The points of all loops."""
        return self.where.moving

    def may_touch(self) -> np.ndarray:
        """Return which points may touch the boundary near which points, shape (k, k).

        Neighbours within ``NEIGHBOURS`` sides along a boundary may not.
        """
        # both points may touch and are not neighbours on one boundary
        found = np.outer(self.may, self.may)
        if self.pair_of is not None:
            found &= self.pair_of[np.ix_(self.edge_of, self.edge_of)] >= 0
        particle = self.where.of_particles
        for loop in self.loops:
            # sides between two particles of the closed loop, in the shorter direction
            own = np.flatnonzero(np.isin(particle, loop))
            # points follow the loop; two of one particle at a corner
            number = np.cumsum(np.diff(particle[own], prepend=particle[own[0]]) != 0)
            between = np.abs(number[:, None] - number)
            found[np.ix_(own, own)] &= np.minimum(between, len(loop) - between) > NEIGHBOURS
        return found

    def reach(self) -> np.ndarray:
        """Largest penetration in contact of every point near every other one, mm, shape (k, k).

        Half of the thinnest wall with sides that may touch, and half of the nominal distance of two
        points that lie behind each other, such as those on both sides of a convex corner; infinite
        where there is neither.
        """
        x = self.nominal[self.where.of_particles]
        normal = outward(x, self.ring)
        # j lies behind i and i behind j
        behind = np.einsum("ijc,jc->ij", x[:, None] - x, normal) < 0.0
        behind &= behind.T
        away = np.hypot(*np.moveaxis(x[:, None] - x, 2, 0))
        # opposite normals: two sides of one wall
        through = self.may_touch() & behind & (normal @ normal.T < 0.0)
        wall = 0.5 * away[through].min(initial=np.inf)
        return np.minimum(wall, np.where(behind, 0.5 * away, np.inf))

    def pairs(self):
        """Return the pairs of points with the points of segments that they may touch, and of those
        points with each other."""
        ring, allowed = self.ring, self.may_touch()
        every = np.arange(len(allowed))
        reached = allowed.copy()
        for by in range(-4, 5):  # two segments to either side of the nearest point
            reached |= allowed[:, ring.step(every, by)]
        near = reached.any(axis=0)
        for by in range(1, NODES - 1):
            reached[every, ring.step(every, by)] |= near
        return np.argwhere(reached)

    def on(self, discretization, index) -> "SelfContactTerm":
        """Build the term for one design."""
        self.law.require_penalties(self.label)
        return SelfContactTerm(self, discretization, index)


class SelfContactTerm(CoupledTerm):
    """``SelfContact`` of one design; forces are those in the residual."""

    history_size = 3
    touches_itself = True

    def __init__(self, definition: SelfContact, discretization, index: int):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, index
        )
        self.complete_law = definition.law
        self.law = definition.law._replace(
            normal_penalty=SHARED * definition.law.normal_penalty,
            tangent_penalty=SHARED * definition.law.tangent_penalty,
        )
        self.reach, self.allowed = definition.reach(), definition.may_touch()
        self.edge_of, self.pair_of = definition.edge_of, definition.pair_of
        self.ring = definition.ring
        # a point opposite must be this near to be followed before it touches
        length = float(self.where.lengths(discretization.particles).max())
        self.near = 4.0 * length
        size = float(np.abs(self.reference).max()) * discretization.depth
        # force w l g on a point with the largest tributary length l
        self.rounding = definition.law.normal_penalty * length * size
        self._direction, self._linearized = np.zeros(len(self.where), int), None

    @property
    def history_dependent(self) -> bool:
        """Whether forces depend on the history; without friction they do not."""
        return not self.law.frictionless

    @property
    def conservative(self) -> bool:
        """Whether forces have a potential, which is so without friction."""
        return self.law.frictionless

    def potential(self, d, response) -> float:
        points, gap = self.gaps(response.x)
        return self.law.potential(gap, self.length[points])

    def released_energy(self, step, before, d, response, target):
        # Pi(u) - Pi(u_n) of the normal penalty
        change = self.potential(d, response) - self.potential(step.d, before)
        gaps = np.full((2, len(self.where)), np.inf)
        for own, found in zip((before, response), gaps, strict=True):
            points, found_there = self.gaps(own.x)
            found[points] = found_there
        now, then = response.history, before.history
        # |t0| (xi - xi0)   Eq. (19)
        slip = then.variables[:, 1] * self.ring.coordinate_change(
            now.variables[:, 0], then.variables[:, 0]
        )
        known = (now.state != UNKNOWN) & (then.state != UNKNOWN)
        # bounds of the friction work over the increment
        most_lost = self.law.most_friction_work(
            np.where(known & np.isfinite(slip), slip, 0.0), gaps, self.length
        )
        least_lost = self.law.least_friction_work(then, now, self.length)
        return ReleasedEnergy(-change - most_lost, -change - least_lost, 0.0)

    def gaps(self, x):
        """Return the points (m,) with a segment opposite at positions ``x``, and their gaps, mm."""
        points, _, now = self._followed(x)
        return points, now.gap

    def begin(self, iteration=None):
        # direction of slip one iteration before; linearisation of mixed iterations
        self._direction[:], self._linearized = (0, None) if iteration is None else iteration

    @property
    def iteration(self):
        return self._direction.copy(), self._linearized

    def no_history(self) -> ContactHistory:
        k = len(self.where)
        return ContactHistory(np.full(k, UNKNOWN), np.zeros((k, 3)))

    # ---- search: nearest segment opposite to each point ----

    def _followed(self, x):
        """Find the points with a segment opposite, the points of the segment, and the kinematics."""
        # nearest allowed point with an opposite normal, e_n,i . e_n,j < 0
        normal = outward(x, self.ring)
        allowed = self.allowed & (normal @ normal.T < 0.0)
        square = ((x[:, None] - x) ** 2).sum(axis=2)
        square[~allowed] = np.inf
        nearest = square.argmin(axis=1)
        # only those near enough
        points = np.flatnonzero(square[np.arange(len(x)), nearest] < self.near**2)
        # closest point (x - x_c) . t = 0 on its segments
        segments, s, found = project(x, x[points], nearest[points], self.ring)
        points, segments, s = points[found], segments[found], s[found]
        nodes = np.column_stack([points, masters(segments, self.ring)])
        now = kinematics(x, nodes, segments, s, self.ring)
        # deeper is not penetration but the other side of the wall
        deep = now.gap > -self.reach[points, nearest[points]]
        return points[deep], nodes[deep], type(now)(*(part[deep] for part in now))

    def _before(self, points, now, history) -> Before:
        state = history.state[points]
        xi_0, size, carried = history.variables[points].T
        # xi - xi0, unknown after a change of wall: contact starts again
        change = self.ring.coordinate_change(now.xi, xi_0)
        lost = (state == UNKNOWN) | ~(np.abs(change) <= LARGEST_CHANGE)
        return Before(
            np.where(lost, UNKNOWN, state), np.where(lost, 0.0, change), np.where(lost, now.size, size),
            carried,
        )  # fmt: skip

    def law_at(self, gap, points, nodes) -> ContactLaw:
        """Return the law of one pass at gaps (m,): half of the limit at the complete pressure.

        Of a friction law by pairs of edges that of the points and the segments opposite.
        """
        law = self.complete_law
        if self.pair_of is not None:
            # of the edge where the segment begins, or where it ends if that edge may not touch
            own, first, last = (self.edge_of[p] for p in (points, nodes[:, 3], nodes[:, 4]))
            pairs = self.pair_of[own, first]
            pairs = np.where(pairs < 0, self.pair_of[own, last], pairs)
            law = law._replace(friction=law.friction.among(pairs))
        limits = law.at(gap).limits
        if limits is None:
            return self.law
        # d limit/dp stays: half of the limit by half of the pressure
        limits[:, :, 0] *= SHARED
        limits[:, :, 2:] *= SHARED
        return self.law._replace(friction=0.0, limits=limits)

    # ---- interface of a coupled term ----

    def respond(self, x, fraction, history) -> CoupledResponse:
        points, nodes, now = self._followed(x)
        return self._evaluate(x, points, nodes, now, np.zeros(len(points)), history)[0]

    def _evaluate(self, x, points, nodes, now, missed, history):
        """Evaluate the response with the law linearised at the gaps g - ``missed`` (m,),
        q = q(g - missed) + dq/dx missed e_n, and the arguments of ``resultants`` at these gaps."""
        normal, now = now.gap_1[:, :2], now._replace(gap=now.gap - missed)
        before, law = self._before(points, now, history), self.law_at(now.gap, points, nodes)
        # trial state, Eqs. (28), (29)
        found, forced_to_stick = self._without_reversal(points, touch(law, now, before))
        closed = found.state != OPEN
        # dq/du, and rows of the history
        local = linearized(law, now, before, found, self.length[points])
        force = np.zeros_like(x)
        # q(g - missed) + dq/dx missed e_n
        q = forces(law, now, before.size, found.tau, self.length[points])
        q += np.einsum("mai,mi->ma", local[:, :N_PLACES, :2], missed[:, None] * normal)
        np.add.at(force, nodes[closed], q[closed].reshape(-1, NODES, 2))
        loaded, branch = np.zeros(len(x), int), np.zeros(len(x), int)
        loaded[nodes[closed]], branch[points] = 1, found.state
        # sum of the 7 x 7 blocks of all points in contact
        pairs, tangent = _merged(nodes[closed], local[closed][:, :N_PLACES, :N_PLACES], len(x))
        response = CoupledResponse(
            x, force, loaded, pairs, tangent, np.empty((0, *x.shape)), np.empty(0), branch,
            self._carried_history(points, now, found), np.empty((1, 0)), forced_to_stick,
        )  # fmt: skip
        return response, (law, now.gap, before, found, self.length[points])

    # ---- mixed iterations ----

    def begin_mixed(self, step, response, target):
        # linearised as in the tangent of the step; slip has no direction yet
        x, (points, nodes, now) = response.x, self._followed(response.x)
        missed = np.zeros(len(points))
        _, at_gaps = self._evaluate(x, points, nodes, now, missed, step.before[self.index])
        self._direction[:] = 0
        self._linearize_at(x, points, nodes, now, missed, at_gaps)

    def add_mixed(self, d, raw, fraction, history, force, values):
        """The law linearised at the gaps that the last linearisation expects."""
        x, last = self.deformed(raw), self._linearized
        points, nodes, now = self._followed(x)
        missed = last.missed(x, points, now, self.ring)
        # the forces at x were asked for since
        self._direction[:] = last.direction
        response, at_gaps = self._evaluate(x, points, nodes, now, missed, history)
        self._linearize_at(x, points, nodes, now, missed, at_gaps)
        return self.assembled(response, force, values)

    def _linearize_at(self, x, points, nodes, now, missed, at_gaps):
        forces, slopes = resultants(*at_gaps)
        # q(g - missed) + dq/dg missed
        forces += slopes[:, :, 0] * missed[:, None]
        self._linearized = Linearization(
            x, points, nodes, now, self._direction.copy(), forces, slopes
        )

    def linear_contact(self, iteration, history):
        last = iteration[1]
        if not last.points.size:
            return None
        return LinearContact(self, last, self._before(last.points, last.kinematics, history))

    def _without_reversal(self, points, found: Touch):
        """Force points to stick whose slip would reverse from one Newton iteration to the next."""
        # direction of slip, 0 in stick
        sense = np.where(found.state == SLIP, np.sign(found.tau), 0).astype(int)
        turned = sense * self._direction[points] < 0
        self._direction[:] = 0
        self._direction[points] = np.where(turned, 0, sense)
        state = np.where(turned, STICK, found.state)
        # tau = w_t g_t in stick
        tau = np.where(turned, self.law.tangent_penalty * found.slip, found.tau)
        return Touch(state, tau, found.slip), int(turned.sum())

    def _carried_history(self, points, now, found) -> ContactHistory:
        history = self.no_history()
        history.state[points] = found.state
        # elastic slip tau / w_t of a closed point, gap of an open one
        carried = np.where(found.state == OPEN, now.gap, found.tau / self.law.tangent_penalty)
        history.variables[points] = np.column_stack([now.xi, now.size, carried])
        return history

    def linearize(self, response, fraction, history) -> LocalMap:
        points, nodes, now = self._followed(response.x)
        before, law = self._before(points, now, history), self.law_at(now.gap, points, nodes)
        found = touch(law, now, before)
        local = linearized(law, now, before, found, self.length[points])
        # dq/dw = SHARED dq/dw of one pass
        local[:, :, NORMAL_PENALTY : NORMAL_PENALTY + 2] *= SHARED
        return self._scattered(points, nodes, local)

    def _scattered(self, points, nodes, local) -> LocalMap:
        history, (x, carried, measure, parameters, reference) = self.rows[1], self.inputs
        places = (2 * nodes[:, :, None] + np.arange(2)).reshape(-1, N_PLACES)
        own = 3 * points[:, None] + np.arange(3)
        rows = np.column_stack([places, history.start + own])
        columns = np.column_stack([
            x.start + places, carried.start + own, measure.start + points,
            np.tile(np.arange(parameters.start, parameters.stop), (len(points), 1)),
        ])  # fmt: skip
        at = [np.broadcast_to(part, local.shape).ravel()
              for part in (rows[:, :, None], columns[:, None, :])]  # fmt: skip
        shape = self.rows[-1].stop, reference.stop
        sparse = coo_array((local.ravel(), tuple(at)), shape=shape).tocsr()
        return LocalMap(sparse, np.zeros((shape[0], 0)), np.zeros((0, shape[1])))

    def uses_history(self, following):
        if not self.history_dependent:
            return np.empty(0, int)
        return (3 * np.flatnonzero(following.branch)[:, None] + np.arange(3)).ravel()

    def kinks(self, response, fraction, history, following=None) -> Kinks:
        k = len(self.where)
        rounding = rounding_of(2.0 * float(np.abs(response.x).max()))
        now, state = response.history.variables, response.history.state
        if not ((state > OPEN) | ((state == OPEN) & (np.abs(now[:, 2]) <= rounding))).any():
            return no_kinks(k)
        points, nodes, at = self._followed(response.x)
        before = self._before(points, at, history)
        found = np.empty(points.size, np.int64)
        variables = np.column_stack([at.xi - before.change, before.size, before.carried])
        law = self.law_at(at.gap, points, nodes)
        find_kinks(0.0, law, at.gap, at.xi, before.state, variables, rounding, found)
        touching = points[found == TOUCHING]
        # walls that touch are taken to slide on each other
        forces, slips = np.zeros((touching.size, k, 2)), np.ones(touching.size, bool)
        return Kinks(touching, forces, slips, points[found == LIMIT])

    # ---- the path ----

    def check_start(self, response):
        if response.branch.any():
            x, y = response.x[int(np.flatnonzero(response.branch)[0])]
            raise GeometryError(
                f"the undeformed section already overlaps itself near x = {x:.4g}, y = {y:.4g} "
                f"({self.label!r}); draw the section with a gap between its walls, or name fewer "
                "edges in [self_contact]"
            )


def _merged(nodes, tangent, k):
    """Pairs of points (p, 2) and their summed tangents (p, 2, 2), from those (m, 14, 14) of m points
    with their segments."""
    m = len(nodes)
    # key k i + j of the pair (i, j)
    keys = (nodes[:, :, None] * k + nodes[:, None, :]).ravel()
    blocks = tangent.reshape(m, NODES, 2, NODES, 2).transpose(0, 1, 3, 2, 4).reshape(-1, 2, 2)
    unique, at = np.unique(keys, return_inverse=True)
    summed = np.zeros((unique.size, 2, 2))
    np.add.at(summed, at, blocks)
    return np.column_stack(np.divmod(unique, k)), summed
