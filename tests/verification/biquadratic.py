"""A second, independent discretisation for reference values: Q2 / discontinuous P1 finite elements.

Biquadratic displacements with a pressure that is linear in every element and jumps between them, a
pair that is stable for incompressible materials. Nothing of it is shared with the particle method
but the material's energy:

    Pi(u, p) = int W_dev(F) + p (J - 1) - p^2 / (2 K) dA - dead loads.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from seal_mdao.materials.isotropic import cofactor
from seal_mdao.materials.mooney_rivlin import MooneyRivlin

PLACES = np.array([-1.0, 0.0, 1.0])
EPS = np.array([[0.0, 1.0], [-1.0, 0.0]])


class Elements(NamedTuple):
    """Shape functions of a mapped nx x ny mesh at its 3 x 3 Gauss points.

    Attributes
    ----------
    nodes : ndarray, shape (n, 2)
    connectivity : ndarray of int, shape (m, 9)
    grad : ndarray, shape (m, 9, 9, 2)
        (element, point, node, component), per length.
    weights : ndarray, shape (m, 9)
    modes : ndarray, shape (9, 3)
        Pressure modes 1, xi, eta at the points.
    """

    nodes: np.ndarray
    connectivity: np.ndarray
    grad: np.ndarray
    weights: np.ndarray
    modes: np.ndarray


def lagrange(x):
    """Quadratic Lagrange functions on -1, 0, 1 and their slopes, (points, 3) each."""
    x = np.asarray(x)[:, None]
    values = np.hstack([0.5 * x * (x - 1), 1 - x * x, 0.5 * x * (x + 1)])
    return values, np.hstack([x - 0.5, -2 * x, x + 0.5])


def mapped_elements(nx: int, ny: int, mapping) -> Elements:
    """Elements of the unit square mapped by ``mapping`` ((n, 2) to (n, 2))."""
    rows = 2 * ny + 1
    i, j = np.divmod(np.arange((2 * nx + 1) * rows), rows)
    nodes = mapping(np.column_stack([i / (2 * nx), j / (2 * ny)]))
    a, b = (2 * k.ravel() for k in np.mgrid[:nx, :ny])
    da, db = (k.ravel() for k in np.mgrid[:3, :3])
    connectivity = (a[:, None] + da) * rows + b[:, None] + db
    g, w = np.polynomial.legendre.leggauss(3)
    value, slope = lagrange(g)
    d_xi = np.einsum("pa,qb->pqab", slope, value).reshape(9, 9)
    d_eta = np.einsum("pa,qb->pqab", value, slope).reshape(9, 9)
    local = np.stack([d_xi, d_eta], axis=-1)
    jacobian = np.einsum("qak,eai->eqik", local, nodes[connectivity])
    grad = np.einsum("qak,eqki->eqai", local, np.linalg.inv(jacobian))
    weights = np.outer(w, w).ravel() * np.linalg.det(jacobian)
    xi, eta = (k.ravel() for k in np.meshgrid(g, g, indexing="ij"))
    modes = np.column_stack([np.ones(9), xi, eta])
    return Elements(nodes, connectivity, grad, weights, modes)


def components(nodes: np.ndarray) -> np.ndarray:
    """Displacement components (m, 2 a) of the nodes (m, a) of elements or points."""
    return (2 * nodes[..., None] + [0, 1]).reshape(len(nodes), -1)


def entry_places(dofs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows and columns of the entries of matrices (m, k, k) in the components ``dofs`` (m, k)."""
    return np.repeat(dofs, dofs.shape[1], axis=1).ravel(), np.tile(dofs, (1, dofs.shape[1])).ravel()


def _element_system(mesh, material, u, p):
    """Residuals and blocks of all elements: r_u (m, 18), r_p (m, 3), k_uu, k_up, k_pp."""
    m = len(mesh.connectivity)
    F = np.eye(2) + np.einsum("eqaj,eai->eqij", mesh.grad, u[mesh.connectivity])
    J, cof = np.linalg.det(F), cofactor(F)
    pressure = p @ mesh.modes.T
    w, modes = mesh.weights, mesh.modes
    P = material.stress(F) + pressure[..., None, None] * cof
    A = material.tangent(F) + pressure[..., None, None, None, None] * np.einsum(
        "ik,jl->ijkl", EPS, EPS
    )
    r_u = np.einsum("eq,eqij,eqaj->eai", w, P, mesh.grad).reshape(m, 18)
    r_p = np.einsum("eq,eq,qk->ek", w, J - 1.0 - pressure / material.bulk_modulus, modes)
    moved = np.einsum("eq,eqijkl,eqbl->eqijbk", w, A, mesh.grad)
    k_uu = np.einsum("eqaj,eqijbk->eaibk", mesh.grad, moved, optimize=True).reshape(m, 18, 18)
    k_up = np.einsum("eq,eqij,eqaj,qk->eaik", w, cof, mesh.grad, modes, optimize=True)
    k_pp = -np.einsum("eq,qk,ql->ekl", w, modes, modes) / material.bulk_modulus
    return r_u, r_p, k_uu, k_up.reshape(m, 18, 3), k_pp


def condensed(mesh, material, u, p):
    """Element residuals and matrices after the pressures are eliminated, and how to get those back."""
    r_u, r_p, k_uu, k_up, k_pp = _element_system(mesh, material, u, p)
    inverse = np.linalg.inv(k_pp)
    back = np.einsum("ekl,eal->eka", inverse, k_up)
    r = r_u - np.einsum("eak,ekl,el->ea", k_up, inverse, r_p)
    k = k_uu - np.einsum("eak,ekb->eab", k_up, back)
    return r, k, np.einsum("ekl,el->ek", inverse, r_p), back


def changed_pressures(p, shift, back, change):
    """Pressures after a change (m, 18) of the displacements; ``shift``, ``back`` as of ``condensed``."""
    return p - shift - np.einsum("eka,ea->ek", back, change)


def solve_elements(
    mesh: Elements, material: MooneyRivlin, fixed: np.ndarray, force: np.ndarray, n_steps: int
) -> np.ndarray:
    """Displacements (n, 2) under dead loads ``force`` (n, 2) applied in equal steps.

    Raises
    ------
    RuntimeError
        When a step does not converge.
    """
    n = len(mesh.nodes)
    u, p = np.zeros((n, 2)), np.zeros((len(mesh.connectivity), 3))
    dofs = components(mesh.connectivity)
    places = entry_places(dofs)
    free = np.flatnonzero(~fixed.ravel())
    for step in range(1, n_steps + 1):
        load = (step / n_steps) * force.ravel()
        for _ in range(30):
            r, k, shift, back = condensed(mesh, material, u, p)
            residual = np.bincount(dofs.ravel(), r.ravel(), 2 * n) - load
            matrix = csc_array((k.ravel(), places), shape=(2 * n, 2 * n))
            change = np.zeros(2 * n)
            change[free] = splu(matrix[free][:, free].tocsc()).solve(-residual[free])
            u = u + change.reshape(n, 2)
            p = changed_pressures(p, shift, back, change[dofs])
            if np.abs(change).max() < 1e-10 * np.abs(u).max():
                break
        else:
            raise RuntimeError(f"the reference solution did not converge in step {step}")
    return u
