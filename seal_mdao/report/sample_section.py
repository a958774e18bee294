"""Designs on samples of their tolerances, as a section of the report."""

from matplotlib.figure import Figure

from seal_mdao.report.embedded_figure import embedded
from seal_mdao.report.html_tables import number, percent, table
from seal_mdao.tolerances.design_comparison import SampledDesign
from seal_mdao.tolerances.statistics import CONFIDENCE, Fraction

NOTE = (
    "Every sample has its own deviations, none of them among the scenarios of the optimisation; all "
    "designs are analysed with the same samples."
)
COST_ROWS = {
    "mean": "mean", "standard deviation": "std", "95 % of the samples are below": "q95",
    "largest": "highest",
}  # fmt: skip


def samples_section(designs: list[SampledDesign], limits, cost: str, figure: Figure) -> str:
    """Format a table and a figure as HTML that needs no other file.

    Parameters
    ----------
    designs : list of SampledDesign
    limits : sequence of SampledLimit
    cost : str
        The minimised measure, with its unit.
    figure : Figure
    """
    # statistics of the cost of every design
    note = NOTE
    costs = [design.summary(())[design.cost] for design in designs]
    rows = [
        [head, *(number(own[key], 3) for own in costs)]
        for head, key in ({f"{cost}, median": "q50"} | COST_ROWS).items()
    ]
    # fraction of the samples within each limit
    rows += [
        [limit.text, *(_percent(design.fraction(limit)) for design in designs)] for limit in limits
    ]
    if limits:
        note = f"In brackets: intervals of {percent(CONFIDENCE)} confidence. {NOTE}"
    rows.append(["samples that could not be analysed", *(str(own.failed) for own in designs)])
    heads = ["", *(design.label for design in designs)]
    caption = f"On {designs[0].samples} new samples of all tolerances"
    return (
        '<section aria-labelledby="samples-title"><h2 id="samples-title">Scatter by tolerances</h2>'
        f'<div class="tables">{table(heads, rows, caption)}</div>'
        f'{embedded(figure, caption)}<p class="note">{note}</p></section>'
    )


def _percent(own: Fraction) -> str:
    """Format a fraction with its confidence interval."""
    return f"{percent(own.value)} ({percent(own.low)} to {percent(own.high)})"
