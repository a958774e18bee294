"""Laws of plane strain at a stretch h across the plane, for bodies of revolution.

With the in-plane T = F : F and the J = h det F of all three stretches the energy is W(T, J, h), made of
the W(T, J) of plane strain, P below, where h = 1.

An isochoric energy depends on ratios of stretches alone:

    W(T, J, h) = P(a, b),    a = T / h^2,    b = J / h^3

and by the chain rule, a_h = -2 a / h and b_h = -3 b / h,

    W_T = P_a / h^2,    W_J = P_b / h^3,    W_h = -(2 a P_a + 3 b P_b) / h.

The energy of a compressible law is sum_i f(lambda_i) + V(J), with f and V and their slopes zero at 1
(``Isotropic.volumetric``). Both (lambda_1, lambda_2, 1) and (1, h, 1) are states of plane strain, in
which V' is the stress across the plane, and so with J_2 = J / h

    W(T, J, h) = P(T, J_2) - V(J_2) + V(J) + f(h),    f(h) = P(1 + h^2, h) - V(h).
"""

import numpy as np

from seal_mdao.materials.isotropic import Isotropic, squared_difference, von_mises_rows

ROWS = 9
"""Of ``derivatives``."""


def is_isochoric(material) -> bool:
    """Whether the volumetric energy of a law is K/2 (J - 1)^2, apart from its W."""
    return material.bulk_modulus != 0.0


def is_known(material) -> bool:
    """Whether the energy of a law is known at stretches across the plane other than 1."""
    return is_isochoric(material) or type(material).volumetric is not Isotropic.volumetric


def energy(material, t, j, h=None) -> np.ndarray:
    """Evaluate W, shape of ``t``."""
    if h is None:
        return material.energy(t, j)
    if is_isochoric(material):
        return material.energy(t / h**2, j / h**3)
    volume = material.volumetric(j) - material.volumetric(j / h) - material.volumetric(h)
    return material.energy(t, j / h) + material.energy(1.0 + h * h, h) + volume


def constant_energies(material, t, j, h=None) -> np.ndarray:
    """Evaluate dW / d constant, shape (n_constants, ...)."""
    if h is None:
        return material.constant_energies(t, j)
    if is_isochoric(material):
        return material.constant_energies(t / h**2, j / h**3)
    v, v_2, v_h = (material.volumetric_constants(x) for x in (j, j / h, h))
    plane = material.constant_energies(t, j / h) + material.constant_energies(1.0 + h * h, h)
    return plane + (v - v_2 - v_h)


def derivatives(material, t, j, h=None) -> np.ndarray:
    """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...), and where h is given W_h, W_Th, W_Jh, W_hh,
    shape (9, ...)."""
    if h is None:
        return material.derivatives(t, j)
    return (_of_ratios if is_isochoric(material) else _of_sums)(material, t, j, h)


def _of_ratios(material, t, j, h):
    """Differentiate P(a, b)."""
    a, b = t / h**2, j / h**3
    w_a, w_b, w_aa, w_ab, w_bb = w = material.derivatives(a, b)
    out = np.empty((ROWS, *np.shape(t)), w.dtype)
    out[0], out[1] = w_a / h**2, w_b / h**3
    out[2], out[3], out[4] = w_aa / h**4, w_ab / h**5, w_bb / h**6
    # the first sum is zero to the bit where there is no stress
    out[5] = -(2.0 * (a * w_a + b * w_b) + b * w_b) / h
    # W_Th = -(2 P_a + 2 a P_aa + 3 b P_ab) / h^3,  W_Jh = -(3 P_b + 2 a P_ab + 3 b P_bb) / h^4
    out[6] = -(2.0 * w_a + 2.0 * a * w_aa + 3.0 * b * w_ab) / h**3
    out[7] = -(3.0 * w_b + 2.0 * a * w_ab + 3.0 * b * w_bb) / h**4
    # W_hh = (6 a P_a + 12 b P_b + 4 a^2 P_aa + 12 a b P_ab + 9 b^2 P_bb) / h^2
    out[8] = 6.0 * a * w_a + 12.0 * b * w_b
    out[8] += 4.0 * a * a * w_aa + 12.0 * a * b * w_ab + 9.0 * b * b * w_bb
    out[8] /= h**2
    return out


