"""Data of the pictures on the page, as values of JSON: the scene of a seal file, states of its
designs, and their first-order changes. Arrays are base64 text of 32-bit floats."""

import base64
from itertools import pairwise

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import FineGrid
from seal_mdao.report.picture_data import contact_points, stress_colours
from seal_mdao.seals.profiles import (
    ROTATION,
    TRAVEL,
    arc_length,
    contacts,
    leading_motion,
    load_segments,
    motions,
    moved_edges,
    true_pressure,
)
from seal_mdao.seals.result import SealResult
from seal_mdao.studio.adjustable import Adjustable, moving_labels
from seal_mdao.studio.preview import PathRates, field_rates, pressure_rates
from seal_mdao.tolerances.first_order import FirstOrder
from seal_mdao.tolerances.tolerance_set import Tolerances

MARGIN = 0.16
"""Clearance around the section, over its size."""
SAME_DIRECTION = 0.2
"""Cosine between the directions of two offsets of one particle below which they are one handle."""


def floats(array) -> str:
    """Encode an array as base64 text of 32-bit floats, little-endian."""
    return base64.b64encode(np.ascontiguousarray(array, "<f4").tobytes()).decode("ascii")


def plain(value) -> list | float | None:
    """Return numbers for JSON, None for those that are not finite."""
    array = np.asarray(value, float)
    found = np.where(np.isfinite(array), array, 0.0).tolist()
    if np.isfinite(array).all():
        return found
    if array.ndim == 0:
        return None
    return [plain(own) for own in array]


# ---- the scene ----


def scene(nominal: SealResult, fine: FineGrid, numbers: list[Adjustable]) -> dict:
    """Return the data that are the same for all designs of a seal file.

    Parameters
    ----------
    nominal : SealResult
        The seal of the file, analysed.
    fine : FineGrid
        Of it.
    numbers : list of Adjustable
    """
    seal, undeformed = nominal.seal, fine.undeformed()
    shapes = [undeformed, fine.deformed() if nominal.path.nominal_steps else undeformed]
    low, high = section.window(shapes, MARGIN, seal)
    velocity = seal.design_velocity[:, fine.points.anchors]
    profiles = _profiles(nominal)
    for own in profiles:
        # the start of a profile is in sight
        low[1] = min(low[1], *(at[1] - 0.5 for at in own["grips"]))
        high[1] = max(high[1], *(at[1] + 0.5 for at in own["grips"]))
    return {
        "quads": fine.quads.tolist(), "loops": [loop.tolist() for loop in fine.loops],
        "regions": fine.region.tolist(), "colours": stress_colours(seal),
        "materials": list(seal.materials), "low": plain(low), "high": plain(high),
        "held": [plain(line) for line in section.fixed_lines(nominal)],
        "ring": bool(seal.body.axisymmetric), "mirrored": section.near_axis(seal),
        "undeformed": floats(undeformed),
        # V of the points of the grid, for every offset
        "velocity": floats(np.einsum("sk,pski->psi", fine.points.weights, velocity)),
        "profiles": profiles, "handles": _handles(seal),
        "numbers": [
            {
                "name": own.name, "text": own.text, "unit": own.unit, "value": own.value,
                "low": own.low, "high": own.high, "group": own.group,
            }
            for own in numbers
        ],
        "force": {"unit": seal.units.force, "directions": list(seal.units.directions)},
        "steps": seal.n_steps,
    }  # fmt: skip


def _profiles(nominal: SealResult) -> list[dict]:
    """Faces, rigid sides and handles of the profiles in their own frames, mm."""
    found, size = [], section.size_of(nominal)
    for contact in contacts(nominal.seal):
        profile, motion = contact.shape.profile(), contact.motion
        face = section.face_of(profile, size)
        rings = section.outlines(section.rigid_side(profile, face, size))
        # the handle of the profile is the point of its face nearest to the section at the end
        middle = nominal.seal.nominal_particles.mean(axis=0)
        line = np.concatenate([a + np.outer(T, b - a) for a, b in pairwise(face)])
        placed = motion.pose(float(motion.n_steps)).places(line)
        grip = line[np.hypot(*(placed - middle).T).argmin()]
        ends = np.concatenate([[0], np.cumsum(motion.steps)]).astype(float)
        grips = [motion.pose(end).places(grip[None])[0] for end in ends]
        found.append({
            "name": contact.label, "face": plain(face), "body": [plain(ring) for ring in rings],
            "pivot": plain(motion.pivot), "grip": plain(grip), "grips": plain(grips),
        })  # fmt: skip
    return found


