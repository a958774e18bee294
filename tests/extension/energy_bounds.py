"""Bounds of the energy that the steps of a path release."""

import numpy as np

from seal_mdao.analysis.jumps import released_energy


def energy_bounds(path):
    """Released energy and work of the loading of all converged steps, shape (n, 2), mJ/m."""
    problem, found = path.problem, []
    for last, step in zip([path.start, *path.steps], path.steps, strict=False):
        problem.responses = step.responses
        found.append(released_energy(problem, step.d, last, step.fraction))
    return np.array(found)
