"""Constraints in the form SLSQP wants: equalities that vanish, inequalities not negative."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from seal_mdao.drivers.slsqp_kernel import SlsqpValues

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from seal_mdao.drivers.evaluation import Evaluation
    from seal_mdao.drivers.layout import ProblemLayout


class SlsqpForm:
    """Translates constraint values and derivatives; a two-sided constraint becomes two.

    Parameters
    ----------
    layout : ProblemLayout
        Layout of the problem. Constraints that depend on no design variable are left out.

    Attributes
    ----------
    equalities, inequalities : int
        Numbers of constraints in SLSQP's form.
    """

    def __init__(self, layout: ProblemLayout):
        equal = layout.active & (layout.c_lower == layout.c_upper)
        above = layout.active & ~equal & np.isfinite(layout.c_lower)
        below = layout.active & ~equal & np.isfinite(layout.c_upper)
        groups = [np.flatnonzero(mask) for mask in (equal, above, below)]
        self._rows = np.concatenate(groups)
        self._signs = np.repeat([1.0, 1.0, -1.0], [rows.size for rows in groups])
        bounds = (layout.c_lower, layout.c_lower, layout.c_upper)
        self._bounds = np.concatenate([b[r] for b, r in zip(bounds, groups, strict=True)])
        self.equalities = groups[0].size
        self.inequalities = groups[1].size + groups[2].size

    def values(
        self,
        point: Evaluation,
        gradient: NDArray[np.float64],
        jacobian: NDArray[np.float64],
        scale: float,
    ) -> SlsqpValues:
        """Return the values and derivatives of a point, the objective divided by ``scale``."""
        d = self._signs * (point.constraints[self._rows] - self._bounds)
        normals = self._signs[:, None] * jacobian[self._rows]
        return SlsqpValues(point.x, point.objective / scale, d, gradient / scale, normals)
