"""Contact pressure of rigid profiles that close an edge against a fluid, and its rates."""

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


class ClosingRates(NamedTuple):
    """Derivatives of the contact pressure.

    Attributes
    ----------
    by_index : ndarray, shape (k, 2)
        With the place of the point itself.
    by_parameter : ndarray, shape (k, n)
        With the parameters.
    """

    by_index: np.ndarray
    by_parameter: np.ndarray


def closing_names(contact: RigidContact) -> tuple:
    """List the parameters of a contact that affect its pressure: motion, shape, normal penalty."""
    law = {f"{contact.prefix}{name}" for name in ("tangent_penalty", *contact.law.constants)}
    return tuple(name for name in contact.scalars if name not in law)


class Closing:
    """Contact pressure w_n |g_n| of one profile at particles of an edge.

    Parameters
    ----------
    contact : RigidContact
    particles : ndarray of int, shape (k,)
    names : tuple of str
        Parameters, in the order of the columns of ``rates``.
    """

    def __init__(self, contact: RigidContact, particles: np.ndarray, names: tuple):
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

    def _gaps(self, x, fraction):
        gap = np.empty(len(self.touches))
        places = np.ascontiguousarray(x[self.touches])
        normal_gaps(self.curve, self.pose(fraction), places, gap)
        return gap

    def pressure(self, x: np.ndarray, fraction: float) -> np.ndarray:
        """Evaluate the contact pressure at the deformed particles ``x`` (k, 2), shape (k,), kPa."""
        out = np.zeros(len(x))
        # c = w_n <-g_n>
        out[self.touches] = self.law.normal_penalty * np.maximum(-self._gaps(x, fraction), 0.0)
        return out

    def rates(self, x: np.ndarray, fraction: float) -> ClosingRates:
        """Compute the derivatives of the contact pressure, zero at points without contact."""
        gap, k = self._gaps(x, fraction), len(x)
        points = self.touches[gap < 0.0]
        motion = self.motion_rates(fraction)
        columns = SHAPE + self.profile.period_rate.size + len(motion)
        local = np.empty((points.size, GAP + 1, columns))
        # of all that the point could do no more is wanted than its gap
        open_before = ContactHistory(np.zeros(k, np.int64), np.ones((k, 3)))
        contact_linearization(
            self.profile, self.curve, self.law, self.pose(fraction), motion, x, np.ones(k),
            np.zeros((k, 2)), open_before, points, local,
        )  # fmt: skip
        out = ClosingRates(np.zeros((k, 2)), np.zeros((k, self.n_names)))
        # dc = -w_n dg_n - g_n dw_n
        by_gap = -self.law.normal_penalty * local[:, GAP]
        by_gap[:, NORMAL_PENALTY] = -gap[gap < 0.0]
        out.by_index[points] = by_gap[:, :2]
        own = [NORMAL_PENALTY, *range(FRICTION + 1, columns)]
        for column, name in zip(own, self.columns, strict=True):
            out.by_parameter[points, name] += by_gap[:, column]
        return out
