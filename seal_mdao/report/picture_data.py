"""The pictures of the report as numbers: deformed sections with stress, contact, profiles.

Coordinates and stress of a fine grid between the particles are rounded to 16-bit integers, which is
some micrometres and a tenth of a kilopascal, and written as base64 text.
"""

import base64
import itertools

import numpy as np
from matplotlib import colormaps
from matplotlib.colors import to_hex

from seal_mdao.contact.friction import OPEN
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.motion import BEFORE
from seal_mdao.measures.stress import VonMises
from seal_mdao.plotting import field
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.style import STRESS_MAPS
from seal_mdao.seals.gaps import open_between
from seal_mdao.seals.profiles import (
    arc_length,
    contacts,
    moving_histories,
    self_contacts,
    true_pressure,
)
from seal_mdao.seals.result import SealResult

POINTS = 600
"""Points of the fine grid that are enough for a picture; with more particles one at each."""
FRAMES = 130
"""Largest number of load steps in a page; of more, evenly spread ones."""
COLOURS = 64
MARGIN = 0.08
"""Clearance around the shapes, over their size."""
FULL = 32000
"""Integer that stands for the largest coordinate, and for the end of a stress scale."""
BETWEEN = 3
"""Mark of a point that is open between others in contact; 0, 1 and 2 are its contact states."""


def evenly_spread(count: int, most: int) -> np.ndarray:
    """Choose at most ``most`` of the indices below ``count``, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).round().astype(int))


class Pictures:
    """Data with which the page draws designs of one seal in one scale.

    Parameters
    ----------
    start, end : SealResult
        The first and the last design, whose complete paths are shown.
    between : list of SealResult
        Designs of which the last load step is shown, ``start`` and ``end`` among them.
    """

    def __init__(self, start: SealResult, end: SealResult, between: list[SealResult]):
        # one grid for each result: a design may be an end as well
        fine = {id(result): _fine_grid(result) for result in (start, end, *between)}
        self._ends, self._between = ([fine[id(r)] for r in own] for own in ((start, end), between))
        # load steps of the first and the last design
        self._steps = [
            evenly_spread(len(own.path.nominal_steps), FRAMES).tolist() for own in (start, end)
        ]
        frames = [
            (own, step)
            for own, steps in zip(self._ends, self._steps, strict=True)
            for step in steps
        ]
        # one window around everything that is drawn
        shapes = [own.deformed(step) for own, step in frames]
        shapes += [own.deformed() for own in self._between]
        shapes += [own.undeformed() for own in self._ends]
        self._low, self._high = section.window(shapes, MARGIN, start.seal)
        # one integer scale of lengths, one of stress for each material up to the end of its colour scale
        self._length = max(np.abs(shape).max() for shape in shapes) / FULL
        self._tops = _tops(frames)

    def as_data(self) -> dict:
        """Return the pictures in types of JSON."""
        start = self._ends[0]
        seal = start.result.seal
        return {
            "quads": start.quads.tolist(),
            "loops": [loop.tolist() for loop in start.loops],
            "length": self._length,
            "regions": start.region.tolist(),
            "scales": _scales(seal, self._tops),
            "ring": seal.body.axisymmetric,
            "mirrored": section.near_axis(seal),
            "force": {
                "unit": seal.units.force,
                "per_mm": seal.units.per_mm,
                "directions": seal.units.directions,
            },
            "low": self._low.tolist(),
            "high": self._high.tolist(),
            "held": [_rounded(line) for line in section.fixed_lines(start.result)],
            "watched": _watched(start),
            "paths": [self._path(*pair) for pair in zip(self._ends, self._steps, strict=True)],
            "designs": [self._design(fine) for fine in self._between],
        }

    def _frame(self, fine: field.FineGrid, step: int) -> dict:
        """One load step: x, y, stress of all points of the grid, x, y of the contact points."""
        # stress in the integer scale of its material, cut at its end
        result, stress = fine.result, fine.von_mises(step)
        scaled = np.minimum(stress * FULL / self._tops[fine.region], FULL)
        touching, marks = contact_points(result, step)
        return {
            "points": packed(np.column_stack([fine.deformed(step) / self._length, scaled])),
            "touching": packed(touching / self._length),
            "marks": marks,
            "poses": _poses(result, result.path.nominal_steps[step].fraction),
            "peak": float(np.round(stress.max(), 2)),
        }

    def _path(self, fine: field.FineGrid, steps) -> dict:
        result = fine.result
        return {
            "frames": [self._frame(fine, step) for step in steps],
            "captions": [result.caption(step) for step in steps],
            "profiles": _profile_shapes(result),
            "curves": [_curves(result, history, steps) for history in moving_histories(result)],
            "completed": result.converged,
        }

    def _design(self, fine: field.FineGrid) -> dict:
        return {
            "frame": self._frame(fine, -1),
            "boundary": packed(fine.undeformed()[np.concatenate(fine.loops)] / self._length),
            "begin": _poses(fine.result, BEFORE),
            "profiles": _profile_shapes(fine.result),
            "completed": fine.result.converged,
        }


def _fine_grid(result: SealResult) -> field.FineGrid:
    """A grid with about as many points whatever the model's refinement."""
    cells = len(result.seal.body.cells)
    return field.fine_grid(result, max(1, round(np.sqrt(POINTS / cells))))


def _tops(frames) -> np.ndarray:
    """Ends of the colour scales of all materials, kPa, for grids at load steps."""
    stresses = [(fine.region, fine.von_mises(step)) for fine, step in frames]
    count = 1 + int(stresses[0][0].max())
    highest = (max(s[region == n].max() for region, s in stresses) for n in range(count))
    return np.array([section.stress_levels(own)[-1] for own in highest])


