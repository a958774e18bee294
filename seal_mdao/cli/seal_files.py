"""What the scripts of a seal file share: reading it, and its errors in one line."""

from contextlib import contextmanager
from pathlib import Path

import seal_mdao as sm
from seal_mdao.progress import LoadStepProgress
from seal_mdao.seals.file.build import build_seal
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal


@contextmanager
def file_errors(path: Path):
    """What cannot be done with a seal file is said about the file."""
    try:
        yield
    except sm.SealFileError:
        raise
    except (ValueError, ImportError) as error:
        raise sm.SealFileError(f"{path}: {' '.join(str(error).split())}") from error


def file_of(path: Path) -> SealFile:
    """A seal file, read.

    Raises
    ------
    SealFileError
    """
    with file_errors(path):
        return sm.read_seal_file(path)


def seal_of(file: SealFile, chosen: dict | None = None) -> OutlineSeal:
    """The seal that a file describes; load steps and penalties that it leaves open are chosen, behind a
    progress bar.

    Parameters
    ----------
    chosen : dict, optional
        What was chosen before, as ``chosen_for`` gives it.

    Raises
    ------
    SealFileError
    LoadPathError
        When the path on which they are to be chosen cannot be completed.
    """
    with file_errors(file.path):
        if not file.leaves_open or chosen is not None:
            return build_seal(file, **(chosen or {}))
        with LoadStepProgress(None, f"choosing {_open_in(file)}") as progress:
            seal = build_seal(file, progress)
    for line in chosen_lines(file, seal):
        print(line)
    return seal


def _open_in(file: SealFile) -> str:
    parts = ["load steps"] if file.step_tolerance is not None else []
    return " and ".join(parts + (["penalties"] if file.open_penalties else []))


def chosen_lines(file: SealFile, seal: OutlineSeal) -> list[str]:
    """What was chosen for a seal and within which tolerance, a line each."""
    lines = []
    if file.step_tolerance is not None:
        lines.append(f"{seal.n_steps} load steps, chosen within {file.step_tolerance:.2%}")
    penalties = chosen_for(file, seal).get("penalties", {})
    if penalties:
        listed = ", ".join(f"{name} = {value:g}" for name, value in penalties.items())
        lines.append(f"penalties chosen within {file.penalty_tolerance:.2%}: {listed} kPa/mm")
    return lines
