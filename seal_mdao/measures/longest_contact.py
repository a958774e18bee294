"""Longest connected part of a contact with a pressure above a given value."""

from dataclasses import dataclass

import numpy as np

from seal_mdao import values
from seal_mdao.measures.boundary_line import BoundaryLine, ordered_points
from seal_mdao.measures.contact_pressure import ContactWidth, PointPressures
from seal_mdao.measures.measure import Measure


@dataclass(frozen=True)
class LongestContact(Measure):
    """Deformed length of the longest connected part of a contact with true pressures above a limit.

    The pressure is taken as linear between a contact point above the limit and one below it, or the end
    of the contact as of ``ContactWidth``, where it is zero. With the limit 0 the part therefore ends as
    ``ContactWidth`` does, and a higher limit gives no longer part. The value jumps only where two parts
    join or one divides, by the length of the shorter one. The derivative jumps where another part
    becomes the longest and, for limits above 0, where an end passes a contact point or a point beside
    an end opens or closes.

    Attributes
    ----------
    profile : str
    pressure : float
        Limit, kPa.

    Raises
    ------
    ValueError
        For a negative limit.
    """

    profile: str
    pressure: float = 0.0
    name: str = "longest_contact"
    units = "mm"
    text = "Longest connected part of the deformed contact with a pressure above a limit."
    needs_points = True

    def __post_init__(self):
        values.real(f"pressure of {self.name!r}", self.pressure, 0.0)

    def least_scale(self, result):
        # less than the distance of the points is not resolved
        return float(result.term(self.profile).where.lengths(result.particles).mean())

    def evaluate(self, result, partials):
        points = PointPressures(result, self.profile, nominal=False)
        order = ordered_points(points.term.where)
        excess, closed = points.value[order] - self.pressure, order[0] == order[-1]
        line = BoundaryLine(points.term.where, order, result.deformed())
        width = ContactWidth(self.profile)
        ends = width.ends(result, line)
        fraction, by_first, by_second = fractions_above(excess)
        part = longest_part(excess > 0.0, line.length * ends.fraction * fraction, closed)
        # l = sum_k L_k phi_k f_k over the segments k of the longest part: phi_k the fraction of the
        # segment in contact, f_k the part of that with a pressure above the limit. dl at constant f_k
        total = width.add_length(result, line, ends, part * fraction, partials)
        # dl/df_k = L_k phi_k,  f_k(p_k, p_(k+1))
        length, on_pressure = line.length * ends.fraction * part, np.zeros(points.value.size)
        np.add.at(on_pressure, order[:-1], length * by_first)
        np.add.at(on_pressure, order[1:], length * by_second)
        points.add_partials(partials, 0, on_pressure)
        return total


def fractions_above(excess: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Compute the fraction of every segment on which a linear function is positive.

    Parameters
    ----------
    excess : ndarray, shape (k,)
        Values at the ends of the segments.

    Returns
    -------
    fraction, by_first, by_second : ndarray, shape (k - 1,)
        phi, and its derivatives in the values at both ends.
    """
    a, b = excess[:-1], excess[1:]
    first, second = (a > 0.0) & (b <= 0.0), (b > 0.0) & (a <= 0.0)
    span = np.where(first | second, np.abs(a - b), 1.0)
    # a > 0 >= b:  phi = a / (a - b),  dphi/da = -b / (a - b)^2,  dphi/db = a / (a - b)^2; mirrored
    fraction = np.where(first, a, np.where(second, b, (a > 0.0) & (b > 0.0))) / span
    by_first = np.where(first, -b, np.where(second, b, 0.0)) / span**2
    by_second = np.where(first, a, np.where(second, -a, 0.0)) / span**2
    return fraction, by_first, by_second


def longest_part(above: np.ndarray, length: np.ndarray, closed: bool) -> np.ndarray:
    """Select the segments of the longest run of consecutive points.

    Parameters
    ----------
    above : ndarray of bool, shape (k,)
        Which points, in order along the boundary, may belong to a run.
    length : ndarray, shape (k - 1,)
        Part of every segment that counts, mm.
    closed : bool
        Whether the last point is the first one once more.

    Returns
    -------
    ndarray of bool, shape (k - 1,)
        The segments with an end in the longest run, the first of equal ones.
    """
    # all points of a run have the same number of other points before them
    run = np.cumsum(~above)
    # a segment belongs to the run of its end above the limit
    of_segment = np.where(above[:-1], run[:-1], run[1:])
    if closed and above[0]:
        # the last run continues in the first one
        of_segment[of_segment == run[-1]] = run[0]
    touched = above[:-1] | above[1:]
    totals = np.bincount(of_segment, weights=length * touched)
    return touched & (of_segment == totals.argmax())
