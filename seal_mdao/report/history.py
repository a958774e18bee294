"""What the recorder file says, as the report's charts and tables need it."""

import re

import numpy as np

from seal_mdao.plotting.recorded import Constraint, RecordedOptimization

FEASIBLE = 1e-3
"""Largest relative violation of a limit that counts as satisfied."""
NAMES = {
    "gap_square_sum": "sum of squared gaps",
    "gap_square_integral": "integral of the squared gap",
    "stress_norm": "norm of all stresses",
    "patch_pressure": "contact pressure of patch",
    "reaction_curve": "vertical reaction along the path",
    "area": "area of the section",
    "reaction": "vertical reaction",
    "boundary_offsets": "boundary offsets",
    "door_radius": "corner radius of the door",
}
DESIGN_UNITS = {"boundary_offsets": "mm", "door_radius": "mm"}
"""Units of inputs that a recorder leaves out unless it is told otherwise."""


def history_data(history: RecordedOptimization) -> dict:
    """The history as JSON can hold it."""
    name = history.objective_name
    return {
        "major": history.major,
        "analyses": history.analyses.tolist(),
        "objective": {
            "label": label(name),
            "unit": unit(history, name),
            "values": history.objective.tolist(),
        },
        "violation": history.max_violation.tolist(),
        "constraints": [_constraint(history, constraint) for constraint in history.constraints],
        "design": [
            part for name in history.design for part in _design_charts(history, name)
        ],
    }  # fmt: skip


def label(name: str) -> str:
    """A variable in words: its entry counts from 1."""
    entry = re.fullmatch(r"(.*)\[(\d+)\]", name)
    if entry is None:
        last = name.rsplit(".", 1)[-1]
        return NAMES.get(last, last.replace("_", " "))
    base, number = label(entry[1]), int(entry[2]) + 1
    return f"stress {number}" if base == "von mises" else f"{base} {number}"


def unit(history: RecordedOptimization, name: str) -> str:
    """Unit of a recorded variable, with a raised exponent; empty when it has none."""
    name = name.split("[")[0]
    text = history.units.get(name, DESIGN_UNITS.get(name.rsplit(".", 1)[-1], ""))
    return re.sub(r"\*\*(\d)", lambda power: "⁰¹²³⁴⁵⁶⁷⁸⁹"[int(power[1])], text)


def use_of_limits(constraint: Constraint) -> np.ndarray:
    """How far a constraint is used up: 1 at the nearer limit, more when it is violated, (n,).

    The distance to the limit is measured in units of the limit (of 1 when that is zero), so that
    for a positive upper limit it is value / limit.
    """
    uses = np.full(len(constraint.values), -np.inf)
    for limit, over in ((constraint.upper, 1.0), (constraint.lower, -1.0)):
        if np.isfinite(limit):
            uses = np.maximum(uses, 1.0 + over * (constraint.values - limit) / (abs(limit) or 1.0))
    return uses


def _constraint(history: RecordedOptimization, constraint: Constraint) -> dict:
    return {
        "label": label(constraint.name),
        "unit": unit(history, constraint.name),
        "values": constraint.values.tolist(),
        "use": finite(use_of_limits(constraint)),
        "lower": finite([constraint.lower])[0],
        "upper": finite([constraint.upper])[0],
    }


def _design_charts(history: RecordedOptimization, name: str) -> list[dict]:
    """One chart for a design variable; two for the offsets of the two boundaries."""
    rows = history.design[name].reshape(len(history.objective), -1)
    parts = [(label(name), slice(None))]
    if history.model is not None and name.rsplit(".", 1)[-1] == "boundary_offsets":
        outer = history.model.outer_parameters
        parts = [
            ("outer boundary offsets", slice(0, outer)),
            ("inner boundary offsets", slice(outer, None)),
        ]
    low, high = history.bounds[name]
    return [
        {
            "label": words,
            "unit": unit(history, name),
            "values": rows[:, part].T.tolist(),
            "lower": finite([low[part].min()])[0],
            "upper": finite([high[part].max()])[0],
        }
        for words, part in parts
    ]


def finite(values) -> list:
    """Numbers for JSON: None where they are infinite or not a number."""
    return [float(v) if np.isfinite(v) else None for v in values]
