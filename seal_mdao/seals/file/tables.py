"""What a seal file decides: one frozen object for every table."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from seal_mdao.contact.friction_law import FrictionLaw
from seal_mdao.geometry.motion import Stage
from seal_mdao.geometry.shape import Shape
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.seals.choice import PENALTY_TOLERANCE
from seal_mdao.seals.outline.cloud import LAYERS
from seal_mdao.seals.outline.cloud_file import GivenCloud
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.section import Outline
from seal_mdao.seals.penalty_error import NORMAL, TANGENT

SELF_CONTACT = "self_contact"
"""Label of the contact of a section with itself."""


@dataclass(frozen=True)
class RegionTable:
    """``[[section.region]]``: a part of the section of another material.

    Attributes
    ----------
    material : str
    at : pair of float
        A point of the part, mm.
    line : tuple of pair of float or None
        Corners of the line that divides it from the rest, mm; None for a body of its own.
    """

    material: str
    at: tuple
    line: tuple | None


@dataclass(frozen=True)
class SectionTable:
    """``[section]``: the outline and how it is filled.

    Attributes
    ----------
    outline : Outline
    material : str
        Of what is in no region.
    spacing : float, Rays or GivenCloud
        Largest distance of particles, mm; or the rays that they lie on; or they themselves.
    drawing, cloud : Path or None
        What the outline and the particles were read from.
    layers : int
        Of particles across a wall at least, where a spacing fills the section.
    regions : tuple of RegionTable
    """

    outline: Outline
    material: str
    spacing: float | Rays | GivenCloud
    drawing: Path | None = None
    cloud: Path | None = None
    regions: tuple[RegionTable, ...] = ()
    layers: int = LAYERS

    @property
    def cuts(self) -> list:
        """Lines (k, 2) that divide the section."""
        return [np.array(region.line) for region in self.regions if region.line is not None]


@dataclass(frozen=True)
class FixedTable:
    """``[fixed]``: edges that are held, and in which directions."""

    edges: tuple = ()
    directions: tuple = ("x", "y")


@dataclass(frozen=True)
class SymmetryTable:
    """``[[symmetry]]``: edges in a plane beyond which the section goes on as its mirror image."""

    edges: tuple
    normal: str


@dataclass(frozen=True)
class ProfileTable:
    """``[[profile]]``: a rigid body and its motion.

    Attributes
    ----------
    name : str
    segments : tuple of Segment
        A chain, the rigid body on the left when walked, in the profile's own frame.
    closed : bool
    contact : tuple of str
        Edges of the section that may touch it.
    friction : float or FrictionLaw
        Coulomb's coefficient, or another law.
    normal_penalty, tangent_penalty : float or None
        kPa/mm; None to be chosen.
    start : pair of float
        Where its origin is at the start, mm.
    angle : float
        How it is turned at the start about the pivot, degrees.
    pivot : pair of float
        Centre of rotation in the profile's own frame, mm.
    stages : tuple of Stage
        Empty for one that stands still.
    contact_points : {"particles", "edges"} or None
        Where the edges may be touched, as of ``EdgeContact``; None until the whole file is known.
    shape : Shape or None
        Of an extension, in place of segments.
    """

    name: str
    segments: tuple
    closed: bool
    contact: tuple
    friction: float | FrictionLaw
    normal_penalty: float | None
    tangent_penalty: float | None
    start: tuple
    angle: float
    pivot: tuple
    stages: tuple[Stage, ...]
    contact_points: str | None
    shape: Shape | None = None

    @property
    def n_steps(self) -> int:
        """Load steps of all stages."""
        return sum(stage.n_steps for stage in self.stages)

    @property
    def travel(self) -> float:
        """Length of its path, mm; rotation is no travel."""
        return float(sum(np.hypot(*stage.translate) for stage in self.stages))


@dataclass(frozen=True)
class CavityTable:
    """``[[cavity]]``: a hole that does not let its air out.

    Attributes
    ----------
    hole : int
        From 1.
    name : str
    pressure : float
        Absolute pressure outside, kPa.
    gamma : float
    """

    hole: int
    name: str
    pressure: float
    gamma: float


@dataclass(frozen=True)
class SelfContactTable:
    """``[self_contact]``: edges that may touch each other or themselves; penalties in kPa/mm, None to
    be chosen."""

    edges: tuple
    friction: float | FrictionLaw
    normal_penalty: float | None
    tangent_penalty: float | None


@dataclass(frozen=True)
class FluidTable:
    """``[[fluid]]``: a fluid at one end of an edge, or of a stretch of them.

    Attributes
    ----------
    edges : tuple of str
    end : str
        "start" or "end" of them as they are walked, from which it comes.
    pressure : float
        kPa.
    steps : int or None
        The last load steps, over which it grows; None for those of the last stage.
    name : str
    share : float
        Of the pressure, by which the seal has to press with more where it is dry.
    """

    edges: tuple
    end: str
    pressure: float
    steps: int | None
    name: str
    share: float


@dataclass(frozen=True)
class TermTable:
    """``[[term]]``: a term of an extension along edges.

    Attributes
    ----------
    type, name : str
    edges : tuple of str
    definition : type
        The ``TermDefinition`` of the extension.
    arguments : dict
        Its fields besides ``label`` and ``where``.
    """

    type: str
    name: str
    edges: tuple
    definition: type
    arguments: dict


@dataclass(frozen=True)
class DesignTable:
    """``[[design]]``: edges that may move, parameters of each, and their bound, mm."""

    edges: tuple
    parameters: int
    bound: float


@dataclass(frozen=True)
class MeasureTable:
    """``[[measure]]``: its type, its name, and what the type asks for."""

    type: str
    name: str
    arguments: dict


@dataclass(frozen=True)
class Constraint:
    """``[[optimize.constraint]]``: a measure by name, and its bounds."""

    measure: str
    lower: float | None
    upper: float | None


@dataclass(frozen=True)
class OptimizeTable:
    """``[optimize]``: the measure that is made small, and what has to hold."""

    minimize: str
    constraints: tuple[Constraint, ...]


@dataclass(frozen=True)
class SealFile:
    """All decisions of a seal file.

    Attributes
    ----------
    path : Path
    materials : dict of str to Isotropic
    section : SectionTable
    fixed : FixedTable
    symmetries : tuple of SymmetryTable
    profiles : tuple of ProfileTable
    designs : tuple of DesignTable
    measures : tuple of MeasureTable
        Those of the file, and those that ``[optimize]`` names by their type.
    optimize : OptimizeTable or None
    cavities : tuple of CavityTable
    self_contact : SelfContactTable or None
    fluids : tuple of FluidTable
    step_tolerance : float or None
        Within which the load steps are to be chosen: every stage has one until then. None where they
        are given.
    penalty_tolerance : float
        Within which the penalties are chosen that the contacts leave open.
    terms : tuple of TermTable
    """

    path: Path
    materials: dict[str, Isotropic]
    section: SectionTable
    fixed: FixedTable
    symmetries: tuple[SymmetryTable, ...]
    profiles: tuple[ProfileTable, ...]
    designs: tuple[DesignTable, ...] = ()
    measures: tuple[MeasureTable, ...] = ()
    optimize: OptimizeTable | None = None
    cavities: tuple[CavityTable, ...] = ()
    self_contact: SelfContactTable | None = None
    fluids: tuple[FluidTable, ...] = ()
    step_tolerance: float | None = None
    penalty_tolerance: float = PENALTY_TOLERANCE
    terms: tuple[TermTable, ...] = ()

    @property
    def open_penalties(self) -> tuple:
        """Parameters of the seal whose values the file leaves to be chosen."""
        contacts = [(f"{profile.name}_", profile) for profile in self.profiles]
        if self.self_contact is not None:
            contacts.append((f"{SELF_CONTACT}_", self.self_contact))
        return tuple(
            prefix + kind
            for prefix, contact in contacts
            for kind in (NORMAL, TANGENT)
            if getattr(contact, kind) is None
        )

    @property
    def leaves_open(self) -> bool:
        """Whether load steps or penalties are to be chosen."""
        return self.step_tolerance is not None or bool(self.open_penalties)

    @property
    def n_steps(self) -> int:
        """Load steps of the path; its stages where the steps are to be chosen."""
        return max(profile.n_steps for profile in self.profiles)

    @property
    def last_stage(self) -> Stage:
        """That of a profile that moves."""
        return next(profile.stages[-1] for profile in self.profiles if profile.stages)

    @property
    def held(self) -> tuple:
        """Edges that are held in both directions."""
        return self.fixed.edges if len(set(self.fixed.directions)) == 2 else ()

    @property
    def planes(self) -> tuple:
        """Edges that are held in one direction, and its number: 0 for x, 1 for y."""
        own = () if self.held else [(name, self.fixed.directions[0]) for name in self.fixed.edges]
        mirrored = [(name, plane.normal) for plane in self.symmetries for name in plane.edges]
        return tuple((name, "xy".index(axis)) for name, axis in (*own, *mirrored))
