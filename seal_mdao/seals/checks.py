"""Checks of the state at the end of a completed load path: equilibrium alone does not make it
admissible.

The model has no contact of the seal with itself unless it is asked for, and contact with rigid profiles
at the contact points only; volume changes are projected on background cells. A state for which one of
these matters is reported; one that is not admissible (``Finding.impossible``) is no result for an
optimisation.
"""

from dataclasses import dataclass, field
from weakref import WeakKeyDictionary

import numpy as np

from seal_mdao.analysis.path_result import PathResult
from seal_mdao.contact.rigid_contact import ContactTerm
from seal_mdao.contact.self_contact import SelfContactTerm
from seal_mdao.loads.fluid_pressure import FluidPressureTerm
from seal_mdao.measures.singular_points import REENTRANT_CORNER
from seal_mdao.rkpm.axisymmetry import zero_radius
from seal_mdao.seals.arbitrary_side import arbitrary_side
from seal_mdao.seals.contact_loss import contact_losses, untouched_profiles
from seal_mdao.seals.creases import creases
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.local_states import (
    CURE,
    LEAVE_OUT,
    ends_of_bonds,
    meaningless_states,
    section_singular_points,
)
from seal_mdao.seals.lost_bodies import lost_bodies
from seal_mdao.seals.missing_contact import buried_edges, same_profiles
from seal_mdao.seals.overlap import crossings, overlap_depths
from seal_mdao.values import place as _at

SLIGHT, DEEP = 0.01, 0.1
"""Fractions of the wall's thickness above which an overlap is reported, and is not admissible."""
CROSSED = 0.005
"""Fraction of the wall's thickness above which local values mean nothing where a boundary is crossed.
Up to ``DEEP`` the missing contact changes the force of a bulb by less than half a percent."""
MISSED = 0.02
"""Fraction of the wall's thickness by which an edge without contact may lie inside a profile."""
SHALLOW_VOLUME, NO_VOLUME = 0.5, 0.1
"""det F of nearly incompressible material below which it is reported, and is not admissible."""
SOLID_VOLUME = 0.2
"""det F of compressible material below which it is reported: less than the rubber in a light foam
takes up. Largest stresses agree under refinement above 0.3, and differ by factors below 0.1."""
AT_CORNER = 3.0
"""Distance from a re-entrant corner, in spacings there, within which it inverts material."""
OPEN_BALANCE, NO_BALANCE = 1e-6, 1e-2
"""Residual over the largest forces of the path above which it is reported, and is not admissible."""
FEW_CELLS = 0.01
"""Fraction of the cells of a material that may be strained beyond its range: corners."""


@dataclass(frozen=True)
class Finding:
    """Fault of the state at the end of a load path.

    Attributes
    ----------
    text : str
        One line: fault, location, size, and advice.
    impossible : bool
        The state is not admissible, so its measures are no result.
    meaningless : bool
        Local values, such as the largest stress, mean nothing.
    place : ndarray, shape (2,), or None
        Undeformed point at which the stress means nothing, where that holds at one point, mm.
    """

    text: str
    impossible: bool
    meaningless: bool = False
    place: np.ndarray | None = field(default=None, compare=False)


_KNOWN = WeakKeyDictionary()


def findings(path: PathResult) -> tuple[Finding, ...]:
    """Find the faults of the state at the end of a completed load path; the result is cached."""
    # cached as long as the path exists
    if path not in _KNOWN:
        samples = EvaluationPoints(path)
        checks = (
            _crossing, _axis, _balance, _stability, _volume, _local, _inside_profiles,
            _inside_itself, _below_base, _contact_loss, _fluids, _strains, _creases, _side, _lost,
        )  # fmt: skip
        _KNOWN[path] = tuple(found for check in checks for found in check(samples))
    return _KNOWN[path]


def _forces(step) -> float:
    """Compute the largest norm of the forces of a term, 0 where there are none."""
    return max(
        (float(np.linalg.norm(r.force)) for r in step.responses if hasattr(r, "force")), default=0.0
    )


