"""A seal file that is quick to analyse: the bulb of the docs, coarse and hardly pressed."""

from pathlib import Path

from seal_file.coarse_bulb import BULB, COARSE, changed

CHANGES = COARSE | {
    'edges = ["seal", "cavity"]': 'edges = ["cavity"]',
    "parameters = 12": "parameters = 4",
    "lower = 40.0": "lower = 15.0",
    "upper = 60.0": "upper = 18.0",
}

OPEN = {
    "\nsteps = 4": "", "\nsteps = 2": "", "\nnormal_penalty = 1e4\ntangent_penalty = 1e2": "",
}  # fmt: skip
"""Load steps and penalties are to be chosen."""


def coarse(changes=()) -> str:
    """The text of the file, with some more of it changed."""
    return changed(changed(BULB.read_text(encoding="utf-8"), CHANGES), changes)


def written(folder: Path, changes=()) -> Path:
    """The file in a folder."""
    path = folder / "seal.toml"
    path.write_text(coarse(changes), encoding="utf-8")
    return path
