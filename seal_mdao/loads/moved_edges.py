"""Edges that follow a rigid motion: prescribed displacements of their particles.

With the motion z, angle of the edges, its start z_0, the pivot c and the rotation R = Q Q_0^T since then

    u = (z - z_0) + (R - 1)(X - z_0 - c),    du/dX = R - 1.
"""

from dataclasses import dataclass, replace

import numpy as np

from seal_mdao.geometry.motion import Motion
from seal_mdao.geometry.pose import quarter_turn
from seal_mdao.terms.term import Scalar


@dataclass(frozen=True, eq=False)
class MovedEdges:
    """Particles that move with one rigid body.

    Attributes
    ----------
    label : str
        Name of the edges, or of the profile to which they are bonded.
    particles : ndarray of int, shape (k,)
    components : tuple of int
        Prescribed components: 0 for x, 1 for y.
    motion : Motion
    start : ndarray, shape (3,)
        x, y, angle in the undeformed state. Parameters that displace the complete motion are reached in
        the first nominal load step.
    """

    label: str
    particles: np.ndarray
    components: tuple
    motion: Motion
    start: np.ndarray

    def _not_begun(self, fraction: float) -> float:
        """Return the fraction of the first nominal step that is still to come."""
        # 1 - s in the first nominal step, s from 0 to 1; all of it in preliminary increments
        return min(max(0.0, 1.0 - fraction), 1.0)

    def _since_start(self, fraction: float) -> np.ndarray:
        """Compute x, y, angle relative to the start, shape (3,)."""
        # w - w_0, the shift of the first waypoint is reached in the first step
        motion = self.motion
        shift = [*motion.positions[0], motion.angles[0]] - self.start
        return motion.coordinates(fraction) - self.start - self._not_begun(fraction) * shift

    def _arms(self, places: np.ndarray, angle: float) -> tuple[np.ndarray, np.ndarray]:
        """Compute R - 1 (2, 2), and R (X - z_0 - c) of places X (k, 2)."""
        cos, sin = np.cos(angle), np.sin(angle)
        rotation = np.array([[cos, -sin], [sin, cos]])
        return rotation - np.eye(2), (places - self.start[:2] - self.motion.pivot) @ rotation.T

    def displacements(self, places: np.ndarray, fraction: float) -> np.ndarray:
        """Compute the displacements (k, 2) of particles at ``places`` (k, 2) at a path parameter."""
        # u = (z - z_0) + (R - 1)(X - z_0 - c)
        moved = self._since_start(fraction)
        turned = self._arms(places, moved[2])[0]
        return moved[:2] + (places - self.start[:2] - self.motion.pivot) @ turned.T

    def rates(self, places: np.ndarray, fraction: float) -> np.ndarray:
        """Differentiate the displacements by the parameters of the motion, shape (k, 2, m)."""
        angle = self._since_start(fraction)[2]
        first = self._not_begun(fraction) * self.motion.rates[:, 0]
        # (z - z_0, angle)' without what the first step has yet to reach
        by_pose = self.motion.rates_at(fraction) - first
        # du/dz = 1,  du/dangle = S R (X - z_0 - c)
        turning = quarter_turn(self._arms(places, angle)[1])
        shifts = np.broadcast_to(by_pose[:, :2].T, (len(places), 2, len(by_pose)))
        return shifts + turning[:, :, None] * by_pose[:, 2]

    def rotation(self, fraction: float) -> np.ndarray:
        """Compute du/dX = R - 1, shape (2, 2)."""
        return self._arms(np.zeros((0, 2)), self._since_start(fraction)[2])[0]

    def with_placement(self) -> "MovedEdges":
        """Return the edges with placement parameters of their motion, as ``Seal.with_placements``."""
        # only prescribed components have one, and a rotation needs both
        names = {
            "xy"[component]: f"{self.label}_{'xy'[component]}" for component in self.components
        }
        if len(self.components) == 2:
            names["angle"] = f"{self.label}_angle"
        if set(names.values()) <= set(self.motion.names):
            return self
        return replace(self, motion=self.motion.with_placement(**names))


