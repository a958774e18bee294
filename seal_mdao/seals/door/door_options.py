"""Options of the door seal, their bounds, and the parts of the seal built from them."""

from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial

import numpy as np

from seal_mdao import values
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.friction import FRICTION_HISTORIES, ContactLaw
from seal_mdao.geometry.motion import Motion, increases_to_one, straight_motion
from seal_mdao.geometry.profile import PROFILE_EXTENT
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.rkpm.cells import GAUSS_POINTS
from seal_mdao.seals.door.section import RingGrid, Section
from seal_mdao.seals.door.shapes import CornerDoor, FlatDoor
from seal_mdao.seals.door.splines import BoundarySplines
from seal_mdao.seals.wall_grid import WALL_SCHEMES
from seal_mdao.terms.points import CONTACT_POINTS

BASE_RAYS = 58
PARTS = {"section": Section, "material": MooneyRivlin, "newton": NewtonOptions}
"""Options that are records of their own."""
MOST_SUPPORT = 10.0
"""Cell edges."""
FARTHEST = 100.0
"""Of the start above the top of the nominal seal, and of the clearance above the start, mm."""


def _optional(check):
    """Return a check that accepts None."""
    return lambda name, value: None if value is None else check(name, value)


def _support(name: str, value):
    # one number: round kernels; two: product kernels, which need more than one cell
    pair = values.numbers(name, value)
    if pair.ndim == 0:
        return values.real(name, value, above=0.0, high=MOST_SUPPORT)
    values.require(
        pair.shape == (2,) and bool(np.all((pair > 1.0) & (pair <= MOST_SUPPORT))),
        f"{name} must be a positive number, or two numbers above 1 and at most {MOST_SUPPORT} "
        f"(around the ring, across the wall), got {values.formatted(value)}",
    )
    return tuple(pair.tolist())


def _gauss(name: str, value):
    if not isinstance(value, tuple | list):
        return values.integer(name, value, *GAUSS_POINTS)
    values.require(
        len(value) == 2,
        f"{name} must be an integer, or two integers (around the ring, across the wall), got "
        f"{values.formatted(value)}",
    )
    return tuple(values.integer(name, points, *GAUSS_POINTS) for points in value)


def _integer(low: int, high: int):
    return partial(values.integer, low=low, high=high)


def _one_of(*choices: str):
    return partial(values.one_of, choices=choices)


def _option(default, check):
    """Declare an option with its default; ``check(name, value)`` returns the checked value."""
    return field(default=default, metadata={"check": check})


