"""The seal that is designed: one frozen object that decides everything but the design parameters."""

from dataclasses import dataclass, field, replace
from functools import cached_property
from numbers import Integral, Real

import numpy as np

from seal_mdao.analysis.body import Body
from seal_mdao.analysis.linear_solver import SOLVERS
from seal_mdao.analysis.loading import LoadProgram
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.friction import FRICTION_HISTORIES, ContactLaw
from seal_mdao.design.splines import BoundarySplines, design_velocity
from seal_mdao.geometry.profile import (
    PROFILE_EXTENT,
    RigidProfile,
    corner_profile,
    flat_profile,
    segmented_corner_profile,
)
from seal_mdao.geometry.section import RingGrid, Section, support_radii
from seal_mdao.materials.mooney_rivlin import MooneyRivlin

DOORS = ("corner", "flat")
BASE_RAYS = 58
OFFSET_BOUND = 0.5


def _require(condition: bool, message: str) -> None:
    if not condition:
        raise ValueError(message)


def _is_integer(value, least: int) -> bool:
    return isinstance(value, Integral) and not isinstance(value, bool) and value >= least


def _is_number(value) -> bool:
    return isinstance(value, Real) and bool(np.isfinite(value))


@dataclass(frozen=True)
class SealModel:
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
        Corner radius at the start, mm.
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
        _require(
            _is_number(self.corner_x), f"corner_x must be a finite number, got {self.corner_x!r}"
        )
        _require(
            self.segments is None or _is_integer(self.segments, 4),
            f"segments must be None or an integer of at least 4, got {self.segments!r}",
        )

    def _check_path(self):
        top = self.section.outer_radius
        _require(
            _is_number(self.start) and self.start > top,
            f"start must be a number above the top of the seal at {top}, got {self.start!r}",
        )
        _require(
            _is_number(self.depth) and 0.0 < self.depth < 2 * top,
            f"depth must be a number between 0 and {2 * top}, got {self.depth!r}",
        )

    def with_(self, **changes) -> "SealModel":
        """A copy with some attributes changed."""
        return replace(self, **changes)

    def with_parameters(self, values: dict) -> "SealModel":
        """A copy with scalar parameters changed; the material's constants by their own names."""
        constants = {
            name: values[name] for name in ("c10", "c01", "bulk_modulus") if name in values
        }
        others = {name: value for name, value in values.items() if name not in constants}
        return replace(self, material=replace(self.material, **constants), **others)

    # ---- what follows from the attributes ----

    @cached_property
    def grid(self) -> RingGrid:
        return RingGrid(self.rays, self.layers, 3 * self.rays // BASE_RAYS)

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
        rays, top = grid.free_rays, self.layers - 1
        return Body(
            cells=grid.cells,
            support_radius=support_radii(grid, self.drawn_particles, self.support),
            fixed=fixed,
            contact=grid.free_outer,
            contact_ends=np.column_stack(
                [grid.particle(rays - 1, top), grid.particle(rays + 1, top)]
            ),
            basis_order=self.basis_order,
            n_gauss=self.n_gauss,
            solver=self.solver,
        )

    @property
    def n_offsets(self) -> int:
        return self.splines.count

    @property
    def law(self) -> ContactLaw:
        return ContactLaw(
            float(self.normal_penalty), float(self.tangent_penalty), float(self.friction),
            self.friction_history == "accumulated",
        )  # fmt: skip

    @property
    def positions(self) -> np.ndarray:
        """Door translation at the start and after every nominal step, shape (n_steps + 1, 2)."""
        end = self.section.outer_radius - self.depth
        y = np.linspace(self.start, end, self.n_steps + 1)
        return np.column_stack([np.zeros_like(y), y])

    @property
    def program(self) -> LoadProgram:
        return LoadProgram(self.positions)

    def profile(self, door_radius: float) -> RigidProfile:
        """The door with the given corner radius, its flat at y = 0."""
        if self.door == "flat":
            return flat_profile()
        side = self.corner_x + self.drawn_door_radius
        if self.segments is None:
            return corner_profile(self.corner_x, door_radius, side)
        return segmented_corner_profile(self.corner_x, door_radius, side, self.segments)

    def particles(self, boundary_offsets: np.ndarray | None = None) -> np.ndarray:
        """Particles of a design, shape (n, 2), mm.

        Raises
        ------
        ValueError
            For offsets of a wrong number, or not finite.
        """
        offsets = self.check_offsets(boundary_offsets)
        return self.drawn_particles + np.tensordot(offsets, self.design_velocity, 1)

    def check_offsets(self, boundary_offsets) -> np.ndarray:
        """Offsets as an array of the right shape; zeros for None."""
        if boundary_offsets is None:
            return np.zeros(self.n_offsets)
        offsets = np.asarray(boundary_offsets, float)
        _require(
            offsets.shape == (self.n_offsets,),
            f"boundary_offsets must have shape ({self.n_offsets},), got {offsets.shape}",
        )
        bad = np.flatnonzero(~np.isfinite(offsets))
        _require(bad.size == 0, f"boundary_offsets[{bad[:1].sum()}] is not a finite number")
        wall = self.section.outer_radius - self.section.inner_radius
        bad = np.flatnonzero(np.abs(offsets) > wall)
        _require(
            bad.size == 0,
            f"boundary_offsets[{bad[:1].sum()}] = {offsets[bad[:1]].sum():.4g} exceeds the wall "
            f"thickness {wall}; offsets are in mm, usual bounds are -0.5 to 0.5",
        )
        return offsets

    def check_door_radius(self, door_radius) -> float:
        """Corner radius as a float; the drawn one for None."""
        if door_radius is None:
            return float(self.drawn_door_radius)
        values = np.asarray(door_radius, float).reshape(-1)
        _require(values.size == 1, f"door_radius must be one number, got {values.size}")
        radius = float(values[0])
        _require(
            np.isfinite(radius) and 0.0 < radius < PROFILE_EXTENT,
            f"door_radius = {radius} must be positive and below {PROFILE_EXTENT}, where the drawn "
            "flat of the door begins",
        )
        return radius


def door_seal(**changes) -> SealModel:
    """The door seal of Kim et al. (2000), section 5, with some attributes of ``SealModel`` changed.

    Examples
    --------
    >>> door_seal(friction=0.3, door="flat").friction
    0.3
    """
    known = SealModel.__dataclass_fields__
    unknown = sorted(set(changes) - set(known))
    if unknown:
        raise TypeError(f"unknown option {unknown[0]!r}; known options are {', '.join(known)}")
    return SealModel(**changes)
