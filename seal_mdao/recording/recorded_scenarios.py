"""Scenarios of a recorded ``ScenarioGroup``: their numbers, and measures at the recorded points."""

import json
from dataclasses import dataclass

import numpy as np

from seal_mdao.recording.recorder_file import RecordedModel
from seal_mdao.scenarios.variation import SCENARIOS_OPTION

ENDING = "_scenarios"
"""End of the names of outputs with one row per scenario."""


@dataclass(frozen=True, eq=False)
class RecordedScenarios:
    """S scenarios of a seal.

    Attributes
    ----------
    columns : list of str
        Names of the K varied quantities.
    rows : ndarray, shape (S, K)
        Their numbers.
    measures : dict of str to (str or None, ndarray)
        Units and values, shape (n, S, m), at the n recorded points by measure, as far as recorded.
    """

    columns: list
    rows: np.ndarray
    measures: dict


def read_scenarios(model: RecordedModel, group: str, component: str, cases: list):
    """Read the ``RecordedScenarios`` of a group; None for a group without scenarios.

    Parameters
    ----------
    model : RecordedModel
    group : str
        Path of the group.
    component : str
        Path of its component with the scenarios, with a dot at its end.
    cases : list of Case

    Raises
    ------
    ValueError
        If the file holds a table of scenarios that is none.
    """
    text = model.options[group].get(SCENARIOS_OPTION)
    if not text:
        return None
    columns, rows = _table(text)
    # outputs (S, m) that were recorded at all points
    measures, count = {}, len(rows)
    for name in cases[0].outputs:
        if name.startswith(component) and name.endswith(ENDING):
            values = [case.outputs.get(name) for case in cases]
            if all(value is not None and value.size % count == 0 for value in values):
                own = name.removeprefix(component).removesuffix(ENDING)
                stacked = np.array([np.reshape(value, (count, -1)) for value in values])
                measures[own] = model.units.get(name), stacked
    return RecordedScenarios(columns, rows, measures)


def _table(text: str) -> tuple[list[str], np.ndarray]:
    """Read names of columns and rows of numbers, (S, K), from JSON."""
    try:
        found = json.loads(text)
        columns, rows = found["columns"], np.array(found["rows"], float)
    except (ValueError, TypeError, KeyError, OverflowError, RecursionError) as error:
        raise ValueError(
            f"the recorded option {SCENARIOS_OPTION} is damaged, so the parameters of the scenarios "
            f"are not known ({error}); give another recorder file, or record the run again"
        ) from error
    names = isinstance(columns, list) and all(isinstance(name, str) for name in columns)
    if not names or rows.ndim != 2 or not len(rows) or rows.shape[1] != len(columns):
        raise ValueError(
            f"the recorded option {SCENARIOS_OPTION} is damaged, so the parameters of the scenarios "
            "are not known; give another recorder file, or record the run again"
        )
    return columns, rows
