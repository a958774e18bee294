"""Measure of the force of the seal on a profile or its supports, at chosen points of the path."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from seal_mdao.errors import LoadPathError
from seal_mdao.geometry.motion import ROUNDING, path_motion
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.support_force import add_support_partials, supports_of_edges
from seal_mdao.values import numbers, real

TRAVEL = "travel"
"""Direction of a reaction: opposite to the travel of the profile."""


@dataclass(frozen=True)
class Reaction(Measure):
    """Force of the seal on a profile, or on fixed or moved edges: at the end of the path, at travels, at
    the ends of stages or at times.

    The force on a profile includes that of edges that are bonded to it.

    A force at a time beyond the end of the path is not a number. Between load steps the force is
    interpolated linearly; the derivatives are those of the interpolated value, also where a parameter
    of the motion, or a duration, changes when a travel or a time is reached.

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
    stages : tuple of int, or None
        In place of travels: at the ends of these stages of the path, from 1 on.
    times : tuple of float, or None
        In place of travels: at these times of a body that relaxes, s.

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
    stages: tuple | None = None
    times: tuple | None = None
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
                f"the travels at which the measure {self.name!r} is evaluated must be finite and "
                f"at least 0 mm, got {travels}"
            )
        if not self.components or not {*self.components} <= {0, 1}:
            raise ValueError(
                f"the force components of the measure {self.name!r} must be 0 (horizontal) or 1 "
                f"(vertical), got {self.components}"
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
        places = (
            (self.travels, " at travels along its path"),
            (self.stages, " at the ends of stages"),
            (self.times, " at times"),
        )
        at = next((text for given, text in places if given is not None), "")
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
                f"the direction of the force of the measure {self.name!r} must be two numbers that "
                f"are not both zero, or {TRAVEL!r}, got {self.direction!r}"
            )
        return tuple((vector / size).tolist())

    @property
    def scale(self) -> float:
        """Factor from N/m to the unit of the value."""
        return 1.0 if self.length is None else 1e-3 * self.length

    @property
    def count(self) -> int:
        """Number of travels, stages or times; 1 for the end."""
        given = (own for own in (self.travels, self.stages, self.times) if own is not None)
        return len(next(given, (None,)))

    def between_steps(self, result):
        points = self._points(result, self.motion(result))
        fractions = np.array([point.fraction for point in points if point is not None])
        return fractions[np.abs(fractions - np.round(fractions)) > ROUNDING]

    @property
    def at_end(self):
        return self.travels is None and self.stages is None and self.times is None

    @property
    def _rows(self) -> int:
        """Number of values per travel."""
        return len(self.components) if self.direction is None else 1

    def size(self, seal):
        return self._rows * self.count

    def check(self, seal):
        if self.times is not None:
            times = stage_times(seal.terms()[0], self.name)
            if _is_beyond(max(self.times), times):
                raise ValueError(
                    f"time = {max(self.times):g} s is beyond the end of the analysis at "
                    f"{times.total:.6g} s; give an earlier time or a longer duration"
                )

    def missing(self, result):
        if self.times is None:
            return ""
        times = stage_times(result.term("structure").definition, self.name)
        if not _is_beyond(max(self.times), times):
            return ""
        return (
            f"the measure {self.name} has no value at {max(self.times):g} s, because the path ends at "
            f"{times.total:.6g} s; give an earlier time or longer durations"
        )

    def evaluate(self, result, partials):
        motion = self.motion(result)
        parts = [
            np.full(self._rows, np.nan)
            if point is None
            else self._interpolated(result, partials, row * self._rows, motion, point)
            for row, point in enumerate(self._points(result, motion))
        ]
        return np.concatenate(parts)

    def _points(self, result, motion) -> list["PathPoint | None"]:
        """List the points of the path at which the force is taken; None for times beyond its end."""
        none = np.zeros(len(motion.names))
        if self.times is not None:
            body = result.term("structure").definition
            times = stage_times(body, self.name)
            found = [
                None if _is_beyond(time, times) else times.fraction_at(min(time, times.total))
                for time in self.times
            ]
            # travel at the fraction: linear between nominal steps
            steps = np.arange(len(motion.travels))
            return [
                None if fraction is None else PathPoint(
                    float(np.interp(fraction, steps, motion.travels)), fraction, none,
                    _fraction_rates(body.environment, fraction),
                )
                for fraction in found
            ]  # fmt: skip
        if self.stages is not None:
            ends = [end_of_stage(result, stage) for stage in self.stages]
            return [PathPoint(motion.travels[end], float(end), none) for end in ends]
        if self.travels is None:
            return [PathPoint(motion.travel, float(len(result.path.nominal_steps)), none)]
        self._check_reached(result, motion)
        # travels are counted from the first touch of the nominal seal, where that is known
        before = result.seal.before_touch
        counted = [before + travel for travel in self.travels]
        return [PathPoint(travel, *motion.at_travel(travel)) for travel in counted]

    def curve(self, result) -> tuple[np.ndarray, np.ndarray]:
        """Return the load-deflection curve: travels (n + 1,), mm, and forces (n + 1,) in the unit of the
        value, at the start and at n nominal steps; along the first component, if there are two."""
        motion, forces = self.motion(result), self.forces(result)
        # counted from the first touch
        travels = motion.travels[: len(forces) + 1]
        # F_k = e_k . R_k, zero at the start without preliminary increments
        forces = [*(self.force_at(result, own) for own in result.path.preliminary[-1:]), *forces]
        none = len(travels) - len(forces)
        units = [self.directions_at(motion, travel)[0][0] for travel in travels[none:]]
        values = [self.scale * (e @ force) for e, force in zip(units, forces, strict=True)]
        return travels - result.seal.before_touch, np.append(np.zeros(none), values)

    def motion(self, result):
        """Return the motion of the profile, or of the first profile that travels if it does not."""
        motions = motions_of(result)
        found = motions.get(self.profile, next(iter(motions.values())))
        if found.travel > 0.0:
            return found
        return next((motion for motion in motions.values() if motion.travel > 0.0), found)

    def least_scale(self, result):
        # a component may vanish: the complete force is the reference, unless that is a rounding error
        largest = float(np.abs(self.forces(result)).max(initial=0.0))
        return self.scale * max(largest, result.path.least_force)

    def forces(self, result) -> np.ndarray:
        """Compute the force at every nominal step, shape (n_steps, 2), N/m."""
        forces = [self.force_at(result, step) for step in result.path.nominal_steps]
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

    def force_at(self, result, step) -> np.ndarray:
        """Compute the force at a converged step, shape (2,), N/m."""
        if self.edges:
            return result.path.support_force(self._supports(result), step)
        return result.path.force(self.profile, step)

    def add_partials(self, result, partials, step, rows, directions) -> None:
        """Add the derivatives of e . F at a step for directions e (r, 2)."""
        supports = self._supports(result)
        if self._touches(result):
            partials.force(self.profile, step)[rows] += directions[:, None]
        if supports.any():
            # e . F of supports: sum of e_i R_i over the prescribed components
            weights = np.where(supports, directions[:, None], 0.0)
            add_support_partials(partials, step, rows, weights)

    def _check_reached(self, result, motion) -> None:
        end = motion.travel - result.seal.before_touch
        farthest = max(self.travels, default=0.0)
        if farthest > end + ROUNDING * motion.travel:
            raise LoadPathError(
                f"the measure {self.name!r} needs the force at {farthest:.6g} mm of travel, but "
                f"the motion of {self.profile or 'the first profile'!r} ends at {end:.6g} mm; "
                "choose smaller travels or a longer motion",
                result,
            )

    def directions_at(self, motion, travel) -> tuple[np.ndarray, np.ndarray]:
        """Compute the directions (r, 2) of the forces at a travel, unit vectors, and their derivatives
        (m, r, 2) with respect to the m parameters of the motion."""
        if self.direction == TRAVEL:
            unit, rates = travel_direction(motion, travel)
            return -unit[None], -rates[:, None]
        fixed = np.eye(2)[list(self.components)]
        if self.direction is not None:
            fixed = np.array([self.direction])
        return fixed, np.zeros((len(motion.names), *fixed.shape))

    def _interpolated(self, result, partials, row, motion, point: "PathPoint") -> np.ndarray:
        """Interpolate the values at a point of the path."""
        # F = (1 - w) F_k + w F_(k+1),  w = fraction - k,  dF/d(fraction) = F_(k+1) - F_k
        steps, fraction = result.path.nominal_steps, point.fraction
        initial = result.path.preliminary[-1:]
        directions, turns = self.directions_at(motion, point.travel)
        directions, turns = self.scale * directions, self.scale * turns
        first, force, change = min(int(fraction), len(steps) - 1), np.zeros(2), np.zeros(2)
        rows = row + np.arange(self._rows)
        for number, weight, sign in (
            (first, 1.0 - (fraction - first), -1.0),
            (first + 1, fraction - first, 1.0),
        ):
            if number == 0 and not initial:  # no contact at the start: F_0 = 0
                continue
            # weights 1 - w of F_k and w of F_(k+1)
            step = steps[number - 1] if number else initial[0]
            total = self.force_at(result, step)
            # F += weight F_k,  dF/d(fraction) += sign F_k
            force, change = force + weight * total, change + sign * total
            if weight != 0.0:
                self.add_partials(result, partials, step, rows, weight * directions)
        # m = e . F:  dm/dp = e . (F_(k+1) - F_k) d(fraction)/dp + F . de/dp
        for name, rate, turn in zip(motion.names, point.rates, turns, strict=True):
            if rate != 0.0 or turn.any():
                partials.parameter(name)[rows] += rate * (directions @ change) + turn @ force
        # dm/dp of the parameters of the time, likewise
        for name, rate in point.by_time:
            partials.parameter(name)[rows] += rate * (directions @ change)
        return directions @ force