def _balance(samples: EvaluationPoints):
    """Report steps at which rounding ended the iterations far from equilibrium."""
    path = samples.path
    forces = np.array([_forces(step) for step in path.steps])
    left = np.array([step.residuals[-1] for step in path.steps])
    # a section that expands freely is in equilibrium: its forces are rounding errors
    largest = forces.max(initial=0.0)
    if largest <= path.least_force:
        return
    # |r| / max |f| over the path in place of |r| / |f| of the step
    left = left * forces / largest
    # negated comparisons report NaN as well
    worst = int(left.argmax())
    if not left[worst] <= OPEN_BALANCE:
        yield Finding(
            f"forces are in equilibrium only to a relative residual of {left[worst]:.1g} in the "
            f"load step that ends at {path.steps[worst].fraction:.4g} (number of the step): "
            "rounding errors or a large tolerance ended the iterations; use material moduli of "
            "similar magnitude and the default tolerance",
            not left[worst] <= NO_BALANCE,
        )


def _stability(samples: EvaluationPoints):
    """Report an unstable equilibrium at the end."""
    path = samples.path
    # stable: positive definite tangent at the end
    if path.steps[-1].stable:
        return
    # symmetric tangent: a negative eigenvalue means instability
    if path.problem.symmetric:
        # critical point of a potential energy
        text = (
            "the equilibrium at the end of the analysis is not stable: the seal would snap to "
            'another equilibrium; follow the stable branch (branch="stable" of NewtonOptions)'
        )
    else:
        # with friction the sign of det K only suggests it
        text = (
            "the equilibrium at the end of the analysis may not be stable, because the determinant "
            "of the tangent stiffness is negative; compare with slightly more travel or other "
            "friction"
        )
    yield Finding(text, False)


def _contact_loss(samples: EvaluationPoints):
    """Report profiles that the seal has slipped off before the end of a closing stage, and those that it
    never touches."""
    for text in (*contact_losses(samples.path), *untouched_profiles(samples.path)):
        yield Finding(text, False)


def _fluids(samples: EvaluationPoints):
    """Report a fluid that acts nowhere, or that passes all profiles at its edge, and two that act on one
    part of the boundary."""
    path, wet = samples.path, {}
    at_end = path.steps[-1].fraction
    for term in path.problem.terms:
        if not isinstance(term, FluidPressureTerm) or term.pressure_at(at_end) == 0.0:
            continue
        weight, closing = path.responses(term.label)[-1].outputs.T
        # w = 0 at every particle of the edge
        if not weight.any():
            yield Finding(
                f"the fluid {term.label!r} has no effect: the contact pressure of a profile stops it "
                "at the end of its edge from which it comes; begin its edges (edge) with the free "
                "edge on the wet side, or change the end (from)",
                False,
            )
        # w > 0 at the last particle of an edge that a contact should close
        elif term.closings and weight[-1] > 0.0:
            yield Finding(
                f"the fluid {term.label!r} passes the contact and acts on its complete edge: a pressure "
                f"of {term.pressure_at(at_end):.4g} kPa needs a contact pressure of "
                f"{1.0 + term.share:.4g} times as much, and the largest one there is "
                f"{closing.max():.4g} kPa; forces and stresses are those of a leaking seal, and the "
                "measure blow_off_pressure is the pressure that it retains",
                False,
            )
        # particles of the edge under the complete pressure
        particles = term.particles[weight == 1.0]
        for label, others in wet.items():
            both = np.intersect1d(particles, others)
            if len(both) > 1:
                yield Finding(
                    f"the fluids {label!r} and {term.label!r} both act on the boundary near "
                    f"{_at(path.discretization.particles[both[0]])} (undeformed coordinates), where "
                    "their pressures add up; let every part of the boundary be an edge of one fluid "
                    "only, for example by dividing the edge between two leak paths",
                    False,
                )
        wet[term.label] = particles


def _creases(samples: EvaluationPoints):
    """Report a free surface beyond the onset of creases."""
    text = creases(samples)
    if text:
        yield Finding(text, False)


def _lost(samples: EvaluationPoints):
    """Report bodies that nothing holds."""
    for text in lost_bodies(samples.path):
        yield Finding(text, True)


def _side(samples: EvaluationPoints):
    """Report a symmetric section that has buckled to one side."""
    text = arbitrary_side(samples.path)
    if text:
        yield Finding(text, False)


