"""Checks of the tables of a seal file against each other: edges, holes, materials, steps, names.

Every check raises ``SealFileError`` with the first contradiction. ``where`` is the place of a table in
the file, as messages name it.
"""

import numpy as np

from seal_mdao.contact.friction_by_group import FrictionByGroup
from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.clearance import LOOK, NEAR, ROUNDING, check_start
from seal_mdao.seals.file.edge_tables import SELF_CONTACT
from seal_mdao.seals.file.environment_table import check_environment
from seal_mdao.seals.file.model_table import AXIAL, check_axisymmetric
from seal_mdao.seals.file.prescribed_edges import (
    check_edges,
    check_friction_by_edge,
    check_moved,
    check_pairs,
    holder,
)
from seal_mdao.seals.file.section_table import check_section
from seal_mdao.seals.file.sliding import check_sliding
from seal_mdao.seals.file.viscoelastic_table import relaxes
from seal_mdao.seals.outline.contours import Contour, Line, Outline
from seal_mdao.seals.outline.rays import Rays
from seal_mdao.seals.outline.section_cloud import OutlineCloud

COLUMNS = ("value", "converged")
"""Names in the rows of a sweep that a measure must not have."""


def check(file) -> None:
    """Raise SealFileError for a ``SealFile`` whose tables contradict each other."""
    # values at the ends of stages need stages
    _check_steps(file)
    # the section and its materials, then all that names its edges
    check_section(file)
    check_axisymmetric(file)
    _check_supports(file)
    check_moved(file)
    _check_designs(file)
    _check_boundary_tolerance(file)
    _check_cavities(file)
    _check_durations(file)
    check_environment(file)
    if file.self_contact is not None:
        check_edges("[self_contact]", "edges", file.self_contact.edges, file.section.outline)
        check_pairs(file.self_contact)
    for number, term in enumerate(file.terms, 1):
        check_edges(f"[[term]] {number}", "edges", term.edges, file.section.outline)
    # what refers to profiles, steps and names
    _check_measures(file)
    _check_fluids(file)
    _check_labels(file)
    # contact of every profile, and whether it touches where nothing else holds the body
    gaps = []
    for number, profile in enumerate(file.profiles, 1):
        where = f"[[profile]] {number} ({profile.name!r})"
        _check_contact(where, profile, file)
        _check_contact_points(where, profile, file)
        gaps.append(check_start(where, profile, file.section.outline))
    _check_bodies_held(file, gaps)
    check_sliding(file)


# ---- edges ----


def _stretch(names, outline: Outline) -> tuple[Contour | None, bool]:
    """Find the contour along which edges follow one another, and whether they go all round it."""
    for contour in outline.contours:
        every = contour.edge_names
        if set(names) <= set(every):
            # a connected part begins once: at an edge that is named after one that is not
            starts = [n for i, n in enumerate(every) if n in names and every[i - 1] not in names]
            return contour if len(starts) <= 1 else None, not starts
    return None, False


def _between(names, file) -> tuple[str, ...]:
    """Find the edges between edges of one contour that connect them; empty if one of these is fixed."""
    outline = file.section.outline
    every = next((c.edge_names for c in outline.contours if set(names) <= set(c.edge_names)), ())
    if not every:
        return ()

    def fixed(edges):
        return any(len(file.supports.get(name, ())) == 2 for name in edges)

    def length(edges):
        return sum(segment.length for name in edges for segment in outline.edge(name))

    # runs of other edges round the contour, of which one remains: a fixed one, else the longest
    first, runs = every.index(names[0]), [()]
    for name in (*every[first:], *every[:first]):
        runs = [*runs, ()] if name in names else [*runs[:-1], (*runs[-1], name)]
    _, *others = sorted(runs, key=lambda run: (fixed(run), length(run)), reverse=True)
    found = tuple(name for run in runs if run in others for name in run)
    return () if fixed(found) else found


def _check_supports(file) -> None:
    """Refuse edges that are held twice, or that lie in no plane of symmetry."""
    outline, own = file.section.outline, file.fixed_edges
    check_edges("[fixed]", "edges", own, outline)
    seen = dict.fromkeys(own, "[fixed]")
    # every edge of symmetry is straight, across one axis
    for number, plane in enumerate(file.symmetries, 1):
        where = f"[[symmetry]] {number}"
        check_edges(where, "edges", plane.edges, outline)
        for name in plane.edges:
            if name in seen:
                raise SealFileError(
                    f"{where}: the edge {name!r} is already in {seen[name]}; remove it from "
                    "one of the two tables"
                )
            seen[name] = where
            axis = "xy".index(plane.normal)
            spread = [s.points(s.chords(LOOK * outline.size))[:, axis] for s in outline.edge(name)]
            if np.ptp(np.concatenate(spread)) > ROUNDING * outline.size:
                raise SealFileError(
                    f"{where}: the edge {name!r} in the list edges does not lie in a plane of "
                    f"constant {plane.normal}"
                )


