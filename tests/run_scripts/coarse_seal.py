"""A seal file that is quick to analyse: the bulb of the docs, coarse and hardly pressed."""

from pathlib import Path

BULB = Path(__file__).parents[1] / "seal_file" / "bulb.toml"
CHANGES = {
    "spacing = 0.9": "spacing = 1.8",
    "[0.0, -6.0]": "[0.0, -1.2]",
    "steps = 60": "steps = 4",
    "[2.0, 0.0]": "[0.0, 0.4]",
    "steps = 20": "steps = 2",
    'edges = ["seal", "cavity"]': 'edges = ["cavity"]',
    "parameters = 12": "parameters = 4",
    "lower = 40.0": "lower = 15.0",
    "upper = 60.0": "upper = 18.0",
    'name = "door"': 'name = "door"\nnormal_penalty = 1e4\ntangent_penalty = 1e2',
}

OPEN = {
    "\nsteps = 4": "", "\nsteps = 2": "", "\nnormal_penalty = 1e4\ntangent_penalty = 1e2": "",
}  # fmt: skip
"""Load steps and penalties are to be chosen."""


def coarse(changes=()) -> str:
    """The text of the file, with some more of it changed."""
    text = BULB.read_text(encoding="utf-8")
    for old, new in (*CHANGES.items(), *dict(changes).items()):
        assert old in text, old
        text = text.replace(old, new)
    return text


def written(folder: Path, changes=()) -> Path:
    """The file in a folder."""
    path = folder / "seal.toml"
    path.write_text(coarse(changes), encoding="utf-8")
    return path
