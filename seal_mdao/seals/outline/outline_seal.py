"""Build a seal from the boundary of any section."""

from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from seal_mdao.contact.default_penalties import completed
from seal_mdao.contact.rigid_contact import RigidContact
from seal_mdao.equilibrium.discretization import Body, Edge
from seal_mdao.loads.moved_edges import ImposedMotions, MovedEdges
from seal_mdao.materials.isotropic import Isotropic
from seal_mdao.materials.ogden_roxburgh import OgdenRoxburgh
from seal_mdao.materials.viscoelastic import PronySeries
from seal_mdao.rkpm.axisymmetry import zero_radius
from seal_mdao.rkpm.cells import bodies, kernel_supports
from seal_mdao.rkpm.visibility import hidden_pairs
from seal_mdao.seals.outline.boundary_path import stretches
from seal_mdao.seals.outline.design import (
    boundary_velocity,
    checked_names,
    harmonic_extension,
)
from seal_mdao.seals.outline.layers import ENOUGH, thin_wall
from seal_mdao.seals.outline.rays import Rays, ray_cloud, through_wall
from seal_mdao.seals.outline.sampling import MATCH
from seal_mdao.seals.outline.section_body import SectionBody
from seal_mdao.seals.outline.section_cloud import Kernels, OutlineCloud, cloud
from seal_mdao.seals.outline.sizes import unusual_size, unusual_stages
from seal_mdao.seals.outline.unusual_values import unusual_values
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.seal import Seal
from seal_mdao.structure.elastic_body import ElasticBody
from seal_mdao.structure.environment import Environment, Growth
from seal_mdao.structure.region import Region

NONE = MappingProxyType({})
"""No edge is supported, or designed."""


class SectionRegion(NamedTuple):
    """A part of the section with its own material.

    Attributes
    ----------
    material : Isotropic
    prefix : str
        Prefix of the names of the material's constants.
    at : pair of float, or None
        A point of the part, mm; None for all that is in no other region.
    lines : tuple of ndarray, shape (k, 2)
        Between two points of the boundary each, along which the section is divided, mm.
    growth : Growth
        By heat and swelling, where there is an environment.
    density : float or None
        kg/m^3; the measure ``mass`` alone needs it.
    prony : PronySeries or None
        Relaxation; the environment knows the time then.
    softening : OgdenRoxburgh or None
        Softening by the largest energy so far.
    """

    material: object
    prefix: str = ""
    at: tuple | None = None
    lines: tuple = ()
    growth: Growth = Growth()
    density: float | None = None
    prony: PronySeries | None = None
    softening: OgdenRoxburgh | None = None

    def on(self, cells) -> Region:
        """Make the region of these cells, None for all of them."""
        return Region(
            self.material, cells, self.prefix, self.growth, self.density, self.prony, self.softening
        )


class BodyModel(NamedTuple):
    """How the body of a section is modelled.

    Attributes
    ----------
    axisymmetric : bool
        Whether the section is turned about the axis x = 0, in place of plane strain.
    environment : Environment or None
        Axial stretch and temperature along the path.
    kernels : Kernels or None
        None for those of rays and of given clouds, else ``Kernels()``.
    """

    axisymmetric: bool = False
    environment: Environment | None = None
    kernels: Kernels | None = None


PLANE_STRAIN = BodyModel()


@dataclass(frozen=True, eq=False, repr=False)
class OutlineSeal(Seal):
    """A seal with a cloud built from its boundary.

    Attributes
    ----------
    loops : tuple of ndarray of int
        Boundary particles of every loop, which come first.
    spacing : float, Rays or OutlineCloud
        Of its cloud, mm; or the rays that fill its wall; or the cloud itself.
    kernels : Kernels
        Of its cloud.
    cuts : tuple of ndarray
        Lines that divide the nominal section between materials, their corners (k, 2), mm.
    design_sizes : tuple of int
        Number of parameters of every design.
    boundaries : tuple of Boundary
        Points of the nominal boundary, those of ``loops``.
    """

    clear_designs = True

    loops: tuple = ()
    spacing: float | Rays | OutlineCloud = 1.0
    kernels: Kernels = field(default_factory=Kernels)
    cuts: tuple = ()
    design_sizes: tuple = ()
    boundaries: tuple = ()

    @cached_property
    def warnings(self) -> tuple[str, ...]:
        """Warnings about an unusual size or displacement, material values far from those of rubber, and
        walls with too few layers of particles; layers of ``rays`` are chosen by the user."""
        extent = np.ptp(self.nominal_particles, axis=0)
        size = unusual_size(extent)
        far = [
            text for own in contacts(self) for text in unusual_stages(own.label, own.motion, extent)
        ]
        # with the changed parameters
        unusual = unusual_values(self._terms[0])
        return (
            *super().warnings, *([size] if size else []), *far, *unusual, *self._few_layers(),
        )  # fmt: skip

    def _few_layers(self) -> tuple[str, ...]:
        if isinstance(self.spacing, Rays):
            return ()
        wall = thin_wall(self.loops, self.nominal_particles, self.body.cells)
        if wall is None:
            return ()
        # no -0 in the message
        x, y = np.round(wall.place, 6) + 0.0
        return (
            f"the wall near x = {x:.3g}, y = {y:.3g} is {wall.thickness:.3g} mm thick and has "
            f"about {wall.layers} layers of particles across, fewer than {ENOUGH}: forces may be "
            "too large by 10 % or more, and stresses too small by 20 % or more; use more layers "
            f"(layers = {ENOUGH} in [section]) or a smaller spacing, and for stresses compare with "
            f"twice as many cells across (layers = {2 * ENOUGH - 1})",
        )

    @property
    def parts(self) -> np.ndarray:
        """Index of the material of every cell."""
        return _parts(self.definitions[0], self.body.cells)


