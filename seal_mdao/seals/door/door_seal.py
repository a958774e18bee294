"""The door seal: one frozen object that decides everything but its shape parameters."""

import json
from contextlib import suppress
from dataclasses import asdict, dataclass, field, replace
from functools import cached_property
from numbers import Integral, Real

import numpy as np

from seal_mdao.analysis.body import Body, Edge
from seal_mdao.analysis.linear_solver import SOLVERS
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.friction import FRICTION_HISTORIES, ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.errors import LoadPathError
from seal_mdao.geometry.motion import Motion, straight_motion
from seal_mdao.geometry.profile import PROFILE_EXTENT, RigidProfile
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.rkpm.cells import support_radii
from seal_mdao.seals.door.area import section_area
from seal_mdao.seals.door.measures import BY_NAME, DOOR, STANDARD, measure_points
from seal_mdao.seals.door.result import DoorSealResult
from seal_mdao.seals.door.section import RingGrid, Section
from seal_mdao.seals.door.shapes import CornerDoor, FlatDoor
from seal_mdao.seals.door.splines import BoundarySplines, design_velocity
from seal_mdao.seals.seal import Seal
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.points import boundary_particles
from seal_mdao.terms.term import Scalar

DOORS = ("corner", "flat")
BASE_RAYS = 58
OFFSET_BOUND = 0.5

OF_THE_CLOUD = ("grid", "splines", "drawn_particles", "design_velocity", "body")
"""What follows from the section and the cloud alone, which no scalar parameter changes."""

PATH_SCALARS = ("normal_penalty", "tangent_penalty", "friction", "depth")
SCALARS = {
    "door_radius": ("mm", "Corner radius of the door."),
    "c10": ("kPa", "Mooney-Rivlin constant C10."),
    "c01": ("kPa", "Mooney-Rivlin constant C01."),
    "bulk_modulus": ("kPa", "Bulk modulus K."),
    "friction": (None, "Coulomb friction coefficient."),
    "depth": ("mm", "Final depth of the door below the top of the drawn seal."),
    "normal_penalty": ("kPa/mm", "Normal penalty w_n."),
    "tangent_penalty": ("kPa/mm", "Tangential penalty w_t."),
}
"""Units and description of the scalar parameters."""


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise ValueError(message)


def _is_integer(value, least: int) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and value >= least


def _is_number(value) -> bool:
    return isinstance(value, Real) and bool(np.isfinite(value))


