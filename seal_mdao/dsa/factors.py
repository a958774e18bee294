"""Factors of converged tangents, and what both sweeps solve with them."""

import numpy as np

from seal_mdao.analysis.problem import PathProblem
from seal_mdao.analysis.result import ConvergedStep


def converged_factor(problem: PathProblem, step: ConvergedStep):
    """Factor of the tangent at a converged step: the kept one, or made again."""
    if step.factor is not None:
        return step.factor
    return problem.factorize_at(step)


def solve_transposed(problem: PathProblem, step: ConvergedStep, loads: np.ndarray) -> np.ndarray:
    """K_n^-T times ``loads`` (n_equations + 1, c), overwritten; the last row, of imposed
    displacements, becomes zero."""
    if loads.shape[1]:
        loads[:-1] = converged_factor(problem, step).solve(loads[:-1], transposed=True)
    loads[-1] = 0.0
    return loads