def _check_boundary_tolerance(file) -> None:
    """Refuse errors of a boundary of which no edge may move: they are offsets of designs."""
    if file.tolerance is not None and file.tolerance.boundary is not None and not file.designs:
        raise SealFileError(
            "[tolerance]: boundary describes random errors of the edges of [[design]], but the "
            "seal file has no [[design]]; add one with the edges that scatter"
        )


def _check_designs(file) -> None:
    """Refuse edges of designs that are held, or that two designs move, and planes that are no plane of
    symmetry of the edges."""
    # edges of [fixed] and [[symmetry]] are those with supports; parts of an edge may overlap
    seen = {}
    for number, design in enumerate(file.designs, 1):
        where = f"[[design]] {number}"
        # boundaries on rays have no arc length and no tangents
        for what in ("between", "arc"):
            if getattr(design, what) is not None and isinstance(file.section.spacing, Rays):
                raise SealFileError(
                    f"{where}: {what} cannot be combined with rays; use spacing in [section] "
                    "instead of rays"
                )
        for what, names in (("edges", design.edges or ()), ("opposite", design.moving[-1:])):
            if names and getattr(design, what) is not None:
                check_edges(where, what, names, file.section.outline)
        for name in design.moving:
            if name in file.supports:
                given = "opposite names" if name == design.opposite else "the list edges contains"
                raise SealFileError(
                    f"{where}: {given} {name!r}, which {holder(file, name)} already constrains; "
                    "remove this edge from one of the two tables"
                )
            if name in seen:
                raise SealFileError(
                    f"{where}: the edge {name!r} is already in {seen[name]}; remove it from "
                    "one of the two tables"
                )
            if design.between is None:
                seen[name] = where


# ---- air, fluids, measures, names ----


def _check_cavities(file) -> None:
    """Refuse holes that there are not, or that two cavities name."""
    # holes are counted from 1, and each has one volume of air
    holes, seen = len(file.section.outline.holes), {}
    for number, cavity in enumerate(file.cavities, 1):
        where = f"[[cavity]] {number}: hole = {cavity.hole}"
        if cavity.hole > holes:
            has = f"{holes} hole{'s' if holes > 1 else ''}" if holes else "no hole"
            cut = (
                "; a hole that a plane of symmetry cuts is part of the outer contour, and its air needs "
                "the complete section, without [[symmetry]]"
            )
            raise SealFileError(
                f"{where}, but the section has {has}; holes are numbered from 1"
                + (cut if file.symmetries else "")
            )
        if cavity.hole in seen:
            raise SealFileError(
                f"{where}, but {seen[cavity.hole]} already has this hole; remove one of the two "
                "tables"
            )
        seen[cavity.hole] = f"[[cavity]] {number}"
        if cavity.vented:
            _check_closing(f"[[cavity]] {number}", cavity, file)


def _check_closing(where: str, cavity, file) -> None:
    """Refuse a closing speed that is missing, that gives a stage no time, or that does nothing."""
    moving = next((profile for profile in file.profiles if profile.travel > 0.0), None)
    # ``check_relaxation`` looks at the times of relaxing materials: every stage has a duration
    timed = relaxes(file)
    if moving is None and not timed:
        raise SealFileError(
            f"{where} has vents, but no profile moves; add a [[profile.stage]] with translate to a "
            "[[profile]]"
        )
    open_stages = [] if timed else [n for n, s in enumerate(moving.stages, 1) if s.duration is None]
    if cavity.closing_speed is None:
        if open_stages:
            raise SealFileError(
                f"{where} has vents but no closing_speed, and stage {open_stages[0]} of the "
                f"profile {moving.name!r} has no duration; give either closing_speed or a duration "
                "of every stage"
            )
        return
    where = f"{where}: closing_speed = {cavity.closing_speed:g}"
    if not open_stages:
        raise SealFileError(
            f"{where} has no effect, because every stage has a duration; leave out closing_speed"
        )
    # time = travel / speed, or as given
    for number, own in enumerate(moving.stages, 1):
        if own.duration is None and not any(own.translate):
            raise SealFileError(
                f"{where} does not define the time of stage {number} of the profile "
                f"{moving.name!r}, which has no translate; give this stage a duration (s)"
            )


