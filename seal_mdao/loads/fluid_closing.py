"""Contact pressure of rigid profiles that close an edge against a fluid, and its rates.

The true pressure of a particle, the normal force over the deformed length as in
``measures.contact_pressure``, which the fluid has to overcome:

    c = w_n <-g_n> A / a,

with A and a the undeformed and the deformed tributary length, in a body of revolution the area
(``terms.points.MaterialPoints.measures``).
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.contact.friction import (
    FRICTION,
    GAP,
    NORMAL_PENALTY,
    SHAPE,
    ContactHistory,
)
from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.contact.rigid_forces import contact_linearization
from seal_mdao.geometry.motion import Cached
from seal_mdao.terms.points import MaterialPoints, single_points


class ClosingRates(NamedTuple):
    """Derivatives of the contact pressure.

    Attributes
    ----------
    by_place, by_reference : ndarray, shape (k, 3, 2)
        With the deformed and the undeformed places of the particle before, the particle itself and the
        one after it.
    by_parameter : ndarray, shape (k, n)
        With the parameters.
    """

    by_place: np.ndarray
    by_reference: np.ndarray
    by_parameter: np.ndarray


def closing_names(contact: RigidContact) -> tuple:
    """List the parameters of a contact that affect its pressure: motion, shape, normal penalty."""
    law = {f"{contact.prefix}{name}" for name in ("tangent_penalty", *contact.law.constants)}
    return tuple(name for name in contact.scalars if name not in law)


def points_along(
    where: MaterialPoints, particles: np.ndarray, touches: np.ndarray
) -> MaterialPoints:
    """Return contact points at particles along an edge, numbered along it.

    Parameters
    ----------
    where : MaterialPoints
        Contact points, at particles; sides that are not part of the edge get no length.
    particles : ndarray of int, shape (k,)
        Particles along the edge.
    touches : ndarray of int, shape (t,)
        Indices in ``particles`` of those that are contact points.
    """
    at = np.argsort(where.at_particles)
    rows = at[np.searchsorted(where.at_particles, particles[touches], sorter=at)]
    number = np.full(max(particles.max(), where.edges.max(initial=0)) + 1, -1)
    number[particles] = np.arange(len(particles))
    # ends of the sides, shape (t, e, 2); both at the point itself for another edge
    ends = number[where.edges[rows]]
    inside = (ends >= 0).all(axis=2, keepdims=True)
    return MaterialPoints(
        single_points(touches), np.zeros(len(touches)),
        np.where(inside, ends, touches[:, None, None]), where.fractions[rows],
        radial=None if where.radial is None else where.radial[rows],
    )  # fmt: skip


class Closing:
    """True contact pressure of one profile at particles of an edge.

    Parameters
    ----------
    contact : RigidContact
    particles : ndarray of int, shape (k,)
    reference : ndarray, shape (k, 2)
        Their undeformed places.
    names : tuple of str
        Parameters, in the order of the columns of ``rates``.
    """

    def __init__(self, contact: RigidContact, particles, reference, names: tuple):
        self.profile = contact.shape.profile()
        # friction does not press
        self.law = contact.law._replace(friction=0.0)
        self.curve = self.profile.curve
        # particles of the edge that the profile can touch
        self.touches = np.flatnonzero(np.isin(particles, contact.where.at_particles))
        self.pose = Cached(contact.motion.pose)
        self.motion_rates = Cached(contact.motion.rates_at)
        self.columns = [names.index(name) for name in closing_names(contact)]
        self.n_names = len(names)
        self.points = points_along(contact.where, particles, self.touches)
        self.undeformed = self.points.measures(reference)
        self.undeformed_rates = self._measure_rates(reference)

    def _stretch(self, x) -> tuple[np.ndarray, np.ndarray]:
        """Compute the deformed tributary lengths a and A / a, which is 1 without a side, shape (t,)."""
        a = self.points.measures(x)
        on = a > 0.0
        return np.where(on, a, 1.0), np.divide(self.undeformed, a, out=np.ones(len(a)), where=on)

    def _measure_rates(self, x) -> np.ndarray:
        """Compute the derivatives of the tributary lengths with the places of the particle before, the
        particle itself and the one after it, shape (t, 3, 2)."""
        t = len(self.touches)
        # da_i/dx_j in x_bar[1 + j, :, i]; no particle is before the first and after the last
        x_bar = np.zeros((len(x) + 2, 2, t))
        self.points.add_measure_seeds(x, np.eye(t), x_bar[1:-1])
        return x_bar[self.touches[:, None] + np.arange(3), :, np.arange(t)[:, None]]

    def _gaps(self, x, fraction):
        gap = np.empty(len(self.touches))
        places = np.ascontiguousarray(x[self.touches])
        normal_gaps(self.curve, self.pose(fraction), places, gap)
        return gap

    def pressure(self, x: np.ndarray, fraction: float) -> np.ndarray:
        """Evaluate the contact pressure at the deformed particles ``x`` (k, 2), shape (k,), kPa."""
        out, gap = np.zeros(len(x)), self._gaps(x, fraction)
        # c = w_n <-g_n> A / a
        out[self.touches] = self.law.normal_penalty * np.maximum(-gap, 0.0) * self._stretch(x)[1]
        return out

    def rates(self, x: np.ndarray, fraction: float) -> ClosingRates:
        """Compute the derivatives of the contact pressure, zero at points without contact."""
        gap, k = self._gaps(x, fraction), len(x)
        points = self.touches[gap < 0.0]
        motion = self.motion_rates(fraction)
        columns = SHAPE + self.profile.period_rate.size + len(motion)
        local = np.empty((points.size, GAP + 1, columns))
        # only the derivatives of the gap are used, which do not depend on the state before
        open_before = ContactHistory(np.zeros(k, np.int64), np.ones((k, 3)))
        contact_linearization(
            self.profile, self.curve, self.law, self.pose(fraction), motion, x, np.ones(k),
            np.zeros((k, 2)), open_before, points, local,
        )  # fmt: skip
        out = ClosingRates(*np.zeros((2, k, 3, 2)), np.zeros((k, self.n_names)))
        closed = gap < 0.0
        a, ratio = (own[closed] for own in self._stretch(x))
        # dc = A / a (-w_n dg_n - g_n dw_n) + c (dA / A - da / a),  c / A = w_n <-g_n> / a
        by_gap = -self.law.normal_penalty * local[:, GAP]
        by_gap[:, NORMAL_PENALTY] = -gap[closed]
        by_gap *= ratio[:, None]
        force = (-self.law.normal_penalty * gap[closed] / a)[:, None, None]
        out.by_place[points] = -(force * ratio[:, None, None]) * self._measure_rates(x)[closed]
        out.by_place[points, 1] += by_gap[:, :2]
        out.by_reference[points] = force * self.undeformed_rates[closed]
        own = [NORMAL_PENALTY, *range(FRICTION + 1, columns)]
        for column, name in zip(own, self.columns, strict=True):
            out.by_parameter[points, name] += by_gap[:, column]
        return out
