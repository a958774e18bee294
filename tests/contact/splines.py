"""Spline profiles with |t| far from 1 and two shape parameters each, as functions of these."""

import numpy as np

from seal_mdao.geometry.spline_profile import chord_length, spline_profile

PHI = 2 * np.pi * np.arange(24) / 24 - 0.5 * np.pi
S = np.linspace(-6.0, 6.0, 33)


def ellipse(a, b):
    """Closed, walked counter-clockwise from its lowest point; the seam is there."""
    unit = np.column_stack([np.cos(PHI), np.sin(PHI)])
    axes = np.array([[1.0, 0.0], [0.0, 1.0]])
    return spline_profile(unit * [a, b], unit * axes[:, None], closed=True)


def wave(height, bend):
    """An open face with crests and troughs, the body above; |t| changes along it."""
    x = S + 0.3 * np.sin(S)
    crests, bow = np.sin(1.5 * S), 0.1 * S**2
    rates = np.zeros((2, S.size, 2))
    rates[0, :, 1], rates[1, :, 1] = crests, bow
    return spline_profile(np.column_stack([x, height * crests + bend * bow]), rates)


def rounded_corner(spacing, radius=4.0, reach=6.0):
    """The line-arc-line door as a spline through points at about equal distances."""
    quarter = 0.5 * np.pi * radius
    count = round((quarter + 2 * reach) / spacing)
    s = np.linspace(-reach, quarter + reach, count + 1)
    angle = np.clip(s / radius, 0.0, 0.5 * np.pi)
    before, after = np.minimum(s, 0.0), np.maximum(s - quarter, 0.0)
    points = np.column_stack(
        [2.0 + before + radius * np.sin(angle), after + radius * (1.0 - np.cos(angle))]
    )
    return spline_profile(points, parameter=chord_length(points))


SPLINES = {"ellipse": (ellipse, (4.0, 2.5)), "wave": (wave, (0.6, 0.5))}
