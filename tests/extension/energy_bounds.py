"""Bounds of the energy that the steps of a path release."""

from itertools import pairwise

import numpy as np

from seal_mdao.analysis.jumps import released_energy


def energy_bounds(path, every=1):
    """Bounds of the released energy and work of the loading in increments of so many converged steps,
    shape (n, 3), mJ/m."""
    steps = [path.start, *path.steps][::every]
    return np.array(
        [released_energy(path.problem, step, last, step.fraction) for last, step in pairwise(steps)]
    )
