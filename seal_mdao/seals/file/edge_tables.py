"""Tables that name edges: supports, air and fluids, self-contact, terms of extensions, designs.

``on`` of a table binds it to a section: it returns the definition of its term.
"""

from dataclasses import replace
from functools import cache
from typing import Annotated

import numpy as np
from pydantic import AfterValidator, model_validator

from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.contact.self_contact import SelfContact
from seal_mdao.geometry.motion import step_fractions
from seal_mdao.loads.fluid_pressure import ENDS, SHARE, FluidPressure
from seal_mdao.loads.trapped_air import ADIABATIC, ATMOSPHERE, TrappedAir
from seal_mdao.loads.vented_air import SHARP_EDGED, VentedAir
from seal_mdao.seals.file.extensions import Extensible, arguments, extension_table, keys_of
from seal_mdao.seals.file.forms import Form, Name, Names, Penalty, Text, many, number, one_of, whole
from seal_mdao.seals.file.friction_table import Friction
from seal_mdao.seals.file.load_steps import MOST_STEPS
from seal_mdao.seals.file.schema import Table, key, rows, table
from seal_mdao.seals.outline.section_body import SectionBody
from seal_mdao.structure.environment import Environment
from seal_mdao.terms.averaged_points import sharp_corners
from seal_mdao.terms.points import boundary_particles, edge_points
from seal_mdao.terms.term import TermDefinition

SELF_CONTACT = "self_contact"
"""Label of the contact of a section with itself."""
MOST_PRESSURE = 1e9
"""kPa."""
VENTS = ("vent_diameter", "vent_spacing", "closing_speed", "discharge_coefficient")
"""Keys of the vents of a cavity; the first two belong together."""
# neighbouring edges, or one of them by its name alone
Stretch = Annotated[
    Text | Names,
    AfterValidator(lambda given: (given,) if isinstance(given, str) else given),
    Form('the name of an edge, or a list of neighbours, such as ["left", "top"]'),
]


@table
class FixedTable(Table):
    """Edges whose displacement is fixed, in both or single directions."""

    edges: Names = key("fixed edges")
    directions: many(one_of("x", "y"), 'a list of "x", "y" or both') = key(
        "fixed directions", ("x", "y")
    )


@table
class SymmetryTable(Table):
    """Edges in a plane of symmetry, beyond which the section continues as its mirror image."""

    edges: Names = key("straight edges in the plane of symmetry; they stay in it in every design")
    normal: one_of("x", "y") = key("axis normal to the plane")


@table
class CavityTable(Table):
    """Hole with trapped air, which may escape through vents."""

    hole: whole(1, 1000) = key("number of the hole, from 1")
    name: Name = key(
        "prefix of the names of its parameters, such as air_pressure and air_gamma", "air"
    )
    pressure: number("kPa", above=0.0) = key(
        "absolute pressure outside, and inside at the start", ATMOSPHERE
    )
    gamma: number(above=0.0) = key(
        "polytropic exponent: 1.4 for fast compression without heat exchange, 1 for slow "
        "compression at constant temperature",
        ADIABATIC,
    )
    vent_diameter: number("mm", above=0.0) | None = key(
        "diameter of round vents; default: no vents", None
    )
    vent_spacing: number("mm", above=0.0) | None = key(
        "distance from one vent to the next along the strip; in a body of revolution along the circle "
        "of the centroid of the undeformed hole",
        None,
    )
    closing_speed: number("mm/s", above=0.0) | None = key(
        "with vents: speed of the first moving profile along its path, in stages without duration; "
        "omit it where every stage has one",
        None,
    )
    discharge_coefficient: number(above=0.0, most=1.0) | None = key(
        f"discharge coefficient of the vents, default {SHARP_EDGED:g}: 0.6 for a sharp edge, 0.8 for a "
        "hole in a wall of twice its diameter",
        None,
    )

    @model_validator(mode="after")
    def _complete_vents(self):
        # diameter and spacing belong together; a speed and a coefficient need vents
        own = {name: getattr(self, name) for name in VENTS}
        missing = [name for name in VENTS[:2] if own[name] is None]
        given = [name for name in VENTS if own[name] is not None]
        if given and missing:
            raise ValueError(
                f"the key {given[0]} is given without {missing[0]}; the vents of a cavity need "
                f"both {' and '.join(VENTS[:2])}"
            )
        if given and self.vent_spacing < self.vent_diameter:
            raise ValueError(
                f"vent_spacing = {self.vent_spacing:g} is less than vent_diameter = "
                f"{self.vent_diameter:g}; give the distance between the centres of the vents"
            )
        return self

    @property
    def vented(self) -> bool:
        """Whether there are vents."""
        return self.vent_diameter is not None

    def on(self, section: SectionBody, environment: Environment | None = None) -> TrappedAir:
        """Bind the air to the particles around its hole; its time is that of the environment, or of
        the first profile that travels."""
        sealed = TrappedAir(
            self.name, section.loops[self.hole], self.pressure, self.gamma, environment
        )
        if not self.vented:
            return sealed
        given = {name: getattr(self, name) for name in VENTS if getattr(self, name) is not None}
        if environment is None or environment.time is None:
            motions = (contact.motion for contact in section.contacts)
            given["motion"] = next(motion for motion in motions if motion.travel > 0.0)
            given["travel"], given["time"] = given["motion"].timing
        return VentedAir(
            sealed.label, sealed.ring, sealed.pressure, sealed.gamma, environment, **given
        )