@dataclass(frozen=True)
class DoorOptions:
    """Options of the door seal: a rubber seal on a fixed base, compressed by a rigid door with
    friction (mm, kPa, N/m).

    Attributes
    ----------
    rays, layers : int
        Particles around and across the wall, 58 to 2320 and 3 to 40; ``rays`` a multiple of 58 so that
        the base keeps its width.
    refinement : int
        Number of parts, 1 to 10, of every interval between rays within 62 degrees of straight up, where
        the door presses.
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
    contact_points : {"particles", "edges", "averages"}
        Contact points: the free particles of the outer boundary, the middle of every straight edge
        between two of them, or the particles, moving as the mean of the edges beside them.
    section : Section
        Nominal section.
    outer_parameters, inner_parameters : int
        Free spline control values of the two boundaries, no more than rays.
    symmetric : bool
        The control values are those of one half of the section, the other is its mirror image.
    material : MooneyRivlin
    door : {"corner", "flat"}
        Rounded corner with a vertical side, or wholly flat.
    corner_x : float
        End of the flat of the corner door for the nominal radius, -50 to 50 mm.
    nominal_door_radius : float
        Corner radius of the nominal door, from 0.01 to below 100 mm.
    door_radius : float or None
        Corner radius of this design; None for the nominal one.
    segments : int or None
        None: exact line-arc-line door; else the number of straight segments, 4 to 10 000.
    friction : float
        Coulomb coefficient, 0 to 10.
    friction_history : {"accumulated", "incremental"}
        Elastic slip carried and return-mapped, or measured from the previous step only, Eq. (19).
    normal_penalty, tangent_penalty : float
        w_n, w_t, kPa/mm; w_n from 0.1 and w_t from 0.001 to 1e8 times the shear modulus a mm.
    start : float
        Height of the door's flat at the start, up to 100 mm above the top of the nominal seal.
    clearance : float
        Distance above ``start`` at which the first load step begins, 0 to 100 mm, so that a design that
        reaches up to ``start`` is still clear of the door. It does not count as travel and does not
        change the ends of the steps.
    depth : float
        Final depth of the door below the top of the nominal seal, from 0.001 mm to its outer diameter.
    door_shift : float
        Horizontal misplacement of the door, -50 to 50 mm.
    door_angle : float
        Misalignment of the door in degrees, -30 to 30, counter-clockwise about the point of its flat
        above the axis of the nominal seal (before the shift).
    n_steps : int
        Load steps from start to depth.
    step_ends : tuple of float, or None
        Ends of the load steps as fractions of the path, the last one 1; None for equal steps.
    newton : NewtonOptions
    """

    rays: int = _option(BASE_RAYS, _integer(BASE_RAYS, 40 * BASE_RAYS))
    layers: int = _option(3, _integer(3, 40))  # two leave the wall far too soft
    refinement: int = _option(1, _integer(1, 10))
    support: float | tuple[float, float] = _option(WALL_SCHEMES["paper"].support, _support)
    basis_order: int = _option(1, _integer(1, 2))
    n_gauss: int | tuple[int, int] = _option(2, _gauss)
    pressure: str = _option("cell", _one_of("cell", "wall"))
    contact_points: str = _option("particles", _one_of(*CONTACT_POINTS))
    section: Section = field(default_factory=Section)
    outer_parameters: int = 14
    inner_parameters: int = 11
    symmetric: bool = _option(False, values.flag)
    material: MooneyRivlin = field(default_factory=MooneyRivlin)
    door: str = _option("corner", _one_of("corner", "flat"))
    corner_x: float = _option(2.0, partial(values.real, low=-50.0, high=50.0))
    nominal_door_radius: float = 4.0
    door_radius: float | None = None
    segments: int | None = _option(None, _optional(_integer(4, 10_000)))
    friction: float = 0.25
    friction_history: str = _option("accumulated", _one_of(*FRICTION_HISTORIES))
    normal_penalty: float = 1e4
    tangent_penalty: float = 1e2
    start: float = 10.0
    clearance: float = _option(0.1, partial(values.real, low=0.0, high=FARTHEST))
    depth: float = 10.0
    door_shift: float = 0.0
    door_angle: float = 0.0
    n_steps: int = _option(105, _integer(1, 10**9))
    step_ends: tuple | None = None
    newton: NewtonOptions = field(default_factory=NewtonOptions)

    @property
    def radius(self) -> float:
        """Corner radius of this design, mm."""
        return self.nominal_door_radius if self.door_radius is None else self.door_radius

    @property
    def bounds(self) -> dict:
        """Bounds of the scalar parameters, keyword arguments of ``values.real`` by name."""
        top, shear = self.section.outer_radius, self.material.shear_modulus
        return {
            # with a larger radius the flat of the door would not begin before its corner
            "door_radius": {"low": 0.01, "below": PROFILE_EXTENT},
            "friction": {"low": 0.0, "high": 10.0},
            "depth": {"low": 0.001, "below": 2 * top},
            "door_shift": {"low": -50.0, "high": 50.0},
            "door_angle": {"low": -30.0, "high": 30.0},
            # over the shear modulus, 1/mm
            "normal_penalty": {"low": 0.1 * shear, "high": 1e8 * shear},
            "tangent_penalty": {"low": 1e-3 * shear, "high": 1e8 * shear},
        }

    # ---- parts of the seal built from the options ----

    @cached_property
    def grid(self) -> RingGrid:
        """Particles of the wall."""
        return RingGrid.refined(self.rays, self.layers, self._base_columns, self.refinement)

    @property
    def _base_columns(self) -> int:
        """Rays from straight down to the end of the flat base.

        Raises
        ------
        ValueError
            When the base ends between two rays: particles would be fixed that do not lie on it.
        """
        # D_0 = k 2 pi / rays with a whole k, else the base ends between two rays
        spacing = 2 * np.pi / self.rays
        columns = round(self.section.base_angle / spacing)
        below = int(self.section.base_angle / spacing)
        values.require(
            columns > 0 and abs(self.section.base_angle - columns * spacing) <= 1e-9,
            f"the angle base_angle = {self.section.base_angle:.6g} (rad) of the door seal must be "
            f"a multiple of the angle 2 pi / {self.rays} between two of the {self.rays} rays, for "
            f"example {max(below, 1) * spacing:.6g} or {(max(below, 1) + 1) * spacing:.6g}",
        )
        return columns

    @cached_property
    def splines(self) -> BoundarySplines:
        """Shape parameters of the section."""
        return BoundarySplines(
            self.section, self.outer_parameters, self.inner_parameters, self.symmetric
        )

    @property
    def law(self) -> ContactLaw:
        """Contact law of the door."""
        accumulated = self.friction_history == "accumulated"
        return ContactLaw(self.normal_penalty, self.tangent_penalty, self.friction, accumulated)

    @property
    def motion(self) -> Motion:
        """Motion straight down from above ``start``; its parameters are ``depth``, shift and angle."""
        # y(1) = R - depth, dy(1)/d(depth) = -1
        end = self.section.outer_radius - self.depth
        steps = self.n_steps if self.step_ends is None else 1
        path = straight_motion((0.0, self.start), (0.0, end), steps, {"depth": (0.0, -1.0)})
        # shift and angle move every waypoint
        path = path.with_placement(x="door_shift", angle="door_angle")
        path = path.moved({"door_shift": self.door_shift, "door_angle": self.door_angle})
        # unequal steps divide one step over the complete path
        if self.step_ends is not None:
            path = path.with_ends(self.step_ends)
        # only the first step becomes longer, upwards
        return replace(path, clearance=(0.0, self.clearance))

    @property
    def shape(self) -> CornerDoor | FlatDoor:
        """Shape of the nominal door."""
        if self.door == "flat":
            return FlatDoor()
        # the vertical side stays where it is when the radius changes
        side = self.corner_x + self.nominal_door_radius
        return CornerDoor(self.corner_x, side, self.nominal_door_radius, self.segments)


