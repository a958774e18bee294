"""The seal analysed: from design parameters to measures, without OpenMDAO."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, lru_cache

import numpy as np

from seal_mdao.analysis.body import discretize
from seal_mdao.analysis.load_path import solve_path
from seal_mdao.analysis.result import ConvergedStep, PathResult, Status
from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.errors import LoadPathError
from seal_mdao.geometry.area import section_area
from seal_mdao.measures.selection import (
    MeasurePoints,
    contact_patches,
    curve_steps,
    opened_points,
    stress_points,
    touching_stretch,
)
from seal_mdao.measures.stress import von_mises_at
from seal_mdao.model import SealModel

CURVE_DEPTHS = (2.0, 4.0, 6.0, 8.0, 10.0)
"""Door travels at which the reaction is a measure, mm; those within the depth are taken."""

FACTOR_MEMORY = 2.0
"""GiB for factors that are kept for sensitivities."""


@dataclass(frozen=True, eq=False)
class SealResult:
    """One design of a seal, analysed.

    ``converged``, ``reaction``, ``newton_iterations`` and the path are there for a path that ended
    early too; the measures at the end of the path then raise ``LoadPathError``.

    Attributes
    ----------
    model : SealModel
    boundary_offsets : ndarray
        mm; None when the result was computed from particles.
    door_radius : float
        mm.
    path : PathResult
    frozen_points : MeasurePoints, optional
        Where the measures are taken; those of the model's own drawn seal when left out.
    """

    model: SealModel
    boundary_offsets: np.ndarray | None
    door_radius: float
    path: PathResult = field(repr=False)
    frozen_points: MeasurePoints | None = None

    @property
    def converged(self) -> bool:
        return self.path.converged

    @property
    def status(self) -> Status:
        return self.path.status

    @property
    def newton_iterations(self) -> np.ndarray:
        """Newton iterations of every nominal step, shape (n_steps,)."""
        return self.path.newton_iterations

    @property
    def step_cuts(self) -> int:
        return self.path.step_cuts

    @property
    def reaction(self) -> np.ndarray:
        """Force of the seal on the door [horizontal, vertical], shape (n_steps, 2), N/m."""
        return self.path.reaction

    @property
    def door_travel(self) -> np.ndarray:
        """Door travel counted from the first touch of the drawn seal, shape (n_steps,), mm."""
        return self.model.section.outer_radius - self.path.positions[:, 1]

    @property
    def particles(self) -> np.ndarray:
        """Undeformed particles, shape (n, 2), mm."""
        return self.path.discretization.particles

    @cached_property
    def points(self) -> MeasurePoints:
        """Where the measures are taken."""
        return measure_points(self.model) if self.frozen_points is None else self.frozen_points

    def require_converged(self) -> None:
        """Raise ``LoadPathError`` for a path that was not completed."""
        if not self.converged:
            raise LoadPathError(_failure(self), self)

    @property
    def end(self) -> ConvergedStep:
        """The last step of a completed path."""
        self.require_converged()
        return self.path.steps[-1]

    @property
    def area(self) -> float:
        """Area of the section, mm^2."""
        if self.boundary_offsets is None:
            return float(self.path.discretization.weights.sum())
        return section_area(self.model.splines, self.boundary_offsets)[0]

    @property
    def von_mises(self) -> np.ndarray:
        """Von Mises stress at the frozen particles at the end of the path, shape (7,), kPa."""
        table = self.path.discretization.table_at(self.points.stress).table
        return von_mises_at(table, self.end.d, self.model.material)[0]

    @property
    def gap(self) -> np.ndarray:
        """Normal gaps at the frozen contact points at the end of the path, mm."""
        return self.end.gap[self.points.gap]

    @property
    def gap_square_sum(self) -> float:
        """Sum of the squared gaps, mm^2."""
        return float(self.gap @ self.gap)

    @property
    def max_penetration(self) -> float:
        """Deepest penetration at the end of the path, mm."""
        return float(max(0.0, -self.end.gap.min()))

    @property
    def contact_counts(self) -> dict:
        """Points in contact, sticking and slipping at the end of the path."""
        state = self.end.after.state
        return {
            "contact": int(np.sum(state != OPEN)),
            "stick": int(np.sum(state == STICK)),
            "slip": int(np.sum(state == SLIP)),
        }

    def deformed(self, step: int = -1) -> np.ndarray:
        """Deformed particles after a nominal step, shape (n, 2), mm."""
        return self.particles + self.path.displacement(step)

    def stress_field(self, step: int = -1) -> np.ndarray:
        """Von Mises stress at all particles after a nominal step, shape (n,), kPa."""
        table = self.path.discretization.everywhere.table
        return von_mises_at(table, self.path.nominal_steps[step].d, self.model.material)[0]


def _failure(result: SealResult) -> str:
    """Where a path ended, in what state, and what can be done."""
    travel = result.door_travel
    reached = (
        f"the door was {travel[-1]:.4g} mm below the top of the drawn seal after the last "
        "converged step"
        if travel.size
        else "no step converged"
    )
    return (
        f"the load path could not be completed at {result.path.failure}; {reached}. Use more load "
        "steps (n_steps), a smaller depth or normal penalty, or a design nearer to the drawn seal"
    )


def analyze(
    model: SealModel,
    boundary_offsets: np.ndarray | None = None,
    door_radius: float | None = None,
    *,
    keep_factors: bool = False,
    callback: Callable | None = None,
) -> SealResult:
    """Analyse one design of a seal.

    Parameters
    ----------
    model : SealModel
    boundary_offsets : ndarray, shape (model.n_offsets,), optional
        Spline control values of the outer, then the inner boundary, mm; zeros when left out.
    door_radius : float, optional
        Corner radius of the door, mm; the drawn one when left out.
    keep_factors : bool
        Keep the factors of the converged tangents for sensitivities, as far as ``FACTOR_MEMORY``
        (GiB) goes.
    callback : callable, optional
        Called with each ``ConvergedStep`` that completes a nominal step.

    Returns
    -------
    SealResult
        Look at ``converged``: a path that ends early is returned, not raised.

    Raises
    ------
    ValueError
        Wrong sizes, values that are not finite, a folded section, too small a support.
    """
    offsets = model.check_offsets(boundary_offsets)
    result = analyze_particles(
        model, model.particles(offsets), door_radius,
        factor_memory=FACTOR_MEMORY if keep_factors else 0.0, callback=callback,
    )  # fmt: skip
    return SealResult(model, offsets, result.door_radius, result.path)


def analyze_particles(
    model: SealModel,
    particles,
    door_radius=None,
    *,
    points: MeasurePoints | None = None,
    factor_memory=0.0,
    callback=None,
) -> SealResult:
    """As ``analyze``, with the particles (n, 2) themselves, and the places of the measures given.

    Factors of converged tangents are kept as far as ``factor_memory`` (GiB) goes.
    """
    radius = model.check_door_radius(door_radius)
    path = solve_path(
        discretize(model.body, particles), model.material, model.profile(radius), model.law,
        model.program, model.newton, factor_memory, callback,
    )  # fmt: skip
    return SealResult(model, None, radius, path, points)


@lru_cache(maxsize=64)
def measure_points(model: SealModel) -> MeasurePoints:
    """Places of the measures, from the path of the drawn seal.

    Raises
    ------
    LoadPathError
        When the drawn seal's path cannot be completed.
    """
    return choose_points(analyze(model))


def choose_points(drawn: SealResult) -> MeasurePoints:
    """Places of the measures for all designs of a model, from its drawn seal, analysed.

    Raises
    ------
    LoadPathError
        When the path was not completed.
    """
    state, grid = drawn.end.after.state, drawn.model.grid
    inner = grid.particle(np.arange(grid.rays), 0)
    rows = [(grid.free_outer, False), (inner, True)]
    return MeasurePoints(
        stress_points(rows, drawn.stress_field()), opened_points(state), touching_stretch(state),
        contact_patches(state), curve_steps(drawn.door_travel, CURVE_DEPTHS),
    )  # fmt: skip
