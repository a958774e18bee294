"""Seeds on the essential transformation, pulled back to the particles."""

import numpy as np

from seal_mdao.equilibrium.discretization import Discretization
from seal_mdao.rkpm.essential import transformation_seeds


def add_matrix_seeds(discretization: Discretization, matrix_bar, particles_bar) -> None:
    """Transpose of T': seeds (c, u, M) on the essential transformation to the particles (n, 2, M)."""
    rows, transformation = discretization.constrained_rows, discretization.transformation
    # Lambda_bar from T_bar
    rows_bar = transformation_seeds(transformation, matrix_bar)
    raw = rows.raw
    point = np.repeat(np.arange(raw.n_groups), np.diff(raw.start))
    # rows over the union -> rows of the table
    phi_bar = rows_bar[point, np.searchsorted(transformation.union, raw.neighbours)]
    grad_bar = np.zeros((raw.grad.size, particles_bar.shape[2]))
    rows.pull_back(np.ascontiguousarray(phi_bar), grad_bar, particles_bar)