def _check_durations(file) -> None:
    """Refuse durations of stages that determine the time of no cavity."""
    moving = next((profile for profile in file.profiles if profile.travel > 0.0), None)
    vented = any(cavity.vented for cavity in file.cavities)
    # ``check_relaxation`` looks at those of relaxing materials
    if relaxes(file):
        return
    for kind, tables in (("profile", file.profiles), ("moved", file.moved)):
        for i, own in enumerate(tables, 1):
            given = [k for k, stage in enumerate(own.stages, 1) if stage.duration is not None]
            if not given or (vented and own is moving):
                continue
            instead = (
                f"give the duration to the stages of {moving.name!r}"
                if vented and moving
                else "leave it out"
            )
            raise SealFileError(
                f"[[{kind}]] {i} ({own.name!r}): [[{kind}.stage]] {given[0]} has a duration, which only "
                "the first moving profile of a seal with a vented [[cavity]] or materials that relax "
                "needs; " + instead
            )


def _check_fluids(file) -> None:
    """Refuse fluids that have no edge to go along, nothing to hold them back, or no time to grow."""
    for number, fluid in enumerate(file.fluids, 1):
        where = f"[[fluid]] {number}"
        _check_fluid_edges(where, fluid, file)
        # without steps the pressure grows in the last stage
        if fluid.steps is None:
            continue
        if file.step_tolerance is not None:
            raise SealFileError(
                f"{where}: steps = {fluid.steps} cannot be given, because the stages of the "
                "profiles have no steps and their load steps are chosen automatically; leave out "
                "steps, and the pressure grows in the last stage"
            )
        if fluid.steps > file.n_steps:
            raise SealFileError(
                f"{where}: steps = {fluid.steps}, but the stages of the profiles have "
                f"{file.n_steps} steps in all; add a last stage with steps only (a dwell), in "
                "which the pressure grows"
            )


def _check_fluid_edges(where: str, fluid, file) -> None:
    """Refuse edges of a fluid that are no connected part; with the key ``from`` those without ends, and
    those that no profile may touch; without it those that one may touch, or that enclose air."""
    edges, outline = fluid.edges, file.section.outline
    check_edges(where, "edge", edges, outline)
    contour, all_round = _stretch(edges, outline)
    where = f"{where}: edge = {', '.join(edges)}"
    if contour is None:
        raise SealFileError(
            f"{where} is not one connected part of the boundary; list adjacent edges, in order"
        )
    if fluid.end is None:
        _check_pressed(where, edges, contour, file)
        return
    if all_round:
        raise SealFileError(
            f"{where} is a closed curve, so it has no wet and no dry end; leave out from if the "
            "pressure acts all round, or divide the curve into several edges and leave one of them out"
        )
    # contact keeps the fluid from the dry side
    touching = dict.fromkeys(name for profile in file.profiles for name in profile.contact)
    if not any(name in touching for name in edges):
        cure = (
            f"add to the list edge one of the edges that a profile may touch: {', '.join(touching)}"
        )
        raise SealFileError(
            f"{where}, but no profile may touch these edges, so nothing stops the fluid; leave out "
            "from if the pressure acts on all of them, or "
            + (cure if touching else "add a [[profile]] that presses on one of them")
        )


def _check_pressed(where: str, edges, contour, file) -> None:
    """Refuse edges with a pressure on all of them that a profile may touch, or that enclose air."""
    for profile in file.profiles:
        if set(edges) & set(profile.contact):
            raise SealFileError(
                f"{where}, without from, but the profile {profile.name!r} may touch it and stop the "
                'fluid; give the end from which the fluid comes (from = "start" or "end"), or list in '
                "contact of the profile only the edges that it touches"
            )
    number = next((n for n, hole in enumerate(file.section.outline.holes, 1) if hole is contour), 0)
    if any(cavity.hole == number for cavity in file.cavities):
        raise SealFileError(
            f"{where} belongs to hole {number}, whose air already presses on it ([[cavity]]); remove "
            "one of the two tables"
        )


