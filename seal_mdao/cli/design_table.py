"""Table of the design parameters of a seal file, as text."""

from seal_mdao.seals.outline.design_parameters import DesignParameter

MOST_ROWS = 40
"""Largest number of rows that are printed; ``summary.json`` contains all of them."""
COLUMNS = ("index", "[[design]]", "edge", "moves most at", "direction", "motion", "largest", "area")


def design_lines(parameters: list[DesignParameter]) -> list[str]:
    """Tabulate design parameters: a heading with units and a row for each; empty without any."""
    if not parameters:
        return []
    shown = parameters[:MOST_ROWS]
    rows = [COLUMNS, *(_row(own) for own in shown)]
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    lines = ["  ".join(map(str.ljust, row, widths)).rstrip() for row in rows]
    left = len(parameters) - len(shown)
    more = [f"and {left} more, in summary.json"] if left else []
    count = f"{len(parameters)} design parameter{'s' if len(parameters) > 1 else ''}"
    heading = (
        f"{count} (boundary_offsets); effect of an increase by 1 mm on the boundary (mm) and on "
        "the area (mm²):"
    )
    return [heading, *lines, *more]


def _row(own: DesignParameter) -> tuple[str, ...]:
    return (
        str(own.index), str(own.table), own.edge, _point(own.place), own.direction,
        _point(own.velocity), f"{own.largest:.3g}", f"{own.area:+.4g}",
    )  # fmt: skip


def _point(pair: tuple[float, float]) -> str:
    return f"({pair[0]:.3g}, {pair[1]:.3g})"
