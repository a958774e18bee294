"""Files in the user's cache with what later runs need again: choices for seal files, triangulations.

What is stored depends on its key, the code of this package and the version of the mesher only, and is
the same bits when it is read again.
"""

import hashlib
import json
import os
import time
from contextlib import suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from platformdirs import user_cache_path

FOLDER = "SEAL_MDAO_CHOICES"
"""Environment variable with the folder of stored files; empty: nothing is stored or read."""
PACKAGE = Path(__file__).parent
MESHER = "netgen-mesher"
"""Distribution that makes the triangles inside sections."""
UNUSED = 90 * 24 * 3600.0
"""Seconds without use after which a stored file is deleted."""


def stored_file(kind: str, key) -> Path | None:
    """Return the path of what is stored for a key, any content of a JSON file; None without a folder.

    ``kind`` is the word with which the name of the file begins.
    """
    own = os.environ.get(FOLDER)
    if own == "":
        return None
    folder = user_cache_path("seal_mdao") / "choices" if own is None else Path(own)
    digest = hashlib.sha256(_code(PACKAGE) + json.dumps(key, sort_keys=True).encode())
    return folder / f"{kind}-{digest.hexdigest()[:32]}.json"


def read_stored(path: Path | None) -> dict | None:
    """Read a stored file; None for one that is missing, cannot be read or is damaged."""
    if path is None:
        return None
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        # reading counts as use
        os.utime(path)
    except (OSError, ValueError):
        return None
    return found


def store(path: Path | None, content: dict) -> None:
    """Write a file; nothing where the path is None or cannot be written."""
    if path is None:
        return
    # other processes see a complete file or none
    unfinished = path.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        _delete_unused(path.parent)
        unfinished.write_text(json.dumps(content), encoding="utf-8")
        unfinished.replace(path)


@cache
def _code(package: Path) -> bytes:
    """Return a digest of all modules of a package and of the version of the mesher."""
    digest = hashlib.sha256()
    with suppress(PackageNotFoundError):
        digest.update(version(MESHER).encode())
    for module in sorted(package.rglob("*.py")):
        digest.update(module.read_bytes())
    return digest.digest()


def _delete_unused(folder: Path) -> None:
    """Delete files that were not used for ``UNUSED`` seconds."""
    for path in folder.iterdir():
        # another process may delete it, too
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > UNUSED:
                path.unlink()
