"""Measures of a seal that relaxes: retained force, time to a force, compression set."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.analysis.cost import duration
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.reaction import Reaction, end_of_stage, stage_times

SMALL = 1e-3
"""Ratio that counts as zero."""


@dataclass(frozen=True)
class RetainedForce(Derived):
    """Force at the second of two stages or times divided by that at the first; not a number where the
    first force is zero.

    Attributes
    ----------
    base : Reaction
        One force at each of them.
    """

    base: Reaction
    name: str = "retained_force"
    units = None
    text = "Ratio of the force to an earlier force, F(t) / F(0)."

    def least_scale(self, result):
        return SMALL

    def missing(self, result):
        text = super().missing(result)
        if text or result.value(self.base)[0] != 0.0:
            return text
        return (
            f"the measure {self.name} has no value, because it is a ratio of two forces, and the force "
            "at the earlier stage or time is 0; choose a stage or time at which the seal is in contact"
        )

    def value(self, values):
        # m = F_2 / F_1
        first, last = values
        if first == 0.0:
            return np.nan, np.zeros(2)
        return last / first, np.array([-last / first**2, 1.0 / first])


@dataclass(frozen=True)
class TimeToForceFraction(Measure):
    """Time from the end of a stage until the force has fallen to a fraction of its value there.

    Between the load steps of a dwell the force is linear in the logarithm of time, as it is drawn. Not a
    number where the fraction is not reached in the dwells that follow the stage.

    Attributes
    ----------
    base : Reaction
        One force, without travels, stages or times.
    fraction : float
        Between 0 and 1.
    stage : int
        From 1 on; a dwell follows.
    """

    base: Reaction
    fraction: float
    stage: int = 1
    name: str = "time_to_force_fraction"
    units = "s"
    text = "Time until the force has fallen to a fraction of the force at the end of a stage."
    at_end = False
    needs_all_steps = True

    def check(self, seal):
        first = stage_times(seal.terms()[0], self.name).first
        if self.stage >= len(first) or not np.isfinite(first[self.stage]):
            raise ValueError(
                f"{self.name!r}: stage = {self.stage} is not followed by a dwell (a stage in which "
                "the profiles do not move); give the number of the stage before a dwell"
            )

    def least_scale(self, result):
        # the least relaxation time of the materials
        return float(self._times(result).first[self.stage])

    def _times(self, result):
        return stage_times(result.term("structure").definition, self.name)

    def _dwell(self, result) -> tuple[int, np.ndarray, np.ndarray]:
        """Find the nominal steps completed at the end of the stage, and after every step of the dwells
        that follow the path parameter and the force e . F, the one at that end first."""
        times, last = self._times(result), self.stage
        while last < len(times.first) and np.isfinite(times.first[last]):
            last += 1
        begin, end = (end_of_stage(result, stage) for stage in (self.stage, last))
        motion = self.base.motion(result)
        direction = self.base.directions_at(motion, motion.travels[begin])[0][0]
        steps = result.path.nominal_steps[begin - 1 : end]
        forces = np.array([direction @ self.base.force_at(result, step) for step in steps])
        return begin, np.arange(begin, begin + len(steps)), forces

    def missing(self, result):
        _, fractions, forces = self._dwell(result)
        if forces[0] == 0.0:
            return (
                f"the measure {self.name} has no value, because the force at the end of stage "
                f"{self.stage} is 0 and cannot relax"
            )
        least = (forces / forces[0]).min()
        if least <= self.fraction:
            return ""
        begin, end = self._times(result).at(fractions[[0, -1]])
        return (
            f"{self.name}: within the dwell of {duration(end - begin)} the force decreases only to "
            f"{least:.4g} of that at the end of stage {self.stage}, not to the fraction "
            f"{self.fraction:g}; use a longer dwell or a larger fraction"
        )

    def evaluate(self, result, partials):
        begin, fractions, forces = self._dwell(result)
        # f F_0 is not reached, see ``missing``
        fallen = np.flatnonzero(forces / forces[0] <= self.fraction) if forces[0] else ()
        if not len(fallen):
            return np.nan
        # the first step after which F_k <= f F_0
        k = int(fallen[0])
        # s = k - 1 + w,  w = (f F_0 - F_(k-1)) / (F_k - F_(k-1)),  m = t(s) - t(s_0)
        change = forces[k] - forces[k - 1]
        w = (self.fraction * forces[0] - forces[k - 1]) / change
        at = float(fractions[k - 1] + w)
        times = self._times(result)
        # dm = dt/ds ds + (dt/dp(s) - dt/dp(s_0)) dp,
        # ds = (f dF_0 - (1 - w) dF_(k-1) - w dF_k) / (F_k - F_(k-1))
        slope = times.slope_at(at) / change
        environment = result.term("structure").definition.environment
        for name, own in environment.time_rates([at, begin]).items():
            partials.parameter(name)[0] += own[0] - own[1]
        motion = self.base.motion(result)
        directions, turns = self.base.directions_at(motion, motion.travels[begin])
        for number, weight in ((0, self.fraction), (k - 1, w - 1.0), (k, -w)):
            step = result.path.nominal_steps[begin - 1 + number]
            weight *= slope
            self.base.add_partials(result, partials, step, np.zeros(1, int), weight * directions)
            # d(e . F) = e . dF + F . de
            for name, turn in zip(motion.names, turns, strict=True):
                if turn.any():
                    force = self.base.force_at(result, step)
                    partials.parameter(name)[0] += weight * float(turn[0] @ force)
        found = times.at([at, begin])
        return found[0] - found[1]


@dataclass(frozen=True)
class CompressionSet(Measure):
    """Fraction of the compression of a particle that remains at the end of the path: with its
    displacement u along one axis, (h_0 - h_end) / (h_0 - h_closed) = u_end / u_closed; not a number
    where u_closed is zero.

    Attributes
    ----------
    point : int
        Particle, on the surface that the profile compresses.
    component : int
        0 horizontal, 1 vertical.
    stage : int
        At whose end, from 1 on, the seal is closed.
    """

    point: int
    component: int = 1
    stage: int = 1
    name: str = "compression_set"
    units = None
    text = (
        "Compression set: fraction of the compression that is not recovered at the end, (h_0 - h) "
        "/ (h_0 - h_closed)."
    )
    at_end = False

    def least_scale(self, result):
        return SMALL

    def on_refined(self, fine, particles):
        return replace(self, point=int(particles[self.point]))

    def _displacements(self, result) -> tuple[int, float, float]:
        """Find the nominal step, from 0, at whose end the seal is closed, u_closed and u_end, mm."""
        number = end_of_stage(result, self.stage) - 1
        closed, end = (
            result.displacement(step)[self.point, self.component] for step in (number, -1)
        )
        return number, closed, end

    def missing(self, result):
        if self._displacements(result)[1] != 0.0:
            return ""
        return (
            f"the measure {self.name} has no value, because the point at which the compression is "
            f"measured has not moved at the end of stage {self.stage}; choose a point on the surface "
            "that the profile compresses, or another stage"
        )

    def evaluate(self, result, partials):
        number, closed, end = self._displacements(result)
        if closed == 0.0:
            return np.nan
        # m = u_e / u_c
        at = 0, self.point, self.component
        partials.displacement()[at] += 1.0 / closed
        partials.displacement(result.path.nominal_steps[number])[at] -= end / closed**2
        return end / closed
