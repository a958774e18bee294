"""Particles, load steps and penalties that a command chose for a seal file, stored for the next one.

The choice takes two to three times as long as the analysis, and minutes with ``accuracy``. It depends on
the seal file and the files that it names, so it is stored in the user's cache for every state of these
(``user_cache``). The results of an analysis with a stored choice are the same bits as those of the
command that made it (``seals.chosen_path``).
"""

from pathlib import Path

from seal_mdao import registry
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.described import contents
from seal_mdao.seals.file.file_tables import SealFile
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.user_cache import read_stored, store, stored_file


def stored_choice(file: SealFile) -> dict | None:
    """Return what was chosen for a seal file, keyword arguments of ``build_seal``; None where nothing is
    stored."""
    return read_stored(_path(file))


def store_choice(file: SealFile, seal: OutlineSeal) -> None:
    """Store what was chosen for the seal of a file with the particles of the seal.

    Load steps whose error is above the allowed one are not stored, because their warning depends on the
    analyses of the choice.
    """
    path = _path(file)
    if path is not None and not seal.step_error:
        store(path, chosen_for(file, seal))


def _path(file: SealFile) -> Path | None:
    """Return the path of the choice for a file; None for one that leaves nothing open or was changed
    after it was read, with installed or registered extensions, whose code is not known, and without a
    folder."""
    text = contents(file)
    if not text or not file.leaves_open:
        return None
    if any(registry.names(kind) for kind in registry.CONTRACTS):
        return None
    return stored_file("choice", text)
