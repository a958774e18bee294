"""The door seal of the paper, Kim et al. (2000): build a ``Seal`` from its options."""

from dataclasses import asdict, replace

import numpy as np

from seal_mdao import values
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.measures.contact_pressure import ContactPressure
from seal_mdao.measures.gap import Gap, GapSquareIntegral, GapSquareSum
from seal_mdao.measures.reaction import Reaction
from seal_mdao.measures.stress import StressNorm, VonMises
from seal_mdao.rkpm.cells import kernel_supports
from seal_mdao.seals.door.door_options import BASE_RAYS, PARTS, DoorOptions, door_options
from seal_mdao.seals.door.splines import design_velocity
from seal_mdao.seals.seal import Parameter, Seal
from seal_mdao.seals.steps_and_penalties import choose
from seal_mdao.seals.wall_grid import WALL_SCHEMES
from seal_mdao.structure.elastic_body import elastic_body
from seal_mdao.terms.averaged_points import averaged_points
from seal_mdao.terms.points import MaterialPoints, boundary_particles, edge_points

DOOR = "door"
"""Label of the contact with the door."""
DOOR_SEAL = "door_seal"
"""Key of the options in the description of a seal."""
OFFSET_BOUND = 0.5
"""Usual bound of the boundary offsets, mm."""
CURVE_TRAVELS = (2.0, 4.0, 6.0, 8.0, 10.0)
"""Door travels of ``reaction_curve``, mm from the first touch; those within the depth are taken."""

STANDARD = (VonMises(), Gap(DOOR), GapSquareSum(Gap(DOOR)), Reaction(DOOR))
"""Measures that an OpenMDAO component has unless others are asked for."""
FURTHER = (
    GapSquareIntegral(DOOR), StressNorm(), ContactPressure(DOOR, nominal=True, name="patch_pressure"),
)  # fmt: skip
"""Optional measures, beside ``reaction_curve``."""

PARAMETERS = {
    "door_radius": ("mm", "Corner radius of the door."),
    "c10": ("kPa", "Mooney-Rivlin constant C10."),
    "c01": ("kPa", "Mooney-Rivlin constant C01."),
    "bulk_modulus": ("kPa", "Bulk modulus K."),
    "normal_penalty": ("kPa/mm", "Normal penalty w_n."),
    "tangent_penalty": ("kPa/mm", "Tangential penalty w_t."),
    "friction": (None, "Coulomb friction coefficient."),
    "depth": ("mm", "Final depth of the door below the top of the nominal seal."),
    "door_shift": ("mm", "Horizontal misplacement of the door."),
    "door_angle": ("deg", "Misalignment of the door, counter-clockwise about the seal's axis."),
}
"""Units and description of the scalar parameters."""

ACCURACIES = {
    "paper": {},
    "engineering": {
        "layers": 4, **WALL_SCHEMES["engineering"]._asdict(), "n_steps": 20,
    },
    "fine": {
        "rays": 2 * BASE_RAYS, "layers": 5, **WALL_SCHEMES["fine"]._asdict(), "n_steps": 42,
    },
}  # fmt: skip
"""Options that decide the discretisation, by the name of the accuracy."""


def door_seal(
    accuracy: str = "paper", steps: str | None = None, step_tolerance: float = 5e-3, **changes
) -> Seal:
    """Build the door seal of Kim et al. (2000), section 5, with some ``DoorOptions`` changed.

    Parameters
    ----------
    accuracy : {"paper", "engineering", "fine"}
        "paper": the cloud and the load steps of the paper, some 3 % from the limit of refinement.
        "engineering": those with the best error per second, the force within 0.5 % and the largest gap
        within 2 % of the limit. "fine": within 0.3 and 1 %; with more rays or layers no error grows.
        Options among ``changes`` override it.
    steps : "auto", optional
        Load steps that change no measure by more than ``step_tolerance``. They are found now, by some
        three analyses of the nominal seal (``seals.steps_and_penalties``), and belong to the seal.
    step_tolerance : float
    **changes
        Options of ``seals.door.door_options.DoorOptions``.

    Raises
    ------
    TypeError, ValueError
        For options that are unknown or not admissible.
    LoadPathError
        When the path of the nominal seal cannot be completed, for ``steps="auto"``.

    Examples
    --------
    >>> door_seal(friction=0.3, door="flat").scalars["friction"].value
    0.3
    """
    values.one_of("accuracy", accuracy, tuple(ACCURACIES))
    values.require(
        steps is None or (isinstance(steps, str) and steps == "auto"),
        f'the argument steps of door_seal must be None or "auto", got {values.formatted(steps)}',
    )
    # explicit options override those of the accuracy
    options = door_options(**{**ACCURACIES[accuracy], **changes})
    if steps is None:
        return _built(options)
    values.real("step_tolerance", step_tolerance, above=0.0, high=1.0)
    # one nominal step, so that the ends are fractions of the path
    choice = choose(_built(replace(options, n_steps=1, step_ends=None)), step_tolerance)
    seal = _built(replace(options, n_steps=len(choice.ends), step_ends=choice.ends))
    found = choice.step_error > step_tolerance
    return replace(seal, step_error=choice.step_error) if found else seal


