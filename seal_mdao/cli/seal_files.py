"""Read seal files for the subcommands, with one-line errors."""

import json
from collections.abc import Callable
from contextlib import contextmanager
from pathlib import Path

import seal_mdao as sm
from seal_mdao.accuracy.chosen_spacing import Cloud
from seal_mdao.file_seal import file_and_seal
from seal_mdao.measures.contact_pressure import ENOUGH
from seal_mdao.plotting.captions import name_seal
from seal_mdao.progress import LoadStepProgress, Waiting
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.file.section_table import SectionTable
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.outline.sizes import ACROSS
from seal_mdao.stored_choice import store_choice, stored_choice


@contextmanager
def file_errors(path: Path):
    """Turn errors met with a seal file into errors that name the file."""
    try:
        yield
    except sm.SealFileError:
        raise
    except (ValueError, ImportError) as error:
        raise sm.SealFileError(f"{path}: {' '.join(str(error).split())}") from error


def file_of(path: Path) -> SealFile:
    """Read a seal file; captions of figures that are saved afterwards name it and its materials.

    Raises
    ------
    SealFileError
    """
    with file_errors(path):
        file = sm.read_seal_file(path)
    name_seal(path.stem, file)
    return file


def filled(file: SealFile) -> OutlineSeal:
    """Fill the section of a file with particles and build its seal, without choosing load steps and
    penalties.

    Raises
    ------
    SealFileError
    """
    with file_errors(file.path), Waiting("placing particles and finding their neighbours"):
        return unchosen_seal(file)


def seal_of(
    file: SealFile,
    chosen: dict | None = None,
    unchosen: OutlineSeal | None = None,
    report: Callable[[Cloud], None] | None = None,
    anew: bool = False,
) -> tuple[SealFile, OutlineSeal]:
    """Build the seal of a file; choose particles, load steps and penalties that are not given.

    Parameters
    ----------
    chosen : dict, optional
        What was chosen before, as ``chosen_for`` returns it.
    unchosen : OutlineSeal, optional
        As of ``build_seal``.
    report : callable, optional
        Called with every cloud that is tried for the ``accuracy`` of the file.
    anew : bool
        Whether to choose again what an earlier command has chosen for the same file.

    Returns
    -------
    SealFile
        With the particles of the seal.
    OutlineSeal

    Raises
    ------
    SealFileError
    LoadPathError
        When the path on which they are to be chosen cannot be completed.
    """
    for notice in notices(file):
        print(notice)
    if unchosen is None and not file.leaves_particles_open:
        unchosen = filled(file)

    def tried(cloud: Cloud) -> None:
        print(cloud_line(cloud), flush=True)
        if report is not None:
            report(cloud)

    with file_errors(file.path):
        if not file.leaves_open or chosen is not None:
            # nothing to choose, or chosen in an earlier run
            return file_and_seal(file, **(chosen or {}), unchosen=unchosen)
        stored = None if anew else stored_choice(file)
        if stored is not None:
            made = file_and_seal(file, **stored, unchosen=unchosen)
        else:
            with LoadStepProgress(None, f"choosing {_open_in(file)}") as progress:
                made = file_and_seal(file, progress, tried, unchosen=unchosen)
            store_choice(*made)
    # the choice decides the results: print it
    for line in chosen_lines(*made):
        print(line if stored is None else f"{line} (by an earlier command)")
    return made


def notices(file: SealFile) -> list[str]:
    """List what of a drawing is left out, which particles a file without spacing has, and which part of
    a symmetric section it describes; one line each."""
    default = ""
    if file.section.default_spacing:
        default = (
            f"particles by default: {', '.join(filling_lines(file.section))} in [section], which is "
            f"1/{ACROSS} of the smaller dimension of the section; `seal-mdao analyze` and `seal-mdao "
            "optimize` estimate the numerical error of the forces, `seal-mdao analyze --errors` that "
            "of all measures"
        )
    return [line for line in (file.section.notice, default, file.part) if line]


def cloud_line(cloud: Cloud) -> str:
    """Describe the particles of a cloud, its largest error in relation to the admissible one, and a
    contact with too few points."""
    worst, filling = cloud.worst, ", ".join(filling_lines(cloud.file.section))
    few = "" if cloud.few_points is None else f"; {cloud.few_points} (at least {ENOUGH})"
    return (
        f"{filling}, {len(cloud.result.particles)} particles: estimated error of {worst.name} "
        f"{100.0 * worst.error:.2g} % (at most {100.0 * worst.admissible:g} %){few}"
    )


def filling_lines(section: SectionTable) -> list[str]:
    """Write the particles of a section as keys of ``[section]``."""
    lines = [f"spacing = {section.spacing:g}", f"layers = {section.layers}"]
    edges = [f"{json.dumps(name)} = {h:g}" for name, h in section.edge_spacing.items()]
    return lines + ([f"edge_spacing = {{ {', '.join(edges)} }}"] if edges else [])


def _open_in(file: SealFile) -> str:
    parts = ["load steps"] if file.step_tolerance is not None else []
    return " and ".join(parts + (["penalties"] if file.open_penalties else []))


def chosen_lines(file: SealFile, seal: OutlineSeal) -> list[str]:
    """List what was chosen with its allowed errors, one line each."""
    lines = []
    if file.section.chosen:
        lines.append(f"particles chosen for accuracy: {', '.join(filling_lines(file.section))}")
    if file.step_tolerance is not None:
        within = f"chosen for an estimated numerical error of at most {file.step_tolerance:.2%}"
        missed = f"whose estimated numerical error exceeds the allowed {file.step_tolerance:.2%}"
        lines.append(f"{seal.n_steps} load steps, {missed if seal.step_error else within}")
    # penalties by name, kPa/mm
    penalties = chosen_for(file, seal).get("penalties", {})
    if penalties:
        listed = ", ".join(f"{name} = {value:g}" for name, value in penalties.items())
        lines.append(
            "contact penalties chosen for an estimated numerical error of at most "
            f"{file.penalty_tolerance:.2%}: {listed} kPa/mm"
        )
    return lines
