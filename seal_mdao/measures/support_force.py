"""Forces of the body on its supports as results of measures: values and partial derivatives.

With the forces f~ = B^T s of all terms at prescribed components, the body exerts -sum f~ on its support.
For weights w on these, m = -w . sum f~ = -w . f_internal - sum over points of s . (B w), so that

    dm/df_internal = -w,    dm/ds = -B w,    dm/dB = -s w^T.
"""

import numpy as np

from seal_mdao.equilibrium.matrix_seeds import add_matrix_seeds
from seal_mdao.terms.point_rates import add_field


def supports_of_edges(problem, edges) -> np.ndarray:
    """Return the prescribed components of edges by their names, a mask (n, 2)."""
    discretization = problem.discretization
    out = np.zeros(discretization.particles.shape, bool)
    for name in edges:
        out[discretization.body.edge(name).particles] = True
    return out & (discretization.layout.equations < 0)


def add_support_partials(partials, step, rows, weights: np.ndarray) -> None:
    """Add the partial derivatives of forces on supports at a converged step.

    Parameters
    ----------
    partials : Partials
    step : ConvergedStep
    rows : ndarray of int, shape (r,)
        Measures.
    weights : ndarray, shape (r, n, 2)
        w of each, zero at free components.
    """
    problem = partials.path.problem
    discretization = problem.discretization
    every = discretization.layout.every_component.equations
    # dm/df_internal = -w
    partials.of_term("structure", step).force[rows] -= weights
    field = np.ascontiguousarray(weights.reshape(len(rows), -1).T)
    nodal = np.moveaxis(weights, 0, 2)
    particles_bar = np.zeros(nodal.shape)
    matrix_bar = np.zeros((*discretization.transformation.matrix.shape, len(rows)))
    terms = zip(problem.terms, discretization.tables, step.responses, strict=True)
    for term, table, response in terms:
        if table is None:
            continue
        # dm/ds = -B w
        at_points, every_point = np.zeros((len(response.force), 2, len(rows))), table.table.n_groups
        add_field(table.table, np.arange(every_point), every, field, at_points)
        if not at_points.any():
            continue
        partials.force(term.label, step)[rows] -= np.moveaxis(at_points, 2, 0)
        # dm/dB = -s w^T, pulled back to the particles
        group = np.repeat(np.arange(every_point), np.diff(table.table.start))
        near = nodal[table.table.neighbours]
        phi_bar = -np.einsum("ec,ecm->em", response.force[group], near)
        none = np.empty((0, len(rows)))
        own = table.pull_back(np.ascontiguousarray(phi_bar), none, particles_bar)
        matrix_bar += 0.0 if own is None else own
    add_matrix_seeds(discretization, matrix_bar, particles_bar)
    partials.particles[rows] += np.moveaxis(particles_bar, 2, 0)
