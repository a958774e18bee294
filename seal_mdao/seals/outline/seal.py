"""Build a seal from the boundary of any section."""

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import NamedTuple

import numpy as np

from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.contact.default_penalties import completed
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.geometry.motion import Motion
from seal_mdao.geometry.shape import Shape
from seal_mdao.loads.trapped_air import ADIABATIC, ATMOSPHERE, TrappedAir
from seal_mdao.rkpm.cells import kernel_supports
from seal_mdao.rkpm.visibility import hidden_pairs
from seal_mdao.seals.outline.cloud import OutlineCloud, cloud
from seal_mdao.seals.outline.cloud_file import GivenCloud
from seal_mdao.seals.outline.design import boundary_velocity, checked_names, stretches
from seal_mdao.seals.outline.extension import harmonic_extension
from seal_mdao.seals.outline.kernels import Kernels
from seal_mdao.seals.outline.layers import ENOUGH, thin_wall
from seal_mdao.seals.outline.rays import Rays, ray_cloud, through_wall
from seal_mdao.seals.outline.self_touch import SelfTouch
from seal_mdao.seals.seal import Seal
from seal_mdao.structure.elastic_body import ElasticBody, Region
from seal_mdao.terms.points import MaterialPoints, boundary_particles, edge_points


class EdgeContact(NamedTuple):
    """A rigid profile and the edges that may touch it.

    Attributes
    ----------
    label : str
    edges : tuple of str
    shape : Shape
    motion : Motion
    law : ContactLaw
    prefix : str
        Prefix of the names of its parameters.
    contact_points : {"particles", "edges"}
        Contact points of the edges: the free particles, or the midpoints of the straight sides between
        two particles.
    """

    label: str
    edges: tuple
    shape: Shape
    motion: Motion
    law: ContactLaw
    prefix: str = ""
    contact_points: str = "particles"

    def on(self, body: Body) -> RigidContact:
        """Build the contact term."""
        sides = np.concatenate([body.edge(name).sides for name in self.edges])
        at_edges = self.contact_points == "edges"
        where = edge_points(sides, 1) if at_edges else points_on(body, sides)
        return RigidContact(self.label, where, self.shape, self.motion, self.law, self.prefix)


class SealedHole(NamedTuple):
    """A sealed hole with trapped air.

    Attributes
    ----------
    label : str
    hole : int
        From 1, in the order of the boundaries.
    pressure, gamma : float
        As of ``TrappedAir``.
    """

    label: str
    hole: int
    pressure: float = ATMOSPHERE
    gamma: float = ADIABATIC

    def on(self, loops) -> TrappedAir:
        """Build the term."""
        return TrappedAir(self.label, loops[self.hole], self.pressure, self.gamma)


class SectionRegion(NamedTuple):
    """A part of the section with another material.

    Attributes
    ----------
    material : Isotropic
    at : pair of float
        A point of the part, mm.
    prefix : str
        Prefix of the names of the material's constants.
    """

    material: object
    at: tuple
    prefix: str = ""


@dataclass(frozen=True, eq=False)
class OutlineSeal(Seal):
    """A seal with a cloud built from its boundary.

    Attributes
    ----------
    loops : tuple of ndarray of int
        Boundary particles of every loop, which come first.
    spacing : float, Rays or GivenCloud
        Of its cloud, mm; or the rays that fill its wall; or the cloud itself.
    kernels : Kernels
        Of its cloud.
    cuts : tuple of ndarray
        Lines that divide the nominal section between materials, their corners (k, 2), mm.
    """

    loops: tuple = ()
    spacing: float | Rays | GivenCloud = 1.0
    kernels: Kernels = field(default_factory=Kernels)
    cuts: tuple = ()

    @cached_property
    def cautions(self) -> tuple[str, ...]:
        """Warning of a wall with too few layers of particles; those of rays are chosen by the user."""
        if isinstance(self.spacing, Rays):
            return ()
        wall = thin_wall(self.loops, self.drawn_particles, self.body.cells)
        if wall is None:
            return ()
        x, y = np.round(wall.place, 6) + 0.0
        return (
            f"the wall near x = {x:.3g}, y = {y:.3g} is {wall.thickness:.3g} mm thick and has about "
            f"{wall.layers} layers of particles across, fewer than {ENOUGH}: forces may be 10 % and "
            f"more too large; use more (layers = {ENOUGH} of [section]) or a smaller spacing",
        )

    @property
    def parts(self) -> np.ndarray:
        """Index of the material of every cell."""
        body = self.definitions[0]
        return body.per_cell(range(len(body.regions)), len(self.body.cells), int)


