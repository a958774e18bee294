"""Friction of a contact point: slip (19), stick or slip (28), traction (29), and their rates (60).

Coulomb's law with a penalty; other laws are in ``friction_law``, one law an edge in
``friction_by_group``, self-contact in ``self_friction``, the key of seal files in
``seals.file.friction_table``. Two histories:

``accumulated``: the elastic slip of the previous step is carried and return-mapped.
``incremental``: slip is measured from the previous converged step only, Eq. (19) as printed.

A point that enters contact starts at zero slip from where it touched. That place is interpolated
between the open point before the step and the closed one after it, with the normal gaps as weights,
so the path does not jump when a design makes a point touch one step earlier or later.

Where |t| != 1 the slip of a step is |t0| (xi - xi0), its arc length as measured at its beginning, and
the force is the traction times v = |t||t0|/c, its conjugate: both are the same for xi and for any
multiple of it. Where |t| changes along the curve they err by the relative change of |t| over the slip
of one step, so both rules converge to the arc length as steps are refined; a natural coordinate close
to the arc length errs least.
"""

import math
from typing import NamedTuple

import numpy as np

from seal_mdao import values
from seal_mdao.compilation import inlined, internal
from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.friction_law import FrictionLaw
from seal_mdao.terms.term import Scalar

OTHER_LAWS = (FrictionLaw, FrictionByGroup)
"""Classes of friction other than one coefficient of Coulomb's law."""
FRICTION_HISTORIES = ("accumulated", "incremental")

# Contact states; a point of UNKNOWN state was near no other boundary and touches without slip.
UNKNOWN, OPEN, STICK, SLIP = -1, 0, 1, 2

# Inputs and outputs of the local linearisation of one contact point. FRICTION is the first constant of
# the friction law; SHAPE, the first of the profile's shape parameters, follows the one of Coulomb's law.
X, Y, XI_0, SIZE_0, SLIP_0, LENGTH, NORMAL_PENALTY, TANGENT_PENALTY, FRICTION, SHAPE = range(10)
FORCE_X, FORCE_Y, XI, SIZE, CARRIED, GAP = range(6)


