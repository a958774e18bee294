"""The door seal: one frozen object that decides everything but its shape parameters."""

import json
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.friction import FRICTION_HISTORIES, ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.equilibrium.linear_solver import SOLVERS
from seal_mdao.geometry.motion import Motion, increases_to_one, straight_motion
from seal_mdao.geometry.profile import PROFILE_EXTENT, RigidProfile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.rkpm.cells import GAUSS_POINTS, kernel_supports
from seal_mdao.seals.choice import choose
from seal_mdao.seals.door.area import section_area
from seal_mdao.seals.door.measures import DOOR, FURTHER, STANDARD
from seal_mdao.seals.door.section import RingGrid, Section
from seal_mdao.seals.door.shapes import CornerDoor, FlatDoor
from seal_mdao.seals.door.splines import BoundarySplines, design_velocity
from seal_mdao.seals.seal import Seal
from seal_mdao.seals.wall_grid import SCHEMES
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import CONTACT_POINTS, MaterialPoints, boundary_particles, edge_points
from seal_mdao.terms.term import Scalar

DOORS = ("corner", "flat")
PRESSURES = ("cell", "wall")
BASE_RAYS = 58
OFFSET_BOUND = 0.5

OF_THE_CLOUD = ("grid", "splines", "drawn_particles", "design_velocity", "body")
"""What follows from the section and the cloud alone, which no scalar parameter changes."""

PATH_SCALARS = (
    "normal_penalty", "tangent_penalty", "friction", "depth", "door_shift", "door_angle",
)  # fmt: skip
SCALARS = {
    "door_radius": ("mm", "Corner radius of the door."),
    "c10": ("kPa", "Mooney-Rivlin constant C10."),
    "c01": ("kPa", "Mooney-Rivlin constant C01."),
    "bulk_modulus": ("kPa", "Bulk modulus K."),
    "friction": (None, "Coulomb friction coefficient."),
    "depth": ("mm", "Final depth of the door below the top of the drawn seal."),
    "door_shift": ("mm", "Horizontal misplacement of the door."),
    "door_angle": ("deg", "Misalignment of the door, counter-clockwise about the seal's axis."),
    "normal_penalty": ("kPa/mm", "Normal penalty w_n."),
    "tangent_penalty": ("kPa/mm", "Tangential penalty w_t."),
}
"""Units and description of the scalar parameters."""


INTEGERS = {
    "rays": (BASE_RAYS, 40 * BASE_RAYS), "layers": (3, 40), "refinement": (1, 10),
    "basis_order": (1, 2), "n_steps": (1, 10**9),
}  # fmt: skip
"""Smallest and largest value. Two layers leave the wall far too soft."""
PENALTIES = {"normal_penalty": (0.1, 1e8), "tangent_penalty": (1e-3, 1e8)}
"""Smallest and largest value over the shear modulus of the rubber, 1/mm."""
MOST_SUPPORT = 10.0
"""Cell edges."""
MOST_FRICTION = 10.0
MOST_SEGMENTS = 10_000
LEAST_RADIUS = 0.01
FARTHEST_CORNER = 50.0
FARTHEST_START = 100.0
LEAST_DEPTH = 0.001
FARTHEST_SHIFT = 50.0
"""mm."""
LARGEST_ANGLE = 30.0
"""Degrees."""


