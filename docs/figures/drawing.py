"""Pictures of the pages: one way to make, label and save them."""

from contextlib import contextmanager
from pathlib import Path

import matplotlib

from seal_mdao.plotting.captions import captioned, materials_text, seal_text
from seal_mdao.plotting.style import SETTINGS, save, subplots
from seal_mdao.seals.door.door_options import DoorOptions

ROOT = Path(__file__).resolve().parents[2]
DOOR_SEAL = {"door seal": materials_text({"rubber": DoorOptions().material})}
"""Caption of figures of the nominal door seal."""


def captioned_files(*files):
    """Print a caption with names and materials of seal files below the figures of a block."""
    return captioned({file.path.stem: seal_text(file) for file in files})


def captioned_body(name: str, date: str = ""):
    """Print a caption below the figures of a block that show a body of Mooney-Rivlin rubber."""
    return captioned({name: materials_text({"rubber": DoorOptions().material})}, date)


@contextmanager
def picture(path: Path, rows: int = 1, columns: int = 1, *, width: float, height: float, **options):
    """Provide the axes of a figure, as ``subplots`` does, and write it when the block ends."""
    with matplotlib.rc_context(SETTINGS):
        figure, axes = subplots(rows, columns, width=width, height=height, **options)
        yield axes
        save(figure, path)


def curves(path: Path, x: str, y: str, lines, size=(5.4, 3.4), legend=(), **settings) -> None:
    """Write a picture of ``lines`` with labels of the axes x and y.

    Parameters
    ----------
    lines : sequence of (x, y, format, color, label) or (..., options)
        Arguments of ``Axes.plot``.
    size : pair of float
        Width and height, inches.
    legend : dict
        Options of the legend.
    **settings
        Further properties of the axes.
    """
    with picture(path, width=size[0], height=size[1]) as axes:
        for at, value, look, color, label, *options in lines:
            axes.plot(at, value, look, color=color, label=label, **dict(*options))
        axes.set(xlabel=x, ylabel=y, **settings)
        axes.legend(**dict(legend))
