"""Points of a load path at which equilibrium became unstable, with their description."""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.seals.checks import crosses_itself
from seal_mdao.seals.profiles import position, stage_number
from seal_mdao.seals.result_units import PLANE
from seal_mdao.terms.point_assembly import interpolate


@dataclass(frozen=True, eq=False)
class Instability:
    """Point of a load path at which equilibrium became unstable.

    Attributes
    ----------
    fraction : float
        Path parameter, in nominal load steps.
    travel : float
        Of the first profile that moves, in its stage, mm; NaN without one.
    kind : str
        "branch": the branch of equilibria continues, but is unstable; "limit": it ends;
        "unsymmetric": under friction the determinant of the tangent has become negative.
    mode : ndarray, shape (n, 2)
        Critical mode: displacements of the particles, the largest component 1.
    moved : float
        How far a particle moved from there to the equilibrium at which the path continues, mm; 0 where
        the path stays on the branch.
    released : float
        Energy released during the jump; NaN where it is unknown.
    lower_bound : bool
        Whether that is a lower bound of it, as with friction.
    unit : str
        Of the energy.
    stage : int
        Number of its stage, from 1; 0 where the path has a single one.
    crossed : bool
        Whether the boundary crosses itself after a jump; the energy of that state is then unknown.
    position : str
        As of ``profiles.position``, for a stage without travel.
    """

    fraction: float
    travel: float
    kind: str
    mode: np.ndarray
    moved: float
    released: float
    lower_bound: bool
    unit: str = PLANE.energy
    stage: int = 0
    crossed: bool = False
    position: str = ""

    @property
    def text(self) -> str:
        """Description in one line."""
        place = f"load step {self.fraction:.4g}"
        if self.position and not self.travel:
            place = self.position
        elif np.isfinite(self.travel):
            place = f"travel {self.travel:.3f} mm" + (
                f" of stage {self.stage}" if self.stage else ""
            )
        if self.kind == "unsymmetric":
            return (
                f"the equilibrium may not be stable from {place} on, because the determinant of "
                "the tangent stiffness is negative; check the following load steps, or compare "
                "with slightly different friction"
            )
        if self.moved == 0.0:
            return (
                f"the equilibrium is not stable from {place} on, and the analysis follows this "
                "unstable branch of equilibria"
            )
        least = "at least " if self.lower_bound else ""
        lost = (
            f" and releases {least}{self.released:.2g} {self.unit}"
            if np.isfinite(self.released)
            else ""
        )
        if self.crossed:
            lost = ", where the boundary crosses itself, so that no energy is given"
        why = (
            "the branch of equilibria ends"
            if self.kind == "limit"
            else "the branch of equilibria bifurcates"
        )
        return (
            f"{why} at {place}: the seal snaps to the next stable equilibrium, {self.moved:.2g} mm "
            f"away{lost}"
        )


def instabilities(result) -> tuple[Instability, ...]:
    """Return the instabilities of a load path, complete or not, in order."""
    return tuple(_instability(result, point) for point in result.path.critical_points)


def _instability(result, point) -> Instability:
    path, mode = result.path, np.empty_like(point.mode)
    # the state after a jump: the end of the path up to the first step behind it
    after = [count for count, step in enumerate(path.steps, 1) if step.fraction >= point.fraction]
    crossed = bool(
        point.moved and after and crosses_itself(replace(path, steps=path.steps[: after[0]]))
    )
    interpolate(path.discretization.everywhere.table, point.mode, mode)
    return Instability(
        point.fraction, result.travel_at(point.fraction), point.kind, mode / np.abs(mode).max(),
        point.moved, np.nan if crossed else point.released, not path.problem.symmetric,
        result.seal.units.energy, stage_number(result.seal, point.fraction), crossed,
        position(result.seal, point.fraction),
    )  # fmt: skip
