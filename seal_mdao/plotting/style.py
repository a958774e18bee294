"""Colours, sizes, creation and saving of figures."""

from io import BytesIO
from pathlib import Path

import matplotlib
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from PIL import Image

from seal_mdao.plotting.captions import caption

# palette of Okabe and Ito, distinguishable with any colour vision
ORANGE, SKY, GREEN, BLUE = "#E69F00", "#56B4E9", "#009E73", "#0072B2"
VERMILION, PURPLE = "#D55E00", "#CC79A7"
GREY, LIGHT_GREY, CELL_GREY = "#6E6E6E", "#DADADA", "#C9C9C9"
CYCLE = (BLUE, VERMILION, GREEN, PURPLE, ORANGE, SKY, GREY)
DASHES = ("-", (0, (2.0, 0.8)), (0, (0.7, 0.7)))
MARKERS = ("o", "s", "^", "D", "v", "P", "X")

STRESS_MAP = "viridis"
STRESS_MAPS = (STRESS_MAP, "YlOrBr", "PuBuGn", "BuPu")
"""Colours of the stress in every material."""
COMPRESSION = {"compress_level": 2}
"""Options of PNG files: level 6, the usual one, takes three times as long for 10 % less."""
BESIDE = {"loc": "center left", "bbox_to_anchor": (1.0, 0.5)}
"""Options of a legend on the right of its axes."""

SETTINGS = {
    "font.size": 10.0,
    # glyphs as they are designed: at this resolution grid-fitting takes time and changes little
    "text.hinting": "none",
    "axes.titlesize": 10.5,
    "axes.labelsize": 10.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "grid.color": "#E6E6E6",
    "grid.linewidth": 0.7,
    "axes.axisbelow": True,
    "legend.edgecolor": "none",
    "legend.framealpha": 0.85,
    "legend.fontsize": 9.0,
    "hatch.linewidth": 0.6,
    "lines.linewidth": 1.6,
    "lines.markersize": 5.0,
}


styled = matplotlib.rc_context(SETTINGS)
"""Decorator of functions that create a figure: applies ``SETTINGS`` while they run."""


class ShownFigure(Figure):
    """A figure that a notebook shows as the value of a cell, without pyplot."""

    @styled
    def _repr_png_(self) -> bytes:
        return png(self, 100)


class SectionLayout(ConstrainedLayoutEngine):
    """Constrained layout that is exact for axes of equal aspect in one run.

    The layout takes the margin of axes as the distance of their labels from the space that they could
    fill. Where the aspect leaves a part of it empty this margin is too small, and the next run, in which
    they are larger, would correct it; until then labels lie on titles and legends of the figure.
    """

    def execute(self, fig):
        """Reserve space for axes that fill it; their aspect makes them smaller when they are drawn."""
        aspects = {axes: axes.get_aspect() for axes in fig.axes}
        fixed = {axes: aspect for axes, aspect in aspects.items() if aspect != "auto"}
        for axes in fixed:
            axes.set_aspect("auto")
        try:
            return super().execute(fig)
        finally:
            for axes, aspect in fixed.items():
                axes.set_aspect(aspect)


def signed(value: float, digits: int = 1) -> str:
    """Format a number with a typographic minus sign, zero without a sign."""
    return f"{round(value, digits) + 0.0:.{digits}f}".replace("-", "\u2212")


def scientific(value: float, digits: int = 2) -> str:
    """Format a number for mathtext, small and large ones with a power of ten."""
    # format g switches to an exponent outside 1e-4 to 10^digits
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    return f"${mantissa} \\cdot 10^{{{int(exponent)}}}$" if exponent else mantissa


def subplots(rows: int = 1, columns: int = 1, *, width: float, height: float, **options):
    """Create a figure outside pyplot with a grid of axes.

    Parameters
    ----------
    rows, columns : int
    width, height : float
        Inches.
    **options
        For ``Figure.subplots``.

    Returns
    -------
    figure : Figure
    axes : Axes or ndarray of Axes
    """
    # not by pyplot, which would keep every figure open and needs a display for some backends
    figure = ShownFigure(figsize=(width, height), layout=SectionLayout())
    FigureCanvasAgg(figure)
    return figure, figure.subplots(rows, columns, **options)