@dataclass(frozen=True)
class DoorSeal(Seal):
    """A rubber seal on a fixed base, pressed by a rigid door with friction (mm, kPa, N/m).

    Attributes
    ----------
    rays, layers : int
        Particles around and across the wall; ``rays`` a multiple of 58 so that the base keeps its
        width.
    support : float
        Kernel support radius over the longest cell edge at a particle.
    basis_order : int
        Monomial basis of the shape functions: 1 linear, 2 quadratic.
    n_gauss : int
        Gauss points per direction of a background cell.
    section : Section
        Drawn section.
    outer_parameters, inner_parameters : int
        Free spline control values of the two boundaries.
    symmetric : bool
        The control values are those of one half of the section, the other is its mirror image.
    material : MooneyRivlin
    door : {"corner", "flat"}
        Rounded corner with a vertical side, or wholly flat.
    corner_x : float
        Where the flat of the corner door ends for the drawn radius, mm.
    drawn_door_radius : float
        Corner radius of the drawn door, mm.
    door_radius : float or None
        Corner radius of this design; None for the drawn one.
    segments : int or None
        None: exact line-arc-line door; else the number of straight segments.
    friction : float
        Coulomb coefficient.
    friction_history : {"accumulated", "incremental"}
        Elastic slip carried and return-mapped, or measured from the previous step only, Eq. (19).
    normal_penalty, tangent_penalty : float
        w_n, w_t, kPa/mm.
    start : float
        Height of the door's flat at the start, mm.
    depth : float
        Final depth of the door below the top of the drawn seal, mm.
    n_steps : int
        Equal load steps from start to depth.
    newton : NewtonOptions
    solver : {"auto", "banded", "superlu", "pardiso"}
        "auto": the band where it is narrow, else PARDISO where pypardiso is installed, else SuperLU.
    """

    rays: int = BASE_RAYS
    layers: int = 3
    support: float = 2.0
    basis_order: int = 1
    n_gauss: int = 2
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
    depth: float = 10.0
    n_steps: int = 105
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
            value = getattr(self, name)
            if not isinstance(value, kind):
                raise TypeError(f"{name} must be a {kind.__name__}, got {value!r}")

    def _check_discretization(self):
        for name, least in (("rays", BASE_RAYS), ("layers", 2), ("n_gauss", 1), ("n_steps", 1)):
            value = getattr(self, name)
            _require(
                _is_integer(value, least),
                f"{name} must be an integer of at least {least}, got {value!r}",
            )
        _require(
            self.rays % BASE_RAYS == 0,
            f"rays = {self.rays} must be a multiple of {BASE_RAYS}, else the base changes its width",
        )
        _require(
            self.basis_order in (1, 2), f"basis_order must be 1 or 2, got {self.basis_order!r}"
        )
        self._check_positive("support")
        _require(self.solver in SOLVERS, f"solver must be one of {SOLVERS}, got {self.solver!r}")
        _ = self.splines

    def _check_positive(self, *names):
        for name in names:
            value = getattr(self, name)
            _require(
                _is_number(value) and value > 0, f"{name} must be a positive number, got {value!r}"
            )

    def _check_contact(self):
        _require(self.door in DOORS, f"door must be one of {DOORS}, got {self.door!r}")
        _require(
            self.friction_history in FRICTION_HISTORIES,
            f"friction_history must be one of {FRICTION_HISTORIES}, got {self.friction_history!r}",
        )
        _require(
            _is_number(self.friction) and self.friction >= 0.0,
            f"friction must be a number that is not negative, got {self.friction!r}",
        )
        self._check_positive("normal_penalty", "tangent_penalty", "drawn_door_radius")
        if self.door_radius is not None:
            self.check_door_radius(self.door_radius)
        _require(
            _is_number(self.corner_x), f"corner_x must be a finite number, got {self.corner_x!r}"
        )
        _require(
            self.segments is None or _is_integer(self.segments, 4),
            f"segments must be None or an integer of at least 4, got {self.segments!r}",
        )

    def _check_path(self):
        _ = self._base_columns
        top = self.section.outer_radius
        _require(
            _is_number(self.start) and self.start > top,
            f"start must be a number above the top of the seal at {top}, got {self.start!r}",
        )
        _require(
            _is_number(self.depth) and 0.0 < self.depth < 2 * top,
            f"depth must be a number between 0 and {2 * top}, got {self.depth!r}",
        )

    def with_(self, **changes) -> "DoorSeal":
        """A copy with some attributes changed."""
        return replace(self, **changes)

    # ---- scalar parameters ----

    inputs = ("door_radius",)

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
        unknown = [name for name in values if name not in self.scalars]
        _require(
            not unknown, f"unknown parameter {unknown[:1]}; known are {', '.join(self.scalars)}"
        )
        constants = {name: values[name] for name in self.material.names if name in values}
        others = {name: value for name, value in values.items() if name not in constants}
        if "door_radius" in others:
            others["door_radius"] = self.check_door_radius(others["door_radius"])
        if constants:
            others["material"] = self.material.with_(**constants)
        return self._same_body(replace(self, **others)) if others else self

    def _same_body(self, other: "DoorSeal") -> "DoorSeal":
        """``other``, which has the same section and cloud, with what has been made of them."""
        for name in OF_THE_CLOUD:
            other.__dict__[name] = getattr(self, name)
        return other

    # ---- what follows from the attributes ----

    @cached_property
    def grid(self) -> RingGrid:
        return RingGrid(self.rays, self.layers, self._base_columns)

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
        _require(
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
        return Body(
            cells=grid.cells,
            support_radius=support_radii(grid.cells, self.drawn_particles, self.support),
            fixed=fixed,
            # the body is on the left: round the seal counter-clockwise, round its hole clockwise
            edges={
                "base": Edge(grid.base, False),
                "outer": Edge(grid.free_outer, False),
                "cavity": Edge(inner[::-1], True),
            },
            drawn=self.drawn_particles,
            basis_order=self.basis_order,
            n_gauss=self.n_gauss,
            solver=self.solver,
        )

    @property
    def law(self) -> ContactLaw:
        return ContactLaw(
            float(self.normal_penalty), float(self.tangent_penalty), float(self.friction),
            self.friction_history == "accumulated",
        )  # fmt: skip

    @property
    def motion(self) -> Motion:
        """Of the door, straight down; the parameter ``depth`` moves its end."""
        end = self.section.outer_radius - self.depth
        return straight_motion((0.0, self.start), (0.0, end), self.n_steps, {"depth": (0.0, -1.0)})

    def terms(self) -> tuple:
        grid, top = self.grid, self.layers - 1
        rays = grid.free_rays
        beside = np.column_stack([grid.particle(rays - 1, top), grid.particle(rays + 1, top)])
        where = boundary_particles(grid.free_outer, beside)
        door = RigidContact(DOOR, where, self.shape, self.motion, self.law)
        return elastic_body(self.material), door

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
        settings, defaults = json.loads(text), cls()
        try:
            for name in ("section", "material", "newton"):
                settings[name] = type(getattr(defaults, name))(**settings[name])
            return cls(**settings)
        except (TypeError, KeyError) as error:
            raise ValueError(
                f"the settings are not those of this version's door seal: {error}"
            ) from error

    def result(self, path, boundary_offsets=None) -> DoorSealResult:
        return DoorSealResult(self, path, boundary_offsets)

    def completed(self, result: DoorSealResult, analysis=None) -> DoorSealResult:
        """The result with the places of its measures, from an analysis of the drawn seal."""
        if result.is_drawn or not result.converged:
            return result
        with suppress(LoadPathError):  # told when the measures are asked for
            drawn = self.as_drawn()
            points = measure_points(drawn) if analysis is None else analysis(drawn).points
            return result.at(points)
        return result

    @property
    def key(self):
        return replace(self, door_radius=self.radius)

    def area(self, offsets):
        return section_area(self.splines, offsets)

    def measures(self, names=()) -> tuple:
        unknown = [name for name in names if name not in BY_NAME]
        _require(not unknown, f"unknown measure {unknown[:1]}; known are {', '.join(BY_NAME)}")
        return tuple(BY_NAME[name] for name in names) if names else STANDARD

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
        _require(
            bad.size == 0,
            f"boundary_offsets[{bad[:1].sum()}] = {offsets[bad[:1]].sum():.4g} exceeds the wall "
            f"thickness {wall}; offsets are in mm, usual bounds are -0.5 to 0.5",
        )
        return offsets

    @staticmethod
    def check_door_radius(door_radius) -> float:
        """Corner radius as a float."""
        values = np.asarray(door_radius, float).reshape(-1)
        _require(values.size == 1, f"door_radius must be one number, got {values.size}")
        radius = float(values[0])
        _require(
            np.isfinite(radius) and 0.0 < radius < PROFILE_EXTENT,
            f"door_radius = {radius} must be positive and below {PROFILE_EXTENT}, where the drawn "
            "flat of the door begins",
        )
        return radius


def door_seal(**changes) -> DoorSeal:
    """The door seal of Kim et al. (2000), section 5, with some attributes of ``DoorSeal`` changed.

    Examples
    --------
    >>> door_seal(friction=0.3, door="flat").friction
    0.3
    """
    known = DoorSeal.__dataclass_fields__
    unknown = sorted(set(changes) - set(known))
    if unknown:
        raise TypeError(f"unknown option {unknown[0]!r}; known options are {', '.join(known)}")
    return DoorSeal(**changes)
