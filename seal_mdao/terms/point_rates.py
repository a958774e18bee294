"""Rows of shape functions B = Phi of single points (contact points, stress particles): products with
B, B^T and the rates B', and the seeds on B.

Fields are numbered by ``equations`` (n, 2), those of the layout or ``every_component``; a component with
a negative number is imposed and left out.
"""

from seal_mdao.compilation import compiled
from seal_mdao.rkpm.shape_functions import grad_rows


@compiled
def add_displacement_rates(table, points, rates, d, out):
    """Add B' d = sum_I Phi_I' d_I of s points to ``out`` (s, 2, P)."""
    for k, i in enumerate(points):
        which = rates.active[rates.start[i, 0] : rates.start[i + 1, 0]]
        count, at = which.size, rates.start[i, 1]
        for a in range(table.start[i + 1] - table.start[i]):
            near = table.neighbours[table.start[i] + a]
            for p in range(count):
                # x'_c += d_Ic Phi_I'
                rate = rates.phi[at + a * count + p]
                out[k, 0, which[p]] += d[near, 0] * rate
                out[k, 1, which[p]] += d[near, 1] * rate


@compiled
def add_field(table, points, equations, field, out):
    """Add B v = sum_I Phi_I v_I of s points to ``out`` (s, 2, P); ``field`` is v, d' or an adjoint."""
    for k, i in enumerate(points):
        for a in range(table.start[i], table.start[i + 1]):
            phi = table.phi[a]
            for c in range(2):
                at = equations[table.neighbours[a], c]
                if at >= 0:
                    # x_c += Phi_I v_Ic
                    row = field[at]
                    for p in range(row.size):
                        out[k, c, p] += phi * row[p]


@compiled
def add_transposed(table, points, equations, values, out):
    """Add B^T s of values s (s, 2, M) at s points to ``out`` (n_equations + 1, M); its last row takes
    what comes to imposed components."""
    for k, i in enumerate(points):
        for c in range(2):
            value = values[k, c]
            for a in range(table.start[i], table.start[i + 1]):
                # v_Ic += Phi_I s_c
                row, phi = out[equations[table.neighbours[a], c]], table.phi[a]
                for m in range(value.size):
                    row[m] += phi * value[m]


@compiled
def add_force_rates(table, points, rates, force, force_rate, branch, equations, out):
    """Add (B^T s)' = B^T s' + B'^T s to ``out`` (n_equations + 1, P).

    Parameters
    ----------
    force, branch : ndarray, shapes (k, 2), (k,)
        Of all points; those of branch zero carry no force.
    force_rate : ndarray, shape (s, 2, P)
        s' of the ``points`` (s,).
    """
    for k, i in enumerate(points):
        if branch[i] == 0:
            continue
        which = rates.active[rates.start[i, 0] : rates.start[i + 1, 0]]
        count, at = which.size, rates.start[i, 1]
        for a in range(table.start[i + 1] - table.start[i]):
            phi = table.phi[table.start[i] + a]
            for c in range(2):
                row = out[equations[table.neighbours[table.start[i] + a], c]]
                for p in range(out.shape[1]):
                    # f'_Ic += Phi_I s_c': b'_V = b'_N + b'_T with s = T of contact   Eq. (69)
                    row[p] += phi * force_rate[k, c, p]
                for p in range(count):
                    # f'_Ic += Phi_I' s_c
                    row[which[p]] += rates.phi[at + a * count + p] * force[i, c]


@compiled
def add_shape_seeds(table, points, x_bar, force, d, adjoint, mix, equations, phi_bar):
    """Add the seeds on B, those of B' d and B'^T s: x_bar . d - s . lambda.

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
                # Phi_I_bar += x_bar_c d_Ic - s_c lambda_Ic, lambda = Lambda C
                u, t, row = d[near, c], force[i, c], adjoint[equations[near, c]]
                for m in range(out.size):
                    out[m] += x_bar[k, c, m] * u
                if t != 0.0:
                    for j in range(row.size):
                        for m in range(out.size):
                            out[m] -= t * row[j] * mix[j, m]


# ---- gradients F = 1 + sum_I d_I grad Phi_I of the k points of a table, the first ones of each group,
# in the order 11, 12, 21, 22, and in a body of revolution h = 1 + sum_I d_I1 Phi_I / R, the product with
# the table's third row ----


@compiled
def add_gradient_rates(table, rates, d, out):
    """Add sum_I d_I grad Phi_I' to ``out`` (k, 4 or 5, P)."""
    of_point, q_count = grad_rows(table), len(out) // (table.start.size - 1)
    for g in range(table.start.size - 1):
        s0 = table.start[g]
        n = table.start[g + 1] - s0
        which = rates.active[rates.start[g, 0] : rates.start[g + 1, 0]]
        count = which.size
        for q in range(q_count):
            i, at = g * q_count + q, of_point * (rates.start[g, 1] + q * n * count)
            for a in range(n):
                near = table.neighbours[s0 + a]
                for j in range(2):
                    for p in range(count):
                        rate = rates.grad[at + (j * n + a) * count + p]
                        # F_ij' += d_Ii Phi_I,j'
                        out[i, j, which[p]] += d[near, 0] * rate
                        out[i, 2 + j, which[p]] += d[near, 1] * rate
                for p in range(count if of_point == 3 else 0):
                    # h' += d_I1 (Phi_I / R)'
                    out[i, 4, which[p]] += d[near, 0] * rates.grad[at + (2 * n + a) * count + p]


