"""Designs on samples of their tolerances, as a section of the report."""

import io
from base64 import b64encode

from matplotlib.figure import Figure

from seal_mdao.report.tables import number, share, table
from seal_mdao.tolerances.comparison import SampledDesign

NOTE = (
    "Every sample is a car and a seal of its own, none of them among the scenarios of the "
    "optimisation; all designs meet the same ones. Gaps are integrals of the squared gap between the "
    "contacts of the drawn seal."
)


def samples_section(designs: list[SampledDesign], band, floor, figure: Figure) -> str:
    """A table and a figure as HTML that stands by itself.

    Parameters
    ----------
    designs : list of SampledDesign
    band : pair of float
        Limits of the reaction, N/m.
    floor : ndarray, shape (patches,)
        Least contact pressures, kPa.
    figure : Figure
    """
    rows = [[head, *map(text, designs)] for head, text in _rows(band, floor)]
    heads = ["", *(design.label for design in designs)]
    caption = f"On {designs[0].samples} fresh samples of all tolerances"
    drawn = io.BytesIO()
    figure.savefig(drawn, dpi=160)
    image = b64encode(drawn.getvalue()).decode("ascii")
    return (
        '<section aria-labelledby="samples-title"><h2 id="samples-title">On other cars</h2>'
        f'<div class="tables">{table(heads, rows, caption)}</div>'
        f'<figure><img src="data:image/png;base64,{image}" alt="{caption}" '
        f'style="max-width:100%"></figure><p class="note">{NOTE}</p></section>'
    )


def _rows(band, floor) -> list:
    """Headings, and what says the cell of a design."""
    low, high = (number(limit, 3) for limit in band)
    least = " and ".join(number(value, 3) for value in floor)

    def of_cost(key):
        return lambda design: number(design.summary(band, floor)["gap_square_integral"][key], 3)

    return [
        ("integral of the squared gap (mm³), median", of_cost("q50")),
        ("mean", of_cost("mean")),
        ("standard deviation", of_cost("std")),
        ("95 % of the samples are below", of_cost("q95")),
        ("largest", of_cost("highest")),
        (f"reaction within {low} to {high} N/m", lambda design: share(design.within(band))),
        (f"contact pressure of at least {least} kPa", lambda design: share(design.above(floor))),
        ("samples that could not be analysed", lambda design: str(design.failed)),
    ]
