"""Design velocity of a section: its boundary moves along nominal normals by B-splines of arc length, the
inside by harmonic extension on the background cells."""

from typing import NamedTuple

import numpy as np
import scipy
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from seal_mdao.rkpm.cells import cell_map, quadrature_weights, tangents

DEGREE = 3


class Stretch(NamedTuple):
    """An edge as a range of points of its loop.

    Attributes
    ----------
    loop : int
    points : ndarray of int, shape (k,)
        Indices in the loop, in order; those of a complete loop once around.
    closed : bool
        Whether it is a complete loop.
    """

    loop: int
    points: np.ndarray
    closed: bool


def stretches(boundaries) -> dict:
    """Find the ``Stretch`` of every edge of boundaries by name; ValueError if it is not contiguous."""
    found = {}
    for loop, boundary in enumerate(boundaries):
        edges = np.asarray(boundary.edge)
        for name in dict.fromkeys(edges.tolist()):
            sides = np.flatnonzero(edges == name)
            if sides.size == edges.size:
                found[name] = Stretch(loop, sides, True)
                continue
            # an edge across the beginning of the loop: rotate its sides into order
            gap = np.flatnonzero(np.diff(sides) > 1)
            if gap.size:
                sides = np.roll(sides, -int(gap[0]) - 1)
            if name in found or (np.diff(sides) % edges.size != 1).any():
                raise ValueError(f"the edge {name!r} is not one unbroken stretch of the boundary")
            found[name] = Stretch(loop, np.append(sides, (sides[-1] + 1) % edges.size), False)
    return found


def checked_names(names, known, what: str) -> None:
    """Raise ValueError for a name that no edge has."""
    for name in names:
        if name not in known:
            raise ValueError(f"{what}: no edge is called {name!r}; edges are {', '.join(known)}")


def boundary_velocity(boundaries, designs, supports) -> np.ndarray:
    """Compute the design velocity of every boundary point, shape (P, k, 2), dimensionless.

    V_p = dX / db_p for parameter b_p: B-spline N_p of arc length along the nominal normals.

    Parameters
    ----------
    boundaries : sequence of Boundary
    designs : mapping of str to int
        Parameters of the edges that move, in this order, and along each edge.
    supports : mapping of str to tuple of int
        Straight edges with one prescribed component stay in their plane: their ends move along it with
        the adjacent edges, and the points between linearly. All other edges without a design have zero
        velocity, and that of a designed edge is zero where it meets one of them.
    """
    known = stretches(boundaries)
    checked_names(designs, known, "design")
    for name in designs:
        if name in supports:
            what = "is fixed" if len(supports[name]) == 2 else "is in a plane"
            raise ValueError(f"design: the edge {name!r} {what}")
    planes = {name: own[0] for name, own in supports.items() if len(own) == 1}
    starts = np.cumsum([0, *(len(boundary.points) for boundary in boundaries)])
    still = [known[name] for name in known if name not in designs and name not in planes]
    fixed_points = {(stretch.loop, int(k)) for stretch in still for k in stretch.points}
    # designed edges end at zero where an edge without velocity begins
    columns = [np.zeros((0, starts[-1], 2))]
    for name, count in designs.items():
        stretch = known[name]
        boundary = boundaries[stretch.loop]
        ends = [(stretch.loop, int(stretch.points[end])) in fixed_points for end in (0, -1)]
        basis = _basis(boundary, stretch, count, ends, name)
        # V_p(X_k) = N_p(s_k) n_k
        own = basis.T[:, :, None] * _directions(boundary, stretch)
        column = np.zeros((count, starts[-1], 2))
        column[:, starts[stretch.loop] + stretch.points] = own
        columns.append(column)
    velocity = np.concatenate(columns)
    for name, component in planes.items():
        stretch = known[name]
        points = starts[stretch.loop] + stretch.points
        _slide(velocity, points, _along(boundaries[stretch.loop], stretch), component)
    return velocity


def _along(boundary, stretch) -> np.ndarray:
    """Compute the arc length of the points of a stretch from its beginning, shape (k,), mm."""
    arc = np.asarray(boundary.arc_length)[stretch.points]
    return (arc - arc[0]) % boundary.length


def _slide(velocity, points, along, component) -> None:
    """Keep an edge in its plane: its ends move along it, points between by linear interpolation."""
    ends = points[[0, -1]]
    velocity[:, ends, component] = 0.0
    # V(s) = (1 - s / L) V_first + s / L V_last
    fraction = (along / along[-1])[None, :, None]
    first, last = (velocity[:, end][:, None] for end in ends)
    velocity[:, points] = first + fraction * (last - first)


