"""Rates of single points (contact points, stress particles) and their transposes.

A ``branch`` of zero leaves a point out: it carries no force.
"""

from seal_mdao.compilation import compiled


@compiled
def displacement_rates(table, rates, d, out):
    """Add sum_I Phi_I' d_I at fixed d to ``out`` (k, 2, P)."""
    for i in range(table.start.size - 1):
        which = rates.active[rates.start[i, 0] : rates.start[i + 1, 0]]
        count, at = which.size, rates.start[i, 1]
        for a in range(table.start[i + 1] - table.start[i]):
            near = table.neighbours[table.start[i] + a]
            for p in range(count):
                rate = rates.phi[at + a * count + p]
                out[i, 0, which[p]] += d[near, 0] * rate
                out[i, 1, which[p]] += d[near, 1] * rate


@compiled
def add_solution_rates(table, equations, solution, out):
    """Add sum_I Phi_I d_I' to the first two rows of ``out`` (k, rows, P); ``solution`` is d'
    (n_equations, P)."""
    for i in range(table.start.size - 1):
        for a in range(table.start[i], table.start[i + 1]):
            for c in range(2):
                at = equations[table.neighbours[a], c]
                if at >= 0:
                    for p in range(solution.shape[1]):
                        out[i, c, p] += table.phi[a] * solution[at, p]


@compiled
def add_nodal_rates(table, nodal, out):
    """Add sum_I Phi_I d_I' to ``out`` (k, 2, P); ``nodal`` (n, 2, P) are rates of the particles."""
    for i in range(table.start.size - 1):
        for a in range(table.start[i], table.start[i + 1]):
            for c in range(2):
                for p in range(nodal.shape[2]):
                    out[i, c, p] += table.phi[a] * nodal[table.neighbours[a], c, p]


@compiled
def add_nodal_gradient_rates(table, nodal, out):
    """Add sum_I B_I d_I' of single points to ``out`` (k, 4, P)."""
    for i in range(table.start.size - 1):
        s0 = table.start[i]
        n = table.start[i + 1] - s0
        for a in range(n):
            for j in range(2):
                b = table.grad[2 * s0 + j * n + a]
                for c in range(2):
                    for p in range(nodal.shape[2]):
                        out[i, 2 * c + j, p] += b * nodal[table.neighbours[s0 + a], c, p]


@compiled
def add_force_rates(table, rates, force, force_rate, branch, equations, out):
    """Add (sum_i Phi_i T_i)' to ``out`` (n_equations + 1, P) for the points that carry a force."""
    for i in range(table.start.size - 1):
        if branch[i] == 0:
            continue
        which = rates.active[rates.start[i, 0] : rates.start[i + 1, 0]]
        count, at = which.size, rates.start[i, 1]
        for a in range(table.start[i + 1] - table.start[i]):
            phi = table.phi[table.start[i] + a]
            for c in range(2):
                row = out[equations[table.neighbours[table.start[i] + a], c]]
                for p in range(out.shape[1]):
                    row[p] += phi * force_rate[i, c, p]
                for p in range(count):
                    row[which[p]] += rates.phi[at + a * count + p] * force[i, c]


@compiled
def gradient_rates(table, rates, d, equations, solution, out):
    """F' = sum_I B_I' d_I + B_I d_I' of single points, ``out`` (k, 4, P) overwritten."""
    out[:] = 0.0
    n_parameters = out.shape[2]
    for i in range(table.start.size - 1):
        s0 = table.start[i]
        n = table.start[i + 1] - s0
        which = rates.active[rates.start[i, 0] : rates.start[i + 1, 0]]
        count, at = which.size, 2 * rates.start[i, 1]
        for a in range(n):
            near = table.neighbours[s0 + a]
            for j in range(2):
                b = table.grad[2 * s0 + j * n + a]
                for c in range(2):
                    e = equations[near, c]
                    if e >= 0:
                        for p in range(n_parameters):
                            out[i, 2 * c + j, p] += b * solution[e, p]
                    for p in range(count):
                        rate = rates.grad[at + (j * n + a) * count + p]
                        out[i, 2 * c + j, which[p]] += d[near, c] * rate


@compiled
def add_displacement_seeds(table, points, x_bar, equations, out):
    """Transpose of ``add_solution_rates``: seeds (s, 2, M) on s of the points to ``out``
    (n_equations + 1, M)."""
    for k, i in enumerate(points):
        for c in range(2):
            seed = x_bar[k, c]
            for a in range(table.start[i], table.start[i + 1]):
                row, phi = out[equations[table.neighbours[a], c]], table.phi[a]
                for m in range(seed.size):
                    row[m] += phi * seed[m]


@compiled
def point_adjoint(table, points, adjoint, equations, out):
    """Adjoint displacement of s single points: ``out`` (s, 2, M) from ``adjoint``
    (n_equations + 1, M).

    The last row of ``adjoint``, that of imposed components, is zero.
    """
    out[:] = 0.0
    for k, i in enumerate(points):
        for a in range(table.start[i], table.start[i + 1]):
            phi = table.phi[a]
            for c in range(2):
                row = adjoint[equations[table.neighbours[a], c]]
                for m in range(row.size):
                    out[k, c, m] += phi * row[m]


@compiled
def add_shape_seeds(table, points, x_bar, force, d, adjoint, mix, equations, phi_bar):
    """Add seeds on Phi: x_bar . d from the point's displacement, -T . lambda from its force.

    Parameters
    ----------
    x_bar : ndarray, shape (s, 2, M)
        Of the ``points`` (s,).
    adjoint, mix : ndarray, shapes (n_equations + 1, c), (c, M)
        lambda is their product.
    """
    for k, i in enumerate(points):
        for a in range(table.start[i], table.start[i + 1]):
            near, out = table.neighbours[a], phi_bar[a]
            for c in range(2):
                u, t, row = d[near, c], force[i, c], adjoint[equations[near, c]]
                for m in range(out.size):
                    out[m] += x_bar[k, c, m] * u
                if t != 0.0:
                    for j in range(row.size):
                        for m in range(out.size):
                            out[m] -= t * row[j] * mix[j, m]


@compiled
def add_gradient_seeds(table, f_bar, d, equations, d_bar, grad_bar):
    """Transpose of ``gradient_rates``: seeds ``f_bar`` (k, 4, M) on F."""
    for i in range(table.start.size - 1):
        s0 = table.start[i]
        n = table.start[i + 1] - s0
        for a in range(n):
            near = table.neighbours[s0 + a]
            for j in range(2):
                at = 2 * s0 + j * n + a
                for c in range(2):
                    seed = f_bar[i, 2 * c + j]
                    row = d_bar[equations[near, c]]
                    for m in range(seed.size):
                        row[m] += seed[m] * table.grad[at]
                        grad_bar[at, m] += seed[m] * d[near, c]
