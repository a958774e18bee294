"""Make the animation of the README: the paper's seal under the closing door.

python docs/closing_animation.py        writes docs/_static/seal_closing.gif

The same picture in full size: ``seal-mdao animate examples/paper_seal.toml -o close.gif``.
"""

import sys
import tempfile
from pathlib import Path

from PIL import Image, ImageSequence

from seal_mdao.cli.subcommands import main

HERE = Path(__file__).resolve().parent
TARGET = HERE / "_static" / "seal_closing.gif"
WIDTH = 720
"""Width of the animation, pixels."""
COLOURS = 64
STRIDE = 2
"""One of so many frames of ``seal-mdao animate`` is shown."""


def shrink(source: Path, target: Path) -> None:
    """Write a smaller copy of an animated GIF: fewer frames, pixels and colours."""
    with Image.open(source) as full:
        duration = full.info["duration"]
        frames = [frame.convert("RGB") for frame in ImageSequence.Iterator(full)]
    size = WIDTH, round(WIDTH * frames[0].height / frames[0].width)
    # one palette for all frames, from the last one, which has all colours of the stress scale
    small = [frame.resize(size, Image.Resampling.LANCZOS) for frame in frames[::STRIDE]]
    palette = small[-1].quantize(COLOURS)
    first, *others = (frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in small)
    first.save(
        target, save_all=True, append_images=others, duration=STRIDE * duration, loop=0,
        optimize=True,
    )  # fmt: skip


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        seal = str(HERE.parent / "examples" / "paper_seal.toml")
        status = main(["animate", seal, "--out", folder, "-o", "full.gif"])
        shrink(Path(folder) / "full.gif", TARGET)
    sys.exit(status)
