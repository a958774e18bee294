"""What the scripts of a seal file share: reading it, and its errors in one line."""

from contextlib import contextmanager
from pathlib import Path

import seal_mdao as sm
from seal_mdao.seals.file.build import build_seal
from seal_mdao.seals.file.tables import SealFile
from seal_mdao.seals.outline.seal import OutlineSeal


@contextmanager
def file_errors(path: Path):
    """What cannot be done with a seal file is said about the file."""
    try:
        yield
    except sm.SealFileError:
        raise
    except (ValueError, ImportError) as error:
        raise sm.SealFileError(f"{path}: {' '.join(str(error).split())}") from error


def seal_of(path: Path) -> tuple[SealFile, OutlineSeal]:
    """A seal file and the seal that it describes.

    Raises
    ------
    SealFileError
    """
    with file_errors(path):
        file = sm.read_seal_file(path)
        return file, build_seal(file)