def _of_sums(material, t, j, h):
    """Differentiate P(T, J_2) - V(J_2) + V(J) + f(h)."""
    plane = j / h
    w_t, w_j, w_tt, w_tj, w_jj = w = material.derivatives(t, plane)
    (v, _, vv), (v_2, _, vv_2) = material.across(t, j), material.across(t, plane)
    # of U = P - V in the plane
    u_j, u_jj = w_j - v_2, w_jj - vv_2
    out = np.empty((ROWS, *np.shape(t)), w.dtype)
    # in this order the values at h = 1 are those of plane strain to the bit
    out[0], out[1] = w_t, w_j / h + (v - v_2 / h)
    out[2], out[3], out[4] = w_tt, w_tj / h, w_jj / h**2 + (vv - vv_2 / h**2)
    # d J_2/dh = -J_2 / h:  W_h = f' - J_2 U_J / h,  W_Th = -J_2 P_TJ / h
    slope, curvature = _across(material, h)
    out[5], out[6] = slope - plane * u_j / h, -plane * w_tj / h
    # W_Jh = -(U_J + J_2 U_JJ) / h^2,  W_hh = f'' + (2 J_2 U_J + J_2^2 U_JJ) / h^2
    out[7] = -(u_j + plane * u_jj) / h**2
    out[8] = curvature + plane * (2.0 * u_j + plane * u_jj) / h**2
    return out


def _across(material, h):
    """Evaluate f' and f'' of f(h) = P(1 + h^2, h) - V(h)."""
    w_t, w_j, w_tt, w_tj, w_jj = material.derivatives(1.0 + h * h, h)
    v, _, vv = material.across(1.0 + h * h, h)
    # f' = 2 h P_T + P_J - V',  f'' = 2 P_T + 4 h^2 P_TT + 4 h P_TJ + P_JJ - V''
    second = 2.0 * w_t + 4.0 * h * (h * w_tt + w_tj) + w_jj - vv
    return 2.0 * h * w_t + w_j - v, second


def constant_derivatives(material, t, j, h=None) -> np.ndarray:
    """Evaluate d(W_T, W_J) / d constant, shape (n_constants, 2, ...), and where h is given d W_h / d
    constant, (n_constants, 3, ...)."""
    if h is None:
        return material.constant_derivatives(t, j)
    if is_isochoric(material):
        a, b = t / h**2, j / h**3
        rates = material.constant_derivatives(a, b)
        by_a, by_b = rates[:, 0], rates[:, 1]
        on_h = -(2.0 * a * by_a + 3.0 * b * by_b) / h
        return np.stack([by_a / h**2, by_b / h**3, on_h], axis=1)
    plane = j / h
    rates, own = (material.constant_derivatives(*x) for x in ((t, plane), (1.0 + h * h, h)))
    v, v_2, v_h = (material.across_constant_derivatives(t, x) for x in (j, plane, h))
    # those of W_J = (P_J - V'(J_2)) / h + V'(J),  W_h = f' - J_2 (P_J - V'(J_2)) / h
    on_h = 2.0 * h * own[:, 0] + own[:, 1] - v_h - plane * (rates[:, 1] - v_2) / h
    return np.stack([rates[:, 0], rates[:, 1] / h + (v - v_2 / h), on_h], axis=1)


def von_mises(material, t, j, h=None) -> np.ndarray:
    """Evaluate the von Mises stress, d/dT and d/dJ, shape (3, ...), and where h is given d/dh, shape
    (4, ...)."""
    if h is None:
        return material.von_mises(t, j)
    w_t, _, w_tt, w_tj, _, w_h, w_th, w_jh, w_hh = derivatives(material, t, j, h)
    # Cauchy stresses (2/J) W_T F F^T + W_J 1 in the plane, h W_h / J + W_J across:
    # W_T / J, and the mean in the plane less that across, (W_T T - h W_h) / J
    shear, away = w_t / j, (w_t * t - h * w_h) / j
    return von_mises_rows(
        [shear, w_tt / j, (w_tj - shear) / j, w_th / j],
        # T^2 - 4 J^2 / h^2
        [squared_difference(t, j / h), 2.0 * t, -8.0 * j / h**2, 8.0 * j * j / h**3],
        [
            away,
            (w_tt * t + w_t - h * w_th) / j,
            (w_tj * t - h * w_jh - away) / j,
            (w_th * t - w_h - h * w_hh) / j,
        ],
    )


def von_mises_constants(material, t, j, h=None) -> np.ndarray:
    """Evaluate d sigma_vm / d constant, shape (n_constants, ...)."""
    if h is None:
        return material.von_mises_constants(t, j)
    w, rates = derivatives(material, t, j, h), constant_derivatives(material, t, j, h)
    spread = squared_difference(t, j / h)
    # as in ``von_mises``; T, J and h do not change
    return von_mises_rows(
        [w[0] / j, *(rates[:, 0] / j)],
        [spread, *(0.0 * spread for _ in rates)],
        [(w[0] * t - h * w[5]) / j, *((rates[:, 0] * t - h * rates[:, 2]) / j)],
    )[1:]
