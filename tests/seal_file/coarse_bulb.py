"""The bulb of the documentation, coarse and slightly compressed, which is quick to analyse."""

from pathlib import Path

BULB = Path(__file__).parent / "bulb.toml"
COARSE = {
    "spacing = 0.9": "spacing = 1.8", "[0.0, -6.0]": "[0.0, -1.2]", "steps = 60": "steps = 4",
    "[2.0, 0.0]": "[0.0, 0.4]", "steps = 20": "steps = 2",
    'name = "door"': 'name = "door"\nnormal_penalty = 1e4\ntangent_penalty = 1e2',
}  # fmt: skip
"""Changes of its text."""


def changed(text: str, changes) -> str:
    """The text with every key of ``changes``, which must be in it, replaced by its value."""
    for old, new in dict(changes).items():
        assert old in text, old
        text = text.replace(old, new)
    return text
