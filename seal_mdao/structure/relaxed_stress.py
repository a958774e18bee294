"""Von Mises stress at points of a region that relaxes, through all steps of the path.

Every point has the history of ``relaxation`` of its own, from its F at all converged steps n:

    S_tot = k_N S_N + H_N,    sigma = F S_tot F^T / J in the plane,    h^2 S_tot,33 / J across it

and the von Mises stress of sigma. The derivatives go back through the steps as those of
``linearized_relaxation`` do. In plane strain h = 1.
"""

import numpy as np

from seal_mdao.materials import stretch_and_growth
from seal_mdao.structure.environment import at_points
from seal_mdao.structure.second_stress import (
    along_gradient,
    point_state,
    second_stress,
    stress_moduli,
)

_NO_STRESS = 1e-300


def relaxed_von_mises(structure, region, f: np.ndarray, fractions):
    """Compute the von Mises stress at s points at the end of N steps, and its derivatives.

    Parameters
    ----------
    structure : StructuralTerm
    region : Region
        With a Prony series.
    f : ndarray, shape (N, s, 5 or 6)
        F in the order 11, 12, 21, 22, J - 1, and h, at the steps.
    fractions : sequence of float, shape (N,)
        Path parameters.

    Returns
    -------
    stress : ndarray, shape (s,)
    by_gradient : ndarray, shape (N, s, 4 or 5)
    by_constants : list of (str, ndarray of shape (s,))
    """
    around = f.shape[-1] == 6
    path = _Path(structure, region, f, fractions)
    f, steps, own, before = path.f, path.steps, path.coefficients, path.before
    stress, viscous = path.stress, path.viscous
    nothing = viscous[0]
    value, on_f, on_total = _of_cauchy(f[-1], path.total)
    # backwards: seeds on S+ and Q_i+ of every step
    by_gradient, by_name = np.zeros((len(f), *on_f.shape)), {}
    by_gradient[-1] = on_f
    on_carried, on_stress, on_viscous = on_total, np.zeros_like(on_total), np.zeros_like(nothing)
    for n in reversed(range(len(steps))):
        step, by_step, ends = steps[n], own[n], (before[n], fractions[n])
        keep, take = by_step.keep[..., None], by_step.take[..., None]
        # what S_tot takes of S+ with k, at the last step alone
        on_factor = (step.stress * on_carried).sum(axis=1)
        seed = on_stress + (take * on_viscous).sum(axis=0) + by_step.factor[0] * on_carried
        by_gradient[n] += along_gradient(f[n], (step.moduli @ seed[..., None]))[..., 0]
        for name, rate in step.by_parameter():
            by_name[name] = by_name.get(name, 0.0) + (rate * seed).sum(axis=1)
        both = on_viscous + on_carried
        on_keep = (viscous[n] * both).sum(axis=2)
        on_take = ((step.stress - stress[n]) * both).sum(axis=2) - on_factor
        for name, rate in structure.material_history.rates_of_region(region, *ends).items():
            row = (rate.keep * on_keep + rate.take * on_take).sum(axis=0)
            by_name[name] = by_name.get(name, 0.0) + row + rate.factor[0] * on_factor
        on_stress, on_viscous = -(take * both).sum(axis=0), keep * both
        on_carried = np.zeros_like(on_carried)
    return value, by_gradient[..., : 5 if around else 4], list(by_name.items())


def relaxed_stress(structure, region, f: np.ndarray, fractions) -> np.ndarray:
    """Compute the von Mises stress of ``relaxed_von_mises`` alone, shape (s,)."""
    path = _Path(structure, region, f, fractions)
    return _of_cauchy(path.f[-1], path.total)[0]


class _Path:
    """Histories of s points through N steps.

    Attributes
    ----------
    f : ndarray, shape (N, s, 6)
        With h, 1 in plane strain.
    steps : list of _Step
    before : list of float
        Path parameters at the beginning of the steps.
    coefficients : list of StepCoefficients
    stress, viscous : list of ndarray, shapes (s, 4), (n, s, 4)
        S and Q_i at the start and at the end of every step.
    total : ndarray, shape (s, 4)
        S_tot at the end.
    """

    def __init__(self, structure, region, f, fractions):
        if f.shape[-1] == 5:
            # h = 1, in which nothing is differentiated
            f = np.concatenate([f, np.ones((*f.shape[:-1], 1))], axis=-1)
        both = zip(f, fractions, strict=True)
        self.f, self.steps = f, [_Step(structure, region, own, at) for own, at in both]
        self.before = [0.0, *fractions[:-1]]
        ends = zip(self.before, fractions, strict=True)
        self.coefficients = [structure.material_history.of_region(region, *own) for own in ends]
        # S and Q_i at the beginning of every step
        nothing = np.zeros((len(region.prony.g), *self.steps[0].stress.shape))
        self.stress, self.viscous = [nothing[0]], [nothing]
        for step, own in zip(self.steps, self.coefficients, strict=True):
            # Q_i+ = a_i Q_i + b_i (S+ - S)
            keep, take = own.keep[..., None], own.take[..., None]
            change = step.stress - self.stress[-1]
            self.viscous.append(keep * self.viscous[-1] + take * change)
            self.stress.append(step.stress)

    @property
    def total(self) -> np.ndarray:
        """S_tot = k S + sum_i (a_i Q_i - b_i S_before) at the end."""
        last = self.coefficients[-1]
        keep, take = last.keep[..., None], last.take[..., None]
        carried = (keep * self.viscous[-2] - take * self.stress[-2]).sum(axis=0)
        return last.factor[0] * self.stress[-1] + carried


