"""Problems of the collection with four and more variables (numbers as in the collection)."""

from __future__ import annotations

from math import cos, sin, sqrt

import numpy as np
from hs_problem import INF, HSProblem, d_minus_product, minus_product


def _hs40_constraints(x):
    return [x[0] ** 3 + x[1] ** 2, x[0] ** 2 * x[3] - x[2], x[3] ** 2 - x[1]]


def _d_hs40_constraints(x):
    return [
        [3 * x[0] ** 2, 2 * x[1], 0, 0],
        [2 * x[0] * x[3], 0, -1, x[0] ** 2],
        [0, -1, 0, 2 * x[3]],
    ]


def _hs43(x):
    square = x[0] ** 2 + x[1] ** 2 + 2 * x[2] ** 2 + x[3] ** 2
    return square - 5 * x[0] - 5 * x[1] - 21 * x[2] + 7 * x[3]


def _d_hs43(x):
    return [2 * x[0] - 5, 2 * x[1] - 5, 4 * x[2] - 21, 2 * x[3] + 7]


def _hs43_constraints(x):
    a, b, c, d = x
    return [
        a**2 + b**2 + c**2 + d**2 + a - b + c - d,
        a**2 + 2 * b**2 + c**2 + 2 * d**2 - a - d,
        2 * a**2 + b**2 + c**2 + 2 * a - b - d,
    ]


def _d_hs43_constraints(x):
    a, b, c, d = x
    return [
        [2 * a + 1, 2 * b - 1, 2 * c + 1, 2 * d - 1],
        [2 * a - 1, 4 * b, 2 * c, 4 * d - 1],
        [4 * a + 2, 2 * b - 1, 2 * c, -1],
    ]


def _hs48(x):
    return (x[0] - 1) ** 2 + (x[1] - x[2]) ** 2 + (x[3] - x[4]) ** 2


def _d_hs48(x):
    a, b = 2 * (x[1] - x[2]), 2 * (x[3] - x[4])
    return [2 * (x[0] - 1), a, -a, b, -b]


def _hs71(x):
    return x[0] * x[3] * (x[0] + x[1] + x[2]) + x[2]


def _d_hs71(x):
    total = x[0] + x[1] + x[2]
    return [x[3] * (total + x[0]), x[0] * x[3], x[0] * x[3] + 1, x[0] * total]


def _hs76(x):
    a, b, c, d = x
    return a**2 + 0.5 * b**2 + c**2 + 0.5 * d**2 - a * c + c * d - a - 3 * b + c - d


def _d_hs76(x):
    a, b, c, d = x
    return [2 * a - c - 1, b - 3, 2 * c - a + d + 1, d + c - 1]


def _hs77(x):
    a, b, c, d, e = x
    return (a - 1) ** 2 + (a - b) ** 2 + (c - 1) ** 2 + (d - 1) ** 4 + (e - 1) ** 6


def _d_hs77(x):
    a, b, c, d, e = x
    gap = 2 * (a - b)
    return [2 * (a - 1) + gap, -gap, 2 * (c - 1), 4 * (d - 1) ** 3, 6 * (e - 1) ** 5]


def _d_hs77_constraints(x):
    a, _, c, d, e = x
    slope = cos(d - e)
    return [
        [2 * a * d, 0, 0, a**2 + slope, -slope],
        [0, 1, 4 * c**3 * d**2, 2 * c**4 * d, 0],
    ]


def _hs78_constraints(x):
    return [np.dot(x, x), x[1] * x[2] - 5 * x[3] * x[4], x[0] ** 3 + x[1] ** 3]


def _d_hs78_constraints(x):
    return [
        2 * np.asarray(x),
        [0, x[2], x[1], -5 * x[4], -5 * x[3]],
        [3 * x[0] ** 2, 3 * x[1] ** 2, 0, 0, 0],
    ]


def _hs100(x):
    a, b, c, d, e, f, g = x
    return (
        (a - 10) ** 2
        + 5 * (b - 12) ** 2
        + c**4
        + 3 * (d - 11) ** 2
        + 10 * e**6
        + 7 * f**2
        + g**4
        - 4 * f * g
        - 10 * f
        - 8 * g
    )


