"""``[[profile]]``: rigid bodies, their curves and motions, and the contact of the section with them."""

from functools import cache, cached_property
from typing import Annotated

import numpy as np
from pydantic import WrapValidator, model_validator

from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.geometry.curve import ARC, CUBIC, LINE
from seal_mdao.geometry.motion import Motion, Stage, staged_motion
from seal_mdao.geometry.profile import Pieces, RigidProfile, rigid_profile
from seal_mdao.geometry.shape import GivenShape, Shape
from seal_mdao.loads.moved_edges import MovedEdges
from seal_mdao.seals.file.extensions import Extensible, arguments, extension_table, keys_of
from seal_mdao.seals.file.forms import Name, Names, Penalty, Text, number, one_of, point
from seal_mdao.seals.file.friction_table import FrictionByEdge
from seal_mdao.seals.file.load_steps import Steps
from seal_mdao.seals.file.schema import Table, key, rows, table
from seal_mdao.seals.file.segment_tables import KINDS, PieceTable, SegmentTable
from seal_mdao.seals.outline.chain import checked_chain
from seal_mdao.seals.outline.contours import JOIN, SAGITTA, Line, Spline
from seal_mdao.seals.outline.crossings import check_simple
from seal_mdao.seals.outline.section_body import SectionBody
from seal_mdao.terms.points import CONTACT_POINTS

MOST_TURN = 3600.0
"""Degrees."""
Place = point(1e5)
Angle = number("degrees", least=-MOST_TURN, most=MOST_TURN)


@table
class StageTable(Table):
    """Stage of a motion, relative to the end of the previous stage."""

    translate: Place = key("translation in this stage", (0.0, 0.0))
    rotate: Angle = key("rotation about the pivot, counter-clockwise", 0.0)
    steps: Steps | None = key(
        "load steps; they are chosen automatically if no stage gives them", None
    )
    duration: number("s", above=0.0) | None = key(
        "duration of the stage, for materials that relax and cavities with vents; default with "
        "vents: travel divided by closing_speed",
        None,
    )


class Staged:
    """A table with the stages of a motion, ``stages``."""

    @property
    def n_steps(self) -> int:
        """Load steps of all stages."""
        return sum(stage.n_steps for stage in self.stages)

    @property
    def travel(self) -> float:
        """Length of the path, mm; rotation is no travel."""
        return float(sum(np.hypot(*stage.translate) for stage in self.stages))

    @property
    def moves(self) -> bool:
        """Whether a stage translates or rotates it."""
        return any(stage.moves for stage in self.stages)


def made_stage(given, read) -> Stage:
    """Make the ``Stage`` of a table; one that has been read is returned."""
    if isinstance(given, Stage):
        return given
    made = read(given)
    return Stage(made.steps, made.translate, made.rotate, duration=made.duration)


@table(kw_only=True)
class ShapeTable(Table):
    """The curve of a profile by its name; its further keys are the fields of its definition."""

    type: Text = key("name of the curve")

    @cached_property
    def made(self) -> Shape:
        """Curve with its parameters."""
        return self.makes(**arguments(self, ShapeTable))

    @model_validator(mode="after")
    def _makeable(self):
        # raises where the fields give no curve
        _ = self.made
        return self


@cache
def _extension(name: str, made: type) -> type[ShapeTable]:
    """Make the table of a curve of another package."""
    return extension_table(ShapeTable, "type", name, made, keys_of(made, ShapeTable))


