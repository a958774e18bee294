"""The rubber once more in three dimensions, from the invariants of C, for complex F."""

import numpy as np


def in_space(F):
    """Plane strain: F_33 = 1."""
    full = np.eye(3, dtype=np.asarray(F).dtype)
    full[:2, :2] = F
    return full


def energy(F, c10, c01):
    """W_dev from I1 and I2 of C = F^T F and J = det F."""
    C = F.T @ F
    i1, i2 = np.trace(C), 0.5 * (np.trace(C) ** 2 - np.trace(C @ C))
    j = np.linalg.det(F)
    return c10 * (i1 * j ** (-2 / 3) - 3) + c01 * (i2 * j ** (-4 / 3) - 3)


def stress(F, c10, c01):
    """P = dW/dF by the chain rule through I1, I2 and J, 3 x 3."""
    C = F.T @ F
    i1, i2 = np.trace(C), 0.5 * (np.trace(C) ** 2 - np.trace(C @ C))
    j = np.linalg.det(F)
    by_i1, by_i2 = 2 * F, 2 * (i1 * F - F @ C)
    by_j = j * np.linalg.inv(F).T
    return (
        c10 * j ** (-2 / 3) * by_i1
        + c01 * j ** (-4 / 3) * by_i2
        - (2 / 3 * c10 * i1 * j ** (-5 / 3) + 4 / 3 * c01 * i2 * j ** (-7 / 3)) * by_j
    )


def von_mises(F, c10, c01):
    """sqrt(3/2 s : s) of the deviatoric Cauchy stress; no conjugation, so complex step passes."""
    cauchy = stress(F, c10, c01) @ F.T / np.linalg.det(F)
    s = cauchy - np.trace(cauchy) / 3 * np.eye(3)
    return np.sqrt(1.5 * np.sum(s * s))


def complex_step(function, F, h=1e-30):
    """d function / dF (2, 2, ...) of a function of the in-plane gradient."""
    out = []
    for i in range(2):
        for k in range(2):
            moved = F.astype(complex)
            moved[i, k] += 1j * h
            out.append(np.imag(function(moved)) / h)
    return np.array(out).reshape(2, 2, *np.shape(out[0]))


def rotation(angle):
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s], [s, c]])


def gradients(rng, count=6):
    """Deformation gradients far from the identity, det F between 0.7 and 1.5."""
    out = []
    for j in np.linspace(0.7, 1.5, count):
        F = rotation(rng.uniform(0, 6)) @ (np.eye(2) + rng.uniform(-0.5, 0.5, (2, 2)))
        out.append(F * np.sqrt(j / abs(np.linalg.det(F))))
        if np.linalg.det(F) < 0:
            out[-1] = out[-1][:, ::-1].copy()
    return np.array(out)