def _d_hs100(x):
    a, b, c, d, e, f, g = x
    return [
        2 * (a - 10),
        10 * (b - 12),
        4 * c**3,
        6 * (d - 11),
        60 * e**5,
        14 * f - 4 * g - 10,
        4 * g**3 - 4 * f - 8,
    ]


def _hs100_constraints(x):
    a, b, c, d, e, f, g = x
    return [
        2 * a**2 + 3 * b**4 + c + 4 * d**2 + 5 * e,
        7 * a + 3 * b + 10 * c**2 + d - e,
        23 * a + b**2 + 6 * f**2 - 8 * g,
        4 * a**2 + b**2 - 3 * a * b + 2 * c**2 + 5 * f - 11 * g,
    ]


def _d_hs100_constraints(x):
    a, b, c, d, _, f, _ = x
    return [
        [4 * a, 12 * b**3, 1, 8 * d, 5, 0, 0],
        [7, 3, 20 * c, 1, -1, 0, 0],
        [23, 2 * b, 0, 0, 0, 12 * f, -8],
        [8 * a - 3 * b, 2 * b - 3 * a, 4 * c, 0, 0, 5, -11],
    ]


PROBLEMS = [
    HSProblem(
        40,
        (0.8, 0.8, 0.8, 0.8),
        -0.25,
        minus_product,
        d_minus_product,
        _hs40_constraints,
        _d_hs40_constraints,
        (1, 0, 0),
        (1, 0, 0),
    ),
    HSProblem(
        43,
        (0, 0, 0, 0),
        -44.0,
        _hs43,
        _d_hs43,
        _hs43_constraints,
        _d_hs43_constraints,
        (-INF,) * 3,
        (8, 10, 5),
    ),
    HSProblem(
        48,
        (3, 5, -3, 2, -2),
        0.0,
        _hs48,
        _d_hs48,
        lambda x: [np.sum(x), x[2] - 2 * (x[3] + x[4])],
        lambda x: [[1, 1, 1, 1, 1], [0, 0, 1, -2, -2]],
        (5, -3),
        (5, -3),
        linear=True,
    ),
    HSProblem(
        71,
        (1, 5, 5, 1),
        17.0140173,
        _hs71,
        _d_hs71,
        lambda x: [np.prod(x), np.dot(x, x)],
        lambda x: [-np.asarray(d_minus_product(x)), 2 * np.asarray(x)],
        (25, 40),
        (INF, 40),
        lower=1,
        upper=5,
    ),
    HSProblem(
        76,
        (0.5, 0.5, 0.5, 0.5),
        -4.681818181,
        _hs76,
        _d_hs76,
        lambda x: [
            x[0] + 2 * x[1] + x[2] + x[3],
            3 * x[0] + x[1] + 2 * x[2] - x[3],
            x[1] + 4 * x[2],
        ],
        lambda x: [[1, 2, 1, 1], [3, 1, 2, -1], [0, 1, 4, 0]],
        (-INF, -INF, 1.5),
        (5, 4, INF),
        lower=0,
        linear=True,
    ),
    HSProblem(
        77,
        (2, 2, 2, 2, 2),
        0.24150513,
        _hs77,
        _d_hs77,
        lambda x: [x[0] ** 2 * x[3] + sin(x[3] - x[4]), x[1] + x[2] ** 4 * x[3] ** 2],
        _d_hs77_constraints,
        (2 * sqrt(2), 8 + sqrt(2)),
        (2 * sqrt(2), 8 + sqrt(2)),
    ),
    HSProblem(
        78,
        (-2, 1.5, 2, -1, -1),
        -2.91970041,
        lambda x: -minus_product(x),
        lambda x: -np.asarray(d_minus_product(x)),
        _hs78_constraints,
        _d_hs78_constraints,
        (10, 0, -1),
        (10, 0, -1),
    ),
    HSProblem(
        100,
        (1, 2, 0, 4, 0, 1, 1),
        680.6300573,
        _hs100,
        _d_hs100,
        _hs100_constraints,
        _d_hs100_constraints,
        (-INF,) * 4,
        (127, 282, 196, 0),
    ),
]
