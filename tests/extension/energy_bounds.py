"""Bounds of the energy that the steps of a path release."""

import numpy as np

from seal_mdao.analysis.jumps import released_energy


def energy_bounds(path):
    """Released energy and work of the loading of all converged steps, shape (n, 2), mJ/m."""
    both = zip([path.start, *path.steps], path.steps, strict=False)
    return np.array(
        [released_energy(path.problem, step, last, step.fraction) for last, step in both]
    )