def _strains(samples: EvaluationPoints):
    """Report materials that are strained beyond the range for which their constants are known."""
    cells = samples.path.discretization.body.cells
    for number, region in enumerate(samples.material_regions):
        valid = region.material.valid
        if valid is None:
            continue
        own = np.arange(len(cells)) if region.cells is None else region.cells
        # elastic stretches, without thermal expansion and swelling
        least, largest = samples.cell_stretches[own].T / samples.growth(region)
        outside = (least < valid[0]) | (largest > valid[1])
        if outside.mean() <= FEW_CELLS:
            continue
        # the cell that is farthest beyond the range
        worst = int(np.maximum(valid[0] / least, largest / valid[1]).argmax())
        place = samples.undeformed[cells[own[worst]]].mean(axis=0)
        name = _name_of(samples, number)
        yield Finding(
            f"{100.0 * outside.mean():.2g} % of the cells of the material{name} are strained "
            f"beyond the range of its constants (stretches {valid[0]:g} to {valid[1]:g}): "
            f"{least[worst]:.3g} to {largest[worst]:.3g} near {_at(place)}; use constants fitted "
            "to tests that cover this range",
            False,
        )


def _volume(samples: EvaluationPoints):
    """Report inverted material, and material that has lost more volume than it can."""
    change = samples.volume_change
    # det F; NaN counts as the least
    least = np.where(np.isnan(change), -np.inf, change)
    # the exact strain is infinite at the end of a bond: refinement inverts more of it
    kinds = ends_of_bonds(samples, samples.undeformed)
    beside = kinds != ""
    for number in range(len(samples.material_regions)):
        own, (slight, none) = samples.regions == number, _least_volumes(samples, number)
        name = _name_of(samples, number)
        corner = least[own & beside].min(initial=np.inf)
        if not corner > slight:
            worst = int(np.flatnonzero(own & beside & (least == corner))[0])
            yield Finding(
                f"material{name} is {_squeezed(corner)} at {kinds[worst]}: det F = {corner:.2g} "
                f"(volume ratio) at {_at(samples.undeformed[worst])} (undeformed "
                f"coordinates); this hardly changes the forces, but {LEAVE_OUT}",
                False,
                meaningless=True,
                place=samples.undeformed[worst],
            )
        inside = own & ~beside
        if not least[inside].min(initial=np.inf) > slight:
            worst = int(np.argmin(np.where(inside, least, np.inf)))
            yield Finding(
                f"material{name} is {_squeezed(change[worst])} between the quadrature points: det F = "
                f"{change[worst]:.2g} at {_at(samples.undeformed[worst])} (undeformed coordinates), so "
                f"the stress there is meaningless; {CURE}",
                not change[worst] > none,
                meaningless=True,
                place=samples.undeformed[worst],
            )


def _least_volumes(samples: EvaluationPoints, number: int) -> tuple[float, float]:
    """Return det F of a region below which it is reported, and is not admissible."""
    return (SHALLOW_VOLUME, NO_VOLUME) if samples.keeps_volume[number] else (SOLID_VOLUME, 0.0)


def _name_of(samples: EvaluationPoints, number: int) -> str:
    """Return the name of a region's material in quotes after a space; empty if it is the only one."""
    name = samples.material_regions[number].name
    return f" {name!r}" if name else ""


def squeezed_corner(samples: EvaluationPoints) -> str:
    """Describe the re-entrant corner, such as the vertex of a notch, at which material is compressed
    most at the last converged step of a path; empty where it is not compressed beyond what is reported.
    """
    slight = [_least_volumes(samples, number)[0] for number in range(len(samples.material_regions))]
    # points that are not below the threshold of their own material do not count
    change = samples.volume_change
    reported = np.where(change < np.array(slight)[samples.regions], change, np.inf)
    least, text = np.inf, ""
    for corner in section_singular_points(samples.path):
        if corner.kind != REENTRANT_CORNER:
            continue
        away = np.hypot(*(samples.undeformed - corner.place).T)
        near = np.where(away <= AT_CORNER * corner.spacing, reported, np.inf)
        worst = int(near.argmin())
        if (change := near[worst]) < least:
            least, name = change, _name_of(samples, samples.regions[worst])
            text = (
                f"material{name} is {_squeezed(change)} at the re-entrant corner at "
                f"{_at(corner.place)} (undeformed coordinates): det F = {change:.2g}; round this "
                "corner (at the vertex of a notch smaller particle spacings do not help)"
            )
    return text


def _squeezed(change: float) -> str:
    """Describe a det F; at most 0 or NaN is inverted, in any material."""
    return "compressed" if change > 0.0 else "inverted"


def _local(samples: EvaluationPoints):
    """Report stretches and stresses at single points that no rubber has."""
    for text, place in meaningless_states(samples):
        yield Finding(text, False, meaningless=True, place=place)