def _check_measures(file) -> None:
    """Refuse names that are taken, places without a cloud, and what other tables do not have."""
    # a name is that of an output of OpenMDAO
    names = [measure.name for measure in file.measures]
    for number, (where, measure) in enumerate(file.located_measures):
        if measure.name in names[:number]:
            raise SealFileError(
                f"{where}: name = {measure.name!r}, but an earlier [[measure]] has this name; give "
                "every measure a different name"
            )
        if measure.name in COLUMNS:
            raise SealFileError(
                f"{where}: name = {measure.name!r} is the name of a column of sweep.csv; give the "
                "measure another name"
            )
        # values of a measure that has several are the columns name_1, name_2, ...
        base, _, digits = measure.name.rpartition("_")
        if digits.isdigit() and any(own.name == base and not own.single for own in file.measures):
            raise SealFileError(
                f"{where}: name = {measure.name!r} is the name of a column of sweep.csv for a value "
                f"of the [[measure]] {base!r}; give one of both measures another name"
            )
        # numbers of particles belong to a cloud that does not change
        cloud = isinstance(file.section.spacing, OutlineCloud)
        if getattr(measure, "places", None) is not None and not cloud:
            raise SealFileError(
                f"{where}: the key places contains indices of particles, which are known only for "
                "a mesh file (cloud in [section]); leave out places, or use cloud"
            )
        _check_work(where, measure, file)
        measure.check(where, file)


def _check_work(where: str, measure, file) -> None:
    """Refuse works that leave out those of moved or bonded edges, and friction beside other losses."""
    own = measure.type == "friction_work" and (file.moved or file.glued)
    if own or (measure.type == "profile_work" and measure.profile in file.glued):
        raise SealFileError(
            f"{where}: type = {measure.type!r} is not available with [[moved]] or glued edges, "
            "because their work is not included; leave out this measure, or use strain_energy"
        )
    # work of all profiles minus the elastic energy: that of a fluid is not subtracted, nor the losses
    # of air in vents
    vented = any(cavity.vent_diameter is not None for cavity in file.cavities)
    if measure.type == "friction_work" and (file.fluids or vented):
        why = "a fluid does work, too" if file.fluids else "air that leaves does work, too"
        raise SealFileError(
            f"{where}: type = 'friction_work' is not available with "
            f"{'[[fluid]]' if file.fluids else 'vents of a [[cavity]]'}, because {why}; leave out "
            "this measure, or use profile_work"
        )


def _check_labels(file) -> None:
    """Refuse cavities, fluids, terms and contact of the section with itself under a taken name."""
    # labels of terms are prefixes of their parameters
    seen = {"structure": "the body itself"} | {p.name: "a profile" for p in file.profiles}
    for kind, rows in (
        ("moved", file.moved),
        ("cavity", file.cavities),
        ("fluid", file.fluids),
        ("term", file.terms),
    ):
        for number, row in enumerate(rows, 1):
            where = f"[[{kind}]] {number}"
            if row.name in seen:
                raise SealFileError(
                    f"{where}: name = {row.name!r}, but {seen[row.name]} has it; give every "
                    f"[[{kind}]] a different name"
                )
            seen[row.name] = where
    if file.self_contact is not None and SELF_CONTACT in seen:
        raise SealFileError(
            f"{seen[SELF_CONTACT]} has the name 'self_contact', which is reserved for "
            "[self_contact]; give it another name"
        )


# ---- profiles ----


def _check_steps(file) -> None:
    """Refuse profiles that all stand still, or whose stages do not run at the same time."""
    # profiles move side by side: one without stages stands still, all others have as many steps
    moving = [own for own in file.moving if own.stages]
    if not moving:
        if file.moved:
            raise SealFileError(
                "nothing moves in this seal file, because no [[profile]] has a [[profile.stage]] "
                "and no [[moved]] has a [[moved.stage]]; add at least one stage"
            )
        raise SealFileError(
            "[[profile]]: nothing moves, because no profile has a [[profile.stage]]; add a stage "
            "to at least one profile"
            + (", without translate if only a fluid presses: stage = [{}]" if file.fluids else "")
        )
    first = moving[0]
    for profile in moving[1:]:
        if profile.n_steps == first.n_steps:
            continue
        if file.step_tolerance is not None:
            # every stage has one step until steps are chosen
            raise SealFileError(
                f"[[profile]]: {first.name!r} has {first.n_steps} stages ([[profile.stage]]), but "
                f"{profile.name!r} has {profile.n_steps}; stages without steps run at the same "
                "time, so give all moving profiles the same number of stages (a profile without "
                "stages does not move)"
            )
        raise SealFileError(
            f"[[profile]]: the stages of {first.name!r} have {first.n_steps} steps in all "
            f"and those of {profile.name!r} {profile.n_steps}; they must be equal (a stage with "
            "steps only is a dwell)"
        )