@table(kw_only=True)
class ProfileTable(Staged, SegmentTable):
    """Rigid body, which lies on the left of its curve in the direction of the curve."""

    name: Name = key("prefix of the names of its parameters, such as door_friction")
    friction: FrictionByEdge = key(
        "Coulomb coefficient, or another law; or one for every edge, such as { seal = 0.2, lip "
        "= 0.6 }"
    )
    contact: Names | None = key(
        "adjacent edges that may touch the profile; default: the free edge nearest at the start"
        " and all free edges adjacent to it",
        None,
    )
    glued: Names | None = key("edges that are bonded to the profile and follow its motion", None)
    segment: rows(PieceTable) | None = key("segments of the curve, if it has several", None)
    shape: Annotated[ShapeTable, Extensible("profiles", "type", _extension)] | None = key(
        "instead of a curve: a shape of an extension, with parameters such as door_a", None
    )
    start: Place = key("position of the origin of its coordinates at the start", (0.0, 0.0))
    angle: Angle = key("rotation about the pivot at the start", 0.0)
    pivot: Place = key("centre of rotation, in the coordinates of its curve", (0.0, 0.0))
    interference: number("mm", least=0.0, most=1e4) = key(
        "largest depth by which it may lie inside the section at the start, such as a shaft in a lip; "
        "preliminary increments bring it to its start from where it does not overlap the section",
        0.0,
    )
    normal_penalty: Penalty | None = key(
        "normal penalty; it is chosen automatically if not given", None
    )
    tangent_penalty: Penalty | None = key(
        "tangential penalty; it is chosen automatically if not given", None
    )
    contact_points: one_of(*CONTACT_POINTS) | None = key(
        "points at which contact is evaluated: the particles, the midpoints between "
        "neighbouring particles, or the particles with the mean gap of the boundary beside "
        "them; chosen if not given",
        None,
    )
    stages: rows(Annotated[StageTable, WrapValidator(made_stage)]) = key(
        "stages of the motion; without stages the profile does not move", (), alias="stage"
    )

    @model_validator(mode="after")
    def _one_curve(self):
        # a curve of segments, which must not cross itself, or one of an extension
        curves = [own for own in ("segment", *KINDS) if getattr(self, own) is not None]
        if self.shape is None:
            check_simple(_corners(self.segments), self.closed)
        elif curves:
            raise ValueError(
                f"the keys {curves[0]} and shape both define the curve of the profile; use only "
                "one of them"
            )
        return self

    @cached_property
    def segments(self) -> tuple:
        """Chain of its curve, unless that is of another package."""
        # keys of a single segment beside a list of them contradict each other
        alone = [kind for kind in KINDS if getattr(self, kind) is not None]
        if self.segment is not None and alone:
            raise ValueError(
                f"the key {alone[0]} and the tables [[profile.segment]] both define the curve of "
                "the profile; use only one of them"
            )
        pieces = (self,) if self.segment is None else self.segment
        # one segment in this table, or those of [[profile.segment]] head to tail
        chain = [segment for piece in pieces for segment in piece.pieces(self.name)]
        return checked_chain(chain, JOIN, _joined(chain))

    @property
    def closed(self) -> bool:
        """Whether the curve is closed."""
        return _joined(self.segments)

    @property
    def turns(self) -> bool:
        """Whether a stage rotates it."""
        return any(stage.rotate for stage in self.stages)

    def on(self, section: SectionBody) -> RigidContact:
        """Bind the contact to the points of its edges."""
        # contact points, shape, motion and law of the term; constants with the name of the profile
        where = section.contact_points(self.contact, self.contact_points)
        shape = GivenShape(rigid_profile_of(self)) if self.shape is None else self.shape.made
        friction = self.friction
        if isinstance(friction, FrictionByGroup):
            friction = friction.among(section.edge_numbers(friction.names, where))
        law = ContactLaw(self.normal_penalty, self.tangent_penalty, friction, True)
        motion = motion_of(self, section.n_steps)
        return RigidContact(self.name, where, shape, motion, law, f"{self.name}_")

    def glue_on(self, section: SectionBody) -> MovedEdges:
        """Bind the motion to the particles of the edges that are bonded to the profile."""
        motion = motion_of(self, section.n_steps)
        start = np.array([*motion.positions[0], motion.angles[0]])
        return MovedEdges(self.name, section.particles(self.glued), (0, 1), motion, start)


def _joined(chain) -> bool:
    """Return whether a chain ends where it begins."""
    return bool(np.hypot(*(chain[-1].end - chain[0].start)) <= JOIN)


def _corners(segments) -> np.ndarray:
    """Compute the corners of a fine polygon along a chain, shape (k, 2)."""
    # sagitta of the chords relative to the largest coordinate
    size = max(np.abs(segment.points([0.0, 0.5, 1.0])).max() for segment in segments)
    parts = [segment.points(segment.chords(SAGITTA * size)[:-1]) for segment in segments]
    return np.concatenate([*parts, segments[-1].points([1.0])])


def motion_of(profile: ProfileTable, n_steps: int) -> Motion:
    """Make the motion of a profile; one without stages stands still for ``n_steps``."""
    # stages in succession from the start, turns about the pivot
    stages = profile.stages or (Stage(n_steps),)
    return staged_motion(stages, profile.start, profile.angle, profile.pivot)


def rigid_profile_of(profile: ProfileTable) -> RigidProfile:
    """Make the curve of a profile in its own frame; lines at the ends of an open one are extended."""
    if profile.shape is not None:
        return profile.shape.made.profile()
    pieces = [piece for segment in profile.segments for piece in _pieces(segment)]
    # pieces in succession by arc length; a closed curve is periodic in it
    kind, origin, angle, radius, length, coefficient = zip(*pieces, strict=True)
    start = np.concatenate([[0.0], np.cumsum(length)])
    return rigid_profile(
        Pieces(kind, origin, angle, radius, start[:-1], length, coefficient),
        period=start[-1] if profile.closed else 0.0,
    )


def _pieces(segment):
    """List kind, origin, angle, radius, length and coefficients of the pieces of a segment."""
    none = np.zeros((4, 2))
    if isinstance(segment, Line):
        # x(s) = x_0 + s (cos a, sin a)
        along = np.subtract(segment.last, segment.first)
        angle = float(np.arctan2(along[1], along[0]))
        return [(LINE, segment.first, angle, 1.0, segment.length, none)]
    if isinstance(segment, Spline):
        # one piece between two knots: x(u) = sum_k c_k u^k, ascending powers
        coefficients = segment.curve.c[::-1].transpose(1, 0, 2)
        lengths = np.diff(segment.parameter)
        return [
            (CUBIC, (0.0, 0.0), 0.0, 1.0, length, own)
            for length, own in zip(lengths, coefficients, strict=True)
        ]
    # radius positive counter-clockwise, as the sweep
    radius = float(np.copysign(segment.radius, segment.sweep))
    return [(ARC, segment.centre, segment.angle, radius, segment.length, none)]