class ContactLaw(NamedTuple):
    """Contact law: penalties, friction law, and the rule for the friction history.

    A penalty that is None follows from the body when the contact becomes part of a seal
    (``contact.default_penalties``).

    Attributes
    ----------
    normal_penalty, tangent_penalty : float or None
        Stress per length.
    friction : float, FrictionLaw or FrictionByGroup
        Coulomb's friction coefficient, another law, or laws of several groups of points.
    accumulated : bool
        Whether the elastic slip of a step passes to the next one.
    limits : ndarray, shape (k, 2, 2 + m), or None
        Of another law than Coulomb's at the points of a kernel (``at``), ``FrictionLaw.at`` of the
        pressures there.
    """

    normal_penalty: float | None = None
    tangent_penalty: float | None = None
    friction: float | FrictionLaw | FrictionByGroup = 0.0
    accumulated: bool = True
    limits: np.ndarray | None = None

    @property
    def open_penalties(self) -> tuple:
        """Names of the penalties that are None."""
        return tuple(
            name for name in ("normal_penalty", "tangent_penalty") if getattr(self, name) is None
        )

    @property
    def frictionless(self) -> bool:
        """Whether there is no friction: Coulomb's law with a coefficient of zero."""
        return not isinstance(self.friction, OTHER_LAWS) and self.friction == 0.0

    @property
    def constants(self) -> dict:
        """Constants of the friction law by name, in the order of their columns from FRICTION on."""
        if isinstance(self.friction, OTHER_LAWS):
            return self.friction.by_name
        return {"friction": self.friction}

    @property
    def scalars(self) -> dict:
        """Penalties and constants of the friction law, ``Scalar`` by name."""
        found = {
            "normal_penalty": Scalar(self.normal_penalty, "kPa/mm", "Normal penalty w_n."),
            "tangent_penalty": Scalar(self.tangent_penalty, "kPa/mm", "Tangential penalty w_t."),
        }
        if not isinstance(self.friction, OTHER_LAWS):
            return found | {
                "friction": Scalar(self.friction, None, "Coulomb friction coefficient.")
            }
        text = f"Constant of the friction law {self.friction.name}: "
        return found | {
            name: Scalar(value, None, f"{text}{name}.") for name, value in self.constants.items()
        }

    def with_parameters(self, changed: dict) -> "ContactLaw":
        """Return the law with some of its ``scalars`` changed; other names are ignored."""
        own = {name: changed[name] for name in self.scalars if name in changed}
        constants = {name: own.pop(name) for name in self.constants if name in own}
        if isinstance(self.friction, OTHER_LAWS):
            return self._replace(friction=self.friction.with_constants(constants), **own)
        return self._replace(**own, **constants)

    def at(self, gap: np.ndarray) -> "ContactLaw":
        """Return the law in the form of the kernels, for points with normal gaps (k,)."""
        if not isinstance(self.friction, OTHER_LAWS):
            return self
        # p = -w_n g_n
        limits = self.friction.at(np.maximum(-self.normal_penalty * gap, 0.0))
        return self._replace(friction=0.0, limits=limits)

    def check(self, label: str) -> None:
        """Validate the law of the contact ``label``.

        Raises
        ------
        ValueError
            For a penalty that is not positive, a negative friction coefficient, or what is no number.
        """
        for name in ("normal_penalty", "tangent_penalty"):
            if name not in self.open_penalties:
                values.real(f"{name} of {label!r}", getattr(self, name), above=0.0)
        if not isinstance(self.friction, OTHER_LAWS):
            values.real(f"friction of {label!r}", self.friction, 0.0)

    def require_penalties(self, label: str) -> None:
        """Raise ValueError for a penalty that is None; ``label`` is the contact's."""
        if self.open_penalties:
            raise ValueError(
                f"{self.open_penalties[0]} of the contact {label!r} has no value; give one in "
                "kPa/mm, or use the contact in a seal, for which penalties are chosen automatically"
            )

    def potential(self, gap: np.ndarray, length: np.ndarray) -> float:
        """Energy of the normal penalty at points with gaps (k,) that stand for ``length`` (k,), mJ/m."""
        # Pi = sum w_n/2 g_n^2 l over g_n < 0, Eq. (20)
        return 0.5 * self.normal_penalty * float(length @ np.minimum(gap, 0.0) ** 2)

    def most_friction_work(self, slip, gaps, length) -> float:
        """Compute an upper bound of the friction work in an increment: the limit (mu p with
        Coulomb's law) at the larger pressure times |slip|.

        Parameters
        ----------
        slip, length : ndarray, shape (k,)
        gaps : pair of ndarray, shape (k,)
            Normal gaps before and after; infinite ones are admissible. A point that is open at one end
            slips in contact over the fraction g_n / (g_n - g_n0) of the increment alone.
        """
        low, high = np.minimum(*gaps), np.maximum(*gaps)
        at = np.flatnonzero(low < 0.0)
        low, high = low[at], high[at]
        # fraction of the increment in contact
        fraction = np.where(high > 0.0, low / np.where(high > 0.0, low - high, 1.0), 1.0)
        # p = w_n |g_n|, the larger one
        pressure = -self.normal_penalty * low
        if isinstance(self.friction, OTHER_LAWS):
            limit, factor = self.friction.highest(pressure), 1.0
        else:
            limit, factor = pressure, self.friction
        return factor * float(np.sum(limit * np.abs(slip[at]) * fraction * length[at]))

    def least_friction_work(self, before: "ContactHistory", after: "ContactHistory", length):
        """Compute a lower bound of the friction work in an increment: the change of the energy of the
        elastic slip, since slip dissipates.

        Parameters
        ----------
        before, after : ContactHistory
            Before and after the increment.
        length : ndarray, shape (k,)

        Returns
        -------
        float
            mJ/m
        """
        # E = sum w_t/2 s^2 l over points in contact, Eq. (20)
        stored = [
            length[own.in_contact] @ own.variables[own.in_contact, 2] ** 2
            for own in (before, after)
        ]
        return 0.5 * self.tangent_penalty * float(stored[1] - stored[0])


class ContactHistory(NamedTuple):
    """History variables of contact points that pass from one converged step to the next.

    Attributes
    ----------
    state : ndarray of int, shape (n,)
        OPEN, STICK or SLIP at the previous step.
    variables : ndarray, shape (n, 3)
        xi0, |t0|, and the elastic slip s0 of a point in contact or the normal gap of an open one.
    """

    state: np.ndarray
    variables: np.ndarray

    @property
    def in_contact(self) -> np.ndarray:
        """Mask (n,) of the points that stick or slip."""
        return (self.state == STICK) | (self.state == SLIP)


def no_history(n_points: int) -> ContactHistory:
    """Return the history of points that have never touched."""
    return ContactHistory(np.zeros(n_points, np.int64), np.zeros((n_points, 3)))


def uses_history(speed_varies: bool, state: np.ndarray) -> np.ndarray:
    """Return which forces depend on the history at the beginning of the step, from the contact
    states (n,).

    In stick all of it is used. In slip the traction follows from the gap, but v = |t||t0|/c takes
    |t0|: it matters where |t| varies along the curve, that is on cubic pieces. d|t|/dx has the
    direction of dxi/dx. Only points in stick carry their earlier history to the next step.
    """
    return state != OPEN if speed_varies else state == STICK


@inlined
def elastic_slip(g_n, change, state_0, size_0, carried):
    """Compute the trial slip g_t of Eq. (19) plus the carried elastic slip; ``change`` is xi - xi0.

    A point that was open slides only over the share g_n / (g_n - g_n0) of the step after it touched.
    """
    if state_0 == UNKNOWN:
        return 0.0
    # g_t = |t0| (xi - xi0)   Eq. (19), of a changed design (59)
    slid = size_0 * change
    if state_0 == OPEN:
        # after the touch: g_t g_n / (g_n - g_n0)
        return slid * g_n / (g_n - carried)
    # g_t + s0
    return slid + carried