class PathPoint(NamedTuple):
    """A point of the path at which a force is taken.

    Attributes
    ----------
    travel : float
        Of the profile, mm.
    fraction : float
        Number of nominal steps completed.
    rates : ndarray, shape (m,)
        Derivatives of the fraction in the m parameters of the motion.
    by_time : tuple of (str, float)
        Its derivatives in parameters of the time, by name.
    """

    travel: float
    fraction: float
    rates: np.ndarray
    by_time: tuple = ()


def motions_of(result) -> dict:
    """Return the motions of profiles and moved edges by label, in the order of the seal."""
    problem = result.path.problem
    moving = (*problem.terms, *getattr(problem.imposed, "edges", ()))
    return {own.label: own.motion for own in moving if hasattr(own, "motion")}


def end_of_stage(result, stage: int) -> int:
    """Return the number of nominal steps up to the end of a stage of the path, counted from 1.

    The stages of the path are those of ``path_motion``.
    """
    return int(np.cumsum(path_motion(motions_of(result).values()).steps)[stage - 1])


def stage_times(body, name: str):
    """Return the ``StageTimes`` of an ``ElasticBody``; ValueError, with the name of a measure, where it
    has none."""
    environment = body.environment
    if environment is None or environment.time is None:
        raise ValueError(
            f"{name!r} is requested at a time, but stages take no time because no material "
            "relaxes; use travel or stage instead"
        )
    return environment.time


def _is_beyond(time: float, times) -> bool:
    """Return whether a time is later than the end of the path, by more than rounding."""
    return time > times.total * (1.0 + ROUNDING)


def _fraction_rates(environment, fraction: float) -> tuple:
    """Derivatives of the path parameter at a given time, by the names of the parameters of the time."""
    # t(s, p) is fixed: ds/dp = -(dt/dp) / (dt/ds)
    slope = environment.time.slope_at(fraction)
    rates = environment.time_rates([fraction])
    return tuple((name, -float(own[0]) / slope) for name, own in rates.items())


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
