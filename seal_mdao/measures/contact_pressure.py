"""Measures of contact pressure and contact width, true and nominal.

The true (Cauchy) pressure is the normal force over the deformed length, the nominal one that over the
undeformed length:

    p_nominal = w_n |g_n|,    p = p_nominal L / l,

with L and l the undeformed and the deformed length of the boundary that belongs to a contact point.
"""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.measures.boundary_line import (
    BoundaryLine,
    ContactFractions,
    add_deformed_seeds,
    contact_fractions,
    is_closed,
    ordered_points,
)
from seal_mdao.measures.contact_modulus import ContactModulus
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.selection import contact_patches
from seal_mdao.measures.smooth_peaks import MEAN_ORDER, lehmer_mean
from seal_mdao.terms.averaged_points import sharp_corners
from seal_mdao.values import place

ENOUGH, SOME = 5, 3
"""Least number of points in contact that resolve the peak to a few percent, and to some 10 %."""
LARGEST_FALL = 0.2
"""Largest relative fall from the peak to the points beside it; with more, peaks of the sections of
``tests/verification/references`` are 2 to 18 % too low."""
FINER = "use a smaller edge_spacing for the edge that touches this profile"
"""What to do about too few contact points."""


@dataclass(frozen=True)
class ContactWidth(Measure):
    """Length of the deformed boundary that is in contact at the end of the path.

    Its ends lie between contact points and follow from the pressure of the last point in contact and
    the gap of the next one (``boundary_line.contact_fractions``).

    Attributes
    ----------
    profile : str
    nominal : bool
        Measure the undeformed boundary instead.
    """

    profile: str
    nominal: bool = False
    name: str = "contact_width"
    units = "mm"
    text = "Length of the deformed boundary in contact."
    needs_points = True

    def __post_init__(self):
        if self.nominal:
            object.__setattr__(self, "text", "Length of the undeformed boundary in contact.")

    def least_scale(self, result):
        # less than the distance of the points is not resolved
        return float(result.term(self.profile).where.lengths(result.particles).mean())

    def evaluate(self, result, partials):
        where = result.term(self.profile).where
        particles = result.particles if self.nominal else result.deformed()
        line = BoundaryLine(where, ordered_points(where), particles)
        ends = self.ends(result, line)
        return self.add_length(result, line, ends, np.ones(line.length.size, bool), partials)

    def ends(self, result, line: BoundaryLine) -> ContactFractions:
        """Compute the fractions in contact of the segments of the complete boundary."""
        modulus = ContactModulus(result, self.profile).values
        gap, law = result.response(self.profile).gap, result.term(self.profile).law
        on = line.stretch
        return contact_fractions(gap[on], line.length, modulus[on], law.normal_penalty)

    def add_length(self, result, line, ends: ContactFractions, chosen, partials) -> float:
        """Compute the length in contact of segments with the factors ``chosen`` (k - 1,), and add its
        derivatives."""
        term, modulus = result.term(self.profile), ContactModulus(result, self.profile)
        order, length = line.stretch, line.length * chosen
        on_gap = partials.output(self.profile, "gap")[0]
        # width = sum_k L_k phi_k(g_k, g_(k+1), ln(E* / (w_n L_k))), phi_k the fraction in contact
        np.add.at(on_gap, order[:-1], length * ends.by_first)
        np.add.at(on_gap, order[1:], length * ends.by_second)
        by_log = length * ends.by_log
        partials.parameter(term.names[0])[0] -= by_log.sum() / term.law.normal_penalty
        on_modulus, closed = np.zeros(len(term.where)), order[ends.closed]
        np.add.at(on_modulus, closed, by_log / modulus.values[closed])
        modulus.add_partials(partials, 0, on_modulus)
        on_line = np.zeros_like(result.particles)
        # dwidth/dL_k = phi_k - dphi_k/d ln(E*), by way of the particles
        line.add_partials((ends.fraction - ends.by_log) * chosen, on_line)
        if self.nominal:
            partials.particles[0] += on_line
        else:
            add_deformed_seeds(partials, 0, on_line)
        return length @ ends.fraction