def outline_seal(
    boundaries, spacing: float | Rays | OutlineCloud, material, *, n_steps: int, supports=NONE,
    contributions=(), designs=(), model: BodyModel = PLANE_STRAIN,
) -> OutlineSeal:  # fmt: skip
    """Build a seal from the boundary of its section.

    Parameters
    ----------
    boundaries : sequence of Boundary
        Outer contour, holes, outer contours of further bodies, as ``sampling.doubled`` returns them:
        points with edge names, arc length, tangents.
    spacing : float, Rays or OutlineCloud
        Target distance of particles, mm; or rays through a wall, for ``rays.ray_boundaries``; or a cloud
        with its boundaries, whose parts are its own, not given by lines of regions.
    material : Isotropic, or sequence of SectionRegion
        One of the regions is that of the rest, with ``at = None``.
    n_steps : int
        Number of nominal load steps, that of the motions.
    supports : mapping of str to tuple of int
        Prescribed displacement components of edges: (0, 1) fixed; (0,) or (1,) in a plane across x or y,
        in which a design keeps them.
    contributions : sequence of callable
        Functions of the ``SectionBody``, which return the definitions of further terms than the body's:
        contacts before fluids, which they keep out; or ``MovedEdges`` of edges among the supports.
    designs : sequence of OffsetDesign, VertexDesign or RadiusDesign
        What may change about the shape; their parameters are the ``boundary_offsets``, mm.
    model : BodyModel, optional
        Kinematics, environment and kernels.

    Raises
    ------
    ValueError
        For names that no edge has.
    GeometryError
        For a boundary that cannot be filled.
    """
    known = stretches(boundaries)
    checked_names(supports, known, "supports: ")
    regions = [SectionRegion(material)] if isinstance(material, Isotropic) else material
    cuts = tuple(np.asarray(line, float) for own in regions for line in own.lines)
    # stretches index points of the loops; edges the particles of the cloud
    filled, extend = _filled(boundaries, spacing, cuts)
    edges = {
        name: Edge(filled.loops[stretch.loop][stretch.points], stretch.closed)
        for name, stretch in known.items()
    }
    kernels = model.kernels
    if kernels is None:
        kernels = spacing.kernels if isinstance(spacing, Rays | OutlineCloud) else Kernels()
    if model.axisymmetric:
        filled = _on_axis(filled)
    # both components of fixed edges are prescribed, the normal one of edges in a plane
    prescribed = np.zeros(filled.particles.shape, bool)
    for name, components in supports.items():
        prescribed[np.ix_(edges[name].particles, components)] = True
    given = isinstance(spacing, OutlineCloud)
    elastic = ElasticBody(_regions(filled, regions, given), model.environment)
    parts = None
    # a part of one layer of cells has too few particles for the quadratic basis
    if len(elastic.regions) > 1 and kernels.basis_order == 1:
        parts = _parts(elastic, filled.cells)
    body = _body(filled, kernels, prescribed, edges, model.axisymmetric, parts)
    # design velocity V = dX/db: on the boundary by the designs, extended to the inside
    on_boundary, sizes = boundary_velocity(boundaries, designs, supports)
    velocity = extend(filled, on_boundary)
    terms, moved, section = [elastic], [], SectionBody(body, filled.loops, n_steps)
    for bind in contributions:
        made = bind(section)
        # motions of edges are prescribed displacements, all others terms
        if isinstance(made, MovedEdges):
            moved.append(made)
            continue
        terms.append(completed(made, elastic, body, filled.particles))
        # fluids act behind the contacts that were bound before them
        bound = tuple(term for term in terms if isinstance(term, RigidContact))
        section = section._replace(contacts=bound)
    return OutlineSeal(
        filled.particles, velocity, body, tuple(terms), n_steps, loops=filled.loops, spacing=spacing,
        kernels=kernels, cuts=cuts, design_sizes=sizes, boundaries=tuple(boundaries),
        imposed_displacements=ImposedMotions(tuple(moved)) if moved else None,
    )  # fmt: skip