def _crossing(samples: EvaluationPoints):
    """Report boundaries that cross: where there is no contact between them, or deeper than the
    penetration of its penalty."""
    segments, pairs, sides, touching = _crossed(samples)
    if len(pairs):
        # deepest overlap
        x = samples.places
        depth = overlap_depths(x, segments, pairs)
        worst = int(depth.argmax())
        place = x[segments[pairs[worst]]].mean(axis=(0, 1))
        yield Finding(
            f"the boundary crosses itself near {_at(place)} by {depth[worst]:.2g} mm, "
            f"{100.0 * depth[worst] / samples.wall:.2g} % of the wall thickness: "
            + _crossing_cure(samples, sides, touching, worst),
            bool(depth[worst] > DEEP * samples.wall),
            meaningless=bool(depth[worst] > CROSSED * samples.wall),
        )


def crosses_itself(path: PathResult) -> bool:
    """Return whether the boundary crosses itself at the end of a path, beyond the penetration of a
    contact."""
    return len(_crossed(EvaluationPoints(path))[1]) > 0


def _crossed(samples: EvaluationPoints) -> tuple:
    """Find the parts of sides (s, 2) of all boundaries, the pairs (c, 2) of them that cross deeper than
    a contact between them permits, the outer sides of these pairs (c, 2), and whether there is contact
    between them (c,)."""
    # sides of all boundaries as pairs of samples
    chains = samples.chains
    segments = np.stack([chains[:, :-1], chains[:, 1:]], axis=2).reshape(-1, 2)
    pairs, depth = crossings(samples.places, segments)
    # sides in contact may overlap by the penetration of the penalty
    sides = pairs // (chains.shape[1] - 1)
    allowed, touching = _allowed_depth(samples, sides)
    # negated: NaN is no depth either
    deeper = ~(depth <= allowed)
    return segments, pairs[deeper], sides[deeper], touching[deeper]


def _crossing_cure(samples: EvaluationPoints, sides, touching, worst: int) -> str:
    """Name the edges that cross at the deepest overlap, and say what to do: contact between all edges
    that cross without it, a stiffer contact where there is one, or a rounder corner where it leaves out
    neighbours."""
    # names of the edges of both sides, at the deepest overlap and wherever there is no contact
    crossed = _edges_of(samples, sides[worst])
    match crossed:
        case []:
            which = "the parts of the boundary there"
        case [edge]:
            which = f"parts of the edge {edge!r}"
        case [edge, other]:
            which = f"the edges {edge!r} and {other!r}"
    if touching[worst]:
        return (
            f"the self-contact between {which} does not prevent it; use a larger penalty of "
            "[self_contact], a smaller particle spacing on these edges (edge_spacing of [section]), "
            "or less travel"
        )
    known = [
        name
        for name, edge in samples.path.discretization.body.edges.items()
        for term in _contacts_with_itself(samples)
        if np.isin(edge.particles, term.where.of_particles).all()
    ]
    # in contact with each other, but for points that are neighbours along the boundary
    listed_pairs = any(term.pair_of is not None for term in _contacts_with_itself(samples))
    if crossed and set(crossed) <= set(known) and not listed_pairs:
        return (
            f"the self-contact between {which} leaves out points that are close to each other along "
            "the boundary, as at the vertex of a notch; round the corner there, use a smaller particle "
            "spacing on these edges (edge_spacing of [section]), or less travel"
        )
    missing = [name for pair in sides[~touching] for name in _edges_of(samples, pair)]
    listed = ", ".join(f'"{name}"' for name in dict.fromkeys([*known, *missing]))
    return (
        f"no self-contact is defined between {which}; use [self_contact] edges = [{listed}] to "
        "define it, or less travel"
    )


def _edges_of(samples: EvaluationPoints, sides: np.ndarray) -> list[str]:
    """List the edges that two outer sides belong to."""
    edges = samples.path.discretization.body.edges.items()
    names = {frozenset(side): name for name, edge in edges for side in edge.sides.tolist()}
    found = [names.get(frozenset(side)) for side in samples.sides[0][sides].tolist()]
    return [name for name in dict.fromkeys(found) if name is not None]


