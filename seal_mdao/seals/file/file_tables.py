"""Tables of a seal file, and the properties of its seal that follow from them."""

from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from pydantic import BaseModel, ConfigDict

from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.seals.conditions import conditions_of
from seal_mdao.seals.file.clearance import cleared
from seal_mdao.seals.file.design_table import DesignTable
from seal_mdao.seals.file.edge_tables import (
    AnyTerm,
    CavityTable,
    FixedTable,
    FluidTable,
    SelfContactTable,
    SymmetryTable,
    TermTable,
)
from seal_mdao.seals.file.environment_table import environment_of, growth_of
from seal_mdao.seals.file.load_steps import PenaltiesTable, StepsTable
from seal_mdao.seals.file.material_table import Materials, MaterialTable
from seal_mdao.seals.file.measure_table import MeasureTable
from seal_mdao.seals.file.measure_types import AnyMeasure
from seal_mdao.seals.file.model_table import AXISYMMETRIC, RADIAL, ModelTable, axis_edges
from seal_mdao.seals.file.moved_table import MovedTable
from seal_mdao.seals.file.optimize_table import OptimizeTable
from seal_mdao.seals.file.profile_table import ProfileTable
from seal_mdao.seals.file.schema import key, rows
from seal_mdao.seals.file.section_table import SectionTable, WrittenSection
from seal_mdao.seals.file.softening_table import softening_of
from seal_mdao.seals.file.tolerance_table import ToleranceTable
from seal_mdao.seals.file.viscoelastic_table import series_of
from seal_mdao.seals.outline.outline_seal import SectionRegion
from seal_mdao.seals.penalty_error import NORMAL, TANGENT
from seal_mdao.seals.steps_and_penalties import PENALTY_TOLERANCE
from seal_mdao.structure.environment import Environment

MODEL = ModelTable()
MOVING = ("profile", "moved")
"""Tables of what moves; a file has one of them."""


class Written(BaseModel):
    """Tables of a seal file as written by the user."""

    # keys are the names of tables; what is unknown is refused by ``read_seal_file`` before
    model_config = ConfigDict(extra="forbid", frozen=True)

    model: ModelTable = key("kinematics and environment", MODEL)
    material: Materials = key("rubbers by their names")
    section: WrittenSection = key("the section")
    profile: rows(ProfileTable) = key("rigid bodies that move against it", ())
    fixed: FixedTable | None = key("fixed edges", None)
    moved: rows(MovedTable) = key("edges with prescribed displacements", ())
    symmetry: rows(SymmetryTable) = key("planes of symmetry", ())
    cavity: rows(CavityTable) = key("holes with trapped or vented air", ())
    self_contact: SelfContactTable | None = key("edges that may touch each other", None)
    fluid: rows(FluidTable) = key("fluids that press on one side", ())
    design: rows(DesignTable) = key("design parameters of the shape", ())
    measure: rows(AnyMeasure) = key("measures to compute", ())
    optimize: OptimizeTable | None = key("objective and constraints", None)
    steps: StepsTable | None = key("accuracy of the chosen load steps", None)
    penalties: PenaltiesTable = key("accuracy of the chosen penalties", PenaltiesTable())
    term: rows(AnyTerm) = key("terms of extension packages along edges", ())
    tolerance: ToleranceTable | None = key("scatter of parameters and boundary between parts", None)


