"""Rubber bodies with four straight edges, 4 mm high, and the tangents at the ends of their paths."""

import numpy as np

from seal_mdao.analysis.problem import PathProblem

SHEAR_MODULUS, BULK_MODULUS, HEIGHT = 200.0, 2e4, 4.0
AROUND = '[model]\nkinematics = "axisymmetric"\n'
_SECTION = """
[section]
material = "{material}"
spacing = {spacing}
outer = [
  {{ edge = "base", line = [[{left}, 0.0], [{right}, 0.0]] }},
  {{ edge = "right", line = [[{right}, 0.0], [{right}, 4.0]] }},
  {{ edge = "top", line = [[{right}, 4.0], [{left}, 4.0]] }},
  {{ edge = "left", line = [[{left}, 4.0], [{left}, 0.0]] }},
]
"""


def rubber(name: str) -> str:
    """Table of a material."""
    return (
        f'\n[material.{name}]\nlaw = "neo_hookean"\nc10 = {0.5 * SHEAR_MODULUS}\n'
        f"bulk_modulus = {BULK_MODULUS}\n"
    )


def section(left: float, right: float, spacing: float, material: str = "rubber") -> str:
    """Table of the section between two abscissas, mm; it ends with its boundary."""
    return _SECTION.format(left=left, right=right, spacing=spacing, material=material)


def inverse_tangent(result) -> np.ndarray:
    """Inverse of the tangent at the last step of a path, shape (n, n)."""
    path = result.path
    assembly = PathProblem(path.discretization, result.seal.terms()).assemble_at(path.steps[-1])
    return assembly.factorize().solve(np.eye(path.discretization.layout.n_equations))
