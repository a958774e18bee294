"""Build the seal of a seal file, with the particles, load steps and penalties that it leaves open."""

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from seal_mdao import values
from seal_mdao.accuracy.chosen_spacing import Cloud, refine
from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.accuracy import with_filling
from seal_mdao.seals.file.build import built
from seal_mdao.seals.file.described import description
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.outline.outline_seal import OutlineSeal


def build_seal(
    file: SealFile | str | Path,
    callback: Callable | None = None,
    step_ends: Sequence[float] | None = None,
    penalties: Mapping[str, float] | None = None,
    unchosen: OutlineSeal | None = None,
    filling: Mapping | None = None,
) -> OutlineSeal:
    """Build the seal of a file: its cloud, terms, design and measures.

    Parameters of a profile have its name before theirs: ``door_friction``; so have constants of the
    materials where there are several: ``foot_c10``.

    Load steps and contact penalties that the file does not give are chosen now, by analyses of the
    nominal seal (``seals.steps_and_penalties``), and are the seal's own from then on, whatever its
    design; with ``accuracy`` in ``[section]`` also the particles (``accuracy.chosen_spacing``). The
    last of these analyses is that of the seal itself: the first ``analyze(seal)`` returns it.

    Parameters
    ----------
    file : SealFile, str or Path
        What ``read_seal_file`` returns, or the path that it takes.
    callback : callable, optional
        As of ``seals.steps_and_penalties.choose`` and ``accuracy.chosen_spacing.refine``, for these
        analyses.
    step_ends : sequence of float, optional
        Ends of load steps that have been chosen before, in stages, in place of a choice.
    penalties : mapping of str to float, optional
        Penalties that have been chosen before, by the names of their parameters, kPa/mm.
    unchosen : OutlineSeal, optional
        ``unchosen_seal(file)`` where it is at hand, so that the section is not filled again.
    filling : mapping, optional
        Particles that have been chosen before: ``spacing`` (mm), ``layers`` and ``edge_spacing`` (mm).

    Raises
    ------
    SealFileError
        For a section that cannot be filled at this spacing, a design with too few parameters, particles
        or load steps that are not found within the tolerance, or ends of steps, penalties or a filling
        that are not those of the file; for a path, whatever ``read_seal_file`` refuses.
    LoadPathError
        When something is to be chosen and the path of the nominal seal cannot be completed; its
        ``result`` is as far as it came.
    TypeError
        For anything else than a ``SealFile`` or a path.
    """
    return file_and_seal(
        file, callback, step_ends=step_ends, penalties=penalties, unchosen=unchosen, filling=filling
    )[1]


def file_and_seal(
    file: SealFile | str | Path,
    callback: Callable | None = None,
    report: Callable[[Cloud], None] | None = None,
    *,
    step_ends: Sequence[float] | None = None,
    penalties: Mapping[str, float] | None = None,
    unchosen: OutlineSeal | None = None,
    filling: Mapping | None = None,
) -> tuple[SealFile, OutlineSeal]:
    """Build the seal of a file as ``build_seal``; also return the file with the particles of the seal.

    Parameters
    ----------
    report : callable, optional
        As of ``accuracy.chosen_spacing.refine``.
    """
    if isinstance(file, str | Path):
        file = read_seal_file(file)
    values.instance("file", file, SealFile)
    if filling is not None:
        file = with_filling(file, filling)
    if file.leaves_particles_open:
        if step_ends is not None or penalties is not None:
            raise SealFileError(
                f"{file.path}: the key accuracy of [section] chooses new particles, for which the "
                "given load steps (argument step_ends) and penalties are not valid; also give the "
                "chosen particles (argument filling) with which these were found"
            )
        try:
            cloud = refine(file, report, callback)
        except ValueError as error:
            # messages of the file itself name it already
            own = isinstance(error, SealFileError)
            raise error if own else SealFileError(f"{file.path}: {error}") from error
        file, seal = cloud.file, cloud.result.seal
    else:
        # a section that was filled with other particles is of no use
        unchosen = None if filling is not None else unchosen
        seal = built(file, callback, step_ends, penalties, unchosen)
    return file, seal.made_from(description(file, seal))
