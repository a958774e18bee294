"""Material laws under conditions: axial stretch, free growth by temperature or swelling, and a
factor of the moduli.

With the stretch h across the plane, growth theta (the stretch that nothing resists) and the factor m of
the moduli, and G(T, J, h) of ``hoop_stretch`` with the J of all three stretches, the energy per length
of the section as it is stretched is

    W = m theta^3 / h G(T / theta^2, h J / theta^3, h / theta)        plane section, J = det F
    W = m theta^3 G(T / theta^2, J / theta^3, h / theta)              body of revolution, h = r / R

A nearly incompressible law has its growth in the volumetric energy alone (``volumetric``): theta = 1
here. Without conditions, None, the law is that of ``hoop_stretch``.
"""

from typing import NamedTuple

import numpy as np

from seal_mdao.materials import hoop_stretch

COUNT = 3
"""Conditions in which ``rates``, ``energy_rates`` and ``von_mises_rates`` differentiate: h, theta, m."""


class Conditions(NamedTuple):
    """Conditions of one material; arrays broadcast against the states.

    Attributes
    ----------
    stretch : ndarray
        h along a plane section; 1 in a body of revolution, whose h is part of the state.
    growth : ndarray
        theta.
    factor : ndarray
        m.
    """

    stretch: np.ndarray
    growth: np.ndarray
    factor: np.ndarray


class _State(NamedTuple):
    """State that a law sees, T, J and h of G, with theta and the length of the section."""

    t: np.ndarray
    j: np.ndarray
    h: np.ndarray
    growth: np.ndarray
    length: np.ndarray
    around: bool

    @property
    def law(self):
        return self.t, self.j, self.h


def _seen(material, state, conditions: Conditions) -> _State:
    """Compute what the law sees of a state (T, J), or (T, J, h) in a body of revolution."""
    around = len(state) == 3
    theta = 1.0 if hoop_stretch.is_isochoric(material) else conditions.growth
    length = 1.0 if around else conditions.stretch
    h = state[2] if around else np.broadcast_to(conditions.stretch, np.shape(state[0]))
    # T / theta^2,  h J / theta^3 or J / theta^3,  h / theta
    return _State(
        state[0] / theta**2, state[1] * length / theta**3, h / theta, theta, length, around
    )


def _scales(own: _State, factor):
    """Factors of G_T, G_J, G_h in W_T, W_J, W_h: the chain rule of the state that the law sees."""
    # m theta^3 / l times 1 / theta^2, l / theta^3, 1 / theta
    return factor * own.growth / own.length, factor, factor * own.growth**2 / own.length


def derivatives(material, state, conditions: Conditions | None) -> np.ndarray:
    """Evaluate W_T, W_J, W_TT, W_TJ, W_JJ, shape (5, ...); of a state (T, J, h) also W_h, W_Th, W_Jh,
    W_hh, shape (9, ...)."""
    if conditions is None:
        return hoop_stretch.derivatives(material, *state)
    own = _seen(material, state, conditions)
    rows, theta, length = hoop_stretch.derivatives(material, *own.law), own.growth, own.length
    on_t, on_j, on_h = _scales(own, conditions.factor)
    # second derivatives: once more 1 / theta^2 by T, l / theta^3 by J, 1 / theta by h
    scales = (
        on_t, on_j, on_t / theta**2, on_j / theta**2, on_j * length / theta**3, on_h,
        on_h / theta**2, on_h * length / theta**3, on_h / theta,
    )  # fmt: skip
    count = len(rows) if own.around else 5
    return np.array([scale * row for scale, row in zip(scales[:count], rows[:count], strict=True)])


def rates(material, state, conditions: Conditions) -> np.ndarray:
    """Differentiate (W_T, W_J), or (W_T, W_J, W_h), in h of a plane section, theta and m, shape
    (3, 2 or 3, ...)."""
    own = _seen(material, state, conditions)
    _, _, w_tt, w_tj, w_jj, _, w_th, w_jh, w_hh = rows = hoop_stretch.derivatives(
        material, *own.law
    )
    slopes = rows[[0, 1, 5]]
    # gradients of G_T, G_J, G_h in T, J, h
    by_t, by_j, by_h = (
        np.array(own) for own in ((w_tt, w_tj, w_th), (w_tj, w_jj, w_jh), (w_th, w_jh, w_hh))
    )
    scales, theta = _scales(own, conditions.factor), own.growth
    out = np.zeros((COUNT, 3 if own.around else 2, *rows.shape[1:]))
    # powers of theta and 1 / l in the scales
    for row, (power, shorter) in enumerate(((1, 1), (0, 0), (2, 1))[: out.shape[1]]):
        gradient = by_t[row], by_j[row], by_h[row]
        out[1, row] = scales[row] * (power * slopes[row] / theta + _by_growth(own, gradient))
        if not own.around:
            # the J and h that the law sees grow with h
            along = gradient[1] * own.j / own.length + gradient[2] / theta
            out[0, row] = scales[row] * (along - shorter * slopes[row] / own.length)
        # W is proportional to m
        out[2, row] = scales[row] * slopes[row] / conditions.factor
    return _without_growth(material, out)


def _by_growth(own: _State, gradient):
    """Differentiate a function of the state that the law sees in theta, from its gradient."""
    # d(T / theta^2) = -2 T / theta^3, ...
    by_t, by_j, by_h = gradient
    return -(2.0 * own.t * by_t + 3.0 * own.j * by_j + own.h * by_h) / own.growth


def _without_growth(material, out: np.ndarray) -> np.ndarray:
    """Set the rates in theta of a law to zero whose growth is in the volumetric energy alone."""
    if hoop_stretch.is_isochoric(material):
        out[1] = 0.0
    return out