def _scales(seal, tops) -> list[dict]:
    """Colour scale of every material: its name (empty for a single one), end (kPa) and colours."""
    names = seal.materials if len(tops) > 1 else [""]
    return [
        {"name": name, "top": float(top), "colours": colours}
        for name, top, colours in zip(names, tops, stress_colours(seal), strict=False)
    ]


def stress_colours(seal) -> list[list[str]]:
    """List the colours of the stress scale of every material, from zero to its end."""
    at = np.linspace(0.0, 1.0, COLOURS)
    maps = itertools.islice(itertools.cycle(STRESS_MAPS), len(seal.definitions[0].regions))
    return [[to_hex(c) for c in colormaps[colors](at)] for colors in maps]


def _watched(fine: field.FineGrid) -> list[list[int]]:
    """Points of the fine grid at the particles whose stresses are a measure, each between its
    neighbours along the boundary; alone inside of the section."""
    beside = {}
    for loop in fine.loops:
        # every boundary point between its neighbours
        ring = zip(np.roll(loop, 1), loop, np.roll(loop, -1), strict=True)
        beside |= {int(at): [int(a), int(at), int(b)] for a, at, b in ring}
    # points of the grid with all weight on one particle
    anchors = fine.points.anchors
    alone = np.flatnonzero((anchors == anchors[:, :1]).all(axis=1))
    at = dict(zip(anchors[alone, 0].tolist(), alone.tolist(), strict=True))
    # particles of all stress measures
    watched = (m for m in fine.result.measures() if isinstance(m, VonMises))
    points = [at[particle] for measure in watched for particle in measure.points]
    return [beside.get(point, [point]) for point in points]


# ---- profiles and contact ----


def _profile_shapes(result) -> list[dict]:
    """Every profile in its own frame: points along its face, and outlines of its rigid side, mm."""
    size, found = section.size_of(result), []
    for contact in contacts(result.seal):
        profile = contact.shape.profile()
        face = section.face_of(profile, size)
        # the filled side of the profile, with holes as further rings
        rings = section.outlines(section.rigid_side(profile, face, size))
        body = [_rounded(ring) for ring in rings]
        found.append({"name": contact.label, "face": _rounded(face), "body": body})
    return found


def _poses(result, fraction: float) -> list:
    """Pose of every profile after ``fraction`` nominal steps: x, y (mm) of the origin of its frame,
    cosine and sine of its angle."""
    found = [contact.motion.pose(fraction) for contact in contacts(result.seal)]
    origin = np.zeros((1, 2))
    return [[*_rounded(pose.places(origin)[0], 6), pose.cos, pose.sin] for pose in found]


def _curves(result, history, steps) -> dict:
    """Curves of a profile at nominal steps: along its contact points, and over its travel; of moved
    edges over their travel alone."""
    words, along = "load step", np.arange(1.0, 1.0 + len(history.force))
    # travel, or pressure of a fluid, where all of the path is one load-unload segment
    if len(history.load_segments) == 1:
        (load_segment,) = history.load_segments
        words, along = load_segment.axis, load_segment.along
    found = {
        "name": history.label,
        "arc": [],
        "along": _rounded(along[steps], 6),
        "words": words,
        "reaction": _rounded(history.force[steps]),
        "component": history.main_component,
    }
    contact = {own.label: own for own in contacts(result.seal)}.get(history.label)
    return found if contact is None else found | _along_contact(result, contact, steps)


def _along_contact(result, contact, steps) -> dict:
    """State, pressure and gap of the contact points of a profile at nominal steps."""
    label, responses = contact.label, result.path.at_nominal(contact.label)
    return {
        "arc": _rounded(arc_length(result, label)),
        "state": [
            "".join(map(str, _marks(result, label, responses[step], step))) for step in steps
        ],
        "pressure": [_rounded(true_pressure(result, contact, step), 2) for step in steps],
        "gap": [_rounded(responses[step].gap, 5) for step in steps],
    }


def contact_points(result, step: int) -> tuple[np.ndarray, str]:
    """Find the points in contact with a profile or another wall after a nominal step, and those that a
    profile leaves open between contacts.

    Returns
    -------
    x : ndarray, shape (k, 2)
        mm.
    marks : str
        A mark of each.
    """
    places, found = [np.empty((0, 2))], [np.empty(0, int)]
    for term in (*contacts(result.seal), *self_contacts(result.seal)):
        response = result.path.at_nominal(term.label)[step]
        # with itself a wall has no order of points, hence no region between contacts
        rigid = isinstance(term, RigidContact)
        own = _marks(result, term.label, response, step) if rigid else response.branch
        # open points beyond the contact are left out
        places.append(response.x[own != OPEN])
        found.append(own[own != OPEN])
    return np.concatenate(places), "".join(map(str, np.concatenate(found)))


def _marks(result, label: str, response, step: int) -> np.ndarray:
    """States of the points of a profile, ``BETWEEN`` where it leaves them open between contacts."""
    state = np.array(response.branch)
    state[open_between(result, label, step)] = BETWEEN
    return state


def _rounded(numbers, digits: int = 4) -> list:
    return np.round(numbers, digits).tolist()


def packed(arrays) -> str:
    """Encode arrays of integers up to 32767 in size as base64 text, little-endian, 16 bit."""
    numbers = np.round(np.array(arrays)).astype("<i2")
    return base64.b64encode(numbers.tobytes()).decode("ascii")
