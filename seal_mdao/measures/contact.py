"""Measures of a contact: gaps, pressures, widths, reactions."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.errors import LoadPathError
from seal_mdao.geometry.motion import ROUNDING
from seal_mdao.measures.aggregates import MEAN_ORDER, lehmer_mean, opened_square_integral
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.selection import contact_patches, opened_points, touching_stretch
from seal_mdao.values import numbers


@dataclass(frozen=True)
class Gap(Measure):
    """Normal gaps at contact points at the end of the path.

    Attributes
    ----------
    profile : str
        Label of the contact.
    points : tuple of int, or None
        Places among the points of the contact; None for those of the drawn seal that stand open
        between others in contact.
    """

    profile: str
    points: tuple | None = None
    name: str = "gap"
    units = "mm"
    text = "Normal gaps at contact points, negative in penetration."

    @property
    def takes_places(self):
        return self.points is None

    def frozen(self, drawn):
        opened = opened_points(drawn.response(self.profile).state)
        return replace(self, points=tuple(int(point) for point in opened))

    def size(self, seal):
        return len(self.points)

    def evaluate(self, result, partials):
        points = np.array(self.points, int)
        partials.output(self.profile, "gap")[np.arange(points.size), points] += 1.0
        return result.response(self.profile).gap[points]


@dataclass(frozen=True)
class GapSquareSum(Derived):
    """Sum of squared gaps, the cost of Eq. (71).

    Attributes
    ----------
    base : Gap
    """

    base: Gap
    name: str = "gap_square_sum"
    units = "mm**2"
    text = "Sum of the squared gaps, the cost of Eq. (71)."

    def value(self, values):
        return values @ values, 2.0 * values


@dataclass(frozen=True)
class GapSquareIntegral(Measure):
    """Integral of g^2 over the undeformed boundary that stands open in a stretch of points.

    Attributes
    ----------
    profile : str
    stretch : tuple of int, or None
        Consecutive contact points; None for those of the drawn seal from the first to the last one
        in contact.
    """

    profile: str
    stretch: tuple | None = None
    name: str = "gap_square_integral"
    units = "mm**3"
    text = (
        "Integral of the squared gap over the opened stretch, hardly dependent on the refinement."
    )

    @property
    def takes_places(self):
        return self.stretch is None

    def frozen(self, drawn):
        touching = touching_stretch(drawn.response(self.profile).state)
        return replace(self, stretch=tuple(int(point) for point in touching))

    def evaluate(self, result, partials):
        stretch = np.array(self.stretch, int)
        line = _Line(result, self.profile, stretch)
        gap = result.response(self.profile).gap[stretch]
        value, by_gap, by_length = opened_square_integral(gap, line.length)
        partials.output(self.profile, "gap")[0, stretch] += by_gap
        line.add_partials(by_length, partials.particles[0])
        return value


class _Line:
    """Straight pieces between consecutive contact points of the undeformed boundary."""

    def __init__(self, result, profile: str, stretch):
        self.where, self.stretch = result.term(profile).where, stretch
        self.edges = np.diff(self.where.points.at(result.particles)[stretch], axis=0)
        self.length = np.hypot(*self.edges.T)

    def add_partials(self, by_length, particles) -> None:
        """Add d/d(particles) (n, 2) of a function with derivatives ``by_length`` (k - 1,)."""
        pull = (by_length / self.length)[:, None] * self.edges
        on_points = np.zeros((len(self.where), 2))
        on_points[self.stretch[1:]] += pull
        on_points[self.stretch[:-1]] -= pull
        self.where.add_point_seeds(on_points[:, :, None], particles[:, :, None])


def way_round(where) -> np.ndarray:
    """The points of a boundary in order, the first once more at the end where it is closed."""
    every, (first, last) = np.arange(len(where)), where.points.anchors[[0, -1]]
    closed = np.isin(last, where.edges[0]).any() and np.isin(first, where.edges[-1]).any()
    return np.append(every, 0) if closed and len(every) > 2 else every


def touching_shares(gap: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Share of every stretch between neighbouring contact points that touches, the gap being linear.

    Parameters
    ----------
    gap : ndarray, shape (k,)

    Returns
    -------
    share, by_first, by_second : ndarray, shape (k - 1,)
        With its derivatives in the gaps at both ends.
    """
    a, b = gap[:-1], gap[1:]
    span = np.where((a < 0.0) != (b < 0.0), a - b, 1.0)
    share = np.where((a < 0.0) & (b < 0.0), 1.0, 0.0)
    first, last = (a < 0.0) & (b >= 0.0), (a >= 0.0) & (b < 0.0)
    share = np.where(first, a / span, np.where(last, -b / span, share))
    # a / (a - b) where the first end touches, -b / (a - b) where the second one does
    by_a = np.where(first, -b, np.where(last, b, 0.0)) / span**2
    by_b = np.where(first, a, np.where(last, -a, 0.0)) / span**2
    return share, by_a, by_b


