"""The pictures of the report as numbers: deformed sections with stress, contact, door.

Coordinates and stress of a fine grid between the particles are rounded to 16-bit integers, which is
some micrometres and a tenth of a kilopascal, and written as base64 text.
"""

import base64

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from seal_mdao.geometry.profile import trace
from seal_mdao.plotting import field
from seal_mdao.plotting.gap import boundary_coordinate
from seal_mdao.plotting.section import stress_levels, window
from seal_mdao.plotting.style import STRESS_MAP
from seal_mdao.report.ring import RingGrid, ring_grid
from seal_mdao.seals.door.measures import DOOR
from seal_mdao.seals.profiles import contacts, true_pressure
from seal_mdao.seals.result import SealResult

POINTS_AROUND, POINTS_ACROSS = 116, 5
"""Points of the fine grid that are enough for a picture."""
FRAMES = 130
"""Load steps that are kept at most; of more, evenly spread ones."""
COLOURS = 64
MARGIN = 0.04
"""Room around the shapes, over their size."""
FULL = 32000
"""Integer that stands for the largest coordinate, and for the end of the stress scale."""
REACH = 60.0
"""How far the door is drawn, mm."""


def fine_grid(result: SealResult) -> RingGrid:
    """A grid with about as many points whatever the model's refinement, those that may touch among
    them."""
    grid, beside = result.seal.grid, _beside(result).shape[1]
    along = beside * max(1, round(POINTS_AROUND / (beside * grid.rays)))
    across = max(1, round((POINTS_ACROSS - 1) / (grid.layers - 1)))
    return ring_grid(result, along, across)


def _beside(result: SealResult) -> np.ndarray:
    """Particles at the points that may touch, shape (k, 1), or to either side of them, (k, 2)."""
    return result.term(DOOR).where.points.anchors


def kept_steps(result: SealResult) -> np.ndarray:
    """Numbers of the nominal steps that are shown, the last one included."""
    count = len(result.path.nominal_steps)
    return np.unique(np.linspace(0, count - 1, min(count, FRAMES)).round().astype(int))


class Pictures:
    """Everything that the page needs to draw designs of one seal in one scale.

    Parameters
    ----------
    start, end : SealResult
        The first and the last design, whose whole paths are shown.
    between : list of SealResult
        Designs of which the last load step is shown, ``start`` and ``end`` among them.
    """

    def __init__(self, start: SealResult, end: SealResult, between: list[SealResult]):
        self._start, self._end, self._between = start, end, between
        self._fine = {id(result): fine_grid(result) for result in (start, end, *between)}
        self._steps = {id(result): kept_steps(result) for result in (start, end)}
        shapes = [self._deformed(r, s) for r in (start, end) for s in self._steps[id(r)]]
        shapes += [self._deformed(result, -1) for result in between]
        shapes += [field.undeformed(result, self._fine[id(result)]) for result in (start, end)]
        self._low, self._high = window(shapes, MARGIN)
        self._high[1] = max(self._high[1], start.seal.section.outer_radius + 1.5)
        self._length = max(np.abs(shape).max() for shape in shapes) / FULL
        highest = max(self._stress(r, s).max() for r in (start, end) for s in self._steps[id(r)])
        self._top = float(stress_levels(highest)[-1])

    def as_data(self) -> dict:
        """The pictures as JSON can hold them."""
        seal = self._start.seal
        around, across = self._fine[id(self._start)].shape
        base = seal.drawn_particles[seal.grid.base]
        return {
            "around": around,
            "across": across,
            "length": self._length,
            "stress": self._top / FULL,
            "top": self._top,
            "colours": [to_hex(c) for c in colormaps[STRESS_MAP](np.linspace(0.0, 1.0, COLOURS))],
            "low": self._low.tolist(),
            "high": self._high.tolist(),
            "base": [base[:, 0].min(), base[:, 0].max(), base[:, 1].min()],
            "contact": self._contact_points(),
            "watched": self._grid_points(list(self._start.measure("von_mises").points)),
            "paths": [self._path(self._start), self._path(self._end)],
            "designs": [self._design(result) for result in self._between],
        }

    def _grid_points(self, particles) -> list[int]:
        """Points of the fine grid at which particles lie."""
        grid = self._start.seal.grid
        around, across = self._fine[id(self._start)].shape
        along, through = around // grid.rays, (across - 1) // (grid.layers - 1)
        ray, layer = np.divmod(particles, grid.layers)
        return (ray * along * across + layer * through).tolist()

    def _contact_points(self) -> list[int]:
        """Points of the fine grid that may touch."""
        beside = _beside(self._start)
        ends = np.reshape(self._grid_points(beside.ravel()), beside.shape)
        return ends.mean(axis=1).astype(int).tolist()

    def _deformed(self, result: SealResult, step: int) -> np.ndarray:
        return field.deformed(result, self._fine[id(result)], step)

    def _stress(self, result: SealResult, step: int) -> np.ndarray:
        return field.von_mises(result, self._fine[id(result)], step)

    def _frame(self, result: SealResult, step: int) -> np.ndarray:
        """x, y, stress of every point of the grid, shape (around * across, 3), integers."""
        places = self._deformed(result, step) / self._length
        stress = np.minimum(self._stress(result, step) * FULL / self._top, FULL)
        return np.column_stack([places, stress])

    def _path(self, result: SealResult) -> dict:
        steps, (door,) = self._steps[id(result)], contacts(result.seal)
        answers = result.path.at_nominal(door.label)
        chosen = [answers[step] for step in steps]
        return {
            "frames": packed([self._frame(result, step) for step in steps]),
            "travel": np.round(result.travel[steps], 6).tolist(),
            "position": np.round([door_position(result, step) for step in steps], 6).tolist(),
            "reaction": np.round(result.reaction[steps], 4).tolist(),
            "peak": [float(np.round(self._stress(result, step).max(), 2)) for step in steps],
            "state": ["".join(map(str, contact.state)) for contact in chosen],
            "pressure": [np.round(true_pressure(result, door, s), 2).tolist() for s in steps],
            "gap": [np.round(contact.gap, 5).tolist() for contact in chosen],
            "arc": np.round(boundary_coordinate(result), 4).tolist(),
            "door": door_face(result),
            "completed": result.converged,
        }

    def _design(self, result: SealResult) -> dict:
        fine = self._fine[id(result)]
        drawn = field.undeformed(result, fine).reshape(*fine.shape, 2)
        return {
            "frame": packed([self._frame(result, -1)]),
            "drawn": packed([drawn[:, [0, -1]] / self._length]),
            "position": door_position(result, -1).tolist(),
            "state": "".join(map(str, result.path.at_nominal("door")[-1].state)),
            "peak": float(np.round(self._stress(result, -1).max(), 2)),
            "door": door_face(result),
            "completed": result.converged,
        }


def door_position(result: SealResult, step: int) -> np.ndarray:
    """Where the door is after a nominal step, shape (2,), mm."""
    return result.seal.motion.pose(result.path.nominal_steps[step].fraction).position


def door_face(result: SealResult) -> list:
    """Points along the door at its position zero, (n, 2) rounded, mm."""
    face = trace(result.seal.profile, 0.2, REACH)
    return np.round(face, 4).tolist()


def packed(arrays) -> str:
    """Arrays of integers up to 32767 in size as base64 text, little-endian, 16 bit."""
    numbers = np.round(np.array(arrays)).astype("<i2")
    return base64.b64encode(numbers.tobytes()).decode("ascii")
