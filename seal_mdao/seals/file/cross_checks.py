"""Whether the tables of a seal file fit each other, before anything is computed."""

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.checks import known
from seal_mdao.seals.file.contact_points import check_contact_points
from seal_mdao.seals.file.edges import check_edges, contour_of
from seal_mdao.seals.file.fluid_checks import check_fluids
from seal_mdao.seals.file.names import check_names
from seal_mdao.seals.file.start import LOOK, gap_at_start, nearest_at_start
from seal_mdao.seals.file.tables import SealFile
from seal_mdao.seals.outline.cloud_file import GivenCloud
from seal_mdao.seals.outline.section import JOIN
from seal_mdao.seals.outline.segments import pair

ROUNDING = 1e-9
"""Penetration at the start that is none, over the size of the section."""

TOUCHING = 1e-9
"""Gap of a profile that touches the section at the start, over its size."""

MOST_PARTICLES = 200_000
"""That a section may need; more is a slip of the spacing."""


def check(file: SealFile) -> None:
    """Refuse a file whose tables contradict each other.

    Raises
    ------
    SealFileError
        With the first contradiction.
    """
    _check_section(file)
    _check_regions(file)
    _check_held(file)
    _check_designs(file)
    _check_cavities(file)
    _check_self_contact(file)
    _check_terms(file)
    _check_measures(file)
    _check_steps(file)
    check_fluids(file)
    check_names(file)
    gaps = []
    for number, profile in enumerate(file.profiles, 1):
        where = f"[[profile]] {number} ({profile.name!r})"
        _check_contact(where, profile, file)
        check_contact_points(where, profile, file)
        gaps.append(_check_start(where, profile, file))
    _check_bodies_held(file, gaps)


def _check_section(file):
    section, outline = file.section, file.section.outline
    known("[section]", "material", section.material, tuple(file.materials), "material")
    if not isinstance(section.spacing, float):
        return
    small = float(np.ptp(outline.box, axis=0).min())
    if section.spacing >= 0.5 * small:
        raise SealFileError(
            f"[section]: spacing = {section.spacing:g}, but the section is only {small:.4g} mm wide; it "
            "must be less than half of that"
        )
    least = np.sqrt(outline.area / MOST_PARTICLES)
    if section.spacing < least:
        raise SealFileError(
            f"[section]: spacing = {section.spacing:g}, which needs more than {MOST_PARTICLES} "
            f"particles; it must be at least {least:.3g}"
        )


def _check_regions(file):
    outline, seen = file.section.outline, {file.section.material: "[section]"}
    ends = np.array([s.points([0.0])[0] for c in outline.contours for s in c.segments])
    for number, region in enumerate(file.section.regions, 1):
        where = f"[[section.region]] {number}"
        known(where, "material", region.material, tuple(file.materials), "material")
        if region.material in seen:
            raise SealFileError(
                f"{where}: material = {region.material!r}, which {seen[region.material]} has already; "
                "give every part a material of its own name"
            )
        seen[region.material] = where
        if region.line is None:
            if not outline.others:
                raise SealFileError(
                    f"{where}: line is missing, but the section is one body; draw the line that divides "
                    "the part from the rest"
                )
            continue
        for point in (region.line[0], region.line[-1]):
            if np.hypot(*(ends - point).T).min() > JOIN:
                raise SealFileError(
                    f"{where}: line ends at {pair(point)}, where no segments of the boundary meet; let "
                    "a segment of the boundary end there"
                )
        if len(region.line) == 2 and np.hypot(*np.subtract(*region.line)) <= JOIN:
            raise SealFileError(f"{where}: line begins and ends at {pair(region.line[0])}")


def _check_held(file):
    outline = file.section.outline
    check_edges("[fixed]", "edges", file.fixed.edges, outline)
    seen = dict.fromkeys(file.fixed.edges, "[fixed]")
    for number, plane in enumerate(file.symmetries, 1):
        where = f"[[symmetry]] {number}"
        check_edges(where, "edges", plane.edges, outline)
        for name in plane.edges:
            if name in seen:
                raise SealFileError(f"{where}: edges has {name!r}, which {seen[name]} has already")
            seen[name] = where
            axis = "xy".index(plane.normal)
            spread = [s.points(s.chords(LOOK * outline.size))[:, axis] for s in outline.edge(name)]
            if np.ptp(np.concatenate(spread)) > ROUNDING * outline.size:
                raise SealFileError(
                    f"{where}: edges has {name!r}, which does not lie in one plane of constant "
                    f"{plane.normal}"
                )


def _check_bodies_held(file, gaps):
    """Every body has a fixed edge or a profile that touches it at the start, with ``gaps`` there."""
    outline = file.section.outline
    for number, contours in enumerate(outline.bodies, 1):
        names = {name for contour in contours for name in contour.edge_names}
        if names & set(file.fixed.edges):
            continue
        own = [
            gap
            for gap, profile in zip(gaps, file.profiles, strict=True)
            if names & set(profile.contact) and profile.contact_points == "particles"
        ]
        if min(own, default=np.inf) <= TOUCHING * outline.size:
            continue
        what = (
            f"body {number} (edge {contours[0].edge_names[0]!r})"
            if outline.others
            else "the section"
        )
        missing = "[fixed] has no edge of it" if file.fixed.edges else "[fixed] is missing"
        nearest = (
            f"the nearest one is {min(own):.3g} mm away "
            if own
            else "no profile may touch it at a particle "
        )
        raise SealFileError(
            f"{missing}, so profiles have to hold {what}, but none touches it at the start: {nearest}"
            "(let a segment of the boundary end where it touches, so that a particle is there)"
        )


