"""Files of the repository that a group of figures was made from, and whether they have changed.

The process that makes a group records what it reads: the modules that it has imported at its end,
the files that it has opened and the folders that it has listed. One that starts another program
depends on the complete package and on all scripts.
"""

import ast
import hashlib
import json
import os
import sys
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ("seal_mdao", "run_scripts", "examples", "docs", "tests")
LEFT_OUT = {"__pycache__", "_generated", "_build"}
DISPATCH = "docs/make_figures.py"
"""Says which groups there are; no figure depends on it."""


class Record:
    """Names of files and folders that this process reads, from now on."""

    def __init__(self):
        self._paths, self._started = set(), False
        sys.addaudithook(self._hear)

    def _hear(self, event: str, arguments: tuple) -> None:
        if event in ("open", "os.scandir") and isinstance(arguments[0], str | bytes | os.PathLike):
            self._paths.add(os.path.abspath(os.fsdecode(arguments[0])))
        elif event == "subprocess.Popen":
            self._started = True

    def digests(self) -> dict[str, str]:
        """Digest of every file and folder that was read, by its path in the repository."""
        paths = {Path(path) for path in self._paths}
        paths |= {Path(m.__file__) for m in [*sys.modules.values()] if getattr(m, "__file__", None)}
        if self._started:
            paths |= {p for folder in FOLDERS[:3] for p in (ROOT / folder).rglob("*.*")}
        inside = {name for path in paths if (name := _name(path)) and path.exists()}
        return {name: _digest(name) for name in sorted(inside - {DISPATCH})}


def unchanged(stored: Path) -> bool:
    """Return whether all that a group was made from, as ``stored`` lists it, is as it was."""
    if not stored.exists():
        return False
    made_from = json.loads(stored.read_text(encoding="utf-8"))
    return all((ROOT / name).exists() and _digest(name) == own for name, own in made_from.items())


def _name(path: Path) -> str | None:
    """Path in the repository; None for files that are no sources."""
    if not path.is_relative_to(ROOT):
        return None
    parts = path.relative_to(ROOT).parts
    if not parts or parts[0] not in FOLDERS or LEFT_OUT & {*parts}:
        return None
    return "/".join(parts)


@cache
def _digest(name: str) -> str:
    """Of a file's bytes, of a module's statements without comments, of the data files in a folder."""
    path = ROOT / name
    if path.is_dir():
        content = "\n".join(sorted(p.name for p in path.iterdir() if p.suffix != ".py"
                                   and p.name not in LEFT_OUT)).encode()  # fmt: skip
    elif path.suffix == ".py":
        content = ast.dump(ast.parse(path.read_bytes())).encode()
    else:
        content = path.read_bytes()
    return hashlib.sha256(content).hexdigest()
