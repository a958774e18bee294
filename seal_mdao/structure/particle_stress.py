"""Von Mises stress of the deviatoric Cauchy stress at points of the section."""

from typing import NamedTuple

import numpy as np

from seal_mdao.compilation import compiled
from seal_mdao.rkpm.shape_functions import grad_rows
from seal_mdao.structure.deformation import group_gradients
from seal_mdao.structure.relaxed_stress import relaxed_von_mises
from seal_mdao.structure.second_stress import point_state
from seal_mdao.structure.softened_stress import softened_von_mises


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


class PointStress(NamedTuple):
    """Von Mises stress at s points at a converged step, and its derivatives.

    Attributes
    ----------
    value : ndarray, shape (s,)
    by_gradient : list of (ConvergedStep, ndarray of shape (s, 4 or 5))
        In F in the order 11, 12, 21, 22, and in h in a body of revolution: at the step itself, and
        before it at all others where the body relaxes or softens.
    by_constants : dict of str to ndarray, shape (s,)
        By the names of the parameters.
    """

    value: np.ndarray
    by_gradient: list
    by_constants: dict


def particle_stress(path, points: np.ndarray, step=None) -> PointStress:
    """Von Mises stress at ``points`` (s,) of ``Body.samples``, the particles first, at a converged step
    (the last).

    At a particle between two materials it is that of the region named last; ``Body.samples`` have it
    in every one of them.
    """
    disc, structure = path.discretization, path.problem.term("structure")
    step = path.steps[-1] if step is None else step
    steps = [step]
    if structure.history_dependent:
        steps = path.steps[: path.steps.index(step) + 1]
    # in order, as the sensitivities ask for their shape functions too
    which, inverse = np.unique(points, return_inverse=True)
    table = disc.table_at(which).table
    f = np.array([deformation_gradients(table, own.d)[inverse] for own in steps])
    # beyond the particles are midpoints of sides and centres of cells
    inside = points.size > 0 and points.max() >= disc.body.n_particles
    of_region = (structure.sample_regions if inside else structure.particle_regions)[points]
    return point_stress(structure, f, of_region, steps)


def point_stress(structure, f: np.ndarray, of_region: np.ndarray, steps: list) -> PointStress:
    """Von Mises stress at any s points, of F there at converged steps (K, s, 5 or 6), as
    ``deformation_gradients`` gives it; ``of_region`` (s,) has the numbers of their materials."""
    count = f.shape[1]
    stress, by_constants = np.empty(count), {}
    by_gradient = np.zeros((len(steps), count, f.shape[2] - 1))
    for number, region in enumerate(structure.definition.regions):
        at = np.flatnonzero(of_region == number)
        if region.prony is None and region.softening is None:
            # a region without history beside others: the last step alone
            value, on_f, rates = _von_mises(structure, region, f[-1, at], steps[-1].fraction)
            by_gradient[-1, at] = on_f
        else:
            fractions = [own.fraction for own in steps]
            evaluate = softened_von_mises if region.prony is None else relaxed_von_mises
            value, on_f, rates = evaluate(structure, region, f[:, at], fractions)
            by_gradient[:, at] = on_f
        stress[at] = value
        for name, row in rates:
            by_constants.setdefault(name, np.zeros(count))[at] += row
    return PointStress(stress, list(zip(steps, by_gradient, strict=True)), by_constants)


def _von_mises(structure, region, f, fraction: float):
    """Stress, d/dF (with d/dh), and pairs (parameter, d/d(parameter)), of an elastic region."""
    _, j, *h = state = point_state(f)
    # cof F = (F_22, -F_21, -F_12, F_11)
    cofactor = f[:, [3, 2, 1, 0]] * (1.0, -1.0, -1.0, 1.0)
    if h:
        cofactor *= h[0][:, None]
    value, by_t, by_j, *by_h = structure.von_mises(region, state, fraction)
    on_f = np.empty((len(f), f.shape[1] - 1))
    # d sigma/dF = 2 sigma_T F + sigma_J h cof F
    on_f[:, :4] = 2.0 * by_t[:, None] * f[:, :4] + by_j[:, None] * cofactor
    for row in by_h:
        # d sigma/dh = sigma_h + sigma_J det F
        on_f[:, 4] = row + by_j * (j / h[0])
    return value, on_f, list(structure.von_mises_rates(region, state, fraction))