@dataclass(frozen=True)
class DoorSeal(Seal):
    """A rubber seal on a fixed base, pressed by a rigid door with friction (mm, kPa, N/m).

    Attributes
    ----------
    rays, layers : int
        Particles around and across the wall, 58 to 2320 and 3 to 40; ``rays`` a multiple of 58 so that
        the base keeps its width.
    refinement : int
        Into how many, 1 to 10, the intervals between rays are divided where the door presses, 62 degrees
        to either side of straight up.
    support : float or pair of float
        One number: round kernels, their support radius over the longest cell edge at a particle, at
        most 10. Two: product kernels, their half-widths around and across the wall over the longest
        edge in that direction.
    basis_order : int
        Monomial basis of the shape functions: 1 linear, 2 quadratic.
    n_gauss : int or pair of int
        Gauss points of a background cell, 2 to 10: one number in both directions, two around and across
        the wall.
    pressure : {"cell", "wall"}
        "cell": one value in every background cell, a staircase across the wall. "wall": continuous and
        piecewise linear from the inner to the outer boundary, with as many values.
    contact_points : {"particles", "edges"}
        Where the door may touch: at the free particles of the outer boundary, or in the middle of every
        straight edge between two of them.
    section : Section
        Drawn section.
    outer_parameters, inner_parameters : int
        Free spline control values of the two boundaries, no more than rays.
    symmetric : bool
        The control values are those of one half of the section, the other is its mirror image.
    material : MooneyRivlin
    door : {"corner", "flat"}
        Rounded corner with a vertical side, or wholly flat.
    corner_x : float
        Where the flat of the corner door ends for the drawn radius, -50 to 50 mm.
    drawn_door_radius : float
        Corner radius of the drawn door, from 0.01 to below 100 mm.
    door_radius : float or None
        Corner radius of this design; None for the drawn one.
    segments : int or None
        None: exact line-arc-line door; else the number of straight segments, 4 to 10 000.
    friction : float
        Coulomb coefficient, 0 to 10.
    friction_history : {"accumulated", "incremental"}
        Elastic slip carried and return-mapped, or measured from the previous step only, Eq. (19).
    normal_penalty, tangent_penalty : float
        w_n, w_t, kPa/mm; w_n from 0.1 and w_t from 0.001 to 1e8 times the shear modulus a mm.
    start : float
        Height of the door's flat at the start, up to 100 mm above the top of the drawn seal.
    room : float
        How far above ``start`` the first load step begins, 0 to 100 mm, so that a design that reaches
        up to ``start`` is still clear of the door. It is no part of the way: all steps end where they
        would without it.
    depth : float
        Final depth of the door below the top of the drawn seal, from 0.001 mm to its outer diameter.
    door_shift : float
        Horizontal misplacement of the door, -50 to 50 mm.
    door_angle : float
        Misalignment of the door in degrees, -30 to 30, counter-clockwise about the point of its flat
        above the axis of the drawn seal (before the shift).
    n_steps : int
        Load steps from start to depth.
    step_ends : tuple of float, or None
        Where they end, as shares of the way, the last one 1; None for equal steps.
    newton : NewtonOptions
    solver : {"auto", "banded", "superlu", "pardiso"}
        "auto": the band where it is narrow, else PARDISO where pypardiso is installed, else SuperLU.
    """

    rays: int = BASE_RAYS
    layers: int = 3
    refinement: int = 1
    support: float | tuple[float, float] = SCHEMES["paper"].support
    basis_order: int = 1
    n_gauss: int | tuple[int, int] = 2
    pressure: str = "cell"
    contact_points: str = "particles"
    section: Section = field(default_factory=Section)
    outer_parameters: int = 14
    inner_parameters: int = 11
    symmetric: bool = False
    material: MooneyRivlin = field(default_factory=MooneyRivlin)
    door: str = "corner"
    corner_x: float = 2.0
    drawn_door_radius: float = 4.0
    door_radius: float | None = None
    segments: int | None = None
    friction: float = 0.25
    friction_history: str = "accumulated"
    normal_penalty: float = 1e4
    tangent_penalty: float = 1e2
    start: float = 10.0
    room: float = 0.1
    depth: float = 10.0
    door_shift: float = 0.0
    door_angle: float = 0.0
    n_steps: int = 105
    step_ends: tuple | None = None
    newton: NewtonOptions = field(default_factory=NewtonOptions)
    solver: str = "auto"

    def __post_init__(self):
        self._check_parts()
        self._check_discretization()
        self._check_contact()
        self._check_path()

    def _check_parts(self):
        for name, kind in (
            ("material", MooneyRivlin),
            ("section", Section),
            ("newton", NewtonOptions),
        ):
            values.instance(name, getattr(self, name), kind)

    def _set(self, name: str, check, *bounds, **more) -> None:
        """Put the checked value in the place of the one given."""
        object.__setattr__(self, name, check(name, getattr(self, name), *bounds, **more))

    def _check_discretization(self):
        for name, bounds in INTEGERS.items():
            self._set(name, values.integer, *bounds)
        values.require(
            self.rays % BASE_RAYS == 0,
            f"rays = {self.rays} must be a multiple of {BASE_RAYS}, else the base changes its width",
        )
        self._check_support()
        self._check_gauss()
        self._set("pressure", values.one_of, PRESSURES)
        self._set("contact_points", values.one_of, CONTACT_POINTS)
        self._set("solver", values.one_of, SOLVERS)
        self._set("symmetric", values.flag)
        splines = self.splines
        for name, count in (
            ("outer_parameters", splines.outer_controls), ("inner_parameters", splines.inner_controls)
        ):  # fmt: skip
            values.require(
                count <= self.rays,
                f"{name} = {getattr(self, name)} gives a boundary of {self.rays} "
                f"particles {count} control values; at most {self.rays} can be told "
                "apart",
            )

    def _check_support(self):
        pair = values.numbers("support", self.support)
        if pair.ndim == 0:
            self._set("support", values.real, above=0.0, high=MOST_SUPPORT)
            return
        values.require(
            pair.shape == (2,) and bool(np.all((pair > 1.0) & (pair <= MOST_SUPPORT))),
            f"support must be a positive number, or two above 1 and at most {MOST_SUPPORT} (around and "
            f"across the wall), got {values.formatted(self.support)}",
        )
        object.__setattr__(self, "support", tuple(pair.tolist()))

    def _check_gauss(self):
        if isinstance(self.n_gauss, tuple | list):
            values.require(
                len(self.n_gauss) == 2,
                "n_gauss must be an integer, or two (around and across the wall), got "
                f"{values.formatted(self.n_gauss)}",
            )
            pair = (values.integer("n_gauss", points, *GAUSS_POINTS) for points in self.n_gauss)
            object.__setattr__(self, "n_gauss", tuple(pair))
        else:
            self._set("n_gauss", values.integer, *GAUSS_POINTS)

    def _check_contact(self):
        self._set("door", values.one_of, DOORS)
        self._set("friction_history", values.one_of, FRICTION_HISTORIES)
        self._set("friction", values.real, 0.0, MOST_FRICTION)
        for name, (least, most) in PENALTIES.items():
            shear = self.material.shear_modulus
            self._set(name, values.real, least * shear, most * shear)
        object.__setattr__(
            self, "drawn_door_radius",
            self.check_door_radius(self.drawn_door_radius, "drawn_door_radius"),
        )  # fmt: skip
        if self.door_radius is not None:
            object.__setattr__(self, "door_radius", self.check_door_radius(self.door_radius))
        self._set("corner_x", values.real, -FARTHEST_CORNER, FARTHEST_CORNER)
        if self.segments is not None:
            self._set("segments", values.integer, 4, MOST_SEGMENTS)

    def _check_path(self):
        _ = self._base_columns
        top = self.section.outer_radius
        self._set("start", values.real, above=top, high=top + FARTHEST_START)
        self._set("room", values.real, 0.0, FARTHEST_START)
        self._set("depth", values.real, LEAST_DEPTH, below=2 * top)
        self._set("door_shift", values.real, -FARTHEST_SHIFT, FARTHEST_SHIFT)
        self._set("door_angle", values.real, -LARGEST_ANGLE, LARGEST_ANGLE)
        if self.step_ends is None:
            return
        ends = values.numbers("step_ends", self.step_ends)
        values.require(
            ends.shape == (self.n_steps,) and increases_to_one(ends),
            f"step_ends must be {self.n_steps} increasing shares of the way (n_steps), the last one 1; "
            f"got {values.formatted(self.step_ends)}",
        )
        object.__setattr__(self, "step_ends", tuple(ends.tolist()))

    def with_(self, **changes) -> "DoorSeal":
        """A copy with some attributes changed."""
        return replace(self, **changes)

    # ---- scalar parameters ----

    inputs = ("door_radius",)
    standard = STANDARD
    further = FURTHER

    @property
    def before_touch(self) -> float:
        return self.start - self.section.outer_radius

    @property
    def radius(self) -> float:
        """Corner radius of this design, mm."""
        return float(self.drawn_door_radius if self.door_radius is None else self.door_radius)

    @property
    def scalars(self) -> dict:
        own = {"door_radius": self.radius}
        own |= {name: getattr(self.material, name) for name in self.material.names}
        own |= {name: getattr(self, name) for name in PATH_SCALARS}
        return {name: Scalar(value, *SCALARS[name]) for name, value in own.items()}

    def as_drawn(self) -> "DoorSeal":
        """The same seal with the drawn door."""
        if self.door_radius is None:
            return self
        return self._same_body(replace(self, door_radius=None))

    def with_parameters(self, values: dict) -> "DoorSeal":
        self.check_parameters(values)
        constants = {name: values[name] for name in self.material.names if name in values}
        others = {name: value for name, value in values.items() if name not in constants}
        if "door_radius" in others:
            others["door_radius"] = self.check_door_radius(others["door_radius"])
        if constants:
            others["material"] = self.material.with_(**constants)
        return self._same_body(replace(self, **others)) if others else self

    def with_ends(self, ends) -> "DoorSeal":
        """As of ``Seal``; what it gives has the ends as ``step_ends``, shares of the way."""
        shares = self.motion.with_ends(ends).shares
        return self._same_body(replace(self, n_steps=len(shares), step_ends=tuple(shares.tolist())))

    def with_rooms(self, rooms: dict) -> "DoorSeal":
        return self._same_body(replace(self, room=float(rooms[DOOR][1])))

    def _same_body(self, other: "DoorSeal") -> "DoorSeal":
        """``other``, which has the same section and cloud, with what has been made of them."""
        for name in OF_THE_CLOUD:
            other.__dict__[name] = getattr(self, name)
        return other

    # ---- what follows from the attributes ----

    @cached_property
    def grid(self) -> RingGrid:
        return RingGrid.refined(self.rays, self.layers, self._base_columns, self.refinement)

    @property
    def _base_columns(self) -> int:
        """Rays from straight down to the end of the flat base.

        Raises
        ------
        ValueError
            When the base ends between two rays: particles would be fixed that do not lie on it.
        """
        spacing = 2 * np.pi / self.rays
        columns = round(self.section.base_angle / spacing)
        below = int(self.section.base_angle / spacing)
        values.require(
            columns > 0 and abs(self.section.base_angle - columns * spacing) <= 1e-9,
            f"base_angle = {self.section.base_angle:.6g} of the section must be a whole number of the "
            f"{self.rays} rays' spacing 2 pi / {self.rays}, for example "
            f"{max(below, 1) * spacing:.6g} or {(max(below, 1) + 1) * spacing:.6g}",
        )
        return columns

    @cached_property
    def splines(self) -> BoundarySplines:
        return BoundarySplines(
            self.section, self.outer_parameters, self.inner_parameters, self.symmetric
        )

    @cached_property
    def drawn_particles(self) -> np.ndarray:
        """Particles of the drawn seal, shape (n, 2)."""
        angles = self.grid.angles
        return self.grid.positions(self.section.inner(angles), self.section.outer(angles))

    @cached_property
    def design_velocity(self) -> np.ndarray:
        """dX / d(offsets), shape (n_offsets, n, 2)."""
        return design_velocity(self.splines, self.grid)

    @cached_property
    def body(self) -> Body:
        grid = self.grid
        fixed = np.zeros((len(self.drawn_particles), 2), bool)
        fixed[grid.base] = True
        inner = grid.particle(np.arange(grid.rays), 0)
        support = grid.along_cells(self.support)
        radius, axes = kernel_supports(grid.cells, self.drawn_particles, support)
        return Body(
            cells=grid.cells,
            support_radius=radius,
            support_axes=axes,
            fixed=fixed,
            # the body is on the left: round the seal counter-clockwise, round its hole clockwise
            edges={
                "base": Edge(grid.base, False),
                "outer": Edge(grid.free_outer, False),
                "cavity": Edge(inner[::-1], True),
            },
            drawn=self.drawn_particles,
            basis_order=self.basis_order,
            n_gauss=grid.along_cells(self.n_gauss),
            solver=self.solver,
            column=grid.column(self.pressure),
        )

    @property
    def law(self) -> ContactLaw:
        return ContactLaw(
            float(self.normal_penalty), float(self.tangent_penalty), float(self.friction),
            self.friction_history == "accumulated",
        )  # fmt: skip

    @property
    def motion(self) -> Motion:
        """Straight down from above ``start``; ``depth`` moves its end, shift and angle all of it."""
        end = self.section.outer_radius - self.depth
        steps = self.n_steps if self.step_ends is None else 1
        way = straight_motion((0.0, self.start), (0.0, end), steps, {"depth": (0.0, -1.0)})
        way = way.with_placement(x="door_shift", angle="door_angle")
        way = way.moved({"door_shift": self.door_shift, "door_angle": self.door_angle})
        if self.step_ends is not None:
            way = way.with_ends(self.step_ends)
        return replace(way, room=(0.0, self.room))

    def terms(self) -> tuple:
        door = RigidContact(DOOR, self._may_touch(), self.shape, self.motion, self.law)
        return elastic_body(self.material), door

    def _may_touch(self) -> MaterialPoints:
        grid, top = self.grid, self.layers - 1
        if self.contact_points == "edges":
            return edge_points(self.body.edge("outer").sides, 1)
        rays = grid.free_rays
        beside = np.column_stack([grid.particle(rays - 1, top), grid.particle(rays + 1, top)])
        return boundary_particles(grid.free_outer, beside)

    def settings(self) -> str:
        return json.dumps(asdict(self))

    @classmethod
    def from_settings(cls, text: str) -> "DoorSeal":
        """The door seal whose ``settings`` these are.

        Raises
        ------
        ValueError
            When they are not those of this version's ``DoorSeal``.
        """
        defaults = cls()
        try:
            settings = json.loads(text)
            for name in ("section", "material", "newton"):
                settings[name] = type(getattr(defaults, name))(**settings[name])
            return cls(**settings)
        except (TypeError, KeyError, RecursionError) as error:
            raise ValueError(
                f"the settings are not those of this version's door seal: {error}"
            ) from error

    @property
    def key(self):
        return replace(self, door_radius=self.radius)

    def area(self, offsets):
        return section_area(self.splines, offsets)

    @property
    def shape(self) -> CornerDoor | FlatDoor:
        """Shape of the door."""
        if self.door == "flat":
            return FlatDoor()
        side = self.corner_x + self.drawn_door_radius
        return CornerDoor(self.corner_x, side, self.radius, self.segments)

    @property
    def profile(self) -> RigidProfile:
        """The door in its own frame, its flat at y = 0."""
        return self.shape.profile()

    def check_offsets(self, offsets) -> np.ndarray:
        offsets = super().check_offsets(offsets)
        wall = self.section.outer_radius - self.section.inner_radius
        bad = np.flatnonzero(np.abs(offsets) > wall)
        values.require(
            bad.size == 0,
            f"boundary_offsets[{bad[:1].sum()}] = {offsets[bad[:1]].sum():.4g} exceeds the wall "
            f"thickness {wall}; offsets are in mm, usual bounds are -0.5 to 0.5",
        )
        return offsets

    @staticmethod
    def check_door_radius(door_radius, name: str = "door_radius") -> float:
        """Corner radius as a float."""
        found = values.numbers(name, door_radius).reshape(-1)
        values.require(found.size == 1, f"{name} must be one number, got {found.size}")
        # from PROFILE_EXTENT on the drawn flat of the door would not begin before its corner
        return values.real(name, float(found[0]), LEAST_RADIUS, below=PROFILE_EXTENT)