def _allowed_depth(samples: EvaluationPoints, sides: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Compute the depth by which pairs of sides (c, 2) may cross, shape (c,), mm: 0 without contact;
    and whether there is contact between them, shape (c,)."""
    ends, found = samples.sides[0][sides], np.zeros(len(sides))
    touching = np.zeros(len(sides), bool)
    for term in _contacts_with_itself(samples):
        # first and last point at every particle, two at a sharp corner; -1 elsewhere
        points = np.full((samples.path.discretization.body.n_particles, 2), -1)
        own = term.where.of_particles
        points[own, 1] = np.arange(len(own))
        points[own[::-1], 0] = np.arange(len(own))[::-1]
        # of both sides of a pair the points at both ends; there may be no pair
        one, other = np.moveaxis(points[ends].reshape(len(ends), 2, 2 * points.shape[1]), 1, 0)
        one, other = one[:, :, None], other[:, None, :]
        # any end of one side may touch any end of the other
        touch = (term.allowed[one, other] & (one >= 0) & (other >= 0)).any(axis=(1, 2))
        deepest = -term.gaps(samples.path.responses(term.label)[-1].x)[1].min(initial=0.0)
        found[touch] = max(deepest, SLIGHT * samples.wall)
        touching |= touch
    return found, touching


def _contacts_with_itself(samples: EvaluationPoints):
    return [term for term in samples.path.problem.terms if isinstance(term, SelfContactTerm)]


def _inside_itself(samples: EvaluationPoints):
    """Report the penetration of walls in contact."""
    for term in _contacts_with_itself(samples):
        x = samples.path.responses(term.label)[-1].x
        # largest penetration -min g_n between walls
        points, gap = term.gaps(x)
        size, whose = _smaller_of_wall_and_squeeze(samples)
        if gap.min(initial=0.0) < -SLIGHT * size:
            place, depth = x[points[gap.argmin()]], -gap.min()
            yield Finding(
                f"walls of the seal lie {depth:.3g} mm inside each other near {_at(place)}, "
                f"{100.0 * depth / size:.2g} % of {whose}: the penalty of the contact "
                f"{term.label!r} is too small; use a larger penalty or less travel",
                bool(depth > DEEP * samples.wall),
            )


def _smaller_of_wall_and_squeeze(samples: EvaluationPoints) -> tuple[float, str]:
    """Return the length with which penetrations are compared, mm, and its name."""
    # a thick wall is squeezed in part only: then the largest displacement, or that of free growth where
    # walls prevent it
    path = samples.path
    squeeze, whose = max(
        (path.largest_displacement, "the largest displacement"),
        (_free_growth(path), "the free expansion"),
    )
    if 0.0 < squeeze < samples.wall:
        return squeeze, whose
    return samples.wall, "the wall's thickness"


def _free_growth(path: PathResult) -> float:
    """Compute the largest |theta - 1| of the materials times the size of the section, mm: how far free
    ends move."""
    structure, at_end = path.problem.term("structure"), [path.steps[-1].fraction]
    found = [
        structure.conditions(region, at_end).conditions for region in structure.definition.regions
    ]
    grown = [float(np.abs(own.growth - 1.0).max()) for own in found if own is not None]
    return max(grown, default=0.0) * float(np.ptp(path.discretization.particles, axis=0).max())


def _inside_profiles(samples: EvaluationPoints):
    """Report a boundary inside a rigid profile: edges that may not touch it, then at the contact points,
    between them, or elsewhere."""
    path = samples.path
    size, whose = _smaller_of_wall_and_squeeze(samples)
    edges, buried = path.discretization.body.edges, list(buried_edges(path, SLIGHT * size))
    for own in buried:
        yield Finding(
            f"the edge {own.edge!r} may not touch the rigid profile {own.profile!r}, and lies "
            f"inside it from {own.since} on, by up to {own.depth:.3g} mm near {_at(own.place)}, "
            f"{100.0 * own.depth / size:.2g} % of {whose}, so forces are wrong from then on; "
            f"{own.cure}",
            bool(own.depth > DEEP * samples.wall),
            meaningless=bool(own.depth > MISSED * samples.wall),
        )
    for term in path.problem.terms:
        if not isinstance(term, ContactTerm):
            continue
        # gaps of all boundary samples, not only of the contact points; but not beside buried edges,
        # nor on the sides that touch the same profile by another contact
        of = [edges[own.edge].particles for own in buried if own.profile == term.label]
        sides = samples.chains[:, [0, -1]]
        beside = np.isin(sides, np.concatenate(of or [[]])).any(axis=1)
        for own in same_profiles(path, term):
            beside |= np.isin(sides, own.where.edges).all(axis=1)
        which = np.unique(samples.chains[~beside])
        if not which.size:
            continue
        gap = term.gaps(samples.places[which], path.steps[-1].fraction)
        worst = int(np.argmin(gap))
        if not gap[worst] >= -SLIGHT * size:  # NaN is no gap either
            place = samples.places[which[worst]]
            yield Finding(
                f"the seal lies {-gap[worst]:.3g} mm inside the rigid profile {term.label!r} near "
                f"{_at(place)}, {-100.0 * gap[worst] / size:.2g} % of {whose}: contact acts only "
                "at the contact points and by a penalty; use more particles along the boundary, a "
                "rounder profile, a larger normal penalty, or less travel",
                not gap[worst] >= -DEEP * samples.wall,
            )


def _axis(samples: EvaluationPoints):
    """Report a boundary of a body of revolution that has passed through the axis, and particles on the
    axis that have left it."""
    path = samples.path
    if not path.discretization.body.axisymmetric:
        return
    which = np.unique(samples.chains)
    places, radii = samples.places[which], samples.undeformed[which, 0]
    rounding = zero_radius(path.discretization.particles)
    # r < 0; between its particles the axis itself is no surface
    place = min(places[radii > 0.0], key=lambda own: own[0])
    if not place[0] >= -rounding:
        yield Finding(
            f"the boundary lies {-place[0]:.3g} mm beyond the axis of revolution x = 0 near "
            f"{_at(place)}: a body of revolution cannot pass through its axis; use less travel, or "
            "model what closes at the axis as a [[profile]]",
            True,
        )
    # R = 0 and u_r != 0, prescribed by the position of moved or glued edges
    on_axis = path.discretization.particles[:, 0] == 0.0
    radial = np.where(on_axis, path.displacement_at(path.steps[-1])[:, 0], 0.0)
    if not np.abs(radial).max() <= rounding:
        worst = path.discretization.particles[np.abs(radial).argmax()]
        yield Finding(
            f"the end of a moved or glued edge at {_at(worst)} (undeformed coordinates) is moved by "
            f"{np.abs(radial).max():.3g} mm away from the axis of revolution x = 0, where nothing moves "
            "along x; displace the edge along y only",
            True,
        )


def _below_base(samples: EvaluationPoints):
    """Report a boundary below the plane of a straight base, fixed or moved, with which there is no
    contact, unless a profile supports the seal there."""
    body = samples.path.discretization.body
    # only a base with both components fixed supports the seal
    base = body.edges.get("base")
    if base is None or not body.fixed[base.particles].all():
        return
    # the base before and after deformation: a moved one carries its plane with it
    undeformed, deformed = samples.undeformed[base.particles], samples.places[base.particles]
    outward = _outward(undeformed)
    # bases that are not straight have no plane
    if np.abs((undeformed - undeformed[0]) @ outward).max() > 1e-6 * samples.wall:
        return
    which = np.unique(samples.chains)
    # a part of the section that lies below in the undeformed state is not on the base
    height = (samples.undeformed[which] - undeformed[0]) @ outward
    which = which[height <= SLIGHT * samples.wall]
    # distance of the deformed boundary below the plane of the base
    normal, least = _outward(deformed), SLIGHT * samples.wall
    depth = (samples.places[which] - deformed[0]) @ normal
    worst = int(np.argmax(depth))
    if depth[worst] > least and not _supported_below(samples, deformed[0], normal, least):
        yield Finding(
            f"the seal sinks {depth[worst]:.3g} mm below the plane of its base near "
            f"{_at(samples.places[which[worst]])}: the model has no support beyond the fixed base; "
            "fix the base over its full width, or add the support as a [[profile]]",
            False,
        )


def _supported_below(samples: EvaluationPoints, base, normal, least: float) -> bool:
    """Return whether the seal presses on a profile more than ``least`` below the plane through ``base``,
    along its unit ``normal``."""
    path = samples.path
    terms = [term for term in path.problem.terms if isinstance(term, ContactTerm)]
    for own in (path.responses(term.label)[-1] for term in terms):
        # (x - x_base).n > least and f.n > 0, with the force f on the profile
        if (((own.x - base) @ normal > least) & (own.force @ normal > 0.0)).any():
            return True
    return False


def _outward(x: np.ndarray) -> np.ndarray:
    """Compute the outward unit normal (2,) of a straight edge through points (k, 2) in order."""
    # tangent turned clockwise, body on the left
    along = (x[-1] - x[0]) / np.linalg.norm(x[-1] - x[0])
    return np.array([along[1], -along[0]])
