"""Measure of the force of the seal on a profile or its supports, at the end or at chosen travels."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.errors import LoadPathError
from seal_mdao.geometry.motion import ROUNDING
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.support_force import add_support_partials, supports_of_edges
from seal_mdao.values import numbers, real

TRAVEL = "travel"
"""Direction of a reaction: opposite to the travel of the profile."""


@dataclass(frozen=True)
class Reaction(Measure):
    """Force of the seal on a profile, or on fixed or moved edges, at the end of the path or at travels.

    The force on a profile includes that of edges that are bonded to it.

    Between load steps the force is interpolated linearly; the derivatives are those of the interpolated
    value, also where a parameter of the motion changes when a travel is reached.

    Attributes
    ----------
    profile : str
        Label of a profile or of moved edges; "" with ``edges``.
    travels : tuple of float, or None
        Travel of the profile along its path, mm, counted from ``Seal.before_touch``; None for the end
        of the path. For a profile without travel it is that of the first profile that travels.
    components : tuple of int
        0 horizontal, 1 vertical; in this order at every travel.
    direction : pair of float, "travel", or None
        In place of the components: the force along this direction, of any length, or opposite to the
        travel of the profile there, positive where the seal resists.
    length : float, or None
        Length of the seal, mm, for a force in N; None for the force per length, N/m.
    edges : tuple of str
        In place of a profile: names of edges, on whose prescribed components the force acts.

    Raises
    ------
    ValueError
        For travels that are no numbers from zero on, other components, a direction of length zero, a
        length that is not positive.
    """

    profile: str
    travels: tuple | None = None
    components: tuple = (0, 1)
    direction: tuple | str | None = None
    length: float | None = None
    edges: tuple = ()
    name: str = "reaction"
    units = "N/m"
    text = "Force of the seal on the profile: horizontal, vertical."

    def __post_init__(self):
        given = () if self.travels is None else self.travels
        travels = numbers(f"travels of {self.name!r}", given).ravel()
        if self.travels is not None:
            object.__setattr__(self, "travels", tuple(travels.tolist()))
        if not all(0.0 <= travel < np.inf for travel in travels):
            raise ValueError(
                f"travels of {self.name!r} must be numbers from 0 mm on, got {travels}"
            )
        if not self.components or not {*self.components} <= {0, 1}:
            raise ValueError(
                f"components of {self.name!r} must be 0 (horizontal) or 1 (vertical), got "
                f"{self.components}"
            )
        object.__setattr__(self, "direction", self._unit_direction())
        if self.length is not None:
            real(f"length of {self.name!r}", self.length, above=0.0)
            object.__setattr__(self, "units", "N")
        on = f"the edges {', '.join(self.edges)}" if self.edges else "the profile"
        object.__setattr__(self, "text", f"Force of the seal on {on}{self._what}.")

    @property
    def _what(self) -> str:
        """Where on the path and in which directions, in words."""
        at = "" if self.travels is None else " at travels along its path"
        if self.direction is not None:
            return at + (" against its travel" if self.direction == TRAVEL else " in a direction")
        return f"{at}: {', '.join(('horizontal', 'vertical')[i] for i in self.components)}"

    def _unit_direction(self) -> tuple | str | None:
        text = isinstance(self.direction, str)
        if self.direction is None or (text and self.direction == TRAVEL):
            return self.direction
        # normalised: the value is a force, whatever the length of the given vector
        vector = np.zeros(2) if text else numbers(f"direction of {self.name!r}", self.direction)
        size = np.linalg.norm(vector)
        if vector.shape != (2,) or not 0.0 < size < np.inf:
            raise ValueError(
                f"direction of {self.name!r} must be two numbers that are not both zero, or "
                f"{TRAVEL!r}, got {self.direction!r}"
            )
        return tuple((vector / size).tolist())

    @property
    def scale(self) -> float:
        """Factor from N/m to the unit of the value."""
        return 1.0 if self.length is None else 1e-3 * self.length

    @property
    def _rows(self) -> int:
        """Number of values per travel."""
        return len(self.components) if self.direction is None else 1

    def size(self, seal):
        return self._rows * (1 if self.travels is None else len(self.travels))

    def evaluate(self, result, partials):
        steps, motion = result.path.nominal_steps, self._motion(result)
        if self.travels is None:
            requested = [(motion.travel, float(len(steps)), np.zeros(len(motion.names)))]
        else:
            self._check_reached(result, motion)
            # travels are counted from the first touch of the nominal seal, where that is known
            before = result.seal.before_touch
            counted = [before + travel for travel in self.travels]
            requested = [(travel, *motion.at_travel(travel)) for travel in counted]
        parts = [
            self._interpolated(result, partials, row * self._rows, motion, *point)
            for row, point in enumerate(requested)
        ]
        return np.concatenate(parts)

    def curve(self, result) -> tuple[np.ndarray, np.ndarray]:
        """Return the load-deflection curve: travels (n + 1,), mm, and forces (n + 1,) in the unit of the
        value, at the start and at n nominal steps; along the first component, if there are two."""
        motion, forces = self._motion(result), self.forces(result)
        # counted from the first touch
        travels = motion.travels[: len(forces) + 1]
        # F_k = e_k . R_k, zero at the start
        units = [self._directions(motion, travel)[0][0] for travel in travels[1:]]
        values = [self.scale * (e @ force) for e, force in zip(units, forces, strict=True)]
        return travels - result.seal.before_touch, np.append(0.0, values)

    def _motion(self, result):
        """Return the motion of the profile, or of the first profile that travels if it does not."""
        problem = result.path.problem
        moving = (*problem.terms, *getattr(problem.imposed, "edges", ()))
        motions = {own.label: own.motion for own in moving if hasattr(own, "motion")}
        found = motions.get(self.profile, next(iter(motions.values())))
        if found.travel > 0.0:
            return found
        return next((motion for motion in motions.values() if motion.travel > 0.0), found)

    def least_scale(self, result):
        # a component may vanish: the complete force is the reference
        return self.scale * float(np.abs(self.forces(result)).max(initial=0.0))

    def forces(self, result) -> np.ndarray:
        """Compute the force at every nominal step, shape (n_steps, 2), N/m."""
        forces = [self._force(result, step) for step in result.path.nominal_steps]
        return np.array(forces).reshape(-1, 2)

    def _supports(self, result) -> np.ndarray:
        """Find the prescribed components on which the force acts, a mask (n, 2)."""
        problem = result.path.problem
        if self.edges:
            return supports_of_edges(problem, self.edges)
        return problem.supports_of(self.profile)

    def _touches(self, result) -> bool:
        """Whether the profile has contact points; moved edges have none."""
        terms = result.path.problem.terms
        return not self.edges and any(term.label == self.profile for term in terms)

    def _force(self, result, step) -> np.ndarray:
        """Compute the force at a converged step, shape (2,), N/m."""
        if self.edges:
            return result.path.support_force(self._supports(result), step)
        return result.path.force(self.profile, step)

    def _add_partials(self, result, partials, step, rows, directions) -> None:
        """Add the derivatives of e . F at a step for directions e (r, 2)."""
        supports = self._supports(result)
        if self._touches(result):
            partials.force(self.profile, step)[rows] += directions[:, None]
        if supports.any():
            weights = np.where(supports, directions[:, None], 0.0)
            add_support_partials(partials, step, rows, weights)

    def _check_reached(self, result, motion) -> None:
        end = motion.travel - result.seal.before_touch
        farthest = max(self.travels, default=0.0)
        if farthest > end + ROUNDING * motion.travel:
            raise LoadPathError(
                f"measure {self.name!r} is requested at {farthest:.6g} mm of travel, and the motion of "
                f"{self.profile or 'the first profile'!r} ends at {end:.6g} mm; choose other travels, "
                "or a longer motion",
                result,
            )

    def _directions(self, motion, travel) -> tuple[np.ndarray, np.ndarray]:
        """Compute the directions (r, 2) of the forces at a travel, and their derivatives (m, r, 2) with
        respect to the m parameters of the motion."""
        if self.direction == TRAVEL:
            unit, rates = travel_direction(motion, travel)
            return -unit[None], -rates[:, None]
        fixed = np.eye(2)[list(self.components)]
        if self.direction is not None:
            fixed = np.array([self.direction])
        return fixed, np.zeros((len(motion.names), *fixed.shape))

    def _interpolated(self, result, partials, row, motion, travel, fraction, rates) -> np.ndarray:
        """Interpolate the values after ``fraction`` nominal steps, at ``travel``; ``rates`` are the
        derivatives of the fraction with respect to the parameters of the motion."""
        # F = (1 - w) F_k + w F_(k+1),  w = fraction - k,  dF/d(fraction) = F_(k+1) - F_k
        steps = result.path.nominal_steps
        directions, turns = self._directions(motion, travel)
        directions, turns = self.scale * directions, self.scale * turns
        first, force, change = min(int(fraction), len(steps) - 1), np.zeros(2), np.zeros(2)
        rows = row + np.arange(self._rows)
        for number, weight, sign in (
            (first, 1.0 - (fraction - first), -1.0),
            (first + 1, fraction - first, 1.0),
        ):
            if number == 0:  # no contact at the start: F_0 = 0
                continue
            # weights 1 - w of F_k and w of F_(k+1)
            step = steps[number - 1]
            total = self._force(result, step)
            force, change = force + weight * total, change + sign * total
            if weight != 0.0:
                self._add_partials(result, partials, step, rows, weight * directions)
        # m = e . F:  dm/dp = e . (F_(k+1) - F_k) d(fraction)/dp + F . de/dp
        for name, rate, turn in zip(motion.names, rates, turns, strict=True):
            if rate != 0.0 or turn.any():
                partials.parameter(name)[rows] += rate * (directions @ change) + turn @ force
        return directions @ force


def travel_direction(motion, travel: float) -> tuple[np.ndarray, np.ndarray]:
    """Compute the unit vector (2,) of the motion of a profile at a travel, and its derivatives (m, 2)
    with respect to the m parameters of the motion; zero for a profile that does not travel."""
    chords, rates = np.diff(motion.positions, axis=0), np.diff(motion.rates[:, :, :2], axis=1)
    lengths = np.hypot(*chords.T)
    ends = np.cumsum(lengths)
    if not ends[-1] > 0.0:
        return np.zeros(2), np.zeros((len(motion.names), 2))
    stage = int(np.searchsorted(ends, min(travel, ends[-1])))
    stage = stage if lengths[stage] > 0.0 else int(np.flatnonzero(lengths)[0])
    # e = d / |d|,  e' = (d' - (d' . e) e) / |d|  for the chord d of the stage
    unit, rate = chords[stage] / lengths[stage], rates[:, stage]
    return unit, (rate - np.outer(rate @ unit, unit)) / lengths[stage]
