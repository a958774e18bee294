"""Measures of energy: strain energy, work of moving profiles and of friction."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.geometry.pose import quarter_turn
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.reaction import end_of_stage


@dataclass(frozen=True)
class StrainEnergy(Measure):
    """Elastic energy of the body at the end of the path, per unit depth."""

    name: str = "strain_energy"
    units = "mJ/m"
    text = "Elastic energy of the body per unit depth."

    def evaluate(self, result, partials):
        partials.energy()[0] += 1.0
        return result.term("structure").energy(result.end.d, result.end.fraction)


@dataclass(frozen=True)
class ProfileWork(Measure):
    """Work of a profile on the seal from the start to the end of the path, or between the ends of two
    stages, per unit depth.

    The sum of force . travel and moment . angle over the nominal load steps by the trapezoidal rule,
    with an error of second order in the step. Over a closed loop it is the work dissipated by friction,
    by softening and by relaxation: the hysteresis loss.

    Attributes
    ----------
    profile : str
        Label of a contact, whose points are particles where the profile turns.
    stages : pair of int, or None
        Stages of the path, counted from 1, between whose ends the work is done; 0 is the start.
    """

    profile: str
    name: str = "profile_work"
    stages: tuple | None = None
    units = "mJ/m"
    text = "Work of the profile on the seal along the path, per unit depth."

    @property
    def at_end(self):
        return self.stages is None

    @property
    def from_start(self):
        return self.stages is None or 0 in self.stages

    def evaluate(self, result, partials):
        term, at, steps = result.term(self.profile), *self._steps(result)
        poses = np.array([term.motion.coordinates(n) for n in at])
        rates = np.array([term.motion.rates_at(n) for n in at])
        # W = -sum_n (F_n . dz_n + M_n dtheta_n),  dz_n = (z_(n+1) - z_(n-1)) / 2,
        # half of one increment at either end
        travels, travel_rates = _travels(poses), _travels(rates)
        value, by_motion = 0.0, np.zeros(rates.shape[1])
        for number, step in enumerate(steps):
            # no force at the start of the path
            if step is None:
                continue
            travel, angle = travels[number, :2], travels[number, 2]
            response = result.response(self.profile, step)
            arm = response.x - poses[number, :2] - term.motion.pivot
            # M = sum a x f = sum a . (-S f):  dM/da = -S f,  dM/df = S a,  a = x - z - c
            on_arm = -quarter_turn(response.force)
            moment = float((arm * on_arm).sum())
            # F and M act on the profile: hence the minus sign
            value -= response.total @ travel + moment * angle
            partials.force(self.profile, step)[0] -= travel + quarter_turn(arm) * angle
            if angle != 0.0:
                # the arm depends on x = X + u of the contact points, which are particles
                particle = term.where.at_particles
                partials.displacement(step)[0, particle] -= on_arm * angle
                partials.particles[0, particle] -= on_arm * angle
            # dW/dp = -F . d(dz)/dp - M d(dtheta)/dp + dtheta (dM/da) . dz/dp
            by_motion -= travel_rates[number] @ np.array([*response.total, moment])
            by_motion += angle * (rates[number, :, :2] @ on_arm.sum(axis=0))
        for name, slope in zip(term.motion.names, by_motion, strict=True):
            partials.parameter(name)[0] += slope
        return value

    def _steps(self, result) -> tuple[list, list]:
        """List the path parameters of the sum, and the converged step at each; None at the start."""
        path = result.path
        nominal, before = path.nominal_steps, path.preliminary
        first, last = (0, len(nominal)) if self.stages is None else self._ends(result)
        steps = [None, *nominal][first : last + 1]
        if first:
            return [*range(first, last + 1)], steps
        at = [path.start.fraction, *(own.fraction for own in before), *range(1, last + 1)]
        return at, [None, *before, *steps[1:]]

    def _ends(self, result) -> tuple[int, int]:
        """Numbers of nominal steps up to the ends of both stages, as far as the path goes."""
        completed = len(result.path.nominal_steps)
        first, last = (end_of_stage(result, own) if own else 0 for own in self.stages)
        return min(first, completed), min(last, completed)


def _travels(poses: np.ndarray) -> np.ndarray:
    """Compute half the increments from the pose before to the pose after; the first pose follows, and
    the last one is followed by, itself."""
    before, after = poses[[0, *range(len(poses) - 1)]], poses[[*range(1, len(poses)), -1]]
    return 0.5 * (after - before)


@dataclass(frozen=True)
class FrictionWork(Measure):
    """Work of all profiles minus the elastic energy of the body at the end of the path.

    Over a path that ends without contact it is the work dissipated by friction, including self-contact.
    During contact it also contains the elastic energy of the penalties and of trapped air.
    """

    name: str = "friction_work"
    units = "mJ/m"
    text = "Work of all profiles that is not stored in the body, per unit depth."
    from_start = True

    def evaluate(self, result, partials):
        profiles = [term.label for term in result.path.problem.terms if hasattr(term, "motion")]
        works = [ProfileWork(label).evaluate(result, partials) for label in profiles]
        # W_f = sum W_profile - Pi_elastic
        partials.energy()[0] -= 1.0
        return sum(works) - result.term("structure").energy(result.end.d, result.end.fraction)
