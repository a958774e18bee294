"""Measures of gaps: single gaps, and those between the first and the last contact."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.boundary_line import BoundaryLine, is_closed, opened_square_integral
from seal_mdao.measures.measure import Derived, Measure
from seal_mdao.measures.selection import contact_range, mirrored_ends, open_points
from seal_mdao.measures.smooth_peaks import NORM_ORDER, p_norm


def open_between(result, profile: str) -> np.ndarray:
    """Find the contact points of a profile that are open between the first and the last contact at the
    end of the path."""
    return open_at(result.term(profile), result.response(profile).state)


def open_at(term, state: np.ndarray) -> np.ndarray:
    """Find the contact points of a ``ContactTerm`` that are open between the first and the last contact
    with these states (k,)."""
    return open_points(state, is_closed(term.where), mirrored_ends(term))


@dataclass(frozen=True)
class Gap(Measure):
    """Normal gaps at contact points at the end of the path.

    Attributes
    ----------
    profile : str
        Label of the contact.
    points : tuple of int, or None
        Indices of contact points; None for those of the nominal seal that are open between others in
        contact.
    """

    profile: str
    points: tuple | None = None
    name: str = "gap"
    units = "mm"
    text = "Normal gaps at contact points, negative in penetration."

    @property
    def selects_points(self):
        return self.points is None

    def frozen(self, nominal):
        opened = open_between(nominal, self.profile)
        return replace(self, points=tuple(int(point) for point in opened))

    def on_refined(self, fine, particles):
        # other particles are open there
        return None

    def size(self, seal):
        return len(self.points)

    def evaluate(self, result, partials):
        points = np.array(self.points, int)
        # dm_k/dg_i = 1 for the k-th chosen point i
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
    text = "Sum of the squared normal gaps at contact points, Eq. (71) of Kim et al. (2000)."

    def value(self, values):
        # sum g^2 and its gradient 2 g   Eq. (71)
        return values @ values, 2.0 * values


@dataclass(frozen=True)
class BetweenContacts(Measure):
    """Base of the measures of gaps from the first to the last contact of the design or the nominal seal.

    A gap counts wherever it opens between contacts of the design; where the nominal seal has contact it
    counts also when the design loses that contact, so no measure falls because a contact lifts off.

    Attributes
    ----------
    profile : str
        Label of the contact.
    nominal : tuple of int, or None
        Contact points from the first to the last contact of the nominal seal; None before its analysis.
    mirrored : tuple of bool
        Ends at which the boundary continues with its mirror image (``selection.mirrored_ends``).
    """

    profile: str
    nominal: tuple | None = None
    mirrored: tuple = (False, False)

    @property
    def selects_points(self):
        return self.nominal is None

    def frozen(self, nominal):
        term = nominal.term(self.profile)
        mirrored = mirrored_ends(term)
        touching = nominal.response(self.profile).state != OPEN
        points = contact_range(touching, is_closed(term.where), mirrored)
        return replace(self, nominal=tuple(points.tolist()), mirrored=mirrored)

    def on_refined(self, fine, particles):
        # contact points there have other indices
        return replace(self, nominal=None).frozen(fine)

    def stretch(self, result) -> np.ndarray:
        """List the contact points from the first to the last contact of either seal, in order."""
        # in contact now or in the nominal seal
        touching = result.response(self.profile).state != OPEN
        touching[list(self.nominal)] = True
        closed = is_closed(result.term(self.profile).where)
        return contact_range(touching, closed, self.mirrored)

    def open_gaps(self, result) -> tuple[np.ndarray, np.ndarray]:
        """Find the points among these that are not in contact, and their gaps, mm."""
        # a gap in contact contributes nothing
        points, response = self.stretch(result), result.response(self.profile)
        points = points[response.state[points] == OPEN]
        return points, response.gap[points]


@dataclass(frozen=True)
class OpenGapSquareSum(BetweenContacts):
    """Sum of the squared gaps between contacts; continuously differentiable if a gap closes."""

    name: str = "gap_square_sum"
    units = "mm**2"
    text = "Sum of the squared gaps between the first and the last contact point."

    def on_refined(self, fine, particles):
        # twice as many particles give twice the sum
        return None

    def evaluate(self, result, partials):
        points, gap = self.open_gaps(result)
        # d(g . g)/dg = 2 g
        partials.output(self.profile, "gap")[0, points] += 2.0 * gap
        return gap @ gap


@dataclass(frozen=True)
class LargestGap(BetweenContacts):
    """Largest gap between contacts, as a p-norm.

    It is never below the largest gap, and at most m^(1/p) times as large with m open points.

    Attributes
    ----------
    order : int
        p.
    """

    order: int = NORM_ORDER
    name: str = "largest_gap"
    units = "mm"
    text = "Smooth upper bound of the largest gap between the first and the last contact point."

    def evaluate(self, result, partials):
        points, gap = self.open_gaps(result)
        value, by_gap = p_norm(gap, self.order)
        partials.output(self.profile, "gap")[0, points] += by_gap
        return value


@dataclass(frozen=True)
class GapSquareIntegral(BetweenContacts):
    """Integral of g^2 over the undeformed boundary that is open between contacts."""

    name: str = "gap_square_integral"
    units = "mm**3"
    text = (
        "Integral of the squared gap between the first and the last contact point, nearly independent "
        "of the particle spacing."
    )

    def evaluate(self, result, partials):
        stretch = self.stretch(result)
        line = BoundaryLine(result.term(self.profile).where, stretch, result.particles)
        gap = result.response(self.profile).gap[stretch]
        # int max(g, 0)^2 dS; depends on the gaps and, by way of the lengths, on the particles
        value, by_gap, by_length = opened_square_integral(gap, line.length)
        partials.output(self.profile, "gap")[0, stretch] += by_gap
        line.add_partials(by_length, partials.particles[0])
        return value
