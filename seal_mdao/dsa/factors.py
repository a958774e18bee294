"""Common parts of both methods: factors of converged tangents, and blocks of load steps."""

import numpy as np

from seal_mdao.analysis.path_result import ConvergedStep
from seal_mdao.analysis.problem import PathProblem

BLOCK_BYTES = 64 * 2**20
"""Loads or adjoints of one block."""


def converged_factor(problem: PathProblem, step: ConvergedStep):
    """Return the factor of the tangent at a converged step, stored or computed again."""
    if step.factor is not None:
        return step.factor
    return problem.factorize_at(step)


def solve_transposed(problem: PathProblem, step: ConvergedStep, loads: np.ndarray) -> np.ndarray:
    """K_n^-T times ``loads`` (n_equations + 1, c), overwritten; the last row, of imposed
    displacements, becomes zero."""
    if loads.shape[1]:
        # K_n^-T, the last row aside
        loads[:-1] = converged_factor(problem, step).solve(loads[:-1], transposed=True)
    loads[-1] = 0.0
    return loads


def blocks(indices, n_equations: int, n_columns: int) -> list:
    """Consecutive pieces of ``indices``, as long as their vectors fit in ``BLOCK_BYTES``."""
    # 8 bytes a number
    size = max(1, BLOCK_BYTES // (8 * n_equations * max(1, n_columns)))
    return [indices[first : first + size] for first in range(0, len(indices), size)]


def is_full(nbytes: int) -> bool:
    """Return whether vectors of that size fill a block."""
    return nbytes >= BLOCK_BYTES
