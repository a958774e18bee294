"""What a seal file has, and what it decides.

Materials are found by name in ``materials.by_name.LAWS`` (their tables follow from the fields of the
laws), types of measures in ``measure_table.KINDS``, which ``kind`` fills, and those of other packages
in ``registry`` (``extensions.Extensible``).
"""

from dataclasses import dataclass
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from seal_mdao.geometry.motion import Stage
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.seals.choice import PENALTY_TOLERANCE
from seal_mdao.seals.file.edge_tables import DesignTable, SelfContactTable
from seal_mdao.seals.file.fluids import CavityTable, FluidTable
from seal_mdao.seals.file.laws import Materials
from seal_mdao.seals.file.load_steps import PenaltiesTable, StepsTable
from seal_mdao.seals.file.measure_kinds import AnyMeasure
from seal_mdao.seals.file.measure_table import MeasureTable
from seal_mdao.seals.file.optimization import OptimizeTable
from seal_mdao.seals.file.profiles import ProfileTable
from seal_mdao.seals.file.schema import key, rows
from seal_mdao.seals.file.section_table import SectionTable, WrittenSection
from seal_mdao.seals.file.supports import FixedTable, SymmetryTable
from seal_mdao.seals.file.term_table import AnyTerm, TermTable
from seal_mdao.seals.penalty_error import NORMAL, TANGENT

SELF_CONTACT = "self_contact"
"""Label of the contact of a section with itself."""


class Written(BaseModel):
    """The tables of a seal file, as it is written."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    material: Materials = key("rubbers by their names")
    section: WrittenSection = key("the section")
    profile: rows(ProfileTable) = key("rigid bodies that move against it")
    fixed: FixedTable | None = key("edges that are held", None)
    symmetry: rows(SymmetryTable) = key("planes of symmetry", ())
    cavity: rows(CavityTable) = key("holes that keep their air", ())
    self_contact: SelfContactTable | None = key("edges that may touch each other", None)
    fluid: rows(FluidTable) = key("fluids that press on one side", ())
    design: rows(DesignTable) = key("edges that may move", ())
    measure: rows(AnyMeasure) = key("what is asked", ())
    optimize: OptimizeTable | None = key("what is made small, and what has to hold", None)
    steps: StepsTable | None = key("how exactly load steps are chosen", None)
    penalties: PenaltiesTable = key("how exactly penalties are chosen", PenaltiesTable())
    term: rows(AnyTerm) = key("terms of other packages along edges", ())


@dataclass(frozen=True)
class SealFile:
    """All decisions of a seal file.

    Attributes
    ----------
    path : Path
    materials : dict of str to Isotropic
    section : SectionTable
    fixed : FixedTable or None
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
    fixed: FixedTable | None
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
    def fixed_edges(self) -> tuple:
        """Edges that ``[fixed]`` holds."""
        return () if self.fixed is None else self.fixed.edges

    @property
    def held(self) -> tuple:
        """Edges that are held in both directions."""
        both = self.fixed is not None and len(set(self.fixed.directions)) == 2
        return self.fixed_edges if both else ()

    @property
    def planes(self) -> tuple:
        """Edges that are held in one direction, and its number: 0 for x, 1 for y."""
        own = () if self.held else [(name, self.fixed.directions[0]) for name in self.fixed_edges]
        mirrored = [(name, plane.normal) for plane in self.symmetries for name in plane.edges]
        return tuple((name, "xy".index(axis)) for name, axis in (*own, *mirrored))
