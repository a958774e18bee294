"""Numbers of several analyses over the one that varies."""

from collections.abc import Mapping, Sequence

from matplotlib.figure import Figure

from seal_mdao.plotting.style import BLUE, styled, subplots

MOST_COLUMNS = 3


@styled
def numbers_over(label: str, values: Sequence[float], columns: Mapping[str, Sequence]) -> Figure:
    """Plot numbers over a varied one, a panel for each.

    Parameters
    ----------
    label : str
        Of the varied number, with its unit.
    values : sequence of float
    columns : mapping of str to sequence
        Numbers at the values by their names.
    """
    across = min(MOST_COLUMNS, len(columns))
    down = -(-len(columns) // across)
    figure, grid = subplots(down, across, width=3.6 * across, height=2.6 * down, squeeze=False)
    for axes in grid.flat[len(columns) :]:
        axes.set_visible(False)
    for axes, (name, numbers) in zip(grid.flat, columns.items(), strict=False):
        axes.plot(values, numbers, "o-", color=BLUE)
        axes.set_title(name.replace("_", " "), loc="left", fontsize=9.5)
        axes.set_xlabel(label)
    return figure
