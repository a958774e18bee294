"""From the decisions of a seal file to a seal that can be analysed."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from seal_mdao import values
from seal_mdao.contact.friction import ContactLaw
from seal_mdao.errors import SealFileError
from seal_mdao.seals.choice import choose
from seal_mdao.seals.file.described import description
from seal_mdao.seals.file.edges import stretch_order
from seal_mdao.seals.file.measures import measure_of
from seal_mdao.seals.file.profiles import motion_of, shape_of
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.file.start import ROUNDING, gap_at_start, nearest_at_start
from seal_mdao.seals.file.tables import (
    SELF_CONTACT,
    FluidTable,
    ProfileTable,
    SealFile,
    SelfContactTable,
)
from seal_mdao.seals.outline.boundary import doubled
from seal_mdao.seals.outline.cloud import LAYERS, graded
from seal_mdao.seals.outline.cloud_file import GivenCloud
from seal_mdao.seals.outline.design import EdgeDesign
from seal_mdao.seals.outline.edge_fluid import EdgeFluid
from seal_mdao.seals.outline.edge_term import EdgeTerm
from seal_mdao.seals.outline.moved import moved_outline
from seal_mdao.seals.outline.rays import Rays, ray_boundaries
from seal_mdao.seals.outline.seal import (
    EdgeContact,
    OutlineSeal,
    SealedHole,
    SectionRegion,
    outline_seal,
)
from seal_mdao.seals.outline.section import Outline, sampled
from seal_mdao.seals.outline.self_touch import SelfTouch


def build_seal(
    file: SealFile | str | Path,
    callback: Callable | None = None,
    step_ends: Sequence[float] | None = None,
    penalties: Mapping[str, float] | None = None,
) -> OutlineSeal:
    """The seal of a file: its cloud, terms, design and measures.

    Parameters of a profile have its name before theirs: ``door_friction``; so have constants of the
    materials where there are several: ``foot_c10``.

    Load steps and contact penalties that the file does not give are chosen now, by analyses of the
    nominal seal (``seals.choice``), and are the seal's own from then on, whatever its design. The
    last of these analyses is that of the seal itself: the first ``analyze(seal)`` returns it.

    Parameters
    ----------
    file : SealFile, str or Path
        What ``read_seal_file`` returns, or the path that it takes.
    callback : callable, optional
        As of ``seals.choice.choose``, for these analyses.
    step_ends : sequence of float, optional
        Ends of load steps that have been chosen before, in stages, in place of a choice.
    penalties : mapping of str to float, optional
        Penalties that have been chosen before, by the names of their parameters, kPa/mm.

    Raises
    ------
    SealFileError
        For a section that cannot be filled at this spacing, a design with too few parameters, load
        steps that are not found within the tolerance, or ends of steps or penalties that are not those
        of the file; for a path, whatever ``read_seal_file`` refuses.
    LoadPathError
        When load steps or penalties are to be chosen and the path of the nominal seal cannot be
        completed; its ``result`` is as far as it came.
    TypeError
        For anything else than a ``SealFile`` or a path.
    """
    if isinstance(file, str | Path):
        file = read_seal_file(file)
    values.instance("file", file, SealFile)
    seal = built(file, callback, step_ends, penalties)
    return seal.made_from(description(file, seal))


def built(
    file: SealFile,
    callback: Callable | None = None,
    step_ends: Sequence[float] | None = None,
    penalties: Mapping[str, float] | None = None,
) -> OutlineSeal:
    """As ``build_seal``, of a file that was read; the seal does not know what it was made from."""
    seal, tolerance, names = _begun(file), file.step_tolerance, file.open_penalties
    try:
        if penalties is not None:
            seal = _with_given_penalties(file, seal, penalties)
            names = ()
        if step_ends is not None:
            if tolerance is None:
                raise SealFileError("step_ends are given, but the file gives the load steps")
            seal, tolerance = seal.with_ends(step_ends), None
        if tolerance is None and not names:
            return seal
        return choose(seal, tolerance, file.penalty_tolerance, names, callback=callback).seal
    except ValueError as error:
        raise SealFileError(f"{file.path}: {error}") from error


def _with_given_penalties(file: SealFile, seal: OutlineSeal, penalties) -> OutlineSeal:
    """The seal with penalties that were chosen before."""
    if set(penalties) != set(file.open_penalties):
        wanted = ", ".join(file.open_penalties) or "none"
        raise SealFileError(
            f"penalties are given of {', '.join(penalties) or 'none'}, but the file leaves open {wanted}"
        )
    seal = seal.with_parameters(dict(penalties))
    return replace(seal, definitions=seal.terms(), changed={})


def _begun(file: SealFile) -> OutlineSeal:
    """The seal with the steps of the file, one for every stage where they are to be chosen."""
    section = file.section
    cuts = section.cuts
    try:
        seal = outline_seal(
            *boundaries_of(section.outline, section.spacing, cuts, section.layers),
            file.materials[section.material],
            n_steps=file.n_steps,
            fixed=file.held,
            planes=file.planes,
            cuts=cuts,
            regions=[
                SectionRegion(file.materials[r.material], r.at, f"{r.material}_")
                for r in section.regions
            ],
            prefix=f"{section.material}_" if section.regions else "",
            contacts=[_contact(profile, file) for profile in file.profiles],
            sealed=[SealedHole(c.name, c.hole, c.pressure, c.gamma) for c in file.cavities],
            touching=_self_touch(file.self_contact),
            fluids=[_fluid(fluid, file) for fluid in file.fluids],
            terms=[EdgeTerm(t.name, t.edges, t.makes, t.arguments) for t in file.terms],
            designs=[EdgeDesign(design.edges, design.parameters) for design in file.designs],
        )
    except ValueError as error:
        raise SealFileError(f"{file.path}: {error}") from error
    check_places(file, seal)
    return replace(seal, standard=tuple(_measures(file, seal.drawn_particles)))


def _measures(file: SealFile, particles):
    """Measures of the file; those of extensions may refuse what their keys say."""
    for number, entry in enumerate(file.measures, 1):
        try:
            yield measure_of(entry, particles)
        except ValueError as error:
            where = f"{file.path}: [[measure]] {number} ({entry.name!r})"
            raise SealFileError(f"{where}: {error}") from error


def boundaries_of(
    outline: Outline, spacing: float | Rays | GivenCloud, cuts=(), layers: int = LAYERS
) -> tuple:
    """Boundary particles, finer where a wall is thin, and the spacing of those inside, mm.

    ``cuts`` are those of ``cloud``, ``layers`` those of particles across a wall. Rays and clouds stay
    what they are.

    Raises
    ------
    GeometryError
        For a section that cannot be filled.
    """
    if isinstance(spacing, Rays):
        return ray_boundaries(outline, spacing), spacing
    if isinstance(spacing, GivenCloud):
        return spacing.boundaries, spacing

    def sample(at):
        return doubled(outline, sampled(outline, lambda places: 2.0 * at(places)))

    return graded(sample, spacing, cuts, layers)


def outline_of(file: SealFile, seal: OutlineSeal, offsets) -> Outline:
    """The section of a design: what has moved as splines through its boundary particles.

    Parameters
    ----------
    file : SealFile
    seal : OutlineSeal
        That of the file.
    offsets : ndarray, shape (seal.n_offsets,)
        mm.

    Raises
    ------
    GeometryError
        For a boundary that crosses itself.
    """
    section = file.section
    boundaries, _ = boundaries_of(section.outline, section.spacing, section.cuts, section.layers)
    particles = seal.particles(offsets)
    return moved_outline(file.section.outline, boundaries, [particles[loop] for loop in seal.loops])


def check_places(file: SealFile, seal: OutlineSeal) -> None:
    """Refuse numbers of particles that there are not.

    Raises
    ------
    SealFileError
    """
    for number, measure in enumerate(file.measures, 1):
        places = measure.arguments.get("places")
        if places is None:
            continue
        label = measure.arguments.get("profile")
        count = len(seal.drawn_particles)
        if label is not None:
            contact = next(term for term in seal.terms() if term.label == label)
            count = len(contact.where)
        most = max(np.max(part) for part in places)
        if most >= count:
            raise SealFileError(
                f"{file.path}: [[measure]] {number}: places has {most}, but there are only {count} "
                + ("particles" if label is None else f"points that may touch {label!r}, from 0 on")
            )


def _contact(profile: ProfileTable, file: SealFile) -> EdgeContact:
    edges, _ = stretch_order(profile.contact, file.section.outline)
    law = ContactLaw(profile.normal_penalty, profile.tangent_penalty, profile.friction, True)
    placed = replace(profile, start=_clear_start(profile, file.section.outline))
    return EdgeContact(
        profile.name, edges, shape_of(profile),
        motion_of(placed, file.n_steps), law, f"{profile.name}_", profile.contact_points,
    )  # fmt: skip


def _fluid(fluid: FluidTable, file: SealFile) -> EdgeFluid:
    edges, _ = stretch_order(fluid.edges, file.section.outline)
    steps = file.last_stage.steps if fluid.steps is None else fluid.steps
    return EdgeFluid(fluid.name, edges, fluid.end, fluid.pressure, steps, fluid.share)


def _self_touch(given: SelfContactTable | None) -> SelfTouch | None:
    if given is None:
        return None
    law = ContactLaw(given.normal_penalty, given.tangent_penalty, given.friction, True)
    return SelfTouch(SELF_CONTACT, given.edges, law)


def _clear_start(profile: ProfileTable, outline: Outline) -> tuple:
    """The start, clear of the section by more than the rounding of coordinates.

    A profile that is drawn to touch would begin within the section or outside of it by chance.
    """
    clear, h = ROUNDING * outline.size, 1e-3 * outline.size
    least, (x, y), _ = nearest_at_start(profile, outline)
    if least > clear:
        return profile.start
    gap = gap_at_start(profile)
    away = np.array([gap(x + h, y) - gap(x - h, y), gap(x, y + h) - gap(x, y - h)]) / (2.0 * h)
    return tuple((np.array(profile.start) - 2.0 * clear * away).tolist())