class _Step:
    """S of the law at s points at one step, and its derivatives in strain and parameters."""

    def __init__(self, structure, region, f, fraction: float):
        self.region, self.f = region, f
        self.own = at_points(structure.conditions(region, [fraction]))
        self.state = point_state(f)
        self.w = stretch_and_growth.derivatives(region.material, self.state, self.own.conditions)
        self.stress = second_stress(f, self.w[0], self.w[1], self.w[5])

    @property
    def moduli(self) -> np.ndarray:
        """dS/dE, (s, 4, 4)."""
        return stress_moduli(self.f, self.w)

    def by_parameter(self):
        """Yield names of parameters and dS/d(each), (s, 4)."""
        material, state, own = self.region.material, self.state, self.own
        rows = stretch_and_growth.constant_derivatives(material, state, own.conditions)
        for name, row in zip(self.region.names, rows, strict=True):
            yield name, second_stress(self.f, *row)
        if own.rates:
            slopes = stretch_and_growth.rates(material, state, own.conditions)
            for name, rates in own.rates.items():
                # d(W_T, W_J, W_h)/dp = d/d(h, theta, m) . d(h, theta, m)/dp
                yield name, second_stress(self.f, *(slopes * rates[:, None]).sum(axis=0))


def _of_cauchy(f: np.ndarray, total: np.ndarray):
    """Von Mises stress of sigma = F S F^T / J, and its derivatives in F (with h) and in S."""
    f11, f12, f21, f22 = f[:, :4].T
    j, h = 1.0 + f[:, 4], f[:, 5]
    # F S (11, 12, 21, 22), and h S_33
    product = along_gradient(f, total[..., None])[..., 0]
    p11, p12, p21, p22, across = product.T
    xx, yy = (p11 * f11 + p12 * f12) / j, (p21 * f21 + p22 * f22) / j
    xy, zz = (p11 * f21 + p12 * f22) / j, across * h / j
    square = 0.5 * ((xx - yy) ** 2 + (yy - zz) ** 2 + (zz - xx) ** 2) + 3.0 * xy**2
    value = np.sqrt(square)
    # d sigma_vm / d sigma, of which 12 counts for both
    scale = 1.0 / np.maximum(value, _NO_STRESS)
    on_xx, on_yy, on_zz = (scale * (1.5 * own - 0.5 * (xx + yy + zz)) for own in (xx, yy, zz))
    on_xy = 1.5 * scale * xy
    # sigma = F S F^T / J: in S it is F^T (.) F / J
    m11, m12 = on_xx * f11 + on_xy * f21, on_xx * f12 + on_xy * f22
    m21, m22 = on_xy * f11 + on_yy * f21, on_xy * f12 + on_yy * f22
    on_total = np.empty_like(total)
    on_total[:, 0], on_total[:, 1] = (f11 * m11 + f21 * m21) / j, (f12 * m12 + f22 * m22) / j
    on_total[:, 2] = (f11 * m12 + f21 * m22 + f12 * m11 + f22 * m21) / j
    on_total[:, 3] = on_zz * h * h / j
    # in F: 2 (.) F S / J - sigma : (.) J_F / J
    on_f = np.empty((len(f), 5))
    on_f[:, 0], on_f[:, 1] = on_xx * p11 + on_xy * p21, on_xx * p12 + on_xy * p22
    on_f[:, 2], on_f[:, 3] = on_xy * p11 + on_yy * p21, on_xy * p12 + on_yy * p22
    on_f[:, 4] = on_zz * across
    on_f *= 2.0 / j[:, None]
    # sigma : (.) = sigma_vm, which is of degree one in sigma;  J_F / J = F^-T and 1 / h
    det = f11 * f22 - f12 * f21
    inverse = np.stack([f22 / det, -f21 / det, -f12 / det, f11 / det, 1.0 / h], axis=1)
    return value, on_f - value[:, None] * inverse, on_total
