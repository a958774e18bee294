"""Types of measures of a seal file: the keys of each."""

from dataclasses import fields, replace
from functools import cache, partial
from typing import Annotated

from pydantic import AfterValidator, model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.measures.contact_pressure import ContactPressure, ContactWidth, PeakPressure
from seal_mdao.measures.fluid import BlowOffPressure, CavityPressure
from seal_mdao.measures.gap import (
    Gap,
    GapSquareIntegral,
    GapSquareSum,
    LargestGap,
    OpenGapSquareSum,
)
from seal_mdao.measures.measure import Measure
from seal_mdao.measures.section_shape import CavityArea, Displacement, Mass, SectionArea, Volume
from seal_mdao.measures.stress import LargestVonMises, StressNorm, VonMises
from seal_mdao.measures.wall_thickness import WallThickness
from seal_mdao.measures.work import FrictionWork, ProfileWork, StrainEnergy
from seal_mdao.seals.file.extensions import Extensible, extension_table, keys_of
from seal_mdao.seals.file.forms import Form, Names, Point, Text, many, number, one_of, whole
from seal_mdao.seals.file.measure_table import (
    AtPlaces,
    MeasureTable,
    OfProfile,
    Places,
    kind,
    nearest,
    only_name,
    simple_kind,
)
from seal_mdao.seals.file.schema import chosen_by, key, known
from seal_mdao.seals.file.sealing_tables import KINDS
from seal_mdao.seals.outline.walls import fault_of_wall

# lists of contact points; orders of p-norms; points
Patches = many(Places, "a list of lists of indices, one for every contact region")
Order = whole(2, 1000)
Sites = many(Point, "a list of points [[x, y], ...] (mm)")


def _two_stages(given):
    if not given[0] < given[1]:
        raise ValueError
    return given


StagePair = Annotated[
    many(whole(0, 1000), "two stages", 2, 2),
    AfterValidator(_two_stages),
    Form("two stages, the second after the first, such as [2, 4]; 0 is the start of the path"),
]


simple_kind("section_area", SectionArea, MeasureTable, "Area of the undeformed section.")
simple_kind("volume", Volume, MeasureTable, "Volume of the undeformed ring.")
simple_kind(
    "mass",
    Mass,
    MeasureTable,
    "Mass of the seal per metre, or of the ring.",
)


@kind("wall_thickness", WallThickness)
class WallThicknessTable(MeasureTable):
    """Smooth lower bound of the smallest wall thickness of the undeformed section."""

    edges: Names | None = key(
        "edges on one side of the wall; default: the walls between all holes and the outer contour",
        None,
    )
    opposite: Names | None = key("edges on the other side", None)
    deficit: number(above=0.0, most=0.5) | None = key(
        "largest relative amount by which the bound is below the thickness; default: 0.02", None
    )

    @model_validator(mode="after")
    def _two_sides(self):
        # a wall has two sides
        if (self.edges is None) != (self.opposite is None):
            raise ValueError(
                "the keys edges and opposite are the two sides of a wall; give both keys or neither"
            )
        return self

    def check(self, where, file):
        outline = file.section.outline
        if self.edges is None:
            # without names a wall lies between the outside and a hole
            if all(len(body) == 1 for body in outline.bodies):
                raise SealFileError(
                    f"{where}: no wall can be found, because the section has no hole; give both "
                    "sides of a wall by the keys edges and opposite"
                )
            return
        for name, own in (("edges", self.edges), ("opposite", self.opposite)):
            for edge in own:
                known(where, name, edge, outline.edge_names, "edge")
        fault = fault_of_wall(outline, self.edges, self.opposite)
        if fault:
            sides = f"{', '.join(self.edges)} and {', '.join(self.opposite)}"
            raise SealFileError(f"{where}: {sides} {fault}")


@kind("cavity_area", CavityArea)
class CavityAreaTable(MeasureTable):
    """Area of a hole of the deformed section."""

    edge: Text = key("closed edge of the hole")

    def check(self, where, file):
        # a hole whose boundary is one edge
        outline = file.section.outline
        known(where, "edge", self.edge, outline.edge_names, "edge")
        holes = [hole.edge_names[0] for hole in outline.holes if len(hole.edge_names) == 1]
        if self.edge not in holes:
            raise SealFileError(
                f"{where}: edge = {self.edge!r} is not the complete boundary of a hole; the "
                f"complete boundaries of holes are {', '.join(holes) or 'none'}"
            )