def outline_seal(
    boundaries, spacing: float | Rays | GivenCloud, material, *, n_steps: int, fixed=(), planes=(),
    contacts=(), sealed=(), touching: SelfTouch | None = None, fluids=(), terms=(), designs=(), cuts=(),
    regions=(), prefix: str = "", kernels: Kernels | None = None, standard=(), inputs=(),
    newton: NewtonOptions | None = None,
) -> OutlineSeal:  # fmt: skip
    """Build a seal from the boundary of its section.

    Parameters
    ----------
    boundaries : sequence of Boundary
        Outer contour, holes, outer contours of further bodies, as ``boundary.doubled`` returns them:
        points with edge names, arc length, tangents.
    spacing : float, Rays or GivenCloud
        Target distance of particles, mm; or rays through a wall, for ``rays.ray_boundaries``; or a cloud
        with its boundaries, whose parts are its own, not given by ``cuts``.
    material : Isotropic
    n_steps : int
        Number of nominal load steps, that of the motions.
    fixed : sequence of str
        Edges that are fixed.
    planes : sequence of (str, int)
        Edges that slide along their plane, and the fixed component normal to it.
    contacts : sequence of EdgeContact
    sealed : sequence of SealedHole
    touching : SelfTouch, optional
        Edges that may touch each other.
    fluids : sequence of EdgeFluid
    terms : sequence of EdgeTerm
        Further ones.
    designs : sequence of EdgeDesign
        Their parameters are the ``boundary_offsets``, mm along the nominal normals.
    cuts : sequence of ndarray, shape (k, 2)
        Lines between points of the boundary that divide bodies, mm.
    regions : sequence of SectionRegion
        Parts between cuts, and bodies, with a material other than ``material``.
    prefix : str
        Prefix of the names of the constants of ``material``.
    kernels : Kernels, optional
        If left out those of rays and of given clouds, else ``Kernels()``.
    standard, inputs, newton
        As of ``Seal``.

    Raises
    ------
    ValueError
        For names that no edge has.
    GeometryError
        For a boundary that cannot be filled.
    """
    known = stretches(boundaries)
    named = [(fixed, "fixed"), ([name for name, _ in planes], "planes")]
    named += [(contact.edges, f"profile {contact.label!r}") for contact in contacts]
    named += [(term.edges, term.label) for term in (touching, *fluids, *terms) if term is not None]
    for names, what in named:
        checked_names(names, known, what)
    # stretches index points of the loops; edges the particles of the cloud
    filled, inside = _filled(boundaries, spacing, cuts)
    edges = {
        name: Edge(filled.loops[stretch.loop][stretch.points], stretch.closed)
        for name, stretch in known.items()
    }
    if kernels is None:
        kernels = spacing.kernels if isinstance(spacing, Rays | GivenCloud) else Kernels()
    body = _body(filled, kernels, _prescribed(filled, edges, fixed, planes), edges)
    # design velocity V = dX/db: on the boundary by B-splines, extended to the inside
    velocity = inside(filled, boundary_velocity(boundaries, designs, fixed, planes))
    elastic = ElasticBody(_regions(filled, Region(material, None, prefix), regions))
    profiles = tuple(
        completed(contact.on(body), elastic, body, filled.particles) for contact in contacts
    )
    # order of the terms: structure, profiles, trapped air, self-contact, fluids
    loads = [*profiles, *(h.on(filled.loops) for h in sealed)]
    loads += [] if touching is None else [touching.on(body, filled.loops)]
    loads += [fluid.on(body, profiles, n_steps) for fluid in fluids]
    loads += [term.on(body) for term in terms]
    return OutlineSeal(
        filled.particles, velocity, body, (elastic, *loads), n_steps, tuple(standard), tuple(inputs),
        newton=newton or NewtonOptions(), loops=filled.loops, spacing=spacing, kernels=kernels,
        cuts=tuple(np.asarray(cut, float) for cut in cuts),
    )  # fmt: skip


def _prescribed(filled: OutlineCloud, edges, fixed, planes) -> np.ndarray:
    """Mark prescribed displacement components, shape (n, 2)."""
    # both components on fixed edges, the normal one on planes
    prescribed = np.zeros(filled.particles.shape, bool)
    for name in fixed:
        prescribed[edges[name].particles] = True
    for name, component in planes:
        prescribed[edges[name].particles, component] = True
    return prescribed


def _filled(boundaries, spacing, cuts):
    """Build the cloud, and the function that extends boundary velocities to all particles."""
    if isinstance(spacing, Rays):
        return ray_cloud(boundaries, spacing), partial(through_wall, rays=spacing)
    if isinstance(spacing, GivenCloud):
        return spacing.cloud, _inside
    return cloud([boundary.points for boundary in boundaries], spacing, cuts), _inside