def _check_designs(file):
    outline, seen = file.section.outline, {}
    for number, design in enumerate(file.designs, 1):
        where = f"[[design]] {number}"
        check_edges(where, "edges", design.edges, outline)
        for name in design.edges:
            if name in file.fixed.edges:
                raise SealFileError(f"{where}: edges has {name!r}, which [fixed] holds")
            if name in dict(file.planes):
                raise SealFileError(f"{where}: edges has {name!r}, which [[symmetry]] holds")
            if name in seen:
                raise SealFileError(f"{where}: edges has {name!r}, which {seen[name]} has already")
            seen[name] = where


def _check_cavities(file):
    holes, seen = len(file.section.outline.holes), {}
    for number, cavity in enumerate(file.cavities, 1):
        where = f"[[cavity]] {number}"
        if cavity.hole > holes:
            raise SealFileError(
                f"{where}: hole = {cavity.hole}, but the section has "
                + ("no hole" if not holes else f"{holes} hole{'s' if holes > 1 else ''}")
            )
        if cavity.hole in seen:
            raise SealFileError(
                f"{where}: hole = {cavity.hole}, which {seen[cavity.hole]} has already"
            )
        seen[cavity.hole] = where


def _check_self_contact(file):
    if file.self_contact is not None:
        check_edges("[self_contact]", "edges", file.self_contact.edges, file.section.outline)


def _check_terms(file):
    for number, term in enumerate(file.terms, 1):
        check_edges(f"[[term]] {number}", "edges", term.edges, file.section.outline)


def _check_measures(file):
    outline = file.section.outline
    holes = {hole.edge_names[0]: hole for hole in outline.holes if len(hole.edge_names) == 1}
    names = [measure.name for measure in file.measures]
    for number, measure in enumerate(file.measures, 1):
        where = f"[[measure]] {number}"
        if measure.name in names[: number - 1]:
            raise SealFileError(
                f"{where}: name = {measure.name!r}, but an earlier measure has it; give every measure "
                "a name of its own"
            )
        if measure.arguments.get("places") is not None and not isinstance(
            file.section.spacing, GivenCloud
        ):
            raise SealFileError(
                f"{where}: places are numbers of particles, which are known beside [section] cloud alone"
            )
        if measure.type == "cavity_pressure":
            airs = [cavity.name for cavity in file.cavities]
            known(where, "cavity", measure.arguments["cavity"], airs, "[[cavity]]")
        if measure.type == "cavity_area":
            edge = measure.arguments["edge"]
            known(where, "edge", edge, outline.edge_names, "edge")
            if edge not in holes:
                raise SealFileError(
                    f"{where}: edge = {edge!r} does not go all round a hole; there "
                    f"{'are' if len(holes) != 1 else 'is'} {', '.join(holes) or 'none'}"
                )


def _check_steps(file):
    moving = [profile for profile in file.profiles if profile.stages]
    if not moving:
        raise SealFileError("[[profile]]: none has a [[profile.stage]]; at least one has to move")
    for profile in moving[1:]:
        if profile.n_steps == moving[0].n_steps:
            continue
        if file.step_tolerance is not None:
            raise SealFileError(
                f"[[profile]]: {moving[0].name!r} has {moving[0].n_steps} of [[profile.stage]] and "
                f"{profile.name!r} {profile.n_steps}; stages without steps go on side by side, so give "
                "all profiles as many (one without any key stands still)"
            )
        raise SealFileError(
            f"[[profile]]: the stages of {moving[0].name!r} have {moving[0].n_steps} steps in all "
            f"and those of {profile.name!r} {profile.n_steps}; they must be equal (a stage that "
            "only has steps stands still)"
        )


def _check_contact(where, profile, file):
    check_edges(where, "contact", profile.contact, file.section.outline)
    for name in profile.contact:
        if name in file.held:
            raise SealFileError(f"{where}: contact = {name!r}, but [fixed] holds this edge")
    contour = contour_of(profile.contact, file.section.outline)
    if contour is None:
        raise SealFileError(
            f"{where}: contact = {', '.join(profile.contact)} is not one stretch of the boundary; give "
            "the others a profile of their own with the same motion"
        )


def _check_start(where, profile, file) -> float:
    """The least gap at the start, which must not be negative."""
    outline = file.section.outline
    least, place, edge = nearest_at_start(profile, outline)
    if least < -ROUNDING * outline.size:
        gap = gap_at_start(profile)
        edges = [segment for name in profile.contact for segment in outline.edge(name)]
        every = np.concatenate([s.points(s.chords(LOOK * outline.size)) for s in edges])
        turned = "; is it walked the wrong way?" if all(gap(*x) < 0.0 for x in every) else ""
        raise SealFileError(
            f"{where}: start = {pair(profile.start)} puts the edge {edge!r} {-least:.3g} mm "
            f"inside the rigid body at {pair(np.round(place, 6) + 0.0)}; start it farther away (the "
            f"rigid body lies on the left when walked{turned})"
        )
    return least