@dataclass(frozen=True)
class ContactWidth(Measure):
    """Length of the undeformed boundary that is in contact at the end of the path.

    Between neighbouring contact points the gap is taken to be linear, so the width changes smoothly.

    Attributes
    ----------
    profile : str
    """

    profile: str
    name: str = "contact_width"
    units = "mm"
    text = "Length of the undeformed boundary in contact."

    def evaluate(self, result, partials):
        way = way_round(result.term(self.profile).where)
        line = _Line(result, self.profile, way)
        share, by_a, by_b = touching_shares(result.response(self.profile).gap[way])
        on_gap = partials.output(self.profile, "gap")[0]
        on_gap[way[:-1]] += line.length * by_a
        on_gap[way[1:]] += line.length * by_b
        line.add_partials(share, partials.particles[0])
        return line.length @ share


@dataclass(frozen=True)
class ContactPressure(Measure):
    """Contact pressure w_n |g_n| of patches of contact points: a mean of high order below the peak.

    Attributes
    ----------
    profile : str
    patches : tuple of tuple of int, or None
        Contact points of every patch; None for all points of the drawn seal's contact, divided in the
        middle of its opened stretch.
    order : int
        Of the Lehmer mean.
    """

    profile: str
    patches: tuple | None = None
    order: int = MEAN_ORDER
    name: str = "contact_pressure"
    units = "kPa"
    text = "Contact pressure of each patch, a mean of high order below the peak."

    @property
    def takes_places(self):
        return self.patches is None

    def frozen(self, drawn):
        found = contact_patches(drawn.response(self.profile).state)
        return replace(self, patches=tuple(tuple(int(p) for p in patch) for patch in found))

    def size(self, seal):
        return len(self.patches)

    def evaluate(self, result, partials):
        gap, term = result.response(self.profile).gap, result.term(self.profile)
        penalty, values = term.law.normal_penalty, np.empty(len(self.patches))
        on_gap = partials.output(self.profile, "gap")
        for row, patch in enumerate(self.patches):
            own = np.array(patch, int)
            values[row], weight = lehmer_mean(penalty * np.maximum(-gap[own], 0.0), self.order)
            on_gap[row, own] -= penalty * weight * (gap[own] < 0.0)
        partials.parameter(term.names[0])[:] += values / penalty
        return values


@dataclass(frozen=True)
class PeakPressure(ContactPressure):
    """Contact pressure of all points of a contact: a mean of high order below the peak."""

    order: int = 40
    name: str = "peak_pressure"
    text = "Contact pressure, a mean of high order below the peak."

    @property
    def takes_places(self):
        return False

    def size(self, seal):
        return 1

    def evaluate(self, result, partials):
        every = tuple(range(len(result.term(self.profile).where)))
        return ContactPressure(self.profile, (every,), self.order).evaluate(result, partials)


@dataclass(frozen=True)
class Reaction(Measure):
    """Force of the seal on a profile at the end of the path, or at chosen travels.

    Between load steps the force is interpolated linearly; the derivatives are those of the interpolated
    value, also where a parameter of the motion changes when a travel is reached.

    Attributes
    ----------
    profile : str
    travels : tuple of float, or None
        How far the profile has come along its path, mm; None for the end of the path.
    components : tuple of int
        0 horizontal, 1 vertical; one after the other at every travel.

    Raises
    ------
    ValueError
        For travels that are no numbers from zero on, or other components.
    """

    profile: str
    travels: tuple | None = None
    components: tuple = (0, 1)
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

    def before(self, seal) -> float:
        """Travel from the start to where ``travels`` are counted from, mm."""
        return 0.0

    def size(self, seal):
        return len(self.components) * (1 if self.travels is None else len(self.travels))

    def evaluate(self, result, partials):
        steps, motion = result.path.nominal_steps, result.term(self.profile).motion
        if self.travels is None:
            places = [(float(len(steps)), np.zeros(len(motion.names)))]
        else:
            self._check_reached(result, motion)
            before = self.before(result.seal)
            places = [motion.at_travel(before + travel) for travel in self.travels]
        parts = [
            self._interpolated(result, partials, row * len(self.components), *place)
            for row, place in enumerate(places)
        ]
        return np.concatenate(parts)

    def _check_reached(self, result, motion) -> None:
        end = motion.travel - self.before(result.seal)
        farthest = max(self.travels, default=0.0)
        if farthest > end + ROUNDING * motion.travel:
            raise LoadPathError(
                f"measure {self.name!r} is asked for at {farthest:.6g} mm of travel, and the motion of "
                f"{self.profile!r} ends at {end:.6g} mm; choose other travels, or a longer motion",
                result,
            )

    def _interpolated(self, result, partials, row, fraction, rates) -> np.ndarray:
        """Components of the force after ``fraction`` nominal steps; ``rates`` are its derivatives with
        respect to the parameters of the motion."""
        steps, place = result.path.nominal_steps, result.path.place(self.profile)
        first, values, change = min(int(fraction), len(steps) - 1), 0.0, 0.0
        rows, components = row + np.arange(len(self.components)), np.array(self.components)
        for number, weight, sign in (
            (first, 1.0 - (fraction - first), -1.0),
            (first + 1, fraction - first, 1.0),
        ):
            if number == 0:  # nothing touches at the start
                continue
            step = steps[number - 1]
            total = np.asarray(step.responses[place].total)[components]
            values, change = values + weight * total, change + sign * total
            if weight != 0.0:
                partials.force(self.profile, step)[rows, :, components] += weight
        for name, rate in zip(result.term(self.profile).motion.names, rates, strict=True):
            if rate != 0.0:
                partials.parameter(name)[rows] += rate * change
        return np.broadcast_to(values, rows.shape)