@kind("cavity_pressure", lambda cavity: CavityPressure(cavity))
class CavityPressureTable(MeasureTable):
    """Excess pressure of the air in a hole over that outside."""

    cavity: Text | None = key("name of a [[cavity]]; default: the only one, or air", None)

    def completed(self, file):
        return replace(self, cavity=only_name(self.cavity, file.cavities, "air"))

    def check(self, where, file):
        known(where, "cavity", self.cavity, [own.name for own in file.cavities], "[[cavity]]")


@kind("blow_off_pressure", BlowOffPressure)
class BlowOffPressureTable(MeasureTable):
    """Pressure at which a fluid penetrates to the dry side."""

    fluid: Text | None = key("name of a [[fluid]]; default: the only one, or fluid", None)

    def completed(self, file):
        return replace(self, fluid=only_name(self.fluid, file.penetrating_fluids, "fluid"))

    def check(self, where, file):
        names = [own.name for own in file.penetrating_fluids]
        known(where, "fluid", self.fluid, names, "[[fluid]] with the key from")


simple_kind("contact_width", ContactWidth, OfProfile, "Length of the deformed boundary in contact.")
simple_kind(
    "nominal_contact_width", partial(ContactWidth, nominal=True), OfProfile,
    "Length of the undeformed boundary in contact.",
)  # fmt: skip


@kind("peak_pressure", PeakPressure)
class PeakPressureTable(OfProfile):
    """Smooth lower bound of the peak of the true contact pressure (mean of high order)."""

    order: Order | None = key(
        f"order of the mean, default {PeakPressure.order}; a larger order is closer to the maximum",
        None,
    )


simple_kind(
    "nominal_peak_pressure", partial(PeakPressure, nominal=True), PeakPressureTable,
    "Smooth lower bound of the peak of the nominal contact pressure (mean of high order).",
)  # fmt: skip


@kind("contact_pressure", lambda profile, places=None, **a: ContactPressure(profile, places, **a))
class ContactPressureTable(OfProfile):
    """True contact pressure of each contact region, as a mean of high order."""

    order: Order | None = key(
        f"order of the mean, default {ContactPressure.order}; a larger order is closer to the maximum",
        None,
    )
    places: Patches | None = key(
        "with a cloud: indices of contact points of every contact region", None
    )
    single = False


simple_kind(
    "nominal_contact_pressure", partial(ContactPressureTable.makes, nominal=True),
    ContactPressureTable, "Nominal contact pressure of each contact region, as a mean of high order.",
)  # fmt: skip


@kind("gap", lambda profile, places=None: Gap(profile, places))
class GapTable(AtPlaces):
    """Normal gaps at the points where the nominal seal is not in contact."""

    single = False


def _gap_square_sum(profile, points=None, places=None):
    """Sum g_n^2 at the points that are open in the nominal seal, Eq. (71), or in every design."""
    nominal = points == "nominal"
    return GapSquareSum(Gap(profile, places)) if nominal else OpenGapSquareSum(profile, places)


@kind("gap_square_sum", _gap_square_sum)
class GapSquareSumTable(AtPlaces):
    """Sum of the squared gaps between the first and the last contact point."""

    points: one_of("design", "nominal") | None = key(
        "contacts between which gaps are measured: those of every design (default) or of the "
        "nominal seal",
        None,
    )


simple_kind(
    "gap_square_integral", lambda profile, places=None: GapSquareIntegral(profile, places), AtPlaces,
    "Integral of the squared gaps between the first and the last contact point.",
)  # fmt: skip


@kind("largest_gap", lambda profile, places=None, **order: LargestGap(profile, places, **order))
class LargestGapTable(AtPlaces):
    """Smooth upper bound of the largest gap between the first and the last contact point."""

    order: Order | None = key(
        f"order of the p-norm, default {LargestGap.order}; a larger order is closer to the maximum",
        None,
    )


