"""Solving a body without a rigid profile: imposed displacements and dead loads only."""

import numpy as np

from seal_mdao.analysis.body import Discretization
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.loading import LoadProgram
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.result import PathResult
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin


def tight(material: MooneyRivlin) -> NewtonOptions:
    """Newton tolerance near what rounding leaves, which grows with the bulk modulus."""
    ratio = material.bulk_modulus / material.shear_modulus
    return NewtonOptions(tolerance=max(1e-11, 1e-14 * ratio))


def ramp(values: np.ndarray, n_steps: int) -> np.ndarray:
    """Nodal values (n, 2) grown from zero in equal steps, shape (n_steps + 1, n, 2)."""
    return np.linspace(0.0, 1.0, n_steps + 1)[:, None, None] * values


def solve_free(
    disc: Discretization,
    material: MooneyRivlin,
    imposed: np.ndarray,
    force: np.ndarray | None = None,
) -> PathResult:
    """Load path of a body that touches nothing.

    Parameters
    ----------
    imposed : ndarray, shape (n_steps + 1, n, 2)
        Displacements of the fixed components at the start and after every step.
    force : ndarray, shape (n_steps + 1, n, 2), optional
        Dead loads.

    Raises
    ------
    RuntimeError
        When the path cannot be completed.
    """
    program = LoadProgram(np.zeros((len(imposed), 2)), imposed, force)
    law = ContactLaw(1.0, 1.0, 0.0, True)
    path = solve_path(disc, material, flat_profile(), law, program, tight(material))
    return completed(path)


def completed(path: PathResult) -> PathResult:
    """The path itself, if it was completed.

    Raises
    ------
    RuntimeError
        With the place of the failure, when it was not.
    """
    if not path.converged:
        raise RuntimeError(f"the benchmark's load path ended at {path.failure}")
    return path
