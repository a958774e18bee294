"""Laws of plane strain at a stretch h across the plane, for bodies of revolution.

An isochoric energy depends on ratios of stretches alone, so that W(T, J) of plane strain, where h = 1,
knows it at every h: with the in-plane T = F : F and the J = h det F of all three stretches

    W(T, J, h) = W(a, b),    a = T / h^2,    b = J / h^3

and by the chain rule, a_h = -2 a / h and b_h = -3 b / h,

    W_T = W_a / h^2,    W_J = W_b / h^3,    W_h = -(2 a W_a + 3 b W_b) / h.

Kirchhoff stresses depend on ratios alone too, so Cauchy stresses are those at (a, b) over h^3.
"""

import numpy as np

ROWS = 9
"""Of ``derivatives``."""


def is_isochoric(material) -> bool:
    """Whether the volumetric energy of a law is K/2 (J - 1)^2, apart from its W."""
    return material.bulk_modulus > 0.0


def plane_state(t, j, h=None) -> tuple[np.ndarray, np.ndarray]:
    """Compute a = T / h^2 and b = J / h^3; T and J themselves without h."""
    return (t, j) if h is None else (t / h**2, j / h**3)


def derivatives(material, t, j, h=None) -> np.ndarray:
    """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...), and where h is given W_h, W_Th, W_Jh, W_hh,
    shape (9, ...)."""
    if h is None:
        return material.derivatives(t, j)
    a, b = plane_state(t, j, h)
    w_a, w_b, w_aa, w_ab, w_bb = material.derivatives(a, b)
    out = np.empty((ROWS, *np.shape(t)))
    out[0], out[1] = w_a / h**2, w_b / h**3
    out[2], out[3], out[4] = w_aa / h**4, w_ab / h**5, w_bb / h**6
    out[5] = -(2.0 * a * w_a + 3.0 * b * w_b) / h
    # W_Th = -(2 W_a + 2 a W_aa + 3 b W_ab) / h^3,  W_Jh = -(3 W_b + 2 a W_ab + 3 b W_bb) / h^4
    out[6] = -(2.0 * w_a + 2.0 * a * w_aa + 3.0 * b * w_ab) / h**3
    out[7] = -(3.0 * w_b + 2.0 * a * w_ab + 3.0 * b * w_bb) / h**4
    # W_hh = (6 a W_a + 12 b W_b + 4 a^2 W_aa + 12 a b W_ab + 9 b^2 W_bb) / h^2
    out[8] = 6.0 * a * w_a + 12.0 * b * w_b
    out[8] += 4.0 * a * a * w_aa + 12.0 * a * b * w_ab + 9.0 * b * b * w_bb
    out[8] /= h**2
    return out


def constant_derivatives(material, t, j, h=None) -> np.ndarray:
    """Evaluate d(W_T, W_J) / d constant, shape (n_constants, 2, ...), and where h is given d W_h / d
    constant, (n_constants, 3, ...)."""
    if h is None:
        return material.constant_derivatives(t, j)
    a, b = plane_state(t, j, h)
    rates = material.constant_derivatives(a, b)
    by_a, by_b = rates[:, 0], rates[:, 1]
    on_h = -(2.0 * a * by_a + 3.0 * b * by_b) / h
    return np.stack([by_a / h**2, by_b / h**3, on_h], axis=1)


def von_mises(material, t, j, h=None) -> np.ndarray:
    """Evaluate the von Mises stress, d/dT and d/dJ, shape (3, ...), and where h is given d/dh, shape
    (4, ...)."""
    if h is None:
        return material.von_mises(t, j)
    a, b = plane_state(t, j, h)
    value, by_a, by_b = material.von_mises(a, b) / h**3
    # d/dh = (-2 a d/da - 3 b d/db - 3) / h of s(a, b) / h^3
    by_h = -(2.0 * a * by_a + 3.0 * b * by_b + 3.0 * value) / h
    return np.array([value, by_a / h**2, by_b / h**3, by_h])


def von_mises_constants(material, t, j, h=None) -> np.ndarray:
    """Evaluate d sigma_vm / d constant, shape (n_constants, ...)."""
    if h is None:
        return material.von_mises_constants(t, j)
    return material.von_mises_constants(*plane_state(t, j, h)) / h**3


def energy(material, t, j, h=None) -> np.ndarray:
    """Evaluate W, shape of ``t``."""
    return material.energy(*plane_state(t, j, h))


def constant_energies(material, t, j, h=None) -> np.ndarray:
    """Evaluate dW / d constant, shape (n_constants, ...)."""
    return material.constant_energies(*plane_state(t, j, h))
