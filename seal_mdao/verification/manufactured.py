"""Manufactured finite-strain solution: L2 and H1 errors of the whole analysis under refinement.

The displacement u(X) is chosen, the first Piola-Kirchhoff stress P follows from the package's own
material, the body force is -Div P (exact to rounding: complex step through P(F(X))), and the
tractions P N act on three sides of the unit square; the fourth has imposed displacements.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.body import Discretization, discretize
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.loading import LoadProgram, still_profile
from seal_mdao.analysis.loads import edge_points, point_loads
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.geometry.profile import flat_profile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin, cofactor
from seal_mdao.verification.bodies import Grid, edges_of, fixed_components, grid_body, scattered
from seal_mdao.verification.fields import domain_rule, operators_at

NO_CONTACT = ContactLaw(1.0, 1.0, 0.0, True)
STEP = 1e-30


class Solution(NamedTuple):
    """A chosen deformation of the unit square.

    Attributes
    ----------
    displacement : callable
        (n, 2) coordinates to (n, 2) displacements; complex arguments allowed.
    """

    displacement: Callable

    def gradient(self, X: np.ndarray) -> np.ndarray:
        """du_i / dX_j by the complex step, shape (n, 2, 2); X real."""
        steps = 1j * STEP * np.eye(2)
        return np.stack([self.displacement(X + s).imag / STEP for s in steps], axis=-1)
