"""What a seal file decides: one frozen object for every table."""

from dataclasses import dataclass
from pathlib import Path

from seal_mdao.geometry.motion import Stage
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.seals.outline.section import Outline


@dataclass(frozen=True)
class SectionTable:
    """``[section]``: the outline, what it is made of, the largest distance of particles, mm, and the
    drawing that the outline is from, if there is one."""

    outline: Outline
    material: str
    spacing: float
    drawing: Path | None = None


@dataclass(frozen=True)
class FixedTable:
    """``[fixed]``: edges that are held."""

    edges: tuple


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
    friction : float
    normal_penalty, tangent_penalty : float
        kPa/mm.
    start : pair of float
        Where its origin is at the start, mm.
    angle : float
        How it is turned at the start about the pivot, degrees.
    pivot : pair of float
        Centre of rotation in the profile's own frame, mm.
    stages : tuple of Stage
        Empty for one that stands still.
    """

    name: str
    segments: tuple
    closed: bool
    contact: tuple
    friction: float
    normal_penalty: float
    tangent_penalty: float
    start: tuple
    angle: float
    pivot: tuple
    stages: tuple[Stage, ...]

    @property
    def n_steps(self) -> int:
        """Load steps of all stages."""
        return sum(stage.steps for stage in self.stages)


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
    profiles : tuple of ProfileTable
    designs : tuple of DesignTable
    measures : tuple of MeasureTable
        Those of the file, and those that ``[optimize]`` names by their type.
    optimize : OptimizeTable or None
    """

    path: Path
    materials: dict[str, Isotropic]
    section: SectionTable
    fixed: FixedTable
    profiles: tuple[ProfileTable, ...]
    designs: tuple[DesignTable, ...] = ()
    measures: tuple[MeasureTable, ...] = ()
    optimize: OptimizeTable | None = None

    @property
    def n_steps(self) -> int:
        """Load steps of the path."""
        return max(profile.n_steps for profile in self.profiles)
