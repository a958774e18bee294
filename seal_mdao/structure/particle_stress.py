"""Von Mises stress of the deviatoric Cauchy stress at particles."""

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.rkpm.shape_functions import grad_rows
from seal_mdao.structure.deformation import group_gradients


@compiled
def _point_gradients(table, d, f):
    """F in the order 11, 12, 21, 22, and J - 1 at single points, ``f`` (s, 5), or (s, 6) with h."""
    rows = grad_rows(table)
    for i in range(table.start.size - 1):
        s0, s1 = table.start[i], table.start[i + 1]
        # F = 1 + sum_I d_I grad Phi_I
        grad = table.grad[rows * s0 : rows * s1]
        group_gradients(grad, d[table.neighbours[s0:s1]].T, s1 - s0, 1, f[i : i + 1])


def deformation_gradients(table, d: np.ndarray) -> np.ndarray:
    """F (s, 5) at single points: 11, 12, 21, 22, and J - 1; in a body of revolution (s, 6) with h."""
    f = np.empty((table.n_groups, 3 + grad_rows(table)))
    _point_gradients(table, d, f)
    return f


def particle_stress(path, points: np.ndarray, step=None):
    """Von Mises stress at ``points`` (s,) of ``Body.samples``, the particles first, at a converged step
    (the last).

    At a point between two materials it is that of the region named last.

    Returns
    -------
    stress : ndarray, shape (s,)
    by_gradient : ndarray, shape (s, 4 or 5)
        d stress / d F in the order 11, 12, 21, 22, and d stress / dh in a body of revolution.
    by_constants : dict of str to ndarray, shape (s,)
        By the names of the material parameters.
    """
    disc, structure = path.discretization, path.problem.term("structure")
    step = path.steps[-1] if step is None else step
    # in order, as the sensitivities ask for their shape functions too
    which, inverse = np.unique(points, return_inverse=True)
    f = deformation_gradients(disc.table_at(which).table, step.d)[inverse]
    # T = F : F,  J = det F
    t, j = (f[:, :4] ** 2).sum(axis=1), 1.0 + f[:, 4]
    # cof F = (F_22, -F_21, -F_12, F_11)
    cofactor, h = f[:, [3, 2, 1, 0]] * (1.0, -1.0, -1.0, 1.0), f[:, 5:].T
    if h.size:
        cofactor *= h.T
    stress, by_constants = np.empty(len(points)), {}
    by_gradient = np.empty((len(points), disc.body.strains))
    # beyond the particles are midpoints of sides and centres of cells
    inside = points.size > 0 and points.max() >= disc.body.n_particles
    of_region = (structure.sample_regions if inside else structure.particle_regions)[points]
    for number, region in enumerate(structure.definition.regions):
        at = np.flatnonzero(of_region == number)
        state = (t[at], j[at], *h[:, at])
        value, by_t, by_j, *by_h = structure.von_mises(region, state, step.fraction)
        stress[at] = value
        # d sigma/dF = 2 sigma_T F + sigma_J h cof F
        by_gradient[at, :4] = 2.0 * by_t[:, None] * f[at, :4] + by_j[:, None] * cofactor[at]
        for row in by_h:
            # d sigma/dh = sigma_h + sigma_J det F
            by_gradient[at, 4] = row + by_j * (j[at] / h[0, at])
        for name, row in structure.von_mises_rates(region, state, step.fraction):
            by_constants.setdefault(name, np.zeros(len(points)))[at] = row
    return stress, by_gradient, by_constants