T = np.linspace(0.0, 1.0, 200)
"""Fractions of the segments of a face at which its nearest point is looked for."""


def _handles(seal) -> list[dict]:
    """Place a handle for every offset of the design where it moves the boundary farthest; two offsets
    that move one particle in different directions share it."""
    boundary = np.concatenate(seal.loops) if seal.n_offsets else np.empty(0, int)
    found: list[dict] = []
    for number, velocity in enumerate(seal.design_velocity):
        size = np.hypot(*velocity[boundary].T)
        at = int(boundary[size.argmax()])
        direction = velocity[at]
        for other in found:
            cosine = direction @ other["directions"][0]
            cosine /= np.hypot(*direction) * np.hypot(*other["directions"][0])
            if other["particle"] == at and abs(cosine) < SAME_DIRECTION:
                other["numbers"].append(number)
                other["directions"].append(direction.tolist())
                break
        else:
            found.append({
                "particle": at, "at": seal.nominal_particles[at].tolist(), "numbers": [number],
                "directions": [direction.tolist()],
            })  # fmt: skip
    return found


# ---- a state ----


def frame(fine: FineGrid, step: int) -> dict:
    """Return the deformed section after a nominal step: coordinates and stress of the grid, points in
    contact, positions of the profiles."""
    result = fine.result
    touching, marks = contact_points(result, step)
    stress = fine.von_mises(step)
    points = np.column_stack([fine.deformed(step), stress])
    fraction = result.path.nominal_steps[step].fraction
    return {
        "points": floats(points), "touching": floats(touching), "marks": marks,
        "poses": plain([own.motion.coordinates(fraction) for own in contacts(result.seal)]),
        "ways": [
            plain(np.column_stack([own.motion.positions, own.motion.angles]))
            for own in contacts(result.seal)
        ],
        "pressure": [_pressure(result, own, step) for own in contacts(result.seal)],
        "tops": _tops(fine, stress), "peak": float(stress.max()), "step": step,
        "caption": result.caption(step),
    }  # fmt: skip


def _tops(fine: FineGrid, stress: np.ndarray) -> list[float]:
    """Ends of the colour scales of all materials, kPa; single peaks do not stretch them."""
    count = len(fine.result.seal.definitions[0].regions)
    parts = (stress[fine.region == number] for number in range(count))
    return [float(section.stress_scale([own])["levels"][-1]) for own in parts]


def _pressure(result, contact, step: int) -> dict:
    state = result.path.at_nominal(contact.label)[step].state
    return {
        "name": contact.label, "arc": plain(arc_length(result, contact.label)),
        "values": plain(true_pressure(result, contact, step)),
        "touching": int(np.sum(state != OPEN)),
    }  # fmt: skip


def curves(result: SealResult) -> list[dict]:
    """Return the forces on all profiles and moved edges over their travel if the motion is one line
    forwards and backwards, else over the load steps."""
    found, done = [], len(result.path.nominal_steps)
    by_label = dict(zip(moving_labels(result.seal), motions(result.seal), strict=False))
    for label in moving_labels(result.seal):
        motion = by_label[label] if by_label[label].moves else leading_motion(result.seal)
        force = result.path.reaction(label)
        across, up = np.abs(force).max(axis=0, initial=0.0)
        words, along, _ = _abscissa(result.seal, motion, done)
        found.append({
            "name": label, "words": words, "along": plain(along), "force": plain(force),
            "component": 0 if across > up else 1, "initial": plain(result.path.initial_force(label)),
        })  # fmt: skip
    return found


def _abscissa(seal, motion, done: int) -> tuple[str, np.ndarray, np.ndarray]:
    """Abscissa of the curves: its name, its values (done,), the direction (3,) along which it is
    measured; zero where it counts load steps."""
    segments = load_segments(motion, done, seal.before_touch)
    if len(segments) != 1 or not motion.moves:
        return "load step", np.arange(1.0, done + 1.0), np.zeros(3)
    (segment,) = segments
    if segment.axis == ROTATION:
        return ROTATION, segment.along, np.array([0.0, 0.0, np.degrees(1.0)])
    chord = next(c for c in np.diff(motion.positions, axis=0) if c.any())
    return TRAVEL, segment.along, np.append(chord / np.hypot(*chord), 0.0)