def door_options(**given) -> DoorOptions:
    """Check options of the door seal; those left out have the values of the example.

    Raises
    ------
    TypeError, ValueError
        For options that are unknown or not admissible.
    """
    known = [own.name for own in fields(DoorOptions)]
    # unknown options before wrong values
    unknown = sorted(set(given) - set(known))
    if unknown:
        raise TypeError(
            f"the built-in door seal has no option {unknown[0]!r}; its options are "
            f"{', '.join(known)}"
        )
    options = DoorOptions(**given)
    for name, kind in PARTS.items():
        values.instance(name, getattr(options, name), kind)
    # first what the bounds of others depend on
    own = {f.name: f.metadata["check"] for f in fields(DoorOptions) if f.metadata}
    options = _checked(options, own)
    options = _checked(options, _dependent_checks(options))
    _check_together(options)
    return options


def _checked(options: DoorOptions, checks: dict) -> DoorOptions:
    """Return the options with their checked values."""
    found = {name: check(name, getattr(options, name)) for name, check in checks.items()}
    return replace(options, **found)


def _radius(name: str, value, bounds: dict) -> float:
    found = values.numbers(name, value).reshape(-1)
    values.require(found.size == 1, f"{name} must be one number, got {found.size}")
    return values.real(name, float(found[0]), **bounds)


def _dependent_checks(options: DoorOptions) -> dict:
    """Make the checks of options whose bounds depend on others."""
    bounds, top = dict(options.bounds), options.section.outer_radius
    radius = partial(_radius, bounds=bounds.pop("door_radius"))
    return {name: partial(values.real, **own) for name, own in bounds.items()} | {
        "nominal_door_radius": radius,
        "door_radius": _optional(radius),
        "start": partial(values.real, above=top, high=top + FARTHEST),
    }


def _check_together(options: DoorOptions) -> None:
    """Check the conditions on several options together."""
    values.require(
        options.rays % BASE_RAYS == 0,
        f"rays = {options.rays} (number of radial rows of particles) must be a multiple of "
        f"{BASE_RAYS}, because the fixed base would otherwise change its width",
    )
    # both raise where the section and the rays do not fit; control values beyond the particles of a
    # boundary would have no effect of their own
    splines, _ = options.splines, options.grid
    for name, count in (
        ("outer_parameters", splines.outer_controls), ("inner_parameters", splines.inner_controls)
    ):  # fmt: skip
        values.require(
            count <= options.rays,
            f"{name} = {getattr(options, name)} gives a boundary of {options.rays} "
            f"particles {count} control values; at most {options.rays} can be "
            "distinguished",
        )
    if options.step_ends is not None:
        ends = values.numbers("step_ends", options.step_ends)
        values.require(
            ends.shape == (options.n_steps,) and increases_to_one(ends),
            f"step_ends must be {options.n_steps} increasing fractions of the travel (n_steps), "
            f"the last one 1; got {values.formatted(options.step_ends)}",
        )
