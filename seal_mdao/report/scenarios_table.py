"""Scenarios of a seal in the report: their numbers, and the measures in each of them."""

from html import escape

import numpy as np

from seal_mdao.recording.recorded_optimization import label, shown_unit
from seal_mdao.recording.recorded_scenarios import RecordedScenarios
from seal_mdao.report.html_tables import number, table, with_unit

MOST_COLUMNS = 3
"""Values of a measure that have columns of their own; of more the largest is shown."""
MOST_ROWS = 20
"""Scenarios of a table that is open at first."""
NOMINAL = "nominal condition"


def nominal_note(name: str, scenarios: RecordedScenarios) -> str:
    """Say as HTML that the pictures of a seal show none of its scenarios."""
    count = len(scenarios.rows)
    return (
        f'<p class="note">Pictures and curves of {escape(name)} show the {NOMINAL}, with the '
        f"parameters of the design itself. The {count} scenarios are in the table of scenarios.</p>"
    )


def scenarios_table(scenarios: RecordedScenarios, name: str = "") -> str:
    """Tabulate the numbers of all scenarios and their measures at the first and at the last point.

    Parameters
    ----------
    name : str
        Of the seal where there are several.
    """
    columns = {}
    for measure, (unit, values) in scenarios.measures.items():
        for heading, own in _by_column(measure, values).items():
            columns[with_unit(heading, shown_unit(unit)) + ", start → end"] = own
    rows = [
        [str(i + 1), *map(number, row), *(_start_to_end(own[:, i]) for own in columns.values())]
        for i, row in enumerate(scenarios.rows.tolist())
    ]
    caption = f"Scenarios of {name}" if name else "Scenarios"
    text = table(["scenario", *scenarios.columns, *columns], rows, caption)
    if len(rows) <= MOST_ROWS:
        return text
    return f"<details><summary>{escape(caption)}: {len(rows)}</summary>{text}</details>"


def _by_column(measure: str, values: np.ndarray) -> dict:
    """Split values (n, S, m) into columns (n, S) by heading; the largest of many values."""
    size = values.shape[2]
    if size == 1:
        return {label(measure): values[..., 0]}
    if size <= MOST_COLUMNS:
        return {label(f"{measure}[{i}]"): values[..., i] for i in range(size)}
    return {f"{label(measure)}, largest of {size}": values.max(axis=2)}


def _start_to_end(values: np.ndarray) -> str:
    # of a single point its value alone
    ends = values[[0, -1]] if len(values) > 1 else values
    return " → ".join(map(number, ends))