@dataclass(frozen=True)
class ContactPressure(Measure):
    """Contact pressure of patches of contact points: a mean of high order, below the peak.

    Attributes
    ----------
    profile : str
    patches : tuple of tuple of int, or None
        Contact points of every patch; None for all contact points, divided at the middle of the open
        parts between the contact regions of the nominal seal.
    order : int
        Of the Lehmer mean.
    nominal : bool
        Use the force per undeformed length, w_n |g_n|, instead of that per deformed length.
    """

    profile: str
    patches: tuple | None = None
    order: int = MEAN_ORDER
    nominal: bool = False
    name: str = "contact_pressure"
    units = "kPa"
    text = (
        "True contact pressure of each contact region: a mean of high order, "
        "slightly below the peak."
    )
    needs_points = True

    def __post_init__(self):
        if self.nominal:
            object.__setattr__(self, "text", self.text.replace("True", "Nominal"))

    @property
    def selects_points(self):
        return self.patches is None

    def frozen(self, nominal):
        closed = is_closed(nominal.term(self.profile).where)
        found = contact_patches(nominal.response(self.profile).state, closed)
        return replace(self, patches=tuple(tuple(int(p) for p in patch) for patch in found))

    def on_refined(self, fine, particles):
        # contact points there have other indices
        return replace(self, patches=None).frozen(fine)

    def size(self, seal):
        return len(self.patches)

    def evaluate(self, result, partials):
        points = PointPressures(result, self.profile, self.nominal)
        values = np.empty(len(self.patches))
        for row, patch in enumerate(self.patches):
            own, on_pressure = np.array(patch, int), np.zeros(points.value.size)
            # one Lehmer mean per patch, with derivatives in the pressures of its points only
            values[row], on_pressure[own] = lehmer_mean(points.value[own], self.order)
            points.add_partials(partials, row, on_pressure)
        return values


class PointPressures:
    """Contact pressures of all points of a profile at the end of the path, kPa."""

    def __init__(self, result, profile: str, nominal: bool):
        self.profile, self.nominal = profile, nominal
        self.term, self.gap = result.term(profile), result.response(profile).gap
        self.penalty = self.term.law.normal_penalty
        # p_nominal = w_n <-g_n>
        self.undeformed, self.value = result.particles, self.penalty * np.maximum(-self.gap, 0.0)
        if nominal:
            self.ratio = np.ones(self.gap.size)
            return
        # p = p_nominal L / l, of areas in a body of revolution
        self.deformed = result.deformed()
        self.length = self.term.where.measures(self.deformed)
        self.ratio = self.term.length / self.length
        self.value = self.value * self.ratio

    def add_partials(self, partials, row: int, on_pressure) -> None:
        """Add partial derivatives in gaps, lengths and the normal penalty of a function with derivatives
        ``on_pressure`` (k,)."""
        on_gap = partials.output(self.profile, "gap")
        # dp/dg = -w_n L / l in contact,  dp/dw_n = p / w_n
        on_gap[row] -= self.penalty * on_pressure * self.ratio * (self.gap < 0.0)
        on_penalty = partials.parameter(self.term.names[0])
        on_penalty[row] += on_pressure @ self.value / self.penalty
        if self.nominal:
            return
        # dp/dL = p / L,  dp/dl = -p / l
        where, on_share = self.term.where, on_pressure * self.value
        by_undeformed, by_deformed = on_share / self.term.length, -on_share / self.length
        where.add_measure_seeds(
            self.undeformed, by_undeformed[:, None], partials.particles[row][:, :, None]
        )
        # l depends on the deformed particles, L on the undeformed ones
        on_deformed = np.zeros_like(self.deformed)
        where.add_measure_seeds(self.deformed, by_deformed[:, None], on_deformed[:, :, None])
        add_deformed_seeds(partials, row, on_deformed)


@dataclass(frozen=True)
class PeakPressure(ContactPressure):
    """Contact pressure of all points of a contact: a mean of high order below the peak."""

    order: int = 40
    name: str = "peak_pressure"
    text = "True contact pressure: a mean of high order, slightly below the peak."

    @property
    def selects_points(self):
        return False

    def size(self, seal):
        return 1

    def evaluate(self, result, partials):
        # one patch of all contact points
        every = (tuple(range(len(result.term(self.profile).where))),)
        own = ContactPressure(self.profile, every, self.order, self.nominal)
        return own.evaluate(result, partials)


def points_around_peak(gap: np.ndarray, closed: bool) -> np.ndarray:
    """Find the consecutive contact points with gap < 0 around the deepest one, indices (k,); on a
    ``closed`` boundary they may pass its first point."""
    # a closed boundary begins at an open point
    first = int((gap >= 0.0).argmax()) if closed else 0
    gap = np.roll(gap, -first)
    opened, deepest = np.flatnonzero(gap >= 0.0), int(gap.argmin())
    if gap[deepest] >= 0.0:
        return np.zeros(0, int)
    before, after = opened[opened < deepest], opened[opened > deepest]
    found = np.arange(before.max(initial=-1) + 1, after.min(initial=gap.size))
    return (found + first) % gap.size


