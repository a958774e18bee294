"""Frictional contact of boundary points with one rigid profile, as a term: b(z, z-bar), Eq. (29)."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.contact.friction import (
    CARRIED,
    GAP,
    OPEN,
    OTHER_LAWS,
    SLIP,
    XI,
    ContactHistory,
    ContactLaw,
    no_history,
    uses_history,
)
from seal_mdao.contact.kinematics import coordinate_change, linearized_positions, normal_gaps
from seal_mdao.contact.kinks import (
    LIMIT,
    SLIGHT,
    TOUCHING,
    Kinks,
    find_kinks,
    no_kinks,
    rounding_of,
)
from seal_mdao.contact.rigid_forces import (
    PASSED,
    contact_linearization,
    contact_points,
    slip_slopes,
)
from seal_mdao.errors import GeometryError
from seal_mdao.geometry.curve import ARC, has_cubics
from seal_mdao.geometry.motion import Cached, Motion
from seal_mdao.geometry.pose import quarter_turn, rigid_velocity
from seal_mdao.geometry.shape import Shape
from seal_mdao.terms.linearization import CarriedDirections, directions_of
from seal_mdao.terms.point_term import PointResponse, PointTerm
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.term import ReleasedEnergy, Scalar, TermDefinition

SLACK = 0.01
"""Fraction of its length by which a mean over edges may start inside a profile that touches the body."""


@dataclass(frozen=True, eq=False)
class RigidContact(TermDefinition):
    """Contact of boundary points with a moving rigid profile.

    Attributes
    ----------
    label : str
        Name of the profile.
    where : MaterialPoints
    shape : Shape
    motion : Motion
        Its parameters count from its waypoints: they are zero.
    law : ContactLaw
    prefix : str
        Put before the names of all parameters but those of the motion.

    Raises
    ------
    ValueError
        For a penalty that is not positive, a negative friction coefficient, or one that is no number;
        for a constant of the friction law with the name of a shape parameter.
    """

    label: str
    where: MaterialPoints
    shape: Shape
    motion: Motion
    law: ContactLaw
    prefix: str = ""

    def __post_init__(self):
        self.law.check(self.label)
        for name in set(self.law.scalars) & set(self.shape.names):
            raise ValueError(
                f"the name {name!r} is used for a constant of the friction law and for a shape "
                f"parameter of {self.label!r}; rename one of them"
            )

    @property
    def scalars(self) -> dict:
        """Penalties and constants of the friction law, shape, motion."""
        law = {self.prefix + name: scalar for name, scalar in self.law.scalars.items()}
        shape = {
            self.prefix + name: Scalar(float(getattr(self.shape, name)), "mm", f"Profile: {name}.")
            for name in self.shape.names
        }
        motion = {
            name: Scalar(0.0, self.motion.unit(name), f"Motion: {name}.")
            for name in self.motion.names
        }
        return law | shape | motion

    def with_parameters(self, values: dict) -> "RigidContact":
        """Return the contact with some of its parameters changed."""
        own = {name.removeprefix(self.prefix): value for name, value in values.items()}
        shape = {name: own[name] for name in self.shape.names if name in own}
        motion = {name: values[name] for name in self.motion.names if name in values}
        return replace(
            self, law=self.law.with_parameters(own),
            shape=replace(self.shape, **shape) if shape else self.shape,
            motion=self.motion.moved(motion),
        )  # fmt: skip

    def with_ends(self, ends) -> "RigidContact":
        """Return the contact with other load steps of its motion."""
        return replace(self, motion=self.motion.with_ends(ends))

    def point_set(self):
        """The points that may touch."""
        return self.where.moving

    def on(self, discretization, index) -> "ContactTerm":
        """Build the term for one design."""
        self.law.require_penalties(self.label)
        return ContactTerm(self, discretization, index)


class ContactResponse(PointResponse):
    """Contact forms of all points; ``branch`` is OPEN, STICK or SLIP."""

    __slots__ = ()

    @property
    def gap(self) -> np.ndarray:
        """Normal gaps g_n, negative in penetration, shape (k,)."""
        return self.outputs[:, 0]

    @property
    def state(self) -> np.ndarray:
        """OPEN, STICK or SLIP, shape (k,)."""
        return self.branch


class ContactTerm(PointTerm):
    """``RigidContact`` of one design. Forces are those of the body on the profile."""

    history_size = 3
    output_names = ("gap",)

    def __init__(self, definition: RigidContact, discretization, index: int):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, index
        )
        self.profile = definition.shape.profile()
        self.curve = self.profile.curve
        self.motion, self.law = definition.motion, definition.law
        k = len(self.where)
        self._force, self._tangent = np.empty((k, 2)), np.empty((k, 2, 2))
        self._state, self._variables = np.empty(k, np.int64), np.empty((k, 3))
        self._gap, self._previous = np.empty((k, 1)), np.zeros(k, np.int64)
        self._through_slip = False
        # both sweeps come back to the steps of the path
        self.pose = Cached(self.motion.pose)
        self.motion_rates = Cached(self.motion.rates_at)
        self._linearized = ()
        self._speed_varies = has_cubics(self.profile)
        size = float(np.abs(discretization.particles).max())
        # the gap of an arc is |x - m| - r, with the rounding error of r where r is large
        largest = np.abs(self.profile.radius[self.profile.kind == ARC]).max(initial=size)
        # force w l g on a point with the largest tributary length l
        length = float(self.where.lengths(discretization.particles).max(initial=0.0))
        self.rounding = self.law.normal_penalty * length * float(largest) * discretization.depth
        # deformed coordinates, and those of the profile without its pose
        self._size = 2.0 * size + float(np.abs(self.curve.origin).max())

    @property
    def history_dependent(self) -> bool:
        """Only friction depends on the history."""
        return not self.law.frictionless

    @property
    def conservative(self) -> bool:
        return self.law.frictionless

    @property
    def begins_at(self) -> float:
        return self.motion.begins_at

    def potential(self, d, response) -> float:
        return self.law.potential(response.gap, self.length)

    def begin(self, iteration=None):
        # states one iteration before; linearisation of mixed iterations
        first = (0, False, ())
        self._previous[:], self._through_slip, linearized = (
            first if iteration is None else iteration
        )
        self._linearized = tuple(part.copy() for part in linearized)

    @property
    def iteration(self):
        linearized = tuple(part.copy() for part in self._linearized)
        return self._previous.copy(), self._through_slip, linearized

    def through_slip(self, cycle):
        previous, _, linearized = cycle[-1]
        # states of all points in the iterations; of mixed ones at their linearised places
        states = [places[-1] if places else own for own, _, places in cycle]
        return (previous, True, linearized) if np.any(np.array(states) == PASSED) else None

    def no_history(self) -> ContactHistory:
        return no_history(len(self.where))

    def gaps(self, x: np.ndarray, fraction: float) -> np.ndarray:
        """Compute the normal gaps (m,) at positions ``x`` (m, 2) after ``fraction`` nominal steps."""
        gap = np.empty(len(x))
        normal_gaps(self.curve, self.pose(fraction), np.ascontiguousarray(x), gap)
        return gap

    def respond(self, x, fraction, history) -> ContactResponse:
        # forces, tangents and states of all points, Eqs. (28), (29), (35), (36)
        changed = contact_points(
            self.curve, self._law_at(x, fraction), self.pose(fraction), x, self.length, history,
            self._previous, self._through_slip, self._force, self._tangent, self._state, self._variables,
            self._gap[:, 0],
        )  # fmt: skip
        return ContactResponse(
            x, self._force, self._tangent, self._state, ContactHistory(self._state, self._variables),
            self._gap, changed,
        )  # fmt: skip

    def _law_at(self, x, fraction) -> ContactLaw:
        """The law at points x (k, 2); Coulomb's needs no gaps."""
        if not isinstance(self.law.friction, OTHER_LAWS):
            return self.law
        return self.law.at(self.gaps(x, fraction))

    # ---- mixed iterations ----

    def begin_mixed(self, step, response, target):
        """The points of the step, with their gaps there, relative to the profile at ``target``."""
        x, pose = response.x, self.pose(step.fraction)
        place, normal, gap = x.copy(), np.zeros_like(x), np.zeros(len(x))
        linearized_positions(self.curve, pose, x, place, normal, gap)
        # places move with the profile to its pose at ``target``
        moved = self.motion.coordinates(target) - self.motion.coordinates(step.fraction)
        # places z, normals, gaps, and states one mixed iteration before
        not_yet = np.zeros_like(self._previous)
        self._linearized = place + rigid_velocity(pose, x) @ moved, normal, gap, not_yet

    def begin_near(self, d, target, known):
        """The points at displacements ``d``, with the gaps ``known`` (k,) that their pressure needs."""
        if known is None:
            return self.begin(None)
        x = self.deformed(self.discretization.transformation.coefficients(d)).copy()
        pose = self.pose(target)
        place, normal, gap = x.copy(), np.zeros_like(x), np.zeros(len(x))
        linearized_positions(self.curve, pose, x, place, normal, gap)
        # as if linearised beside x along the tangent, where the gap is the known one
        across = np.column_stack([-normal[:, 1], normal[:, 0]])
        place = x - self._size * across
        self._linearized = place, normal, known.copy(), np.zeros_like(self._previous)

    def add_mixed(self, d, raw, fraction, history, force, values):
        """The law linearised at the places z whose gaps the last linearisation expects: with x - z
        along the normal, f = f(z) + T(z) (x - z). Points are open, stick and slip as they do at z, so
        one that touches there is pulled back where x has a small positive gap."""
        x, (*linearized, previous) = self.deformed(raw), self._linearized
        place = linearized[0]
        linearized_positions(self.curve, self.pose(fraction), x, *linearized)
        # the forces at x were asked for since, where the point may be open
        self._previous[:] = previous
        # f(z) + T(z) (x - z)
        response = self.respond(place, fraction, history)
        self._linearized = *linearized, self._previous.copy()
        response.force[:] += np.einsum("kij,kj->ki", response.tangent, x - place)
        return self.assembled(response._replace(x=x), force, values)

    # ---- the contract of a term at single points ----

    def linearize(self, response, fraction, history, points):
        out = np.empty((points.size, *self.local_shape))
        # derivatives of force and history with respect to all inputs of a point
        contact_linearization(
            self.profile, self.curve, self.law.at(response.gap), self.pose(fraction),
            self.motion_rates(fraction), response.x, self.length, response.force, history, points, out,
        )  # fmt: skip
        return out

    def kinks(self, response, fraction, history, following=None) -> Kinks:
        rounding = rounding_of(self._size + float(np.abs(self.pose(fraction).position).max()))
        found = np.empty(len(self.where), np.int64)
        if not find_kinks(
            self.curve.period, self.law.at(response.gap), response.gap, response.history.variables[:, 0],
            history.state, history.variables, rounding, found,
        ):  # fmt: skip
            return no_kinks(found.size)
        touching = np.flatnonzero(found == TOUCHING)
        # |g_t| of this step compared with |g_n0|
        slips = np.abs(self._slid(response, history)) > SLIGHT * np.abs(history.variables[:, 2])
        if following is not None:
            # and of the next one with its gap
            after = self._slid(following, response.history)
            slips |= np.abs(after) > SLIGHT * np.abs(following.gap)
        forces = np.zeros((touching.size, *response.x.shape))
        if touching.size:  # w_n l e_n, e_n the derivative of the gap
            normal = self.linearize(response, fraction, history, touching)[:, GAP, :2]
            weight = self.law.normal_penalty * self.length[touching]
            forces[np.arange(touching.size), touching] = weight[:, None] * normal
        return Kinks(touching, forces, slips[touching], np.flatnonzero(found == LIMIT))

    def _slid(self, response, history) -> np.ndarray:
        """|t0| (xi - xi0) of all points in a step, mm."""
        # |t0| (xi - xi0)   Eq. (19)
        change = response.history.variables[:, 0] - history.variables[:, 0]
        if self.curve.period:
            change -= self.curve.period * np.floor(change / self.curve.period + 0.5)
        return history.variables[:, 1] * change

    # ---- history carried to the next step ----

    def uses_history(self, following):
        return np.flatnonzero(uses_history(self._speed_varies, following.branch))

    def carried_directions(self, response, following, local, used) -> CarriedDirections:
        """Return the carried history as directions: the next step depends on one function of it, the
        elastic slip; where |t| varies on two, the natural coordinate (with |t0|) and the elastic slip.
        """
        if self._speed_varies:
            slopes = local[:, XI : CARRIED + 1 : 2, :2]
            slopes[following.branch[used] == SLIP, 1] = 0.0
            return directions_of(used, slopes)
        of_slip = np.zeros((used.size, 2, 2))
        slip_slopes(
            self.curve, used, response.history, following.history.variables[:, 0], following.gap,
            local, of_slip,
        )  # fmt: skip
        return directions_of(used, of_slip)

    # ---- the path ----

    def check_start(self, response):
        gap = own = response.gap
        slack = 0.0
        if self.where.averages is not None:
            # means lie beside the curve by less than the slack; inside are those whose particles are
            slack = SLACK * self.where.lengths(self.discretization.particles)
            points = self.where.points.at(self.discretization.particles)
            own = self.gaps(points, self.begins_at)
            slack = np.where(own < 0.0, 0.0, slack)
        if np.any(gap < -slack):
            raise GeometryError(
                f"the undeformed seal overlaps the rigid profile {self.label!r} by "
                f"{-min(gap.min(), own.min()):.3g} mm at the start; move the profile away by at "
                "least this distance (start of the door seal; of a seal file its start, or the "
                f"parameters {self.label}_x and {self.label}_y)"
            )

    def changes(self, step, response, target):
        """The force depends on the place relative to the profile only, so its rate with the motion is
        minus its tangent. With the incremental history slip starts again from zero. Where a point
        slides on, its friction is back at once; where it does not, the force jumps to that at the
        old place with the new history. Both are predicted then.
        """
        moved = self._moved(response, step.fraction, target)
        if self.law.accumulated:
            return [self.point_loads(moved, response.branch)]
        jump = self._force_again(response, step.fraction) - response.force
        return [self.point_loads(change, response.branch) for change in (moved + jump, moved)]

    def released_energy(self, step, before, d, response, target):
        # work of the profile: forces at both ends of the increment times its motion
        works = [
            self._loading_work(own, at, step.fraction, target)
            for own, at in ((before, step.fraction), (response, target))
        ]
        change = self.potential(d, response) - self.potential(step.d, before)
        gaps, slip = (before.gap, response.gap), np.zeros(len(self.where))
        for i in np.flatnonzero(np.minimum(*gaps) < 0.0) if self.history_dependent else ():
            now, then = response.history.variables[i], before.history.variables[i]
            # |t0| (xi - xi0)   Eq. (19)
            slip[i] = then[1] * coordinate_change(self.curve, now[0], then[0])
        most_lost = self.law.most_friction_work(slip, gaps, self.length)
        least_lost = self.law.least_friction_work(before.history, response.history, self.length)
        return ReleasedEnergy(
            min(works) - change - most_lost, max(works) - change - least_lost,
            max(map(abs, works)),
        )  # fmt: skip

    def _loading_work(self, response, at, fraction, target) -> float:
        """Work of the forces of ``response``, with the profile at ``at``, on its motion, mJ/m."""
        change = self.motion.coordinates(target) - self.motion.coordinates(fraction)
        if change[2] == 0.0:
            # -F . dx of a translation
            return -float(response.total @ change[:2])
        return -float(np.sum(response.force * (rigid_velocity(self.pose(at), response.x) @ change)))

    def _moved(self, response, fraction, target) -> np.ndarray:
        """Change of the forces (k, 2) at fixed x when the profile advances."""
        change = self.motion.coordinates(target) - self.motion.coordinates(fraction)
        if change[2] == 0.0:
            return -np.einsum("kij,j->ki", response.tangent, change[:2])
        # df = -K dx, and the force turns with the profile
        shift = rigid_velocity(self.pose(fraction), response.x) @ change
        moved = -np.einsum("kij,kj->ki", response.tangent, shift)
        return moved + change[2] * quarter_turn(response.force)

    def _force_again(self, response, fraction) -> np.ndarray:
        """Compute the forces (k, 2) at the same positions with the history after the step."""
        k = len(self.where)
        force = np.empty((k, 2))
        contact_points(
            self.curve, self.law.at(response.gap), self.pose(fraction), response.x, self.length,
            response.history, np.zeros(k, np.int64), False, force, np.empty((k, 2, 2)),
            np.empty(k, np.int64), np.empty((k, 3)), np.empty(k),
        )  # fmt: skip
        return force

    def describe(self, response, fraction):
        x, y = self.pose(fraction).position
        return (
            f"{self.label} at x = {x:.4g}, y = {y:.4g}, {int(np.sum(response.branch != OPEN))} points "
            f"in contact, {int(np.sum(response.branch == SLIP))} slipping"
        )