@compiled
def add_field_gradient(table, equations, field, out):
    """Add sum_I v_I grad Phi_I to ``out`` (k, 4 or 5, P); ``field`` is v."""
    of_point, q_count = grad_rows(table), len(out) // (table.start.size - 1)
    for g in range(table.start.size - 1):
        s0 = table.start[g]
        n = table.start[g + 1] - s0
        for q in range(q_count):
            i, first = g * q_count + q, of_point * (s0 * table.group_size + q * n)
            for a in range(n):
                for c in range(2):
                    at = equations[table.neighbours[s0 + a], c]
                    if at >= 0:
                        row = field[at]
                        for j in range(2):
                            # F_ij += v_Ii Phi_I,j
                            b = table.grad[first + j * n + a]
                            for p in range(row.size):
                                out[i, 2 * c + j, p] += b * row[p]
                        if of_point == 3 and c == 0:
                            # h += v_I1 Phi_I / R
                            b = table.grad[first + 2 * n + a]
                            for p in range(row.size):
                                out[i, 4, p] += b * row[p]


@compiled
def add_gradient_loads(table, f_bar, equations, d_bar):
    """Transpose of ``add_field_gradient``: seeds ``f_bar`` (k, 4 or 5, M) on F, added to those on v,
    ``d_bar`` (n_equations + 1, M)."""
    of_point, q_count = grad_rows(table), len(f_bar) // (table.start.size - 1)
    for g in range(table.start.size - 1):
        s0 = table.start[g]
        n = table.start[g + 1] - s0
        for q in range(q_count):
            i, first = g * q_count + q, of_point * (s0 * table.group_size + q * n)
            for a in range(n):
                near = table.neighbours[s0 + a]
                for j in range(2):
                    b = table.grad[first + j * n + a]
                    for c in range(2):
                        # v_Ii_bar += F_ij_bar Phi_I,j
                        seed, row = f_bar[i, 2 * c + j], d_bar[equations[near, c]]
                        for m in range(seed.size):
                            row[m] += seed[m] * b
                if of_point == 3:
                    # v_I1_bar += h_bar Phi_I / R
                    b, seed = table.grad[first + 2 * n + a], f_bar[i, 4]
                    row = d_bar[equations[near, 0]]
                    for m in range(seed.size):
                        row[m] += seed[m] * b


@compiled
def add_gradient_seeds(table, f_bar, d, grad_bar):
    """Transpose of ``add_gradient_rates``: seeds ``f_bar`` (k, 4 or 5, M) on F, added to those on grad
    Phi, ``grad_bar`` (grad.size, M)."""
    of_point, q_count = grad_rows(table), len(f_bar) // (table.start.size - 1)
    for g in range(table.start.size - 1):
        s0 = table.start[g]
        n = table.start[g + 1] - s0
        for q in range(q_count):
            i, first = g * q_count + q, of_point * (s0 * table.group_size + q * n)
            for a in range(n):
                near = table.neighbours[s0 + a]
                for j in range(2):
                    row = grad_bar[first + j * n + a]
                    for c in range(2):
                        # Phi_I,j_bar += F_ij_bar d_Ii
                        seed = f_bar[i, 2 * c + j]
                        for m in range(seed.size):
                            row[m] += seed[m] * d[near, c]
                if of_point == 3:
                    # (Phi_I / R)_bar += h_bar d_I1
                    row, seed = grad_bar[first + 2 * n + a], f_bar[i, 4]
                    for m in range(seed.size):
                        row[m] += seed[m] * d[near, 0]