def options_of(seal: Seal) -> DoorOptions:
    """Return the options of a door seal, with the present values of its parameters.

    Raises
    ------
    ValueError
        For another seal.
    """
    values.require(
        DOOR_SEAL in seal.description,
        "the seal was not made by door_seal, so it has no options of the door seal",
    )
    # options of the description, and parameters changed since
    options, changed = _read(seal.description[DOOR_SEAL]), dict(seal.changed)
    names = options.material.names
    # values of parameters over those that the seal was built with
    constants = {name: changed.pop(name) for name in names if name in changed}
    _, clearance = seal.description.get("clearances", {}).get(DOOR, (0.0, options.clearance))
    material = options.material.with_(**constants)
    return replace(options, material=material, clearance=clearance, **changed)


def with_options(seal: Seal, **changes) -> Seal:
    """Build a door seal again with some of its options changed.

    Raises
    ------
    TypeError, ValueError
        For another seal, and options that are unknown or not admissible.
    """
    options = options_of(seal)
    # rebuild from all options, so that the bounds are checked again
    own = {name: getattr(options, name) for name in DoorOptions.__dataclass_fields__}
    return door_seal(**{**own, **changes})


def described_door_seal(description: dict) -> Seal:
    """Build the door seal from a ``Seal.description``.

    Raises
    ------
    ValueError
        When it is not that of a door seal of this version.
    """
    try:
        return _built(_read(description[DOOR_SEAL]))
    except (TypeError, KeyError, RecursionError) as error:
        raise ValueError(
            "the recorded settings of a door seal are not valid in this version of seal_mdao: "
            f"{error}"
        ) from error


def _read(settings: dict) -> DoorOptions:
    """Read options from JSON values."""
    parts = {name: kind(**settings[name]) for name, kind in PARTS.items()}
    return door_options(**settings | parts)


def _built(options: DoorOptions) -> Seal:
    """Build the seal of options that have been checked."""
    section, grid, splines = options.section, options.grid, options.splines
    # X_0: particles on rays between the two nominal boundaries
    particles = grid.positions(section.inner(grid.angles), section.outer(grid.angles))
    body = _body(options, particles)
    # terms: elastic body, and contact with the door
    where = _contact_points(options, body)
    door = RigidContact(DOOR, where, options.shape, options.motion, options.law)
    seal = Seal(
        particles, design_velocity(splines, grid), body, (elastic_body(options.material), door),
        options.n_steps, STANDARD, ("door_radius",), newton=options.newton,
        further=(*FURTHER, *_reaction_curve(options)), parameters=_parameters(options),
        before_touch=options.start - section.outer_radius,
        section_area=splines.area,
        offset_limit=section.outer_radius - section.inner_radius,
    ).made_from({DOOR_SEAL: asdict(options)})  # fmt: skip
    # the radius is a changed parameter: measures select their points with the nominal door
    if options.door_radius is None:
        return seal
    return seal.with_parameters({"door_radius": options.door_radius})


def _parameters(options: DoorOptions) -> dict[str, Parameter]:
    """Describe the public parameters; those of the motion are zero at the nominal path."""
    # p = p_0 + change: waypoints count from zero
    zeros = {name: getattr(options, name) for name in ("depth", "door_shift", "door_angle")}
    # no term has the radius of the flat door
    if not options.shape.names:
        zeros["door_radius"] = options.nominal_door_radius
    bounds = options.bounds
    return {
        name: Parameter(units, text, zeros.get(name, 0.0), bounds.get(name, {}))
        for name, (units, text) in PARAMETERS.items()
    }


def _reaction_curve(options: DoorOptions) -> tuple:
    """Make the measure of the vertical force at those of ``CURVE_TRAVELS`` within the depth."""
    # travels beyond the depth have no force
    travels = tuple(travel for travel in CURVE_TRAVELS if travel <= options.depth)
    return (Reaction(DOOR, travels, (1,), name="reaction_curve"),) if travels else ()


def _body(options: DoorOptions, particles: np.ndarray) -> Body:
    grid = options.grid
    # both components of the particles on the base
    fixed = np.zeros((len(particles), 2), bool)
    fixed[grid.base] = True
    inner = grid.particle(np.arange(grid.rays), 0)
    # supports in units of the longest cell edge at a particle
    support = grid.along_cells(options.support)
    radius, axes = kernel_supports(grid.cells, particles, support)
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
        nominal=particles,
        basis_order=options.basis_order,
        n_gauss=grid.along_cells(options.n_gauss),
        column=grid.column(options.pressure),
    )


def _contact_points(options: DoorOptions, body: Body) -> MaterialPoints:
    """Make the contact points of the outer boundary."""
    grid, top = options.grid, options.layers - 1
    if options.contact_points == "edges":
        # one point in the middle of every side
        return edge_points(body.edge("outer").sides, 1)
    # tributary lengths reach half-way to the neighbours, at the ends to the base corners
    rays = grid.free_rays
    beside = np.column_stack([grid.particle(rays - 1, top), grid.particle(rays + 1, top)])
    if options.contact_points == "averages":
        return averaged_points(grid.free_outer, beside, body.nominal)
    return boundary_particles(grid.free_outer, beside)
