"""Load paths of the benchmarks, and the forces that hold their bodies."""

import numpy as np

from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.analysis.path_result import PathResult
from seal_mdao.analysis.problem import PathProblem
from seal_mdao.equilibrium.discretization import Body, Discretization, discretize
from seal_mdao.loads.imposed import ImposedDisplacements


def tight(*materials) -> NewtonOptions:
    """Newton tolerance near what rounding leaves, which grows with the bulk modulus.

    The exact solutions are of the primary branch, also where it is not stable any more: a free side
    wrinkles below a stretch of about 0.54, and errors of integration count under high pressure.
    """
    ratio = max(material.bulk_modulus / material.shear_modulus for material in materials)
    return NewtonOptions(tolerance=max(1e-11, 1e-14 * ratio), branch="primary")


def ramp(n_steps: int) -> np.ndarray:
    """From 0 to 1 in equal steps, shape (n_steps + 1,)."""
    return np.linspace(0.0, 1.0, n_steps + 1)


def grown(values: np.ndarray, n_steps: int) -> ImposedDisplacements:
    """Displacements (n, 2) imposed in equal steps."""
    return ImposedDisplacements(ramp(n_steps)[:, None, None] * values)


def solve(
    body: Body, particles: np.ndarray, definitions, n_steps: int, imposed=None, options=None
) -> PathResult:
    """Load path of a body under its terms; arguments as of ``PathProblem`` and ``solve_path``.

    Raises
    ------
    RuntimeError
        When the path cannot be completed.
    """
    disc = discretize(body, particles, definitions)
    return solve_discretized(disc, definitions, n_steps, imposed, options)


def solve_discretized(
    disc: Discretization, definitions, n_steps: int, imposed=None, options=None
) -> PathResult:
    """As ``solve``, with the shape functions given."""
    path = solve_path(PathProblem(disc, definitions, imposed), n_steps, options)
    if not path.converged:
        raise RuntimeError(f"the benchmark's load path ended at {path.failure}")
    return path


def holding_forces(path: PathResult) -> np.ndarray:
    """Forces that hold imposed components at every nominal step, shape (n_steps, n, 2)."""
    structure = path.problem.term("structure")
    return np.array([structure.forces(step.d, step.fraction) for step in path.nominal_steps])
