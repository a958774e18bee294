"""Work that a moving profile does on the body."""

from dataclasses import dataclass

import numpy as np

from seal_mdao.geometry.pose import quarter_turn
from seal_mdao.measures.measure import Measure


@dataclass(frozen=True)
class ProfileWork(Measure):
    """Work of a profile on the seal from the start to the end of the path, per unit depth.

    The sum of force . travel and moment . angle over the nominal load steps by the trapezoidal rule:
    its error goes down with the square of the step. Over a closed loop it is what friction takes.

    Attributes
    ----------
    profile : str
        Label of a contact, whose points are particles where the profile turns.
    """

    profile: str
    name: str = "profile_work"
    units = "mJ/m"
    text = "Work of the profile on the seal along the path, per unit depth."

    def evaluate(self, result, partials):
        term, steps = result.term(self.profile), result.path.nominal_steps
        at = np.arange(len(steps) + 1.0)
        places = np.array([term.motion.coordinates(n) for n in at])
        rates = np.array([term.motion.rates_at(n) for n in at])
        travels, travel_rates = _travels(places), _travels(rates)
        value, by_motion = 0.0, np.zeros(rates.shape[1])
        for number, step in enumerate(steps):
            response = result.response(self.profile, step)
            travel, angle = travels[number, :2], travels[number, 2]
            arm = response.x - places[number + 1, :2] - term.motion.pivot
            on_arm = -quarter_turn(response.force)  # of the moment
            moment = float((arm * on_arm).sum())
            # the force is that of the body on the profile
            value -= response.total @ travel + moment * angle
            partials.force(self.profile, step)[0] -= travel + quarter_turn(arm) * angle
            if angle != 0.0:
                particle = term.where.at_particles
                partials.displacement(step)[0, particle] -= on_arm * angle
                partials.particles[0, particle] -= on_arm * angle
            by_motion -= travel_rates[number] @ np.array([*response.total, moment])
            by_motion += angle * (rates[number + 1, :, :2] @ on_arm.sum(axis=0))
        for name, slope in zip(term.motion.names, by_motion, strict=True):
            partials.parameter(name)[0] += slope
        return value


def _travels(places: np.ndarray) -> np.ndarray:
    """Half the way from the place before each one to the one after it, the first left out; the last
    one has none after it."""
    following = np.concatenate([places[2:], places[-1:]])
    return 0.5 * (following - places[:-1])


@dataclass(frozen=True)
class FrictionWork(Measure):
    """Work of all profiles that the body has not stored as elastic energy at the end of the path.

    Over a path that ends open it is what friction took, against profiles and of the body on itself.
    While profiles press it holds the elastic energy of the penalties and of trapped air besides.
    """

    name: str = "friction_work"
    units = "mJ/m"
    text = "Work of all profiles that is not stored in the body, per unit depth."

    def evaluate(self, result, partials):
        profiles = [term.label for term in result.path.problem.terms if hasattr(term, "motion")]
        works = [ProfileWork(label).evaluate(result, partials) for label in profiles]
        partials.energy()[0] -= 1.0
        return sum(works) - result.term("structure").energy(result.end.d)
