"""What the scripts of a seal file share: reading it, and its errors in one line."""

from contextlib import contextmanager
from pathlib import Path

import seal_mdao as sm
from seal_mdao.progress import LoadStepProgress
from seal_mdao.seals.file.build import build_seal
from seal_mdao.seals.file.tables import SealFile
from seal_mdao.seals.outline.seal import OutlineSeal
from seal_mdao.seals.step_choice import FINER


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


def seal_of(file: SealFile, step_ends=None) -> OutlineSeal:
    """The seal that a file describes; load steps that are to be chosen are, behind a progress bar.

    Raises
    ------
    SealFileError
    LoadPathError
        When the path on which load steps are to be chosen cannot be completed.
    """
    with file_errors(file.path):
        if file.step_tolerance is None or step_ends is not None:
            return build_seal(file, step_ends=step_ends)
        with LoadStepProgress(None, "choosing load steps, analysis") as progress:
            seal = build_seal(file, progress)
    print(
        f"{seal.n_steps} load steps, chosen within {file.step_tolerance:.2%} of {FINER} times as many"
    )
    return seal
