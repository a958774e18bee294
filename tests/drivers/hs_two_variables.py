"""Problems of the collection with two variables (numbers as in the collection)."""

from __future__ import annotations

from math import cos, pi, sin, sqrt

import numpy as np
from hs_problem import INF, HSProblem


def _rosenbrock(x):
    return 100 * (x[1] - x[0] ** 2) ** 2 + (1 - x[0]) ** 2


def _d_rosenbrock(x):
    return [-400 * x[0] * (x[1] - x[0] ** 2) - 2 * (1 - x[0]), 200 * (x[1] - x[0] ** 2)]


def _hs5(x):
    return sin(x[0] + x[1]) + (x[0] - x[1]) ** 2 - 1.5 * x[0] + 2.5 * x[1] + 1


def _d_hs5(x):
    slope, gap = cos(x[0] + x[1]), 2 * (x[0] - x[1])
    return [slope + gap - 1.5, slope - gap + 2.5]


def _d_hs9(x):
    a, b = pi * x[0] / 12, pi * x[1] / 16
    return [pi / 12 * cos(a) * cos(b), -pi / 16 * sin(a) * sin(b)]


def _hs23_constraints(x):
    return [
        x[0] + x[1],
        x[0] ** 2 + x[1] ** 2,
        9 * x[0] ** 2 + x[1] ** 2,
        x[0] ** 2 - x[1],
        x[1] ** 2 - x[0],
    ]


def _d_hs23_constraints(x):
    a, b = 2 * x[0], 2 * x[1]
    return [[1, 1], [a, b], [9 * a, b], [a, -1], [-1, b]]


def _d_hs24(x):
    c = 27 * sqrt(3)
    return [2 * (x[0] - 3) * x[1] ** 3 / c, ((x[0] - 3) ** 2 - 9) * 3 * x[1] ** 2 / c]


ROOT3 = sqrt(3)

