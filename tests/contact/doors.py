"""Rigid profiles of all forms as functions of their radius, and one point pressed on them."""

import numpy as np

from seal_mdao.contact.friction import FRICTION, ContactHistory
from seal_mdao.contact.kinematics import normal_gaps
from seal_mdao.contact.rigid_forces import contact_linearization, contact_points
from seal_mdao.geometry.curve import ARC, curve_point, curve_velocity
from seal_mdao.geometry.pose import Pose
from seal_mdao.geometry.profile import (
    PieceRates,
    Pieces,
    circle_profile,
    corner_profile,
    flat_profile,
    rigid_profile,
    segmented_corner_profile,
)

AT_REST = Pose.of((0.0, 0.0))


def hollow(radius):
    """A rigid bore with the body inside: an arc walked clockwise, radius negative."""
    way = 2 * np.pi
    return rigid_profile(
        Pieces([ARC], [(0.5, 0.2)], [2.0], [-radius], [0.0], [way * radius]),
        PieceRates(radius=[[-1.0]], period=[way]), way * radius,
    )  # fmt: skip


FORMS = {
    "corner": lambda r: corner_profile(2.0, r, 6.0),
    "segments": lambda r: segmented_corner_profile(2.0, r, 6.0, 8),
    "flat": lambda r: flat_profile(),
    "circle": lambda r: circle_profile((0.4, 1.0), r),
    "hollow": hollow,
}
RADIUS = 4.0


def curve(profile, piece, xi):
    """x_c, t, x_c,xixi, x_c,xixixi as an array (4, 2)."""
    return np.array(curve_point(profile, piece, xi))


def velocity(profile, piece, xi, shape=0):
    """V_c, V_c,xi, V_c,xixi as an array (3, 2); zero for a profile without shape parameters."""
    if profile.n_shapes == 0:
        return np.zeros((3, 2))
    return np.array(curve_velocity(profile, shape, piece, xi))


def normal(profile, piece, xi):
    """Outward unit normal of the rigid body, the tangent turned clockwise."""
    t = curve(profile, piece, xi)[1]
    return np.array([t[1], -t[0]]) / np.hypot(*t)


def at_gap(profile, piece, share, gap):
    """A point at a distance ``gap`` from a place on a piece, and its natural coordinate."""
    length = min(profile.length[piece], 300.0)
    xi = profile.start[piece] + share * length
    return curve(profile, piece, xi)[0] + gap * normal(profile, piece, xi), xi


def _at(law, profile, pose, x):
    """The law at the gap of one point."""
    gap = np.empty(1)
    normal_gaps(profile.curve, pose, np.array([x], float), gap)
    return law.at(gap)


def press(profile, law, x, history, previous=0, length=1.0, pose=AT_REST, through_slip=False):
    """``contact_points`` for one point: force, tangent, state, kept, gap, whether it is taken to stick
    or slip, what it did."""
    state, variables = history
    before = ContactHistory(np.array([state]), np.array([variables], float))
    way, force, tangent = np.array([previous]), np.empty((1, 2)), np.empty((1, 2, 2))
    after, kept, gap = np.empty(1, np.int64), np.empty((1, 3)), np.empty(1)
    made = contact_points(
        profile, _at(law, profile, pose, x), pose, np.array([x], float),
        np.array([float(length)]), before, way, through_slip, force, tangent, after, kept, gap,
    )  # fmt: skip
    return force[0], tangent[0], int(after[0]), kept[0], float(gap[0]), made, int(way[0])


def linearized(profile, law, x, history, length=1.0, pose=AT_REST):
    """``contact_linearization`` for one point, (6, FRICTION + constants of the law + S)."""
    state, variables = history
    before = ContactHistory(np.array([state]), np.array([variables], float))
    columns = FRICTION + len(law.constants) + profile.n_shapes
    out = np.full((1, 6, columns), np.nan)
    contact_linearization(
        profile, profile.curve, _at(law, profile, pose, x), pose, np.empty((0, 3)), np.array([x], float),
        np.array([float(length)]), np.zeros((1, 2)), before, np.array([0]), out,
    )  # fmt: skip
    return out[0]
