"""``[[profile]]``: rigid bodies, as the file says and as the contact needs them."""

import numpy as np

from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.geometry.curve import ARC, CUBIC, LINE
from seal_mdao.geometry.motion import Motion, Stage, staged_motion
from seal_mdao.geometry.profile import RigidProfile, rigid_profile
from seal_mdao.geometry.shape import GivenShape, Shape
from seal_mdao.seals.file.checks import (
    LIST,
    NAME,
    NAMES,
    Key,
    number,
    one_of,
    point,
    table,
    tables,
)
from seal_mdao.seals.file.extensions import FRICTION, SHAPE
from seal_mdao.seals.file.load_steps import STEPS
from seal_mdao.seals.file.shapes import KEYS, segments_of
from seal_mdao.seals.file.tables import ProfileTable
from seal_mdao.seals.outline.chain import checked_chain
from seal_mdao.seals.outline.crossings import check_simple
from seal_mdao.seals.outline.section import JOIN, SAGITTA, Line, Spline
from seal_mdao.terms.points import CONTACT_POINTS

MOST_PENALTY, MOST_TURN = 1e12, 3600.0
"""kPa/mm, degrees."""
PLACE = point(1e5)
"""mm."""
PENALTY = number(above=0.0, most=MOST_PENALTY)

PROFILE_KEYS = {
    "name": Key(NAME),
    "friction": Key(FRICTION),
    "contact": Key(NAMES),
    **KEYS,
    "segment": Key(LIST, None),
    "shape": Key(SHAPE, None),
    "start": Key(PLACE, (0.0, 0.0)),
    "angle": Key(number(least=-MOST_TURN, most=MOST_TURN), 0.0),
    "pivot": Key(PLACE, (0.0, 0.0)),
    "normal_penalty": Key(PENALTY, None),
    "tangent_penalty": Key(PENALTY, None),
    "contact_points": Key(one_of(*CONTACT_POINTS), None),
    "stage": Key(LIST, None),
}
STAGE_KEYS = {
    "translate": Key(PLACE, (0.0, 0.0)),
    "rotate": Key(number(least=-MOST_TURN, most=MOST_TURN), 0.0),
    "steps": Key(STEPS, None),
}


def read_profile(position: int, given: dict) -> ProfileTable:
    """The ``position``-th profile of a file; what it leaves open is None.

    Raises
    ------
    SealFileError
    """
    name = given.get("name")
    where = f"[[profile]] {position}" + (f" ({name!r})" if isinstance(name, str) else "")
    values = table(where, given, PROFILE_KEYS)
    segments, closed = _chain(where, values) if values["shape"] is None else ((), False)
    return ProfileTable(
        values["name"], segments, closed, values["contact"], values["friction"],
        values["normal_penalty"], values["tangent_penalty"], values["start"], values["angle"],
        values["pivot"], _stages(where, values["stage"]), values["contact_points"],
        _shape(where, values),
    )  # fmt: skip


def _shape(where, values) -> Shape | None:
    """The shape of an extension, which has neither segments nor another curve beside it."""
    others = [kind for kind in ("segment", *KEYS) if values[kind] is not None]
    if values["shape"] is not None and others:
        raise SealFileError(f"{where}: {others[0]} beside shape; use one of them")
    return values["shape"]


def _chain(where, values):
    """The segments of a curve, and whether it is closed."""
    segments = _segments(where, values)
    closed = bool(np.hypot(*(segments[-1].end - segments[0].start)) <= JOIN)
    try:
        segments = checked_chain(segments, JOIN, closed)
        check_simple(_corners(segments), closed)
    except GeometryError as error:
        raise SealFileError(f"{where}: {error}") from None
    return segments, closed


def _segments(where, values) -> list:
    alone = [kind for kind in KEYS if values[kind] is not None]
    if values["segment"] is None:
        return segments_of(where, values, values["name"])
    if alone:
        raise SealFileError(f"{where}: {alone[0]} beside [[profile.segment]]; use one of them")
    found = []
    for i, given in enumerate(tables("profile.segment", values["segment"]), 1):
        place = f"{where}: [[profile.segment]] {i}"
        found += segments_of(place, table(place, given, KEYS), values["name"])
    return found


def _corners(segments) -> np.ndarray:
    """Corners of a fine polygon along a chain, shape (k, 2)."""
    size = max(np.abs(segment.points([0.0, 0.5, 1.0])).max() for segment in segments)
    parts = [segment.points(segment.chords(SAGITTA * size)[:-1]) for segment in segments]
    return np.concatenate([*parts, segments[-1].points([1.0])])


def _stages(where, given) -> tuple:
    if given is None:
        return ()
    stages = []
    for i, one in enumerate(tables("profile.stage", given), 1):
        values = table(f"{where}: [[profile.stage]] {i}", one, STAGE_KEYS)
        stages.append(Stage(values["steps"], values["translate"], values["rotate"]))
    return tuple(stages)


def motion_of(profile: ProfileTable, n_steps: int) -> Motion:
    """The motion of a profile; one without stages stands still for ``n_steps``."""
    stages = profile.stages or (Stage(n_steps),)
    return staged_motion(stages, profile.start, profile.angle, profile.pivot)


def shape_of(profile: ProfileTable) -> Shape:
    """The shape of a profile, without parameters unless it is that of an extension."""
    return profile.shape or GivenShape(rigid_profile_of(profile))


def rigid_profile_of(profile: ProfileTable) -> RigidProfile:
    """The curve of a profile in its own frame; an open one goes on beyond lines at its ends."""
    if profile.shape is not None:
        return profile.shape.profile()
    pieces = [piece for segment in profile.segments for piece in _pieces(segment)]
    kind, origin, angle, radius, length, coefficient = zip(*pieces, strict=True)
    start = np.concatenate([[0.0], np.cumsum(length)])
    return rigid_profile(
        kind, origin, angle, radius, start[:-1], length, coefficient=coefficient,
        period=start[-1] if profile.closed else 0.0,
    )  # fmt: skip


def _pieces(segment):
    """Kind, origin, angle, radius, length and coefficients of the pieces of a segment."""
    none = np.zeros((4, 2))
    if isinstance(segment, Line):
        along = np.subtract(segment.last, segment.first)
        angle = float(np.arctan2(along[1], along[0]))
        return [(LINE, segment.first, angle, 1.0, segment.length, none)]
    if isinstance(segment, Spline):
        coefficients = segment.curve.c[::-1].transpose(1, 0, 2)
        lengths = np.diff(segment.parameter)
        return [
            (CUBIC, (0.0, 0.0), 0.0, 1.0, length, own)
            for length, own in zip(lengths, coefficients, strict=True)
        ]
    radius = float(np.copysign(segment.radius, segment.sweep))
    return [(ARC, segment.centre, segment.angle, radius, segment.length, none)]