PROBLEMS = [
    HSProblem(1, (-2, 1), 0.0, _rosenbrock, _d_rosenbrock, lower=(-INF, -1.5)),
    HSProblem(
        3,
        (10, 1),
        0.0,
        lambda x: x[1] + 1e-5 * (x[1] - x[0]) ** 2,
        lambda x: [-2e-5 * (x[1] - x[0]), 1 + 2e-5 * (x[1] - x[0])],
        lower=(-INF, 0),
    ),
    HSProblem(
        4,
        (1.125, 0.125),
        8 / 3,
        lambda x: (x[0] + 1) ** 3 / 3 + x[1],
        lambda x: [(x[0] + 1) ** 2, 1],
        lower=(1, 0),
    ),
    HSProblem(5, (0, 0), -ROOT3 / 2 - pi / 3, _hs5, _d_hs5, lower=(-1.5, -3), upper=(4, 3)),
    HSProblem(
        6,
        (-1.2, 1),
        0.0,
        lambda x: (1 - x[0]) ** 2,
        lambda x: [-2 * (1 - x[0]), 0],
        lambda x: [10 * (x[1] - x[0] ** 2)],
        lambda x: [[-20 * x[0], 10]],
        (0,),
        (0,),
    ),
    HSProblem(
        7,
        (2, 2),
        -ROOT3,
        lambda x: np.log(1 + x[0] ** 2) - x[1],
        lambda x: [2 * x[0] / (1 + x[0] ** 2), -1],
        lambda x: [(1 + x[0] ** 2) ** 2 + x[1] ** 2],
        lambda x: [[4 * x[0] * (1 + x[0] ** 2), 2 * x[1]]],
        (4,),
        (4,),
    ),
    HSProblem(
        9,
        (0, 0),
        -0.5,
        lambda x: sin(pi * x[0] / 12) * cos(pi * x[1] / 16),
        _d_hs9,
        lambda x: [4 * x[0] - 3 * x[1]],
        lambda x: [[4, -3]],
        (0,),
        (0,),
        linear=True,
    ),
    HSProblem(
        10,
        (-10, 10),
        -1.0,
        lambda x: x[0] - x[1],
        lambda x: [1, -1],
        lambda x: [-3 * x[0] ** 2 + 2 * x[0] * x[1] - x[1] ** 2],
        lambda x: [[-6 * x[0] + 2 * x[1], 2 * x[0] - 2 * x[1]]],
        (-1,),
        (INF,),
    ),
    HSProblem(
        11,
        (4.9, 0.1),
        -8.498464223,
        lambda x: (x[0] - 5) ** 2 + x[1] ** 2 - 25,
        lambda x: [2 * (x[0] - 5), 2 * x[1]],
        lambda x: [-(x[0] ** 2) + x[1]],
        lambda x: [[-2 * x[0], 1]],
        (0,),
        (INF,),
    ),
    HSProblem(
        12,
        (0, 0),
        -30.0,
        lambda x: 0.5 * x[0] ** 2 + x[1] ** 2 - x[0] * x[1] - 7 * x[0] - 7 * x[1],
        lambda x: [x[0] - x[1] - 7, 2 * x[1] - x[0] - 7],
        lambda x: [4 * x[0] ** 2 + x[1] ** 2],
        lambda x: [[8 * x[0], 2 * x[1]]],
        (-INF,),
        (25,),
    ),
    HSProblem(
        14,
        (2, 2),
        9 - 2.875 * sqrt(7),
        lambda x: (x[0] - 2) ** 2 + (x[1] - 1) ** 2,
        lambda x: [2 * (x[0] - 2), 2 * (x[1] - 1)],
        lambda x: [0.25 * x[0] ** 2 + x[1] ** 2, x[0] - 2 * x[1]],
        lambda x: [[0.5 * x[0], 2 * x[1]], [1, -2]],
        (-INF, -1),
        (1, -1),
    ),
    HSProblem(
        18,
        (2, 2),
        5.0,
        lambda x: 0.01 * x[0] ** 2 + x[1] ** 2,
        lambda x: [0.02 * x[0], 2 * x[1]],
        lambda x: [x[0] * x[1], x[0] ** 2 + x[1] ** 2],
        lambda x: [[x[1], x[0]], [2 * x[0], 2 * x[1]]],
        (25, 25),
        (INF, INF),
        lower=(2, 0),
        upper=50,
    ),
    HSProblem(
        21,
        (-1, -1),
        -99.96,
        lambda x: 0.01 * x[0] ** 2 + x[1] ** 2 - 100,
        lambda x: [0.02 * x[0], 2 * x[1]],
        lambda x: [10 * x[0] - x[1]],
        lambda x: [[10, -1]],
        (10,),
        (INF,),
        lower=(2, -50),
        upper=50,
        linear=True,
    ),
    HSProblem(
        22,
        (2, 2),
        1.0,
        lambda x: (x[0] - 2) ** 2 + (x[1] - 1) ** 2,
        lambda x: [2 * (x[0] - 2), 2 * (x[1] - 1)],
        lambda x: [x[0] + x[1], -(x[0] ** 2) + x[1]],
        lambda x: [[1, 1], [-2 * x[0], 1]],
        (-INF, 0),
        (2, INF),
    ),
    HSProblem(
        23,
        (3, 1),
        2.0,
        lambda x: x[0] ** 2 + x[1] ** 2,
        lambda x: [2 * x[0], 2 * x[1]],
        _hs23_constraints,
        _d_hs23_constraints,
        (1, 1, 9, 0, 0),
        (INF,) * 5,
        lower=-50,
        upper=50,
    ),
    HSProblem(
        24,
        (1, 0.5),
        -1.0,
        lambda x: ((x[0] - 3) ** 2 - 9) * x[1] ** 3 / (27 * ROOT3),
        _d_hs24,
        lambda x: [x[0] / ROOT3 - x[1], x[0] + ROOT3 * x[1]],
        lambda x: [[1 / ROOT3, -1], [1, ROOT3]],
        (0, 0),
        (INF, 6),
        lower=0,
        linear=True,
    ),
]
