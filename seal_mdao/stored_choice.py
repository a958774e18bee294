"""Particles, load steps and penalties that a command chose for a seal file, stored for the next one.

The choice takes two to three times as long as the analysis, and minutes with ``accuracy``. It depends on
the seal file, the files that it names and the code of this package only, so a file is stored in the
user's cache for every state of these. The results of an analysis with a stored choice are the same bits
as those of the command that made it (``seals.chosen_path``).
"""

import hashlib
import json
import os
import time
from contextlib import suppress
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

from seal_mdao import registry
from seal_mdao.compilation import PACKAGE
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.described import contents
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal

FOLDER = "SEAL_MDAO_CHOICES"
"""Environment variable with the folder of stored choices; empty: nothing is stored or read."""
UNUSED = 90 * 24 * 3600.0
"""Seconds without use after which a stored choice is deleted."""


def stored_choice(file: SealFile) -> dict | None:
    """Return what was chosen for a seal file, keyword arguments of ``build_seal``; None where nothing is
    stored."""
    path = _path(file)
    if path is None:
        return None
    # a file that cannot be read or is damaged counts as missing
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
        os.utime(path)
    except (OSError, ValueError):
        return None
    return found


def store_choice(file: SealFile, seal: OutlineSeal) -> None:
    """Store what was chosen for the seal of a file with the particles of the seal.

    Load steps whose error is above the allowed one are not stored, because their warning depends on the
    analyses of the choice.
    """
    path = _path(file)
    if path is None or seal.step_error:
        return
    # other processes see a complete file or none
    unfinished = path.with_suffix(f".{os.getpid()}")
    with suppress(OSError):
        path.parent.mkdir(parents=True, exist_ok=True)
        _delete_unused(path.parent)
        unfinished.write_text(json.dumps(chosen_for(file, seal)), encoding="utf-8")
        unfinished.replace(path)


def _path(file: SealFile) -> Path | None:
    """Return the path of the choice for a file; None for one that leaves nothing open or was changed
    after it was read, with installed or registered extensions, whose code is not known, and without a
    folder."""
    own, text = os.environ.get(FOLDER), contents(file)
    if own == "" or not text or not file.leaves_open:
        return None
    if any(registry.names(kind) for kind in registry.CONTRACTS):
        return None
    folder = user_cache_path("seal_mdao") / "choices" if own is None else Path(own)
    digest = hashlib.sha256(_sources(PACKAGE) + json.dumps(text, sort_keys=True).encode())
    return folder / f"{digest.hexdigest()[:32]}.json"


@cache
def _sources(package: Path) -> bytes:
    """Return a digest of all modules of a package."""
    digest = hashlib.sha256()
    for module in sorted(package.rglob("*.py")):
        digest.update(module.read_bytes())
    return digest.digest()


def _delete_unused(folder: Path) -> None:
    """Delete choices that were not used for ``UNUSED`` seconds."""
    for path in folder.iterdir():
        # another process may delete it, too
        with suppress(OSError):
            if time.time() - path.stat().st_mtime > UNUSED:
                path.unlink()