@table
class FluidTable(Table):
    """Fluid on an edge: on all of it, or from one end until contact with a profile stops it."""

    edges: Stretch = key(
        "an edge, or a list of adjacent edges: with from, those from the wet side through the "
        "contact to the dry side; without it, those on which the pressure acts",
        alias="edge",
    )
    pressure: number("kPa", above=0.0, most=MOST_PRESSURE) = key(
        "pressure of the fluid above that on the dry side"
    )
    end: one_of(*ENDS) | None = key(
        "end of the edge at which the fluid is; the outer contour runs counter-clockwise, holes"
        " clockwise; without it the pressure acts on the complete edge, such as that of an inflated "
        "hole, which no profile may touch",
        None,
        alias="from",
    )
    steps: whole(1, MOST_STEPS) | None = key(
        "number of load steps at the end of the path over which the pressure grows from 0 in "
        "equal parts; default: those of the last stage",
        None,
    )
    name: Name = key("prefix of the name of its parameter, such as fluid_pressure", "fluid")
    share: number(above=0.0, most=1.0) = key(
        "a point is dry if the true contact pressure exceeds (1 + share) times the pressure of the "
        "fluid",
        SHARE,
    )

    def on(self, section: SectionBody, last: int | tuple = 1) -> FluidPressure:
        """Bind the fluid to its edges, behind the contacts that may touch them.

        Parameters
        ----------
        last : int or tuple of float
            Steps of the last stage, over which the pressure grows unless ``steps`` is given: a number of
            equal ones, or the fractions of the pressure at their ends.
        """
        edges = section.in_order(self.edges)
        particles = section.particles(edges)
        # zero pressure up to the last steps, over which it grows
        grown = step_fractions(last if self.steps is None else self.steps)
        ramp = np.concatenate([np.zeros(section.n_steps + 1 - len(grown)), grown])
        if self.end is None:
            # a closed edge ends where it begins
            if section.sides(edges)[-1, 1] == particles[0]:
                particles = np.append(particles, particles[0])
            return FluidPressure(self.name, particles, "start", self.pressure, ramp, ())
        # contacts that touch the edges close them against the fluid
        closing = tuple(
            own for own in section.contacts if np.isin(particles, own.where.at_particles).any()
        )
        # the particles before and after every one; none at the ends
        beside = np.column_stack([
            np.append(particles[0], particles[:-1]), np.append(particles[1:], particles[-1])
        ])  # fmt: skip
        sides = boundary_particles(particles, beside).edges
        return FluidPressure(
            self.name, particles, self.end, self.pressure, ramp, closing, self.share,
            sharp_corners(sides, section.body.nominal),
        )  # fmt: skip


