"""Numbers of several analyses over the one that varies."""

from collections.abc import Collection, Mapping, Sequence

from matplotlib.figure import Figure

from seal_mdao.plotting.style import BLUE, styled, subplots
from seal_mdao.plotting.travel_curves import add_length_axis
from seal_mdao.seals.result_units import ResultUnits

MOST_COLUMNS = 3


@styled
def numbers_over(
    label: str,
    values: Sequence[float],
    columns: Mapping[str, Sequence],
    ring: ResultUnits | None = None,
    forces: Collection[str] = (),
) -> Figure:
    """Plot numbers over a varied one, a panel for each.

    Parameters
    ----------
    label : str
        Of the varied number, with its unit.
    values : sequence of float
    columns : mapping of str to sequence
        Numbers at the values by the titles of their panels.
    ring : ResultUnits, optional
        Of rings of one circumference: ``forces`` have a right axis in N per mm of it.
    forces : collection of str
        Titles of the columns that are forces, N.
    """
    across = min(MOST_COLUMNS, len(columns))
    down = -(-len(columns) // across)
    figure, grid = subplots(down, across, width=3.6 * across, height=2.6 * down, squeeze=False)
    for axes in grid.flat[len(columns) :]:
        axes.set_visible(False)
    for axes, (name, numbers) in zip(grid.flat, columns.items(), strict=False):
        axes.plot(values, numbers, "o-", color=BLUE)
        axes.set_title(name, loc="left", fontsize=9.5)
        axes.set_xlabel(label)
        if name in forces:
            add_length_axis(axes, ring)
    return figure