@inlined
def elastic_slip_rate(column, g_n, gap_r, change, change_r, state_0, size_0, carried):
    """Derivative of ``elastic_slip`` with respect to the input ``column``, Eq. (60)."""
    if state_0 == UNKNOWN:
        return 0.0
    # g_t' = |t0|' (xi - xi0) + |t0| (xi' - xi0')   Eq. (60). With (52) now and at the step before (0),
    # |t0|' = beta0 xi0' + e_t0.V_c0,xi and w = V - V_c + z' this is, in the order of the print,
    #   nu e_t.w + (g_n |t0|/c) e_n.V_c,xi                         from xi'; with dx alone (32)
    #   + ((beta0 g_t - |t0|^2)/c0) e_t0.w0                        from |t0|' and xi0'
    #   + ((g_n0 beta0 (xi - xi0) - g_n0 |t0|)/c0) e_n0.V_c0,xi    from |t0|' and xi0'; g_n |t0| printed
    #   + (xi - xi0) e_t0.V_c0,xi                                  from |t0|'
    slid, slid_r = size_0 * change, size_0 * change_r
    if column == SIZE_0:
        slid_r = change
    carried_r = 1.0 if column == SLIP_0 else 0.0
    if state_0 != OPEN:
        return slid_r + carried_r
    # (g_n / (g_n - g_n0))' = (g_n g_n0' - g_n0 g_n') / (g_n - g_n0)^2
    whole = g_n - carried
    share_r = (g_n * carried_r - carried * gap_r) / (whole * whole)
    return slid_r * g_n / whole + slid * share_r


@internal
def law_constants(limits):
    """Return the number of constants of the friction law; one for Coulomb's."""
    if limits is None:
        return 1
    return limits.shape[2] - 2


@internal
def friction_limit(limits, law, i, g_n, g_t):
    """Compute the largest traction of point ``i`` against slip along g_t: mu w_n |g_n| of Eq. (28),
    or the value of another law in ``law.limits``, given separately so that numba omits the unused
    branch."""
    if limits is None:
        # mu w_n |g_n|   Eq. (28)
        return -law.friction * law.normal_penalty * g_n
    return limits[i, 1 if math.copysign(1.0, g_t) > 0.0 else 0, 0]


@internal
def _friction_limit_rate(limits, law, i, column, g_n, gap_r, tau):
    """Derivative of ``friction_limit``, which is |tau|."""
    if limits is None:
        # d(mu w_n |g_n|) = mu |g_n| dw_n + w_n |g_n| dmu - mu w_n dg_n
        if column == NORMAL_PENALTY:
            return abs(tau) / law.normal_penalty
        if column == FRICTION:
            return -law.normal_penalty * g_n
        return -law.friction * law.normal_penalty * gap_r
    own = limits[i, 1 if math.copysign(1.0, tau) > 0.0 else 0]
    if FRICTION <= column < FRICTION + own.size - 2:
        return own[2 + column - FRICTION]  # d limit / d constant
    # d limit / dp p', p = -w_n g_n
    return own[1] * (-g_n if column == NORMAL_PENALTY else -law.normal_penalty * gap_r)


@inlined
def traction(law, i, g_n, g_t):
    """Contact state and tangential traction per area, Eqs. (28), (29).

    Parameters
    ----------
    law : ContactLaw
        ``at`` the gaps of the points, of which this is the ``i``-th.
    g_n, g_t : float
        Normal gap, and elastic slip as if the point stuck.

    Returns
    -------
    state : int
    tau : float
        w_t g_t in stick, +-mu w_n |g_n| in slip; stress.
    """
    if g_n >= 0.0:
        return OPEN, 0.0
    limit = friction_limit(law.limits, law, i, g_n, g_t)
    # stick: tau = w_t g_t   Eqs. (28), (29)
    tau = law.tangent_penalty * g_t
    if abs(tau) < limit:
        return STICK, tau
    # slip: tau = omega_t g_n, omega_t = -mu w_n sgn(g_t), which is +-mu w_n |g_n|   Eqs. (39), (40)
    return SLIP, math.copysign(limit, g_t)


@inlined
def traction_rate(law, i, column, state, tau, g_n, gap_r, slip_r):
    """Derivatives of tau and of the elastic slip tau / w_t that is carried on, with respect to the input
    ``column``: tau' of the tangents (36), (41) and of the loads (63), (66)."""
    if state == STICK:
        # tau' = w_t g_t' + w_t' g_t, the elastic slip g_t'
        tau_r = law.tangent_penalty * slip_r
        if column == TANGENT_PENALTY:
            tau_r = tau / law.tangent_penalty
        return tau_r, slip_r
    limit_r = _friction_limit_rate(law.limits, law, i, column, g_n, gap_r, tau)
    # tau' = +-(mu w_n |g_n|)' = (omega_t g_n)', the elastic slip (tau / w_t)'
    tau_r = math.copysign(1.0, tau) * limit_r
    slip_r = tau_r / law.tangent_penalty
    if column == TANGENT_PENALTY:
        slip_r = -tau / law.tangent_penalty**2
    return tau_r, slip_r
