"""Design velocity of a section: its boundary moves by offsets of edges, vertices and radii, the inside
by harmonic extension on the background cells."""

from contextlib import contextmanager

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from seal_mdao.rkpm.cells import cell_map, quadrature_weights, tangents
from seal_mdao.seals.outline.offset_fields import STILL, OffsetDesign
from seal_mdao.seals.outline.sampled_boundary import SampledBoundary


class ImpossibleDesignError(ValueError):
    """A design that cannot be applied to a section.

    Attributes
    ----------
    number : int
        Its number, from 1, with which the message begins.
    """

    def __init__(self, number: int, reason: Exception):
        super().__init__(f"[[design]] {number}: {reason}")
        self.number, self.reason = number, str(reason)


def checked_names(names, known, where: str = "") -> None:
    """Raise ValueError, with its message behind ``where``, for a name that no edge has."""
    for name in names:
        if name not in known:
            edges = ", ".join(known)
            raise ValueError(f"{where}the section has no edge {name!r}; its edges are {edges}")


@contextmanager
def _numbered_in_errors(number: int):
    """Make a ValueError of the design with a number an ``ImpossibleDesignError``."""
    try:
        yield
    except ValueError as error:
        raise ImpossibleDesignError(number, error) from error


def boundary_velocity(boundaries, designs, supports) -> tuple[np.ndarray, tuple]:
    """Compute the design velocity of every boundary point, and the number of parameters of the designs.

    V_p = dX / db_p for parameter b_p, shape (P, k, 2), dimensionless.

    Parameters
    ----------
    boundaries : sequence of Boundary
    designs : sequence of OffsetDesign, VertexDesign or RadiusDesign
        Their parameters in this order.
    supports : mapping of str to tuple of int
        Edges with one prescribed component that lie in a plane across it stay in it: their ends move
        along it with the adjacent edges, and the points between linearly. All other edges without a
        design have zero velocity, and that of a designed edge is zero where it meets one of them.

    Raises
    ------
    ImpossibleDesignError
        For names that no edge has, too few parameters, points that are not on the boundary, designs that
        would move a fixed edge, or another one out of its plane.
    """
    sampled = SampledBoundary(boundaries, supports)
    moving = set()
    for number, design in enumerate(designs, 1):
        with _numbered_in_errors(number):
            if isinstance(design, OffsetDesign):
                opposite = () if design.opposite is None else (design.opposite,)
                checked_names((*design.edges, *opposite), sampled.stretches)
                for name in (*design.edges, *opposite):
                    _require_free(name, supports)
            moved = design.moving(sampled)
            for name in sorted(moved):
                _require_free(name, supports)
        moving |= moved
    sampled.hold(moving)
    columns = [np.zeros((0, len(sampled.points), 2))]
    for number, design in enumerate(designs, 1):
        with _numbered_in_errors(number):
            columns.append(design.columns(sampled))
            if not isinstance(design, OffsetDesign):
                _require_supported(sampled, columns[-1], supports, design.remedy)
    velocity = np.concatenate(columns)
    for name, component in sampled.planes.items():
        _slide(velocity, sampled.indices(name), sampled.path(name).along, component)
    return velocity, tuple(len(own) for own in columns[1:])


def possible_designs(boundaries, designs, supports) -> tuple[list[int], dict[int, str]]:
    """Find the designs that ``boundary_velocity`` can apply to a section together.

    Parameters
    ----------
    boundaries, designs, supports
        As of ``boundary_velocity``.

    Returns
    -------
    list of int
        Indices of these designs, from 0.
    dict of int to str
        Why each of the others cannot be applied, by its index.
    """
    left, refused = list(range(len(designs))), {}
    while True:
        try:
            boundary_velocity(boundaries, [designs[i] for i in left], supports)
        except ImpossibleDesignError as error:
            refused[left.pop(error.number - 1)] = error.reason
        else:
            return left, refused


def _require_free(name, supports) -> None:
    """Refuse a designed edge that is supported."""
    if name in supports:
        what = "is fixed" if len(supports[name]) == 2 else "is fixed in one direction"
        raise ValueError(f"the edge {name!r} {what}, so it cannot move; choose another edge")


def _require_supported(sampled, columns, supports, remedy: str) -> None:
    """Refuse velocities of fixed edges, and of the ends of edges out of their planes."""
    for name, components in supports.items():
        # one component that is prescribed along an edge, not across it, does not restrict its shape
        if len(components) == 1 and name not in sampled.planes:
            continue
        # between their ends, edges in a plane follow these
        which = sampled.indices(name)
        which = which if len(components) == 2 else which[[0, -1]]
        moved = (
            np.abs(columns[:, which][..., list(components)]).max(axis=(0, 2), initial=0.0) > STILL
        )
        if moved.any():
            what = "is fixed" if len(components) == 2 else "can move only along its own line"
            # not only an end that a neighbour moves: the edge itself is designed
            cure = "choose another edge" if moved.all() and len(components) == 2 else remedy
            raise ValueError(
                f"the design parameter would move the edge {name!r}, which {what}; {cure}"
            )


def _slide(velocity, points, along, component) -> None:
    """Keep an edge in its plane: its ends move along it, points between by linear interpolation."""
    ends = points[[0, -1]]
    velocity[:, ends, component] = 0.0
    # V(s) = (1 - s / L) V_first + s / L V_last
    fraction = (along / along[-1])[None, :, None]
    first, last = (velocity[:, end][:, None] for end in ends)
    velocity[:, points] = first + fraction * (last - first)


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