# ---- first-order changes ----


def rates(fine: FineGrid, found: PathRates, step: int, count: int) -> dict:
    """Return the derivatives of a state with respect to the ``count`` numbers of the page, the first
    parameters of ``found``, in their units."""

    def packed(array) -> str:
        return floats(np.asarray(array)[..., :count])

    result = fine.result
    path, done = result.path, len(result.path.nominal_steps)
    x, stress = field_rates(result, found, fine, step)
    fraction = path.nominal_steps[step].fraction
    by_label = dict(zip(moving_labels(result.seal), motions(result.seal), strict=False))
    abscissas = []
    for label in moving_labels(result.seal):
        motion = by_label[label] if by_label[label].moves else leading_motion(result.seal)
        abscissas.append(_abscissa_rates(result.seal, motion, done, found))
    return {
        # (k, 3, P) and so on: the parameters last
        "points": packed(np.concatenate([x, stress[:, None]], axis=1)),
        "poses": [
            packed(_pose_rates(own.motion, own.motion.rates_at(fraction), found))
            for own in contacts(result.seal)
        ],
        "ways": [
            packed([
                _pose_rates(own.motion, own.motion.rates[:, k], found)
                for k in range(len(own.motion.angles))
            ])
            for own in contacts(result.seal)
        ],
        "pressure": [
            packed(pressure_rates(result, found, own, step)) for own in contacts(result.seal)
        ],
        "force": [
            None if own is None else packed(own) for own in _force_rates(result, found)
        ],
        "along": [packed(own) for own in abscissas],
        "measures": {name: packed(own) for name, own in found.measures.items()},
        "step": step,
    }  # fmt: skip


def scatter(result: SealResult, found: PathRates, tolerances: Tolerances, names) -> list:
    """Compute standard deviations of the forces of all curves after every load step, to first order.

    Parameters
    ----------
    found : PathRates
        With respect to the offsets and the parameters ``names``.

    Returns
    -------
    list of (list of [float, float]) or None
        N/m or N, for every moving part; None where its force is not that of contact alone.
    """
    seal = result.seal
    nominal = {name: seal.scalars[name].value for name in names}
    # dF/dn = dF/dp dp/dn of the numbers that vary
    by_number = tolerances.middle(seal).rates(0, nominal)[1]
    covariance = tolerances.offsets_covariance(seal)
    bands = []
    for force in _force_rates(result, found):
        if force is None:
            bands.append(None)
            continue
        rows = force.reshape(-1, force.shape[-1])
        # deviations do not depend on the values
        line = FirstOrder(
            np.zeros(len(rows)), rows[:, seal.n_offsets :] @ by_number, rows[:, : seal.n_offsets],
            tolerances.means, tolerances.deviations, covariance,
        )  # fmt: skip
        bands.append(plain(line.std.reshape(-1, 2)))
    return bands


def _force_rates(result: SealResult, found: PathRates) -> list:
    """Rates (load steps, 2, P) of the forces of all curves; None where a force is not that of contact
    alone."""
    path = result.path
    at = [path.steps.index(own) for own in path.nominal_steps]
    return [
        np.array([found.forces[label][k] for k in at])
        if label in found.forces and not _bonded(result.seal, label) else None
        for label in moving_labels(result.seal)
    ]  # fmt: skip


def _bonded(seal, label: str) -> bool:
    """Whether edges are bonded to a profile, so that its force is not that of contact alone."""
    return any(own.label == label for own in moved_edges(seal))


def _spread(names, rows: np.ndarray, found: PathRates) -> np.ndarray:
    """Rates (m, c) of the parameters ``names`` as columns (c, P) of all parameters."""
    # x' = (dx/dp) p'
    return rows.T @ found.sweep.rates.of(names)


def _pose_rates(motion, rows: np.ndarray, found: PathRates) -> np.ndarray:
    return _spread(motion.names, rows, found)


def _abscissa_rates(seal, motion, done: int, found: PathRates) -> np.ndarray:
    """Rates of the abscissa, shape (done, P)."""
    _, _, direction = _abscissa(seal, motion, done)
    rows = np.array([motion.rates_at(k + 1.0) - motion.rates[:, 0] for k in range(done)])
    # s' = u . (w' - w_0')
    return np.array([_spread(motion.names, (own @ direction)[:, None], found)[0] for own in rows])