def reseed(seal: OutlineSeal, offsets) -> OutlineSeal:
    """Rebuild the cloud of a seal for its present boundary.

    Parameters and their values keep their meaning: with the same offsets the boundary is the same,
    point by point, and the inside is new. Terms may refer to boundary particles only.

    Raises
    ------
    GeometryError
        For a boundary that cannot be filled.
    ValueError
        For a section of several materials, or one not filled by a spacing.
    """
    several = len(seal.definitions[0].regions) > 1
    if several or not isinstance(seal.spacing, int | float):
        raise ValueError(
            "only a section of one material that is filled by a spacing has other clouds"
        )
    offsets = seal.check_offsets(offsets)
    present = seal.particles(offsets)
    filled = cloud([present[loop] for loop in seal.loops], seal.spacing)
    n = filled.n_boundary
    # the boundary particles come first and keep their indices and fixed components
    prescribed = np.zeros(filled.particles.shape, bool)
    prescribed[:n] = seal.body.fixed[:n]
    velocity = _inside(filled, seal.design_velocity[:, :n])
    return replace(
        seal,
        # nominal particles such that X = X_0 + sum_p b_p V_p is the new cloud at the present offsets b
        drawn_particles=filled.particles - np.tensordot(offsets, velocity, 1),
        design_velocity=velocity,
        body=_body(filled, seal.kernels, prescribed, seal.body.edges),
    )


def points_on(body: Body, sides) -> MaterialPoints:
    """Return the free particles of boundary sides (m, 2) as contact points with tributary lengths."""
    which = np.array(list(dict.fromkeys(sides.ravel().tolist())), int)
    # particles before and after; a particle itself where it has no side
    neighbours = np.column_stack([np.arange(body.n_particles)] * 2)
    neighbours[sides[:, 1], 0] = sides[:, 0]
    neighbours[sides[:, 0], 1] = sides[:, 1]
    movable = which[~body.fixed[which].all(axis=1)]
    return boundary_particles(movable, neighbours[movable])


def _regions(filled: OutlineCloud, rest: Region, regions) -> tuple:
    """Build the regions of cells; ``rest`` is that of all cells in no other."""
    parts = [_part_at(filled, region.at) for region in regions]
    for i, part in enumerate(parts):
        if part in parts[:i]:
            raise ValueError(
                f"at = ({regions[i].at[0]:.4g}, {regions[i].at[1]:.4g}) is in the part of the section "
                f"in which ({regions[parts.index(part)].at[0]:.4g}, "
                f"{regions[parts.index(part)].at[1]:.4g}) is"
            )
    found = tuple(
        Region(region.material, np.flatnonzero(filled.parts == part), region.prefix)
        for region, part in zip(regions, parts, strict=True)
    )
    if not found:
        return (rest,)
    others = np.flatnonzero(~np.isin(filled.parts, parts))
    if not others.size:
        raise ValueError("every part of the section is in a region; leave one to its own material")
    return (rest._replace(cells=others), *found)


def _part_at(filled: OutlineCloud, point) -> int:
    """Find the part of the section that contains a point."""
    corners = filled.particles[filled.cells]
    side, to = np.roll(corners, -1, axis=1) - corners, np.asarray(point, float) - corners
    # inside a convex counter-clockwise cell: on the left of all its sides, s x (p - a) >= 0
    inside = (side[..., 0] * to[..., 1] - side[..., 1] * to[..., 0] >= 0.0).all(axis=1)
    if not inside.any():
        raise ValueError(f"at = ({point[0]:.4g}, {point[1]:.4g}) is outside of the section")
    return int(filled.parts[np.flatnonzero(inside)[0]])


def _body(filled: OutlineCloud, kernels: Kernels, prescribed, edges) -> Body:
    # kernels are chosen for the nominal particles, and stay the same in all designs
    cells, nominal = filled.cells, filled.first_places
    nominal = filled.particles if nominal is None else nominal
    radius, axes = filled.support_radius, filled.support_axes
    if radius is None:
        radius, axes = kernel_supports(cells, nominal, kernels.support)
    return Body(
        cells, radius, prescribed, edges, drawn=nominal,
        hidden=hidden_pairs(cells, nominal, radius),
        support_axes=axes, basis_order=kernels.basis_order, column=kernels.column,
        n_gauss=kernels.n_gauss,
    )  # fmt: skip


def _inside(filled: OutlineCloud, velocity: np.ndarray) -> np.ndarray:
    """Extend the boundary velocity (P, k, 2) harmonically to all particles (P, n, 2)."""
    boundary = np.concatenate(filled.loops)
    return harmonic_extension(filled.cells, filled.particles, boundary, velocity)
