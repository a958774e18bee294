"""What stands for figures, texts and numbers that a build without figures lacks.

Files are written where the pages look for them. The next build with figures replaces them,
for only a group that was made has its sources recorded.
"""

import re
from pathlib import Path

import matplotlib.image
import numpy as np

ELLIPSIS = "…"
GREY, SHAPE = 0.85, (90, 160)
TARGETS = re.compile(r"^```\{(?:figure|include)\} (\S+)|<(\S+\.html)>`", re.MULTILINE)
NUMBER = re.compile(r"\{\{ (\w+)\.([\w.]+) \}\}")


def texts(docs: Path) -> dict[Path, str]:
    """Text of every page that is written by hand, by its path."""
    pages = (p for p in docs.rglob("*.md") if not {"_build", "_generated", "_static"} & {*p.parts})
    return {page: page.read_text(encoding="utf-8") for page in sorted(pages)}


def write_missing(docs: Path, generated: Path) -> None:
    """Write a grey picture or a line of text for every file that pages show and that is not there."""
    for page, text in texts(docs).items():
        for shown in TARGETS.findall(text):
            target = (page.parent / (shown[0] or shown[1])).resolve()
            if target.is_relative_to(generated) and not target.exists():
                target.parent.mkdir(parents=True, exist_ok=True)
                if target.suffix == ".png":
                    matplotlib.image.imsave(target, np.full((*SHAPE, 3), GREY))
                else:
                    target.write_text(f"{ELLIPSIS}\n", encoding="utf-8")


def numbers(docs: Path, made: dict) -> dict:
    """The numbers that were made, and an ellipsis for each of the others that the pages quote."""
    found = {group: dict(own) for group, own in made.items()}
    for text in texts(docs).values():
        for group, path in NUMBER.findall(text):
            own, (*outer, name) = found.setdefault(group, {}), path.split(".")
            for key in outer:
                own = own.setdefault(key, {})
            own.setdefault(name, ELLIPSIS)
    return found
