"""The door seal analysed, with the words of the paper's example."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from seal_mdao.contact.friction import OPEN, SLIP, STICK
from seal_mdao.errors import LoadPathError
from seal_mdao.seals.door.measures import BY_NAME, MeasurePoints, chosen_points, measures_at
from seal_mdao.seals.result import SealResult
from seal_mdao.structure.particle_stress import particle_stress


@dataclass(frozen=True, eq=False)
class DoorSealResult(SealResult):
    """One design of a door seal, analysed.

    Attributes
    ----------
    frozen_points : MeasurePoints, optional
        Where the measures are taken. The drawn seal itself does without: it chooses them.
    """

    frozen_points: MeasurePoints | None = None

    @property
    def reaction(self) -> np.ndarray:
        """Force of the seal on the door [horizontal, vertical], shape (n_steps, 2), N/m."""
        return self.path.reaction("door")

    @property
    def door_positions(self) -> np.ndarray:
        """Height of the door's flat after every completed nominal step, shape (n_steps,), mm."""
        motion = self.seal.motion
        fractions = [step.fraction for step in self.path.nominal_steps]
        return np.array([motion.pose(fraction).position[1] for fraction in fractions])

    @property
    def door_travel(self) -> np.ndarray:
        """Door travel counted from the first touch of the drawn seal, shape (n_steps,), mm."""
        return self.seal.section.outer_radius - self.door_positions

    def travel_at(self, fraction: float) -> float:
        return float(self.seal.section.outer_radius - self.seal.motion.pose(fraction).position[1])

    def steps_at(self, depths) -> list[int]:
        """Nominal steps whose door travel is nearest to ``depths`` (mm), each once, in order."""
        travel = self.door_travel
        return sorted({int(np.argmin(np.abs(travel - depth))) for depth in depths})

    def key_steps(self) -> list[int]:
        travel = self.door_travel[-1:]
        return self.steps_at(np.outer(travel, [0.25, 0.5, 0.75, 1.0]).ravel())

    def caption(self, step: int) -> str:
        return f"door travel {self.door_travel[step]:.1f} mm"

    @property
    def contact(self):
        """What the contact with the door answers at the end of the path."""
        return self.response("door")

    @property
    def door_radius(self) -> float:
        """Corner radius of the door, mm."""
        return self.seal.radius

    @property
    def is_drawn(self) -> bool:
        """Whether this is the drawn seal under the drawn door."""
        seal = self.seal
        same_door = seal.radius == seal.drawn_door_radius
        return same_door and np.array_equal(self.particles, seal.drawn_particles)

    @cached_property
    def points(self) -> MeasurePoints:
        """Where the measures are taken; nothing is analysed for it.

        Raises
        ------
        LoadPathError
            When they are not known, because this path or that of the drawn seal was not completed.
        """
        if self.frozen_points is not None:
            return self.frozen_points
        self.require_converged()
        if not self.is_drawn:
            raise LoadPathError(
                "the measures are taken where the drawn seal has its peaks and its gap, and its path "
                "could not be completed; give the result the places of another seal, "
                "result.at(measure_points(...))",
                self,
            )
        return chosen_points(self)

    def at(self, points: MeasurePoints) -> "DoorSealResult":
        """The same result with its measures taken at ``points``."""
        return replace(self, frozen_points=points)

    def measures(self, measures=None) -> tuple:
        chosen = self.seal.measures() if measures is None else measures
        named = [BY_NAME[m] if isinstance(m, str) and m in BY_NAME else m for m in chosen]
        own = BY_NAME.values()
        return super().measures(
            [measures_at(self.points, (m,))[0] if m in own else m for m in named]
        )

    @property
    def area(self) -> float:
        """Area of the section between its spline boundaries, mm^2.

        Raises
        ------
        ValueError
            For a result computed from particles, which has no splines.
        """
        if self.boundary_offsets is None:
            raise ValueError(
                "a result computed from particles has no spline boundaries; the area of its cells is "
                "path.discretization.weights.sum()"
            )
        return self.seal.area(self.boundary_offsets)[0]

    @property
    def von_mises(self) -> np.ndarray:
        """Von Mises stress at the frozen particles at the end of the path, shape (7,), kPa."""
        return particle_stress(self.path, self.points.stress, self.end)[0]

    @property
    def gap(self) -> np.ndarray:
        """Normal gaps at the frozen contact points at the end of the path, mm."""
        return self.contact.gap[self.points.gap]

    @property
    def gap_square_sum(self) -> float:
        """Sum of the squared gaps, mm^2."""
        return float(self.gap @ self.gap)

    @property
    def max_penetration(self) -> float:
        """Deepest penetration at the end of the path, mm."""
        return float(max(0.0, -self.contact.gap.min()))

    @property
    def contact_counts(self) -> dict:
        """Points in contact, sticking and slipping at the end of the path."""
        state = self.contact.state
        return {
            "contact": int(np.sum(state != OPEN)),
            "stick": int(np.sum(state == STICK)),
            "slip": int(np.sum(state == SLIP)),
        }

    @property
    def failure(self) -> str:
        travel = self.door_travel
        reached = (
            f"; the door was {travel[-1]:.4g} mm below the top of the drawn seal then"
            if travel.size and not self.converged
            else ""
        )
        return super().failure + reached