@table
class PairTable(Table):
    """Two edges that may touch each other, or one that may touch itself, with own friction."""

    edges: many(Text, 'one name of an edge, or two, such as ["left", "right"]', 1, 2) = key(
        "two edges that may touch each other, or one that may touch itself"
    )
    friction: Friction = key("Coulomb coefficient, or another law")

    @property
    def name(self) -> str:
        """Suffix of the names of its constants."""
        return "_".join(self.edges)


@table
class SelfContactTable(Table):
    """Edges that may touch each other or themselves, neighbouring points excluded."""

    edges: Names = key(
        "edges that may touch; those that do not touch only increase the computing time"
    )
    friction: Friction | None = key(
        "Coulomb coefficient, or another law; if not given, only the edges of pair may touch", None
    )
    normal_penalty: Penalty | None = key(
        "normal penalty; it is chosen automatically if not given", None
    )
    tangent_penalty: Penalty | None = key(
        "tangential penalty; it is chosen automatically if not given", None
    )
    pairs: rows(PairTable) = key("pairs of edges with their own friction", (), alias="pair")

    name = SELF_CONTACT

    @model_validator(mode="after")
    def _some_friction(self):
        if self.friction is None and not self.pairs:
            raise ValueError(
                "the key 'friction' is missing; give it, or a [[self_contact.pair]] for every pair "
                "of edges that may touch"
            )
        return self

    def on(self, section: SectionBody) -> SelfContact:
        """Bind the contact to the loops that contain the edges."""
        particles, nominal = section.particles(self.edges), section.body.nominal
        # closest points are looked for on the complete loops
        own = tuple(loop for loop in section.loops if np.isin(loop, particles).any())
        touching = np.isin(np.concatenate(own), particles)
        friction, pair_of = (self.friction, None) if not self.pairs else self._by_pairs()
        law = ContactLaw(self.normal_penalty, self.tangent_penalty, friction, True)
        contact = SelfContact(
            SELF_CONTACT, own, touching, nominal, law, axisymmetric=section.body.axisymmetric
        )
        if not self.pairs:
            return contact
        edge_of = section.edge_numbers(self.edges, contact.where)
        # the last row and column of pair_of are those of points on none of the edges
        edge_of = np.where(edge_of < 0, len(self.edges), edge_of)
        return replace(contact, edge_of=edge_of, pair_of=pair_of)

    def _by_pairs(self) -> tuple[FrictionByGroup, np.ndarray]:
        """Return the laws of the pairs, that of all others last, and the pair of both edges."""
        count = len(self.edges)
        others = [] if self.friction is None else [("", self.friction)]
        pair_of = np.full((count + 1, count + 1), -1)
        if others:
            pair_of[:count, :count] = len(self.pairs)
        for group, pair in enumerate(self.pairs):
            one, other = (self.edges.index(name) for name in (pair.edges[0], pair.edges[-1]))
            pair_of[one, other] = pair_of[other, one] = group
        named = [(pair.name, pair.friction) for pair in self.pairs] + others
        return FrictionByGroup(*zip(*named, strict=True)), pair_of


TERM_NAME = "prefix of the names of its parameters; default: its type"


@table(kw_only=True)
class TermTable(Table):
    """User-defined load or contact, given by its type; its further keys are those of its class."""

    type: Text = key("name of the user-defined load or contact (term)")
    name: Name | None = key(TERM_NAME, None)
    edges: Names = key("edges on which the user-defined load or contact acts")

    @property
    def arguments(self) -> dict:
        """Fields of its definition beside ``label`` and ``where``."""
        return arguments(self, TermTable)

    def on(self, section: SectionBody) -> TermDefinition:
        """Bind the term to the Gauss points of the sides of its edges."""
        points = edge_points(section.sides(self.edges))
        return self.makes(label=self.name, where=points, **self.arguments)


@cache
def _extension(name: str, made: type) -> type[TermTable]:
    """Make the table of a term of another package."""
    # the name is the type unless given; label and points are given by the section
    keys = {"name": (Name, key(TERM_NAME, name))} | keys_of(made, TermTable, ("label", "where"))
    return extension_table(TermTable, "type", name, made, keys)


AnyTerm = Annotated[TermTable, Extensible("terms", "type", _extension)]