def _check_contact(where: str, profile, file) -> None:
    """Refuse contact of edges that are fixed, or that are not one connected part of the boundary."""
    # fixed particles are no contact points; edges in a plane still slide
    check_edges(where, "contact", profile.contact, file.section.outline)
    for name in profile.contact:
        if len(file.supports.get(name, ())) == 2:
            owner = holder(file, name)
            raise SealFileError(
                f"{where}: contact = {name!r}, but {owner} prescribes the displacements of this "
                "edge, so that it cannot come into contact; remove this edge from the list contact "
                f"or from {owner}"
            )
    if isinstance(profile.friction, FrictionByGroup):
        check_friction_by_edge(where, profile)
    if _stretch(profile.contact, file.section.outline)[0] is None:
        between = ", ".join(map(repr, _between(profile.contact, file)))
        raise SealFileError(
            f"{where}: contact = {', '.join(profile.contact)} is not one connected part of the "
            "boundary; add "
            + f"{between} between them, or " * bool(between)
            + "a second [[profile]] with the same curve and motion for the edges of the other part"
        )


def _check_contact_points(where: str, profile, file) -> None:
    """Refuse contact between the particles where something needs a particle at the contact."""
    if profile.contact_points == "particles":
        return
    where = f'{where}: contact_points = "{profile.contact_points}", but'
    if file.penetrating_fluids:
        raise SealFileError(
            f"{where} a [[fluid]] with the key from needs contact points at the particles; leave out "
            "contact_points"
        )
    work = turning_work(profile, file.measures)
    if work is not None:
        named = next(place for place, own in file.located_measures if own is work)
        raise SealFileError(
            f"{where} the {work.type} ({named}) of a rotating "
            "profile needs contact points at the particles; leave out contact_points or this measure"
        )


def turning_work(profile, measures):
    """Find a measure of the work of a rotating profile, whose moment needs forces at particles; None if
    there is none."""
    if not profile.turns:
        return None
    for measure in measures:
        of = measure.profile if measure.type == "profile_work" else None
        if of == profile.name or measure.type == "friction_work":
            return measure
    return None


def _check_opposed(names, file) -> None:
    """Refuse a body in plane strain that a single straight profile pushes, with nothing behind it."""
    # another body, a fluid, a term or a plane of symmetry may hold it
    planes = {name for plane in file.symmetries for name in plane.edges}
    others = file.axisymmetric or file.self_contact or file.fluids or file.terms or names & planes
    touching = [profile for profile in file.profiles if names & set(profile.contact)]
    if others or len(touching) > 1 or touching[0].shape is not None:
        return
    segments = touching[0].segments
    if len(segments) == 1 and isinstance(segments[0], Line):
        raise SealFileError(
            f"the section has no support against the straight profile {touching[0].name!r}; fix an "
            "edge ([fixed]), or add a [[profile]] without stages on the opposite side"
        )


def unsupported_bodies(file) -> list:
    """Find the bodies that only profiles hold: number, and names of the edges, of each."""
    # edges in a plane of symmetry hold nothing along it
    planes = {name for plane in file.symmetries for name in plane.edges}
    fixed = set(file.supports) - planes
    if file.axisymmetric:
        # a ring holds its radius itself; it can only move along the axis
        fixed = {name for name, held in file.supports.items() if AXIAL in held}
    found = []
    for number, contours in enumerate(file.section.outline.bodies, 1):
        names = {name for contour in contours for name in contour.edge_names}
        # planes of symmetry along both axes hold a body in the plane
        normals = {plane.normal for plane in file.symmetries if names & set(plane.edges)}
        if not names & fixed and len(normals) < 2:
            found.append((number, names))
    return found


def _check_bodies_held(file, gaps) -> None:
    """Refuse a body without a fixed edge that no profile touches or nearly touches at the start, with
    these gaps (mm)."""
    outline = file.section.outline
    for number, names in unsupported_bodies(file):
        # a profile holds a body only at a particle that it touches at the start
        own = [
            gap
            for gap, profile in zip(gaps, file.profiles, strict=True)
            if names & set(profile.contact) and profile.contact_points != "edges"
        ]
        if min(own, default=np.inf) <= NEAR * outline.size:
            _check_opposed(names, file)
            continue
        # what is missing, and how far the nearest profile is
        missing = "[fixed] has no edge of this body" if file.fixed_edges else "[fixed] is missing"
        nearest = "no profile may touch it at a particle"
        if own:
            nearest = f"the nearest one is {min(own):.3g} mm away"
        raise SealFileError(
            f"{missing}, so profiles must support {outline.body_title(number)}, but none touches it at "
            f"the start: {nearest}; start it in contact, at a point at which a segment of the boundary "
            "ends (a particle lies there), or fix an edge ([fixed])"
        )