def constant_derivatives(material, state, conditions: Conditions | None) -> np.ndarray:
    """Evaluate d(W_T, W_J) / d constant, shape (n_constants, 2, ...); of a state (T, J, h) also of W_h,
    shape (n_constants, 3, ...)."""
    if conditions is None:
        return hoop_stretch.constant_derivatives(material, *state)
    own = _seen(material, state, conditions)
    rows = hoop_stretch.constant_derivatives(material, *own.law)
    scales = _scales(own, conditions.factor)[: 3 if own.around else 2]
    # the same factors, for no constant is in the state
    return np.stack([scale * rows[:, row] for row, scale in enumerate(scales)], axis=1)


def energy(material, state, conditions: Conditions | None) -> np.ndarray:
    """Evaluate W, shape of T."""
    if conditions is None:
        return hoop_stretch.energy(material, *state)
    own = _seen(material, state, conditions)
    return _energy_scale(own, conditions) * hoop_stretch.energy(material, *own.law)


def _energy_scale(own: _State, conditions: Conditions):
    # m theta^3 / l
    return conditions.factor * own.growth**3 / own.length


def constant_energies(material, state, conditions: Conditions | None) -> np.ndarray:
    """Evaluate dW / d constant, shape (n_constants, ...)."""
    if conditions is None:
        return hoop_stretch.constant_energies(material, *state)
    own = _seen(material, state, conditions)
    return _energy_scale(own, conditions) * hoop_stretch.constant_energies(material, *own.law)


def energy_rates(material, state, conditions: Conditions) -> np.ndarray:
    """Differentiate W in h of a plane section, theta and m, shape (3, ...)."""
    own = _seen(material, state, conditions)
    value, rows = (
        hoop_stretch.energy(material, *own.law),
        hoop_stretch.derivatives(material, *own.law),
    )
    gradient, scale = (rows[0], rows[1], rows[5]), _energy_scale(own, conditions)
    out = np.zeros((COUNT, *rows.shape[1:]))
    if not own.around:
        # W = m theta^3 / h G: W_h = m theta^3 / h (dG/dh - G / h)
        along = gradient[1] * own.j / own.length + gradient[2] / own.growth
        out[0] = scale * (along - value / own.length)
    # W_theta = m theta^3 / l (3 G / theta + dG/dtheta),  W_m = W / m
    out[1] = scale * (3.0 * value / own.growth + _by_growth(own, gradient))
    out[2] = scale * value / conditions.factor
    return _without_growth(material, out)


def von_mises(material, state, conditions: Conditions | None) -> np.ndarray:
    """Evaluate the von Mises stress, d/dT and d/dJ, shape (3, ...); of a state (T, J, h) also d/dh,
    shape (4, ...)."""
    if conditions is None:
        return hoop_stretch.von_mises(material, *state)
    own = _seen(material, state, conditions)
    # sigma = m sigma_G(T / theta^2, h J / theta^3, h / theta): the scales cancel
    value, by_t, by_j, by_h = conditions.factor * hoop_stretch.von_mises(material, *own.law)
    by_t, by_j = by_t / own.growth**2, by_j * own.length / own.growth**3
    return np.array([value, by_t, by_j, *([by_h / own.growth] if own.around else [])])


def von_mises_constants(material, state, conditions: Conditions | None) -> np.ndarray:
    """Evaluate d sigma_vm / d constant, shape (n_constants, ...)."""
    if conditions is None:
        return hoop_stretch.von_mises_constants(material, *state)
    own = _seen(material, state, conditions)
    return conditions.factor * hoop_stretch.von_mises_constants(material, *own.law)


def von_mises_rates(material, state, conditions: Conditions) -> np.ndarray:
    """Differentiate the von Mises stress in h of a plane section, theta and m, shape (3, ...)."""
    own = _seen(material, state, conditions)
    value, *gradient = hoop_stretch.von_mises(material, *own.law)
    out = np.zeros((COUNT, *np.shape(value)))
    if not own.around:
        out[0] = gradient[1] * own.j / own.length + gradient[2] / own.growth
    out[1], out[2] = _by_growth(own, gradient), value / conditions.factor
    return _without_growth(material, conditions.factor * out)


class Volumetric(NamedTuple):
    """The volumetric energy theta^3 K/2 (h J / theta^3 - 1)^2 per length h in the form of plane strain,
    K* / 2 (J - 1 + c)^2.

    Attributes
    ----------
    bulk : ndarray
        K* over K: h / theta^3 of a plane section, 1 / theta^3 of a body of revolution.
    offset : ndarray
        c = 1 - theta^3 / h, or 1 - theta^3.
    bulk_rates, offset_rates : ndarray, shape (3, ...)
        Derivatives in h, theta and m.
    """

    bulk: np.ndarray
    offset: np.ndarray
    bulk_rates: np.ndarray
    offset_rates: np.ndarray


def volumetric(conditions: Conditions) -> Volumetric:
    """Compute the effect of the conditions on the volumetric energy of a nearly incompressible
    law."""
    h, theta, zero = conditions.stretch, conditions.growth, 0.0 * conditions.factor
    # theta^3 / h K/2 (h J / theta^3 - 1)^2 = (h / theta^3) K/2 (J - theta^3 / h)^2
    bulk = h / theta**3
    return Volumetric(
        bulk, 1.0 - theta**3 / h,
        np.array([bulk / h + zero, -3.0 * bulk / theta + zero, zero]),
        np.array([theta**3 / h**2 + zero, -3.0 * theta**2 / h + zero, zero]),
    )  # fmt: skip
