"""Problems of the collection with three variables (numbers as in the collection)."""

from __future__ import annotations

from math import exp, log, sqrt

import numpy as np
from hs_problem import INF, HSProblem, d_minus_product, minus_product


def _d_hs26(x):
    a, b = 2 * (x[0] - x[1]), 4 * (x[1] - x[2]) ** 3
    return [a, b - a, -b]


def _hs35(x):
    square = 2 * x[0] ** 2 + 2 * x[1] ** 2 + x[2] ** 2 + 2 * x[0] * x[1] + 2 * x[0] * x[2]
    return 9 - 8 * x[0] - 6 * x[1] - 4 * x[2] + square


def _d_hs35(x):
    return [
        -8 + 4 * x[0] + 2 * x[1] + 2 * x[2],
        -6 + 4 * x[1] + 2 * x[0],
        -4 + 2 * x[2] + 2 * x[0],
    ]


def _hs65(x):
    return (x[0] - x[1]) ** 2 + (x[0] + x[1] - 10) ** 2 / 9 + (x[2] - 5) ** 2


def _d_hs65(x):
    a, b = 2 * (x[0] - x[1]), 2 * (x[0] + x[1] - 10) / 9
    return [a + b, b - a, 2 * (x[2] - 5)]


PROBLEMS = [
    HSProblem(
        26,
        (-2.6, 2, 2),
        0.0,
        lambda x: (x[0] - x[1]) ** 2 + (x[1] - x[2]) ** 4,
        _d_hs26,
        lambda x: [(1 + x[1] ** 2) * x[0] + x[2] ** 4],
        lambda x: [[1 + x[1] ** 2, 2 * x[0] * x[1], 4 * x[2] ** 3]],
        (3,),
        (3,),
    ),
    HSProblem(
        28,
        (-4, 1, 1),
        0.0,
        lambda x: (x[0] + x[1]) ** 2 + (x[1] + x[2]) ** 2,
        lambda x: [2 * (x[0] + x[1]), 2 * (x[0] + 2 * x[1] + x[2]), 2 * (x[1] + x[2])],
        lambda x: [x[0] + 2 * x[1] + 3 * x[2]],
        lambda x: [[1, 2, 3]],
        (1,),
        (1,),
        linear=True,
    ),
    HSProblem(
        29,
        (1, 1, 1),
        -16 * sqrt(2),
        minus_product,
        d_minus_product,
        lambda x: [x[0] ** 2 + 2 * x[1] ** 2 + 4 * x[2] ** 2],
        lambda x: [[2 * x[0], 4 * x[1], 8 * x[2]]],
        (-INF,),
        (48,),
    ),
    HSProblem(
        31,
        (1, 1, 1),
        6.0,
        lambda x: 9 * x[0] ** 2 + x[1] ** 2 + 9 * x[2] ** 2,
        lambda x: [18 * x[0], 2 * x[1], 18 * x[2]],
        lambda x: [x[0] * x[1]],
        lambda x: [[x[1], x[0], 0]],
        (1,),
        (INF,),
        lower=(-10, 1, -10),
        upper=(10, 10, 1),
    ),
    HSProblem(
        34,
        (0, 1.05, 2.9),
        -log(log(10)),
        lambda x: -x[0],
        lambda x: [-1, 0, 0],
        lambda x: [x[1] - exp(x[0]), x[2] - exp(x[1])],
        lambda x: [[-exp(x[0]), 1, 0], [0, -exp(x[1]), 1]],
        (0, 0),
        (INF, INF),
        lower=0,
        upper=(100, 100, 10),
    ),
    HSProblem(
        35,
        (0.5, 0.5, 0.5),
        1 / 9,
        _hs35,
        _d_hs35,
        lambda x: [x[0] + x[1] + 2 * x[2]],
        lambda x: [[1, 1, 2]],
        (-INF,),
        (3,),
        lower=0,
        linear=True,
    ),
    HSProblem(
        37,
        (10, 10, 10),
        -3456.0,
        minus_product,
        d_minus_product,
        lambda x: [x[0] + 2 * x[1] + 2 * x[2]],
        lambda x: [[1, 2, 2]],
        (0,),
        (72,),
        lower=0,
        upper=42,
        linear=True,
    ),
    HSProblem(
        65,
        (-5, 5, 0),
        0.9535288567,
        _hs65,
        _d_hs65,
        lambda x: [np.dot(x, x)],
        lambda x: [2 * np.asarray(x)],
        (-INF,),
        (48,),
        lower=(-4.5, -4.5, -5),
        upper=(4.5, 4.5, 5),
    ),
    HSProblem(
        66,
        (0, 1.05, 2.9),
        0.5181632741,
        lambda x: 0.2 * x[2] - 0.8 * x[0],
        lambda x: [-0.8, 0, 0.2],
        lambda x: [x[1] - exp(x[0]), x[2] - exp(x[1])],
        lambda x: [[-exp(x[0]), 1, 0], [0, -exp(x[1]), 1]],
        (0, 0),
        (INF, INF),
        lower=0,
        upper=(100, 100, 10),
    ),
]
