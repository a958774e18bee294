"""What fictitious loads and their transposes do with one cell at many load steps.

Slopes are grad u with rows (step, component) and columns (quadrature point, component).
"""

import numba as nb


@nb.njit(cache=True, error_model="numpy")
def widest_group(table):
    """Largest number of neighbours of a group."""
    widest = 0
    for cell in range(table.start.size - 1):
        widest = max(widest, table.start[cell + 1] - table.start[cell])
    return widest


@nb.njit(cache=True, error_model="numpy")
def block(buffer, rows, columns):
    """The beginning of a flat buffer as a matrix."""
    return buffer[: rows * columns].reshape(rows, columns)


@nb.njit(cache=True, error_model="numpy")
def cell_displacements(d, near, out):
    """``out`` (2 K, n): d of the neighbours, rows (step, component)."""
    for k in range(d.shape[0]):
        for a in range(near.size):
            out[2 * k, a] = d[k, near[a], 0]
            out[2 * k + 1, a] = d[k, near[a], 1]


@nb.njit(cache=True, error_model="numpy", inline="always")
def point_gradients(slopes, k, q_count, f):
    """``f`` (q, 5): F and det F - 1 at one step, from grad u with rows (step, component)."""
    for q in range(q_count):
        f11, f12 = slopes[2 * k, 2 * q], slopes[2 * k, 2 * q + 1]
        f21, f22 = slopes[2 * k + 1, 2 * q], slopes[2 * k + 1, 2 * q + 1]
        f[q, 0], f[q, 1], f[q, 2], f[q, 3] = 1.0 + f11, f12, f21, 1.0 + f22
        f[q, 4] = f11 + f22 + (f11 * f22 - f12 * f21)


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def add_pressure(weight, f, e0, e1, e2, e3, out):
    """out += weight cof F : e, over all parameters or adjoints."""
    c0, c1, c2, c3 = weight * f[3], -weight * f[2], -weight * f[1], weight * f[0]
    for m in range(out.size):
        out[m] += c0 * e0[m] + c1 * e1[m] + c2 * e2[m] + c3 * e3[m]


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def stress_of(w, a, f, pressure, e0, e1, e2, e3, d0, d1, d2, d3):
    """d = w (A : e + p cof F), components 11, 12, 21, 22, over all parameters or adjoints."""
    for m in range(pressure.size):
        x0, x1, x2, x3, p = w * e0[m], w * e1[m], w * e2[m], w * e3[m], w * pressure[m]
        d0[m] = a[0, 0] * x0 + a[0, 1] * x1 + a[0, 2] * x2 + a[0, 3] * x3 + p * f[3]
        d1[m] = a[1, 0] * x0 + a[1, 1] * x1 + a[1, 2] * x2 + a[1, 3] * x3 - p * f[2]
        d2[m] = a[2, 0] * x0 + a[2, 1] * x1 + a[2, 2] * x2 + a[2, 3] * x3 - p * f[1]
        d3[m] = a[3, 0] * x0 + a[3, 1] * x1 + a[3, 2] * x2 + a[3, 3] * x3 + p * f[0]


@nb.njit(cache=True, error_model="numpy", fastmath={"contract", "reassoc"})
def add_scaled(out, factor, values):
    """out += factor values."""
    for m in range(out.size):
        out[m] += factor * values[m]
