"""The pictures of the report as numbers: deformed sections with stress, contact, profiles.

Coordinates and stress of a fine grid between the particles are rounded to 16-bit integers, which is
some micrometres and a tenth of a kilopascal, and written as base64 text.
"""

import base64

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from seal_mdao.measures.stress import VonMises
from seal_mdao.plotting import field
from seal_mdao.plotting.section import held_lines, stress_levels, window
from seal_mdao.plotting.style import STRESS_MAP
from seal_mdao.report.contacts import contact_points, poses, profile_curves, profile_shapes
from seal_mdao.seals.result import SealResult

POINTS = 600
"""Points of the fine grid that are enough for a picture; with more particles one at each."""
FRAMES = 130
"""Load steps that are kept at most; of more, evenly spread ones."""
COLOURS = 64
MARGIN = 0.08
"""Room around the shapes, over their size."""
FULL = 32000
"""Integer that stands for the largest coordinate, and for the end of the stress scale."""


def fine_grid(result: SealResult) -> field.FineGrid:
    """A grid with about as many points whatever the model's refinement."""
    cells = len(result.seal.body.cells)
    return field.fine_grid(result, max(1, round(np.sqrt(POINTS / cells))))


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
        self._length = max(np.abs(shape).max() for shape in shapes) / FULL
        highest = max(self._stress(r, s).max() for r in (start, end) for s in self._steps[id(r)])
        self._top = float(stress_levels(highest)[-1])

    def as_data(self) -> dict:
        """The pictures as JSON can hold them."""
        fine = self._fine[id(self._start)]
        return {
            "quads": fine.quads.tolist(),
            "loops": [loop.tolist() for loop in fine.loops],
            "length": self._length,
            "stress": self._top / FULL,
            "top": self._top,
            "colours": [to_hex(c) for c in colormaps[STRESS_MAP](np.linspace(0.0, 1.0, COLOURS))],
            "low": self._low.tolist(),
            "high": self._high.tolist(),
            "held": [np.round(line, 4).tolist() for line in held_lines(self._start)],
            "watched": self._watched(),
            "paths": [self._path(self._start), self._path(self._end)],
            "designs": [self._design(result) for result in self._between],
        }

    def _watched(self) -> list[list[int]]:
        """Points of the fine grid at the particles whose stresses are a measure, each between its
        neighbours along the boundary; alone inside of the section."""
        fine, beside = self._fine[id(self._start)], {}
        for loop in fine.loops:
            ring = zip(np.roll(loop, 1), loop, np.roll(loop, -1), strict=True)
            beside |= {int(at): [int(a), int(at), int(b)] for a, at, b in ring}
        anchors = fine.points.anchors
        alone = np.flatnonzero((anchors == anchors[:, :1]).all(axis=1))
        at = dict(zip(anchors[alone, 0].tolist(), alone.tolist(), strict=True))
        watched = (m for m in self._start.measures() if isinstance(m, VonMises))
        points = [at[particle] for measure in watched for particle in measure.points]
        return [beside.get(point, [point]) for point in points]

    def _deformed(self, result: SealResult, step: int) -> np.ndarray:
        return field.deformed(result, self._fine[id(result)], step)

    def _stress(self, result: SealResult, step: int) -> np.ndarray:
        return field.von_mises(result, self._fine[id(result)], step)

    def _picture(self, result: SealResult, step: int) -> dict:
        """One load step: x, y, stress of all points of the grid, x, y of the contact points."""
        places = self._deformed(result, step) / self._length
        stress = np.minimum(self._stress(result, step) * FULL / self._top, FULL)
        touching, marks = contact_points(result, step)
        return {
            "points": packed(np.column_stack([places, stress])),
            "touching": packed(touching / self._length),
            "marks": marks,
            "poses": poses(result, result.path.nominal_steps[step].fraction),
            "peak": float(np.round(self._stress(result, step).max(), 2)),
        }

    def _path(self, result: SealResult) -> dict:
        steps = self._steps[id(result)]
        return {
            "frames": [self._picture(result, step) for step in steps],
            "captions": [result.caption(step) for step in steps],
            "profiles": profile_shapes(result),
            "curves": profile_curves(result, steps),
            "completed": result.converged,
        }

    def _design(self, result: SealResult) -> dict:
        fine = self._fine[id(result)]
        boundary = field.undeformed(result, fine)[np.concatenate(fine.loops)]
        return {
            "frame": self._picture(result, -1),
            "boundary": packed(boundary / self._length),
            "begin": poses(result, 0.0),
            "profiles": profile_shapes(result),
            "completed": result.converged,
        }


def packed(arrays) -> str:
    """Arrays of integers up to 32767 in size as base64 text, little-endian, 16 bit."""
    numbers = np.round(np.array(arrays)).astype("<i2")
    return base64.b64encode(numbers.tobytes()).decode("ascii")
