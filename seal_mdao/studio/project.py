"""The only folder that the live section reads and writes."""

import re
from pathlib import Path

NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 _-]{0,59}(\.[A-Za-z0-9_-]{1,40}){0,2}")
"""Plain names of files: no separators, no leading dot."""
KINDS = (".toml", ".dxf", ".vtu", ".html", ".json", ".csv")
"""Ends of the names of files that are read or written."""


class ProjectError(ValueError):
    """Raised for a name that does not refer to a file in the project folder."""


class Project:
    """Project folder; names refer only to files directly in it.

    Parameters
    ----------
    folder : str or Path

    Raises
    ------
    ProjectError
        For a folder that does not exist.
    """

    def __init__(self, folder):
        self.folder = Path(folder).resolve()
        if not self.folder.is_dir():
            raise ProjectError(f"{folder} is not a folder")

    def path(self, name: str) -> Path:
        """Return the path of a file in the folder.

        Raises
        ------
        ProjectError
            For anything but a plain name of a known kind, and for a link that leads elsewhere.
        """
        if not isinstance(name, str) or not NAME.fullmatch(name):
            raise ProjectError(
                "a file name may contain at most 60 letters, digits, blanks, '-' and '_', and "
                "needs an ending such as .toml"
            )
        path = self.folder / name
        if path.suffix.lower() not in KINDS:
            raise ProjectError(f"{name}: the ending must be {' or '.join(KINDS)}")
        # of plain names only a symbolic link could lead out of the folder
        if path.is_symlink():
            raise ProjectError(f"{name} is not in the project folder")
        return path

    def new(self, stem: str, kinds: tuple = (".toml",)) -> str:
        """Return a name without extension that no file has yet: ``stem``, or ``stem_2`` and so
        on."""
        number = 1
        while True:
            name = stem if number == 1 else f"{stem}_{number}"
            if not any(self.path(f"{name}{kind}").exists() for kind in kinds):
                return name
            number += 1

    def seal_files(self) -> list[str]:
        """List the names of the seal files, sorted."""
        found = (path.name for path in self.folder.glob("*.toml") if not path.is_symlink())
        return sorted(name for name in found if NAME.fullmatch(name))
