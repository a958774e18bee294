"""Build the seal of a seal file: its cloud, terms, design and measures."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.seals.clear_start import with_clear_starts
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.measure_table import measure_of
from seal_mdao.seals.outline.contours import Outline, sampled
from seal_mdao.seals.outline.moved import shifted_outline
from seal_mdao.seals.outline.outline_seal import BodyModel, OutlineSeal, outline_seal
from seal_mdao.seals.outline.rays import Rays, ray_boundaries
from seal_mdao.seals.outline.sampling import doubled
from seal_mdao.seals.outline.section_cloud import LAYERS, Kernels, OutlineCloud, graded
from seal_mdao.seals.steps_and_penalties import choose


def built(
    file: SealFile,
    callback: Callable | None = None,
    step_ends: Sequence[float] | None = None,
    penalties: Mapping[str, float] | None = None,
    unchosen: OutlineSeal | None = None,
) -> OutlineSeal:
    """Build the seal of a file that was read and whose particles are given or chosen, as
    ``file_seal.build_seal``, without its description."""
    seal = unchosen_seal(file) if unchosen is None else unchosen
    tolerance, names = file.step_tolerance, file.open_penalties
    try:
        # what was chosen before takes the place of a choice
        if penalties is not None:
            seal = _with_given_penalties(file, seal, penalties)
            names = ()
        if step_ends is not None:
            if tolerance is None:
                raise SealFileError(
                    "the argument step_ends cannot be combined with numbers of load steps (steps) "
                    "in the stages of the seal file; leave out either"
                )
            seal, tolerance = seal.with_ends(step_ends), None
        if tolerance is None and not names:
            return seal
        return choose(seal, tolerance, file.penalty_tolerance, names, callback=callback).seal
    except ValueError as error:
        raise SealFileError(f"{file.path}: {error}") from error


def unchosen_seal(file: SealFile) -> OutlineSeal:
    """Build the seal of a file with one load step for every stage whose steps are to be chosen.

    Raises
    ------
    SealFileError
    """
    # the section and its cloud, then the terms along its edges, then the measures
    section = file.section
    try:
        boundaries = section_boundaries(section)
        seal = outline_seal(
            *boundaries, file.regions, n_steps=file.n_steps, supports=file.supports,
            contributions=[*file.contributions, *file.motions],
            designs=[own.made() for own in file.designs],
            model=BodyModel(file.axisymmetric, file.environment, _kernels(section)),
        )  # fmt: skip
    except ValueError as error:
        raise SealFileError(f"{file.path}: {error}") from error
    # profiles that lie inside the section begin farther back
    if any(own.interference for own in file.profiles):
        seal = with_clear_starts(seal, seal.nominal_particles)
    _check_places(file, seal)
    seal = replace(seal, standard=tuple(_measures(file, seal)))
    if file.tolerance is not None:
        # placements of profiles and numbers of measures are parameters that may vary
        file.tolerance.check(f"{file.path}: [tolerance.", seal.with_placements())
    return seal


def _with_given_penalties(file: SealFile, seal: OutlineSeal, penalties) -> OutlineSeal:
    """Set penalties that were chosen before, as part of the definitions of the terms."""
    if set(penalties) != set(file.open_penalties):
        wanted = ", ".join(file.open_penalties) or "none"
        raise SealFileError(
            "the argument penalties must contain the contacts without penalties in the seal file, "
            f"{wanted}, but contains {', '.join(penalties) or 'no contact'}"
        )
    # set as parameters, which checks them, then taken over into the definitions
    seal = seal.with_parameters(dict(penalties))
    return replace(seal, definitions=seal.terms(), changed={})


def _measures(file: SealFile, seal: OutlineSeal):
    """Make the measures of the file; some refuse their keys, or the seal."""
    for where, entry in file.located_measures:
        try:
            measure = measure_of(entry, seal.nominal_particles)
            measure.check(seal)
            yield measure
        except ValueError as error:
            # the key that implies a measure contains its name
            name = "" if entry.name in file.implied else f" ({entry.name!r})"
            raise SealFileError(f"{file.path}: {where}{name}: {error}") from error


def _kernels(section) -> Kernels | None:
    """Choose the kernels of a section filled by a spacing; rays and clouds have their own (None)."""
    if isinstance(section.spacing, Rays | OutlineCloud):
        return None
    return Kernels()


def section_boundaries(section) -> tuple:
    """Sample the boundary particles of ``[section]`` by ``boundaries_of``."""
    return boundaries_of(
        section.outline, section.spacing, section.cuts, section.layers, section.edge_spacing
    )


def boundaries_of(
    outline: Outline,
    spacing: float | Rays | OutlineCloud,
    cuts=(),
    layers: int = LAYERS,
    edge_spacing: dict | None = None,
) -> tuple:
    """Sample boundary particles, finer where a wall is thin, and the spacing of those inside, mm.

    ``cuts`` are those of ``cloud``, ``layers`` those of particles across a wall, ``edge_spacing``
    smaller distances along edges by their names, mm. Rays and clouds are returned unchanged.

    Raises
    ------
    GeometryError
        For a section that cannot be filled.
    """
    # points of rays and of clouds are decided by these
    if isinstance(spacing, Rays):
        return ray_boundaries(outline, spacing), spacing
    if isinstance(spacing, OutlineCloud):
        return spacing.boundaries, spacing

    def sample(at):
        # every other point is put on the curve in the middle of a side of twice the spacing
        limits = {edge: 2.0 * h for edge, h in (edge_spacing or {}).items()}
        return doubled(outline, sampled(outline, lambda places: 2.0 * at(places), limits))

    return graded(sample, spacing, cuts, layers)


def outline_of(file: SealFile, seal: OutlineSeal, offsets) -> Outline:
    """Make the section of a design from the seal of a file and its offsets (mm).

    Segments that have moved become splines through their boundary particles.

    Raises
    ------
    GeometryError
        For a boundary that crosses itself.
    """
    # the same boundary particles as those of the seal, then where they are in the design
    section = file.section
    boundaries, _ = section_boundaries(section)
    particles = seal.particles(offsets)
    return shifted_outline(section.outline, boundaries, [particles[loop] for loop in seal.loops])


def _check_places(file: SealFile, seal: OutlineSeal) -> None:
    """Refuse numbers of particles that do not exist."""
    for where, measure in file.located_measures:
        places = measure.arguments.get("places")
        if places is None:
            continue
        # of contact points where the measure names a profile, else of all particles
        label = measure.arguments.get("profile")
        count, what = len(seal.nominal_particles), "particles"
        if label is not None:
            contact = next(term for term in seal.terms() if term.label == label)
            count, what = len(contact.where), f"points that may touch {label!r}, from 0 on"
        most = max(np.max(part) for part in places)
        if most >= count:
            raise SealFileError(
                f"{file.path}: {where}: places contains the index {most}, but there "
                f"are only {count} " + what
            )
