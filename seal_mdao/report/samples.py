"""Designs on samples of their tolerances, as a section of the report."""

import io
from base64 import b64encode

from matplotlib.figure import Figure

from seal_mdao.report.tables import number, share, table
from seal_mdao.tolerances.sampled_designs import SampledDesign

NOTE = (
    "Every sample is a car and a seal of its own, none of them among the scenarios of the "
    "optimisation; all designs meet the same ones."
)


def samples_section(designs: list[SampledDesign], limits, cost: str, figure: Figure) -> str:
    """A table and a figure as HTML that stands by itself.

    Parameters
    ----------
    designs : list of SampledDesign
    limits : sequence of SampledLimit
    cost : str
        What is made small, with its unit.
    figure : Figure
    """
    rows = [[head, *map(text, designs)] for head, text in _rows(limits, cost)]
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


def _rows(limits, cost: str) -> list:
    """Headings, and what says the cell of a design."""

    def of_cost(key):
        return lambda design: number(design.summary(())[design.cost][key], 3)

    return [
        (f"{cost}, median", of_cost("q50")),
        ("mean", of_cost("mean")),
        ("standard deviation", of_cost("std")),
        ("95 % of the samples are below", of_cost("q95")),
        ("largest", of_cost("highest")),
        *((limit.text, lambda design, own=limit: share(design.share(own))) for limit in limits),
        ("samples that could not be analysed", lambda design: str(design.failed)),
    ]