def peak_points(result, profile: str, step=None) -> np.ndarray:
    """Find the ``points_around_peak`` of a profile at a converged step, by default the end of the
    path."""
    closed = is_closed(result.term(profile).where)
    return points_around_peak(result.response(profile, step).gap, closed)


def fall_beside_peak(gap: np.ndarray, around: np.ndarray) -> float:
    """Compute the relative fall of the pressure from its peak to the mean of the points beside it that
    are in contact; ``around`` of ``points_around_peak``, with at least two points."""
    # p = w_n <-g>
    depth = -gap[around]
    peak = int(depth.argmax())
    beside = depth[[i for i in (peak - 1, peak + 1) if 0 <= i < depth.size]]
    return 1.0 - beside.mean() / depth[peak]


def _measured_profiles(result, kind=ContactPressure) -> list[str]:
    """List the profiles with measures of one kind, by default of the contact pressure."""
    every = (own.profile for own in result.measures() if isinstance(own, kind))
    return list(dict.fromkeys(every))


def unresolved_contacts(result) -> tuple[str, ...]:
    """Warn of measured contact pressures and widths with too few contact points, one line for each
    profile."""
    lines = []
    pressures = _measured_profiles(result)
    for profile in pressures:
        around = peak_points(result, profile)
        count = len(around)
        if SOME <= count < ENOUGH:
            lines.append(
                f"the peak pressure on {profile!r} is computed from only {count} adjacent points in "
                f"contact, so its numerical error may be 10 %; {FINER}"
            )
        elif 0 < count < SOME:
            lines.append(
                f"the peak pressure on {profile!r} is not resolved: at the peak only {_few(count)} in "
                "contact, which may be narrower there than the distance of two points; the "
                "computed peak may be several times too small and the contact width wrong, while "
                f"the force is affected far less; {FINER}"
            )
        elif count and _is_narrow(result, profile, around):
            points, gap = result.term(profile).where.points, result.response(profile).gap
            peak = place(points.at(result.particles)[gap.argmin()])
            lines.append(
                f"the peak pressure on {profile!r} is concentrated on less than twice the distance of "
                f"the contact points, near {peak} (undeformed coordinates), so it may be 20 % too low; "
                f"{FINER}; at a sharp corner it may grow with every refinement"
            )
    for profile in _measured_profiles(result, ContactWidth):
        count = len(peak_points(result, profile))
        if profile not in pressures and 0 < count < SOME:
            lines.append(
                f"the contact width on {profile!r} is not resolved: where the pressure is highest only "
                f"{_few(count)} in contact, and the width there may be several times too small or too "
                f"large, while the force is affected far less; {FINER}"
            )
    return tuple(lines)


def _is_narrow(result, profile: str, around: np.ndarray) -> bool:
    """Return whether the pressure falls much beside its peak, but not at a pressed corner, which has a
    warning of its own."""
    if _pressed_corners(result, profile).size:
        return False
    return fall_beside_peak(result.response(profile).gap, around) > LARGEST_FALL


def _few(count: int) -> str:
    """Name one or two contact points."""
    return "2 adjacent points are" if count == 2 else "1 point is"


def pressed_corners(result) -> tuple[str, ...]:
    """Warn of measured contact pressures beside a sharp corner of the section where contact at particles
    has one contact point for both sides, one line for each profile."""
    lines = []
    for profile in _measured_profiles(result):
        pressed = _pressed_corners(result, profile)
        if pressed.size:
            corner = place(result.term(profile).where.points.at(result.particles)[pressed[0]])
            lines.append(
                f"{profile!r} presses on a sharp corner of the section, at {corner} (undeformed "
                "coordinates): its contact point represents both sides of the corner, so the "
                "pressure there and beside it may be wrong by 15 to 60 %; use "
                'contact_points = "averages" for this profile, which has a contact point for each '
                "side, list only the pressed edges in contact of this profile, or round the corner"
            )
    return tuple(lines)


def _pressed_corners(result, profile: str) -> np.ndarray:
    """Find the contact points in contact that represent both sides of a sharp corner."""
    corners = two_sided_corners(result.term(profile).where, result.particles)
    return np.flatnonzero(corners & (result.response(profile).gap < 0.0))


def two_sided_corners(where, particles) -> np.ndarray:
    """Return a mask (k,) of the contact points at sharp corners, with a side of the section before and
    after them."""
    if where.edges.shape[1] != 2:  # points in the middle of a side
        return np.zeros(len(where), bool)
    return sharp_corners(where.edges, particles)
