"""Read files of users, and files named in them: only ordinary files of bounded size."""

import errno
import os
import re
import stat
from pathlib import Path

LARGEST_FILE = 2**28
"""Bytes of a file that is read at once."""


def require_ordinary(path) -> None:
    """Check that a path is that of an ordinary file of bounded size.

    Raises
    ------
    OSError
        For a folder, a device, a pipe, or too many bytes; its ``strerror`` says so.
    """
    found = Path(path).stat()
    if stat.S_ISDIR(found.st_mode):
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), str(path))
    if not stat.S_ISREG(found.st_mode):
        raise OSError(errno.EINVAL, "it is a device or a pipe, not a file", str(path))
    if found.st_size > LARGEST_FILE:
        raise _too_large(path)


def read_bytes(path) -> bytes:
    """Read the content of an ordinary file.

    Raises
    ------
    OSError
        As ``require_ordinary``.
    """
    require_ordinary(path)
    with Path(path).open("rb") as file:
        # files of the system may report no size
        content = file.read(LARGEST_FILE + 1)
    if len(content) > LARGEST_FILE:
        raise _too_large(path)
    return content


def read_text(path, encoding: str = "utf-8") -> str:
    """Read the text of an ordinary file, with newlines only.

    Raises
    ------
    OSError
        As ``require_ordinary``.
    UnicodeDecodeError
        For other bytes.
    """
    return read_bytes(path).decode(encoding).replace("\r\n", "\n").replace("\r", "\n")


def filled_lines(path, failure: type[Exception]) -> list[tuple[str, str]]:
    """Read the lines of a file of data in UTF-8, without empty ones and comments.

    Parameters
    ----------
    failure : type
        Exception to raise, with one line, for a file that cannot be read or is no text.

    Returns
    -------
    list of (str, str)
        File and number of the line for messages, and its text.
    """
    try:
        lines = read_text(path, "utf-8-sig").splitlines()
    except OSError as error:
        raise failure(f"{path}: cannot be read: {error.strerror}") from None
    except UnicodeDecodeError:
        raise failure(f"{path}: not a text file in UTF-8; save it in this encoding") from None
    return [
        (f"{path}, line {number}", line)
        for number, line in enumerate(lines, 1)
        if line.strip().strip(",") and not line.lstrip().startswith("#")
    ]


def _too_large(path) -> OSError:
    return OSError(
        errno.EFBIG,
        f"the input file is larger than the limit of {LARGEST_FILE // 2**20} MiB",
        str(path),
    )


def reason_of(error: BaseException) -> str:
    """Describe why a library cannot read a file, without its message, which may quote the file.

    Returns what the operating system says, or the kind of the error, and the line if it names one.
    """
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    line = re.search(r"\bline:? #?(\d{1,9})\b", str(error))
    return type(error).__name__ + (f", line {line[1]}" if line else "")