ACCURACIES = {
    "paper": {},
    "engineering": {
        "layers": 4, **SCHEMES["engineering"]._asdict(), "n_steps": 20, "solver": "banded",
    },
    "fine": {
        "rays": 2 * BASE_RAYS, "layers": 5, **SCHEMES["fine"]._asdict(), "n_steps": 42,
        "solver": "banded",
    },
}  # fmt: skip
"""Attributes of ``DoorSeal`` that decide the discretisation, by the name of the accuracy."""


def door_seal(
    accuracy: str = "paper", steps: str | None = None, step_tolerance: float = 5e-3, **changes
) -> DoorSeal:
    """The door seal of Kim et al. (2000), section 5, with some attributes of ``DoorSeal`` changed.

    Parameters
    ----------
    accuracy : {"paper", "engineering", "fine"}
        "paper": the cloud and the load steps of the paper, some 3 % from the limit of refinement.
        "engineering": those with the best error per second, the force within 0.5 % and the largest gap
        within 2 % of the limit. "fine": within 0.3 and 1 %; with more rays or layers no error grows.
        Attributes among ``changes`` go before.
    steps : "auto", optional
        Load steps that change no measure by more than ``step_tolerance`` (``seals.choice``). They are
        found now, by some three analyses of the nominal seal, and are an attribute of what is returned.
    step_tolerance : float

    Raises
    ------
    TypeError, ValueError
        For options that are unknown or not admissible.
    LoadPathError
        When the path of the drawn seal cannot be completed, for ``steps="auto"``.

    Examples
    --------
    >>> door_seal(friction=0.3, door="flat").friction
    0.3
    """
    known = DoorSeal.__dataclass_fields__
    unknown = sorted(set(changes) - set(known))
    if unknown:
        raise TypeError(f"unknown option {unknown[0]!r}; known options are {', '.join(known)}")
    values.one_of("accuracy", accuracy, tuple(ACCURACIES))
    values.require(
        steps is None or (isinstance(steps, str) and steps == "auto"),
        f'steps must be None or "auto", got {values.formatted(steps)}',
    )
    seal = DoorSeal(**{**ACCURACIES[accuracy], **changes})
    if steps is None:
        return seal
    seal = replace(seal, n_steps=1, step_ends=None)
    values.real("step_tolerance", step_tolerance, above=0.0, high=1.0)
    return choose(seal, step_tolerance).seal
