"""Von Mises stress at points of a region that softens, through all steps of the path.

Every point has the largest energy W_max of its own, from its F at the converged steps n before the last
one N. The deviatoric stress has the factor eta of ``materials.ogden_roxburgh``:

    sigma_vm = eta(W_N, W_max) sigma_vm(F_N),    W_max = max_n W_n
"""

import numpy as np

from seal_mdao.materials import stretch_and_growth
from seal_mdao.materials.ogden_roxburgh import softened
from seal_mdao.structure.second_stress import along_gradient, point_state, second_stress


def softened_von_mises(structure, region, f: np.ndarray, fractions):
    """Compute the von Mises stress at s points at the end of N steps, and its derivatives.

    Parameters
    ----------
    structure : StructuralTerm
    region : Region
        That softens.
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
    path = _Path(structure, region, f, fractions)
    law, stress, by_t, by_j, *by_h = path.law, *path.elastic_stress
    # of eta sigma_vm: eta d(sigma_vm) + sigma_vm ((d eta/dW) dW_N + (d eta/dW_max) dW_max)
    by_gradient = np.zeros((len(f), f.shape[1], f.shape[2] - 1))
    # d sigma_vm/dF = 2 sigma_T F + sigma_J J_F, as W_F
    by_gradient[-1] = law.factor[:, None] * _by_gradient(f[-1], by_t, by_j, by_h)
    by_name = {}

    def add(names_and_rows, factor):
        for name, row in names_and_rows:
            by_name[name] = by_name.get(name, 0.0) + factor * row

    add(structure.von_mises_rates(region, path.state(-1), fractions[-1]), law.factor)
    names = [region.prefix + name for name in region.softening.constants]
    add(zip(names, law.by_constants, strict=True), stress)
    for at, slope in ((path.last, law.by_energy), (path.largest_at, law.by_largest)):
        for n in np.unique(at):
            factor = np.where(at == n, stress * slope, 0.0)
            if factor.any():
                by_gradient[n] += factor[:, None] * path.energy_gradient(n)
                add(path.energy_constants(n), factor)
    return law.factor * stress, by_gradient, list(by_name.items())


def softened_stress(structure, region, f: np.ndarray, fractions) -> np.ndarray:
    """Compute the von Mises stress of ``softened_von_mises`` alone, shape (s,)."""
    path = _Path(structure, region, f, fractions)
    return path.law.factor * path.elastic_stress[0]


class _Path:
    """Energies of s points through N steps.

    Attributes
    ----------
    law : Softened
        eta at the last step, and its derivatives.
    last, largest_at : ndarray of int, shape (s,)
        The last step, and that of W_max before.
    """

    def __init__(self, structure, region, f, fractions):
        self.structure, self.region, self.f, self.fractions = structure, region, f, fractions
        # W without the factor of the moduli over the temperature, as in ``softening``
        energies = np.array(
            [stretch_and_growth.energy(region.material, self.state(n), None) for n in range(len(f))]
        )
        # W_max = 0 of the undeformed state before the first step
        before = np.concatenate([np.zeros((1, f.shape[1])), energies[:-1]])
        self.largest_at = np.maximum(before.argmax(axis=0) - 1, 0)
        self.last = np.full(f.shape[1], len(f) - 1)
        law = region.softening
        self.law = softened(energies[-1], before.max(axis=0), law.r, law.m, law.beta)

    def state(self, n: int) -> list:
        """T, J, and h of a body of revolution, at a step."""
        return point_state(self.f[n])

    @property
    def elastic_stress(self) -> np.ndarray:
        """Von Mises stress of the elastic law at the last step, and its derivatives in the state."""
        return self.structure.von_mises(self.region, self.state(-1), self.fractions[-1])

    def energy_gradient(self, n: int) -> np.ndarray:
        """dW/dF and dW/dh at a step, (s, 4 or 5)."""
        w = stretch_and_growth.derivatives(self.region.material, self.state(n), None)
        return _by_gradient(self.f[n], w[0], w[1], w[5:6])

    def energy_constants(self, n: int):
        """Yield names of parameters and dW/d(each) at a step, (s,)."""
        rows = stretch_and_growth.constant_energies(self.region.material, self.state(n), None)
        yield from zip(self.region.names, rows, strict=True)


def _by_gradient(f, by_t, by_j, by_h) -> np.ndarray:
    """Differentiate a function of T, J and h in F and h: 2 q_T F + q_J J_F, and q_h + q_J det F."""
    return along_gradient(f, second_stress(f, by_t, by_j, *by_h)[..., None])[..., 0]