def panels(count: int, most: int, size, **options):
    """Create a figure with ``count`` axes in rows of at most ``most``.

    Parameters
    ----------
    count, most : int
    size : callable
        ``size(rows, columns)`` returns width and height, inches.
    **options
        For ``Figure.subplots``.

    Returns
    -------
    figure : Figure
    axes : list of Axes
        Those in use; the rest of the last row is hidden.
    """
    columns = min(count, most)
    rows = -(-count // columns)  # rounded up
    width, height = size(rows, columns)
    figure, grid = subplots(rows, columns, width=width, height=height, squeeze=False, **options)
    for axes in grid.flat[count:]:
        axes.set_visible(False)
    return figure, list(grid.flat[:count])


def mark_failure(figure: Figure, result) -> None:
    """Write above a figure where the path of a result stopped, unless it was completed."""
    if not result.converged:
        last = len(result.path.nominal_steps) - 1
        figure.suptitle(f"path stopped at {result.caption(last)}", fontsize=10.5, color=VERMILION)


SMALL_PRINT = 6.5
"""Size of the caption, points."""


def add_caption(figure: Figure) -> None:
    """Write the caption of ``captions.captioned`` into a margin below a figure, once."""
    width, height = figure.get_size_inches()
    # a letter is about half as wide as its size; 72 points an inch
    most = int(width * 72.0 / (0.5 * SMALL_PRINT))
    text = caption(most)
    if not text or any(own.get_gid() == "caption" for own in figure.texts):
        return
    margin = 2.0 * SMALL_PRINT / 72.0 / height
    if figure.get_layout_engine() is not None:
        figure.get_layout_engine().set(rect=(0.0, margin, 1.0, 1.0 - margin))
    # legends below the axes are placed in the figure, not in the layout, which reserves their height;
    # their distance from the edge is in units of their font size
    below = (own for own in figure.legends if getattr(own, "_outside_loc", None) == "lower")
    for legend in below:
        legend.borderaxespad += 2.0 * SMALL_PRINT / legend.prop.get_size_in_points()
    # names may hold the $ that begins a formula
    shown = figure.text(
        0.99, 0.3 * margin, text, ha="right", va="bottom", color=GREY, fontsize=SMALL_PRINT,
        gid="caption", parse_math=False,
    )  # fmt: skip
    # shorter where its letters are wider, so that the figure crops none
    while len(shown.get_text()) > 1 and shown.get_window_extent().x0 < 0.0:
        most = min(most, len(shown.get_text())) - 1
        shown.set_text(caption(most))


def png(figure: Figure, dpi: int) -> bytes:
    """Return the PNG of a figure with its caption."""
    add_caption(figure)
    content = BytesIO()
    figure.savefig(content, format="png", dpi=dpi)
    return content.getvalue()


@styled
def save(figure: Figure, path, dpi: int = 160) -> Path:
    """Write a figure with its caption to ``path``, creating its folder, and return the path."""
    path = Path(path)
    add_caption(figure)
    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix != ".png":
        figure.savefig(path, dpi=dpi)
        return path
    # drawn once: ``savefig`` draws a figure with a layout engine twice, first only for the layout
    figure.set_dpi(dpi)
    figure.canvas.draw()
    size = figure.canvas.get_width_height(physical=True)
    image = Image.frombuffer("RGBA", size, figure.canvas.buffer_rgba(), "raw", "RGBA", 0, 1)
    # of an opaque figure the alpha channel is left out, whose compression takes a quarter of the time
    if figure.get_facecolor()[3] == 1.0:
        image = image.convert("RGB")
    image.save(path, dpi=(dpi, dpi), **COMPRESSION)
    return path
