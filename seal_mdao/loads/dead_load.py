"""Dead loads: forces at material points with a fixed direction, and their derivatives, Eq. (47)."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.terms.point_term import PointResponse, PointTerm
from seal_mdao.terms.points import MaterialPoints
from seal_mdao.terms.ramp import at_ends, at_fraction
from seal_mdao.terms.term import ReleasedEnergy, Scalar, TermDefinition

COMPONENTS = ("x", "y")
_NO_TANGENT = np.empty(0)


@dataclass(frozen=True, eq=False)
class DeadLoad(TermDefinition):
    """Dead load: a force per measure of every point (a traction where the measure is a length).

    Attributes
    ----------
    label : str
    where : MaterialPoints
    density : ndarray, shape (2,) or (k, 2)
        Force per measure, at a ramp of 1. One for all points has the parameters ``label_x`` and
        ``label_y``; forces of single points have none.
    ramp : ndarray, shape (n_steps + 1,)
        Multiplier at the start and after every nominal step; linear between.
    """

    label: str
    where: MaterialPoints
    density: np.ndarray
    ramp: np.ndarray
    couples = False

    @property
    def scalars(self) -> dict:
        """Parameters: the components of a common density."""
        if np.ndim(self.density) > 1:
            return {}
        return {
            f"{self.label}_{component}": Scalar(
                float(value), None, f"Load {self.label!r}, {component}."
            )
            for component, value in zip(COMPONENTS, self.density, strict=True)
        }

    def with_parameters(self, values: dict) -> "DeadLoad":
        """Return the load with components of its density changed."""
        if not values:
            return self
        changed = {name: scalar.value for name, scalar in self.scalars.items()} | values
        return replace(self, density=np.array([changed[name] for name in self.scalars]))

    def with_ends(self, ends) -> "DeadLoad":
        """Return the load with its ramp for other load steps."""
        return replace(self, ramp=at_ends(np.asarray(self.ramp, float), ends))

    def point_set(self):
        """Return the loaded points."""
        return self.where.points

    def on(self, discretization, index) -> "DeadLoadTerm":
        """Build the term for one design."""
        return DeadLoadTerm(self, discretization, index)


class DeadLoadTerm(PointTerm):
    """Residual term of a ``DeadLoad`` for one design; the load enters the residual with a minus sign."""

    def __init__(self, definition: DeadLoad, discretization, index: int):
        super().__init__(
            definition.label, definition.scalars, definition.where, discretization, index
        )
        self.ramp = np.asarray(definition.ramp, float)
        self.density = np.broadcast_to(definition.density, (len(self.where), 2)).astype(float)
        self._none = np.zeros((len(self.where), 2, 2)), np.ones(len(self.where), np.int64)

    conservative = True

    def potential(self, d, response) -> float:
        # Pi = -sum_i f_i . u_i;  response.force holds -f_i
        return float(np.sum(response.force * (response.x - self.reference)))

    def released_energy(self, step, before, d, response, target):
        # Pi changes by sum_i (R_i - R_i^0) . u_i while the load grows at fixed u: with u before and
        # after the step; released is the smaller or the larger one minus the change of Pi
        grown = response.force - before.force
        works = [float(np.sum(grown * (own.x - self.reference))) for own in (before, response)]
        change = self.potential(d, response) - self.potential(step.d, before)
        return ReleasedEnergy(min(works) - change, max(works) - change, max(map(abs, works)))

    def _force(self, fraction) -> np.ndarray:
        # R_i = -lambda(s) L_i q_i
        return -at_fraction(self.ramp, fraction) * self.length[:, None] * self.density

    def add(self, d, raw, fraction, history, force, values):
        # dR/du = 0: no tangent is assembled, which saves time for many points
        return super().add(d, raw, fraction, history, force, _NO_TANGENT)

    def respond(self, x, fraction, history):
        tangent, branch = self._none
        return PointResponse(x, self._force(fraction), tangent, branch, None, np.empty((len(x), 0)))

    def linearize(self, response, fraction, history, points):
        # l'_V(z-bar) = sum_i z-bar_i . (lambda L_i q_i)'   Eq. (47), with R = -l: columns x (zero), L, q
        out, size = np.zeros((points.size, *self.local_shape)), at_fraction(self.ramp, fraction)
        out[:, :, 2] = -size * self.density[points]
        if self.names:
            out[:, 0, 3] = out[:, 1, 4] = -size * self.length[points]
        return out

    def changes(self, step, response, target):
        # dR = R(s_target) - R(s), independent of u
        change = self._force(target) - response.force
        return [self.point_loads(change, response.branch)]