@dataclass(frozen=True, eq=False)
class ImposedMotions:
    """Prescribed displacements of edges that follow rigid motions; zero at all other fixed components.

    The interface is that of ``ImposedDisplacements``.

    Attributes
    ----------
    edges : tuple of MovedEdges
        Where two share a particle and a component, the later one prescribes it.
    reference : ndarray, shape (n, 2), or None
        Undeformed particles of the design (``on``).
    """

    edges: tuple
    reference: np.ndarray | None = None

    @property
    def names(self) -> tuple:
        """Scalar parameters of all motions."""
        return tuple(dict.fromkeys(name for own in self.edges for name in own.motion.names))

    @property
    def scalars(self) -> dict:
        """Parameters, zero for the motions as they are."""
        return {
            name: Scalar(0.0, own.motion.unit(name), f"Motion: {name}.")
            for own in self.edges for name in own.motion.names
        }  # fmt: skip

    @property
    def labels(self) -> tuple:
        """Names of the moved edges, each once."""
        return tuple(dict.fromkeys(own.label for own in self.edges))

    @property
    def varies(self) -> bool:
        """Whether the displacements depend on a parameter or on the undeformed particles."""
        return bool(self.names) or any(np.ptp(own.motion.angles) != 0.0 for own in self.edges)

    def with_parameters(self, values: dict) -> "ImposedMotions":
        """Return the motions with parameters changed by ``values``."""
        changed = []
        for own in self.edges:
            mine = {name: value for name, value in values.items() if name in own.motion.names}
            changed.append(replace(own, motion=own.motion.moved(mine)))
        return replace(self, edges=tuple(changed))

    def with_ends(self, ends) -> "ImposedMotions":
        """Return the same motions in other load steps, whose ``ends`` are in nominal steps."""
        edges = (replace(own, motion=own.motion.with_ends(ends)) for own in self.edges)
        return replace(self, edges=tuple(edges))

    def with_placements(self) -> "ImposedMotions":
        """Return the motions with placement parameters (``Seal.with_placements``)."""
        return replace(self, edges=tuple(own.with_placement() for own in self.edges))

    def on(self, particles: np.ndarray) -> "ImposedMotions":
        """Bind the motions to the undeformed particles (n, 2) of a design."""
        return replace(self, reference=particles)

    def prescribed(self, label: str) -> np.ndarray:
        """Return the components that the edges ``label`` prescribe, a mask (n, 2)."""
        out = np.zeros(self.reference.shape, bool)
        for own in self.edges:
            if own.label == label:
                out[np.ix_(own.particles, own.components)] = True
        return out

    def _each(self):
        """Yield the edges, the index of their entries in arrays (n, 2, ...), and their particles."""
        for own in self.edges:
            index = np.ix_(own.particles, own.components)
            yield own, index, self.reference[own.particles]

    def at(self, fraction: float) -> np.ndarray:
        """Compute displacements (n, 2) at a path parameter."""
        out = np.zeros(self.reference.shape)
        for own, index, places in self._each():
            out[index] = own.displacements(places, fraction)[:, own.components]
        return out

    def linearization(self, fraction: float) -> np.ndarray:
        """Differentiate the displacements by the parameters, shape (2 n, len(names))."""
        names, out = self.names, np.zeros((*self.reference.shape, len(self.names)))
        for own, index, places in self._each():
            columns = [names.index(name) for name in own.motion.names]
            rates = np.zeros((*places.shape, len(names)))
            rates[:, :, columns] = own.rates(places, fraction)
            # the later of two edges prescribes a common particle, with zeros for other parameters
            out[index] = rates[:, own.components]
        return out.reshape(self.reference.size, len(names))

    def by_particles(self, fraction: float) -> np.ndarray:
        """Differentiate the displacement of every particle by its undeformed place, shape (n, 2, 2)."""
        out = np.zeros((*self.reference.shape, 2))
        for own, index, _ in self._each():
            out[index] = own.rotation(fraction)[list(own.components)]
        return out