@kind("profile_work", lambda profile, stage=None: ProfileWork(profile, stages=stage))
class ProfileWorkTable(OfProfile):
    """Work of a profile on the seal; for a closed cycle the hysteresis loss."""

    stage: StagePair | None = key(
        "two stages between whose ends the work is computed, such as [2, 4], which are those of the "
        "first profile or moved edges that move or have several stages; default: the complete path",
        None,
    )

    def check(self, where, file):
        stages = len(file.stages)
        if self.stage is not None and self.stage[1] > stages:
            raise SealFileError(
                f"{where}: stage = {list(self.stage)}, but the motion has only {stages} "
                f"stage{'s' if stages > 1 else ''}"
            )


simple_kind(
    "friction_work", FrictionWork, MeasureTable,
    "Work of friction: work of all profiles that is not stored in the body.",
)  # fmt: skip
simple_kind("strain_energy", StrainEnergy, MeasureTable, "Elastic energy of the body.")


@kind("stress_norm", StressNorm)
class StressNormTable(MeasureTable):
    """p-norm of the von Mises stress of the particles, an upper bound of the largest."""

    order: Order | None = key(
        f"order of the p-norm, default {StressNorm.order}; a larger order is closer to the maximum",
        None,
    )


@kind("von_mises", VonMises)
class VonMisesTable(MeasureTable):
    """Smooth upper bound of the von Mises stress over the section, or stress at particles."""

    excess: number(above=0.0, most=1.0) | None = key(
        "largest relative amount by which the bound is above the largest stress; default: 0.05",
        None,
    )
    away_from_singular: number("mm", above=0.0) | None = key(
        "excludes points within this distance from the end of a fixed edge, a sharp re-entrant "
        "corner, or the end or a corner of an interface between materials of different stiffness, "
        "where the exact stress is infinite",
        None,
    )
    at: Sites | None = key("points: the stress of the nearest particles", None)
    count: whole(1, 1000) | None = key(
        "number of the largest maxima along the boundary of the nominal seal", None
    )
    places: Places | None = key(
        "with a cloud: indices of the particles at which the stress is taken", None
    )

    @model_validator(mode="after")
    def _one_choice(self):
        # places are given by points or by a number of maxima; the excess is that of the smooth maximum
        if self.at is not None and self.count is not None:
            raise ValueError("the keys at and count are given together; use only one of them")
        for name in ("excess", "away_from_singular"):
            if getattr(self, name) is not None and not self.single:
                raise ValueError(
                    f"the key {name} applies only to the maximum over the complete section and "
                    f"cannot be combined with at, count or places; leave out {name}"
                )
        return self

    @property
    def single(self) -> bool:
        """Whether the value is that of the complete section, not of single particles."""
        return all(own is None for own in (self.at, self.count, self.places))

    def measure(self, particles):
        # a smooth maximum of the section, or the stress at particles
        if self.single:
            given = {"excess": self.excess, "away_from_singular": self.away_from_singular}
            return LargestVonMises(**{name: own for name, own in given.items() if own is not None})
        # particles by number, nearest to points, or at the largest maxima of the nominal seal
        places = self.places
        if places is None and self.at is not None:
            places = tuple(nearest(point, particles) for point in self.at)
        return VonMises(places) if self.count is None else VonMises(places, self.count)


@kind("displacement", Displacement)
class DisplacementTable(MeasureTable):
    """Displacement of a particle, horizontal and vertical."""

    at: Point = key("a point; the displacement is that of the nearest particle")
    single = False

    def measure(self, particles):
        return self.makes(nearest(self.at, particles))


@cache
def _extension(name: str, made: type[Measure]) -> type[MeasureTable]:
    """Make the table of a type of measure of another package."""
    # a definition with a field ``profile`` has that key; ``name`` is that of every measure
    of_profile = "profile" in [field.name for field in fields(made)]
    base = OfProfile if of_profile else MeasureTable
    single = made.scalar or made.size is Measure.size
    keys = keys_of(made, base, ("name", "profile"))
    return extension_table(base, "type", name, made, keys, single=single)


EXTENSIONS = Extensible("measures", "type", _extension, KINDS)
"""Types of other packages."""
AnyMeasure = Annotated[chosen_by("type", KINDS), EXTENSIONS]
"""A table of any type."""