@dataclass(frozen=True)
class SealFile:
    """Content of a seal file: its tables, and what follows from several of them.

    Attributes
    ----------
    materials : dict of str to Isotropic
        Laws with their constants, given or fitted.
    material_tables : dict of str to MaterialTable
        Their tables as written, with density and what heat and liquids do to them.
    measures : tuple of MeasureTable
        Those of the file, and those that ``[optimize]`` names by their type.
    step_tolerance : float or None
        Within which the load steps are to be chosen: every stage has one until then. None where they
        are given.
    penalty_tolerance : float
        Within which the penalties are chosen that the contacts leave open.
    implied : dict of str to str
        Where ``[optimize]`` names the measures without a table of their own, by their names.
    given : dict
        The tables as they were parsed.
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
    moved: tuple[MovedTable, ...] = ()
    tolerance: ToleranceTable | None = None
    model: ModelTable = MODEL
    material_tables: dict[str, MaterialTable] = field(default_factory=dict)
    implied: dict[str, str] = field(default_factory=dict, compare=False)
    given: dict = field(default_factory=dict, compare=False)

    @property
    def located_measures(self) -> list[tuple[str, MeasureTable]]:
        """Every measure with the table or key of the file that names it, for messages."""
        return [
            (self.implied.get(own.name, f"[[measure]] {number}"), own)
            for number, own in enumerate(self.measures, 1)
        ]

    @property
    def axisymmetric(self) -> bool:
        """Whether the section is turned about the axis x = 0."""
        return self.model.kinematics == AXISYMMETRIC

    @property
    def part(self) -> str:
        """Words for the part of the section that the file has, where planes of symmetry cut it, and for
        the forces that the complete section has; empty without such planes."""
        normals = sorted({plane.normal for plane in self.symmetries})
        if not normals:
            return ""
        # mirror images add up along the plane, and cancel each other across it
        along = "radial" if self.axisymmetric else "horizontal"
        doubled = [{"y": along, "x": "vertical"}[normal] for normal in normals]
        size = "half" if len(normals) == 1 else "quarter"
        return f"{size} section: double its {' and '.join(doubled)} force"

    @property
    def open_penalties(self) -> tuple:
        """Penalties that the file does not give, by the names of their parameters."""
        # contacts with profiles, then that of the section with itself
        touching = (*self.profiles, *([] if self.self_contact is None else [self.self_contact]))
        return tuple(
            f"{contact.name}_{kind}"
            for contact in touching
            for kind in (NORMAL, TANGENT)
            if getattr(contact, kind) is None
        )

    @property
    def leaves_open(self) -> bool:
        """Whether the file does not give all of particles, load steps and penalties, so that they are
        chosen."""
        return (
            self.step_tolerance is not None
            or bool(self.open_penalties)
            or self.section.accuracy is not None
        )

    @property
    def leaves_particles_open(self) -> bool:
        """Whether the particles have still to be chosen for an accuracy."""
        return self.section.accuracy is not None and not self.section.chosen

    @property
    def n_steps(self) -> int:
        """Number of load steps; number of stages if the steps are to be chosen."""
        return max(own.n_steps for own in self.moving)

    @property
    def moving(self) -> tuple:
        """Profiles and moved edges, including those that do not move."""
        return (*self.profiles, *self.moved)

    @property
    def leading(self) -> ProfileTable | MovedTable | None:
        """First profile or moved edges that move or have several stages, or else with a stage; None
        where nothing has any."""
        staged = [own for own in self.moving if own.stages]
        first = staged[0] if staged else None
        return next((own for own in staged if own.moves or len(own.stages) > 1), first)

    @property
    def stages(self) -> tuple:
        """Stages of the path: those of ``leading``."""
        return () if self.leading is None else self.leading.stages

    @property
    def glued(self) -> dict:
        """Edges that are bonded to profiles, by the name of the profile."""
        return {own.name: own.glued for own in self.profiles if own.glued is not None}

    @property
    def fixed_edges(self) -> tuple:
        """Edges that ``[fixed]`` constrains."""
        return () if self.fixed is None else self.fixed.edges

    @property
    def fixed_components(self) -> tuple:
        """Components that ``[fixed]`` prescribes: 0 for x, 1 for y."""
        directions = () if self.fixed is None else self.fixed.directions
        return tuple(sorted(set(map("xy".index, directions))))

    @property
    def supports(self) -> dict:
        """Prescribed displacement components of edges: 0 for x, 1 for y."""
        # fixed edges in one or both directions, edges of symmetry across their plane
        own = self.fixed_components
        mirrored = {n: ("xy".index(p.normal),) for p in self.symmetries for n in p.edges}
        held = dict.fromkeys(self.fixed_edges, own) | mirrored
        if self.axisymmetric:
            # edges on the axis stay there, those of [fixed] wholly
            radial = dict.fromkeys(axis_edges(self.section.outline), (RADIAL,))
            held = radial | held | {n: (0, 1) for n in radial if 1 in held.get(n, ())}
        held |= {name: moved.components for moved in self.moved for name in moved.edges}
        return held | {name: (0, 1) for edges in self.glued.values() for name in edges}

    @property
    def motions(self) -> list:
        """Functions that bind moved and bonded edges to a section."""
        outline = self.section.outline
        glued = [cleared(own, outline).glue_on for own in self.profiles if own.glued is not None]
        return [own.on for own in self.moved] + glued

    @property
    def regions(self) -> list:
        """Parts of the section with their materials; the first is the remaining part."""
        # constants have the prefix of their material where there are several
        section, several = self.section, bool(self.section.regions)
        prefix = f"{section.material}_" if several else ""
        rest = self._region(section.material, prefix, lines=section.parting)
        return [rest] + [
            self._region(own.material, f"{own.material}_", own.at, lines)
            for own, lines in zip(section.regions, section.region_lines, strict=True)
        ]

    def _region(self, name: str, prefix: str, at=None, lines=()) -> SectionRegion:
        """Make a part of the section of the material ``name``."""
        return SectionRegion(
            self.materials[name], prefix, at, lines, growth_of(self, name),
            self.material_tables[name].density, series_of(self, name), softening_of(self, name),
        )  # fmt: skip

    @property
    def penetrating_fluids(self) -> tuple[FluidTable, ...]:
        """Fluids that come from one end of an edge, up to a contact."""
        return tuple(own for own in self.fluids if own.end is not None)

    @property
    def environment(self) -> Environment | None:
        """Axial stretch, temperature and time along the path."""
        return environment_of(self)

    def conditions(self) -> dict:
        """Evaluate axial stretch, temperature and swelling at the end of the path."""
        return conditions_of(self.environment, {own.prefix: own.growth for own in self.regions})

    @property
    def contributions(self) -> list:
        """Functions that bind every term but the body to a section, in the order of the terms."""
        # the fluid of the last stage rises with that of a profile that moves
        last = self.stages[-1].steps
        # profiles, air, self-contact, fluids, terms of extensions
        touching = [cleared(profile, self.section.outline).on for profile in self.profiles]
        air = [partial(cavity.on, environment=self.environment) for cavity in self.cavities]
        itself = [] if self.self_contact is None else [self.self_contact.on]
        fluids = [partial(fluid.on, last=last) for fluid in self.fluids]
        return touching + air + itself + fluids + [term.on for term in self.terms]