def _basis(boundary, stretch, count, fixed, name) -> np.ndarray:
    """Evaluate the B-splines at the points of a stretch, shape (k, count).

    ``fixed``: whether its first, and its last, point does not move.
    """
    least = DEGREE + 1
    if count + sum(fixed) * (not stretch.closed) < least:
        raise ValueError(
            f"design: the edge {name!r} needs at least {least - sum(fixed)} parameters, got {count}"
        )
    arc = _along(boundary, stretch)
    if stretch.closed:
        return _periodic(arc / boundary.length, count)
    # clamped uniform knots: only the first spline is not zero at the first point, only the last
    # at the last one; these are left out where the ends are fixed
    inner = np.linspace(0.0, arc[-1], count + sum(fixed) - DEGREE + 1)
    knots = np.concatenate([[0.0] * DEGREE, inner, [arc[-1]] * DEGREE])
    values = scipy.interpolate.BSpline.design_matrix(arc, knots, DEGREE).toarray()
    return values[:, fixed[0] : values.shape[1] - fixed[1]]


def _periodic(s, count) -> np.ndarray:
    """Evaluate periodic B-splines at fractions ``s`` of the loop; number j is largest at j / count."""
    knots = np.arange(-DEGREE, count + DEGREE + 1) / count
    values = scipy.interpolate.BSpline.design_matrix(s, knots, DEGREE).toarray()
    # splines that leave the interval at its end enter it at the beginning: add the two parts
    found = values[:, :count].copy()
    found[:, :DEGREE] += values[:, count:]
    return np.roll(found, -1, axis=1)


def _directions(boundary, stretch) -> np.ndarray:
    """Compute the velocity of points for a unit offset, shape (k, 2): both sides of a corner by 1.

    At the ends of a stretch only its own normal counts: the adjacent edge adds its own velocity.
    """
    before, after = (
        np.column_stack([t[:, 1], -t[:, 0]])
        for t in np.asarray(boundary.tangent)[stretch.points].transpose(1, 0, 2)
    )
    if not stretch.closed:
        before[0], after[-1] = after[0], before[-1]
    # v . n_1 = v . n_2 = 1 for v = (n_1 + n_2) / (1 + n_1 . n_2), bounded at sharp corners
    denominator = 1.0 + (before * after).sum(axis=1)
    return (before + after) / np.maximum(denominator, 0.5)[:, None]


def stiffness(cells: np.ndarray, particles: np.ndarray):
    """Assemble the stiffness int grad N_a . grad N_b of the Laplacian, sparse (n, n)."""
    mapping = cell_map(cells)
    t = tangents(mapping, particles)
    weights = quadrature_weights(mapping, particles)
    slopes = np.empty((2, *weights.shape, 4))
    slopes[:] = mapping.rule.slopes[:, None]
    slopes[:, mapping.triangles] = mapping.triangle_rule.slopes[:, None]
    # t_k = dX/dxi_k:  J = t_1 x t_2,  dN/dx = (dN/dxi_1 t_2y - dN/dxi_2 t_1y) / J,
    # dN/dy = (dN/dxi_2 t_1x - dN/dxi_1 t_2x) / J
    jacobian = t[0, ..., 0] * t[1, ..., 1] - t[0, ..., 1] * t[1, ..., 0]
    t, jacobian = t[..., None], jacobian[..., None]
    along_x = (slopes[0] * t[1, ..., 1, :] - slopes[1] * t[0, ..., 1, :]) / jacobian
    along_y = (slopes[1] * t[0, ..., 0, :] - slopes[0] * t[1, ..., 0, :]) / jacobian
    # k_ab = sum_q w_q (N_a,x N_b,x + N_a,y N_b,y)
    local = sum(np.einsum("cq,cqa,cqb->cab", weights, g, g) for g in (along_x, along_y))
    rows = np.broadcast_to(mapping.cells[:, :, None], local.shape)
    columns = np.broadcast_to(mapping.cells[:, None], local.shape)
    n = len(particles)
    return coo_array((local.ravel(), (rows.ravel(), columns.ravel())), shape=(n, n)).tocsc()


def harmonic_extension(cells, particles, boundary, values: np.ndarray) -> np.ndarray:
    """Extend values (P, k, 2) at boundary particles (k,) harmonically to all particles (P, n, 2).

    Linear in the values; linear fields are reproduced. One factorisation serves all P of them.
    """
    n_fields, n = len(values), len(particles)
    inside = np.setdiff1d(np.arange(n), boundary)
    out = np.zeros((n_fields, n, 2))
    out[:, boundary] = values
    if n_fields == 0 or inside.size == 0:
        return out
    # K_ii V_i = -K_ib V_b for the inside i and the boundary b
    matrix = stiffness(cells, particles)[inside]
    known = values.transpose(1, 0, 2).reshape(len(boundary), -1)
    solved = splu(matrix[:, inside].tocsc()).solve(-(matrix[:, boundary] @ known))
    out[:, inside] = solved.reshape(inside.size, n_fields, 2).transpose(1, 0, 2)
    return out
