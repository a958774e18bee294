"""Second Piola-Kirchhoff stress S, Green strain E and the moduli dS/dE of W(T, J), or W(T, J, h).

With C = F^T F of the plane, J = h det F and the derivatives J C^-1 = (h / det F) adj C of J in C,

    S = 2 W_T 1 + W_J J C^-1 in the plane,    S_33 = (W_h + W_J det F) / h across it

so that P = F S and P_h = h S_33. S, as everything that is carried along the path, does not turn with the
body. Components come last: 11, 22, 12, and in a body of revolution 33; strains have 2 E_12 in the third
place, so that S : E' is the sum of products.
"""

import numpy as np


def components(f: np.ndarray) -> int:
    """Number of components of S: 3 in the plane, 4 with h (``f`` of ``Deformation``)."""
    return f.shape[-1] - 2


def point_state(f: np.ndarray) -> list[np.ndarray]:
    """Compute T = F : F and J, and h in a body of revolution, of ``f`` (s, 5 or 6) at s points."""
    return [(f[:, :4] ** 2).sum(axis=1), 1.0 + f[:, 4], *f[:, 5:].T]


def _inverse(f):
    """J C^-1 (11, 22, 12), C^-1 (11, 22, 12), and det F."""
    f11, f12, f21, f22 = np.moveaxis(f[..., :4], -1, 0)
    det = f11 * f22 - f12 * f21
    # adj C = (C_22, C_11, -C_12)
    adjugate = np.stack(
        [f12 * f12 + f22 * f22, f11 * f11 + f21 * f21, -(f11 * f12 + f21 * f22)], axis=-1
    )
    h = f[..., 5] if f.shape[-1] == 6 else 1.0
    return (h / det)[..., None] * adjugate, adjugate / (det * det)[..., None], det


def second_stress(f: np.ndarray, w_t, w_j, w_h=None) -> np.ndarray:
    """Compute S from W_T, W_J and, with h, W_h: linear in these, so of their rates the rate at fixed F.

    Parameters
    ----------
    f : ndarray, shape (..., 5 or 6)
        F in the order 11, 12, 21, 22, J - 1, and h.
    w_t, w_j, w_h : ndarray, shape (...)

    Returns
    -------
    ndarray, shape (..., 3 or 4)
    """
    on_j, _, det = _inverse(f)
    out = np.empty((*f.shape[:-1], components(f)))
    # S = 2 W_T 1 + W_J J C^-1
    out[..., :3] = w_j[..., None] * on_j
    out[..., :2] += 2.0 * w_t[..., None]
    if w_h is not None:
        out[..., 3] = (w_h + w_j * det) / f[..., 5]
    return out


def stress_moduli(f: np.ndarray, w) -> np.ndarray:
    """Compute the symmetric dS/dE, shape (..., c, c) with c = 3 or 4, from the derivatives ``w`` of W at
    fixed pressure, (5 or 9, ...)."""
    w_j, w_tt, w_tj, w_jj = w[1:5]
    on_j, inverse, det = _inverse(f)
    count = components(f)
    # T' = 2 (E_11' + E_22'),  J' = J C^-1 : E' + det F h',  h' = E_33' / h
    t, j = np.zeros((*f.shape[:-1], count)), np.zeros((*f.shape[:-1], count))
    t[..., :2], j[..., :3] = 2.0, on_j
    if count == 4:
        j[..., 3] = det / f[..., 5]

    def outer(a, b):
        return a[..., :, None] * b[..., None, :]

    # of W_T T_E + W_J J_E
    out = w_tt[..., None, None] * outer(t, t) + w_jj[..., None, None] * outer(j, j)
    out += w_tj[..., None, None] * (outer(t, j) + outer(j, t))
    # d(J C^-1)/dE = J C^-1 (-C^-1 : E' + E_33' / h^2) + (h / det F) adj(2 E')
    scale = (f[..., 5] if count == 4 else 1.0) / det
    second = np.zeros((*f.shape[:-1], count, count))
    second[..., :3, :3] = -outer(on_j, inverse)
    second[..., 0, 1] += 2.0 * scale
    second[..., 1, 0] += 2.0 * scale
    second[..., 2, 2] -= scale
    if count == 4:
        h = f[..., 5]
        across = on_j / (h * h)[..., None]
        second[..., :3, 3], second[..., 3, :3] = across, across
        # S_33 = (W_h + W_J det F) / h at fixed W_h, W_J, det F
        second[..., 3, 3] = -det / h**3
    out += w_j[..., None, None] * second
    if count == 4:
        w_h, w_th, w_jh, w_hh = w[5:]
        across = np.zeros((*f.shape[:-1], count))
        across[..., 3] = 1.0 / h
        mixed = w_th[..., None] * t + w_jh[..., None] * j
        out += outer(mixed, across) + outer(across, mixed)
        out[..., 3, 3] += w_hh / h**2 - w_h / h**3
    return out


def green_rates(f: np.ndarray, rates: np.ndarray) -> np.ndarray:
    """Compute E' of F', sym(F^T F') with twice its 12 component, and h h'.

    Parameters
    ----------
    f : ndarray, shape (..., 5 or 6)
    rates : ndarray, shape (..., 4 or 5, P)
        F' in the order 11, 12, 21, 22, and h'.

    Returns
    -------
    ndarray, shape (..., 3 or 4, P)
    """
    f11, f12, f21, f22 = np.moveaxis(f[..., :4, None], -2, 0)
    r11, r12, r21, r22 = (rates[..., i, :] for i in range(4))
    out = np.empty((*rates.shape[:-2], components(f), rates.shape[-1]))
    out[..., 0, :] = f11 * r11 + f21 * r21
    out[..., 1, :] = f12 * r12 + f22 * r22
    out[..., 2, :] = f11 * r12 + f12 * r11 + f21 * r22 + f22 * r21
    if rates.shape[-2] == 5:
        out[..., 3, :] = f[..., 5, None] * rates[..., 4, :]
    return out


def along_gradient(f: np.ndarray, stress: np.ndarray) -> np.ndarray:
    """Compute P = F S and P_h = h S_33, the transpose of ``green_rates``.

    Parameters
    ----------
    f : ndarray, shape (..., 5 or 6)
    stress : ndarray, shape (..., 3 or 4, P)

    Returns
    -------
    ndarray, shape (..., 4 or 5, P)
    """
    f11, f12, f21, f22 = np.moveaxis(f[..., :4, None], -2, 0)
    s11, s22, s12 = (stress[..., i, :] for i in range(3))
    out = np.empty((*stress.shape[:-2], stress.shape[-2] + 1, stress.shape[-1]))
    out[..., 0, :], out[..., 1, :] = f11 * s11 + f12 * s12, f11 * s12 + f12 * s22
    out[..., 2, :], out[..., 3, :] = f21 * s11 + f22 * s12, f21 * s12 + f22 * s22
    if stress.shape[-2] == 4:
        out[..., 4, :] = f[..., 5, None] * stress[..., 3, :]
    return out