def _on_axis(filled: OutlineCloud) -> OutlineCloud:
    """Set the radii of particles at the axis, which rounding, such as that of a mesh file, leaves beside
    it, to zero."""
    particles = filled.particles.copy()
    radii = particles[:, 0]
    radii[np.abs(radii) <= max(zero_radius(particles), MATCH)] = 0.0
    return replace(filled, particles=particles)


def _filled(boundaries, spacing, cuts):
    """Build the cloud, and the function that extends boundary velocities to all particles."""
    # radial rows: linear across the wall; all other clouds: harmonic
    if isinstance(spacing, Rays):
        return ray_cloud(boundaries, spacing), partial(through_wall, rays=spacing)
    if isinstance(spacing, OutlineCloud):
        return spacing, _inside
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
    # parts of several materials, rays and given clouds cannot be filled by a spacing alone
    several = len(seal.definitions[0].regions) > 1
    if several or not isinstance(seal.spacing, int | float):
        raise ValueError(
            "new particles can be generated only for a section with a single material and the key "
            "spacing"
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
        nominal_particles=filled.particles - np.tensordot(offsets, velocity, 1),
        design_velocity=velocity,
        body=_body(filled, seal.kernels, prescribed, seal.body.edges, seal.body.axisymmetric),
    )


def _regions(filled: OutlineCloud, regions, given: bool) -> tuple:
    """Find the cells of every region, first of that of the rest; ``given`` if the cloud is that of a
    file."""
    rest, *others = sorted(regions, key=lambda region: region.at is not None)
    if not others:
        return (rest.on(None),)
    parts = [filled.part_at(region.at) for region in others]
    for i, part in enumerate(parts):
        if part in parts[:i]:
            one, other = others[i].at, others[parts.index(part)].at
            raise ValueError(
                f"the points at = ({one[0]:.4g}, {one[1]:.4g}) and at = ({other[0]:.4g}, "
                f"{other[1]:.4g}) of two regions lie in the same part of the section; every "
                "[[section.region]] must be a different part"
            )
    # cells of no other region belong to the rest
    remaining = np.flatnonzero(~np.isin(filled.parts, parts))
    undivided = filled.parts.max() == bodies(filled.cells, len(filled.particles)).max()
    if not remaining.size and undivided and given:
        raise ValueError(
            "the cells of the mesh (cloud) are not divided between [section] and [[section.region]]; "
            "give the mesh cell data 'part', one number for each part of the section"
        )
    if not remaining.size and undivided and any(region.lines for region in regions):
        raise ValueError(
            "the lines of [[section.region]] do not divide the section, so that all of it is in a "
            "region; a line that ends at a hole must continue on the other side of this hole"
        )
    if not remaining.size:
        raise ValueError(
            "every part of the section is in a [[section.region]]; remove one region, so that this "
            "part has the material of [section]"
        )
    cells = [remaining, *(np.flatnonzero(filled.parts == part) for part in parts)]
    return tuple(region.on(own) for region, own in zip((rest, *others), cells, strict=True))


def _parts(elastic: ElasticBody, cells) -> np.ndarray:
    """Find the index of the region of every cell."""
    return elastic.per_cell(range(len(elastic.regions)), len(cells), int)


def _body(
    filled: OutlineCloud, kernels: Kernels, prescribed, edges, axisymmetric: bool, parts=None
) -> Body:
    # kernels are chosen for the nominal particles, and stay the same in all designs
    cells, nominal = filled.cells, filled.first_indices
    nominal = filled.particles if nominal is None else nominal
    radius, axes = filled.support_radius, filled.support_axes
    if radius is None:
        radius, axes = kernel_supports(cells, nominal, kernels.support)
    return Body(
        cells, radius, prescribed, edges, nominal=nominal,
        hidden_pairs=hidden_pairs(cells, nominal, radius, parts),
        parts=parts,
        support_axes=axes, basis_order=kernels.basis_order, column=kernels.column,
        n_gauss=kernels.n_gauss, axisymmetric=axisymmetric,
    )  # fmt: skip


def _inside(filled: OutlineCloud, velocity: np.ndarray) -> np.ndarray:
    """Extend the boundary velocity (P, k, 2) harmonically to all particles (P, n, 2)."""
    boundary = np.concatenate(filled.loops)
    return harmonic_extension(filled.cells, filled.particles, boundary, velocity)
