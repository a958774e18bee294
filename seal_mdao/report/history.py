"""What the recorder file says, as the report's charts and tables need it."""

import numpy as np

from seal_mdao.recording.recorded_optimization import (
    Constraint,
    RecordedOptimization,
    label,
    unit_of,
)

FEASIBLE = 1e-3
"""Largest relative violation of a limit that counts as satisfied."""


def history_data(history: RecordedOptimization) -> dict:
    """The history as JSON can hold it."""
    name = history.objective_name
    return {
        "major": history.major,
        "analyses": history.analyses.tolist(),
        "objective": {
            "label": label(name),
            "unit": unit_of(history, name),
            "values": finite(history.objective),
        },
        "violation": finite(history.max_violation),
        "constraints": [_constraint(history, constraint) for constraint in history.constraints],
        "design": [
            part for name in history.design for part in _design_charts(history, name)
        ],
    }  # fmt: skip


def _constraint(history: RecordedOptimization, constraint: Constraint) -> dict:
    return {
        "label": label(constraint.name),
        "unit": unit_of(history, constraint.name),
        "values": finite(constraint.values),
        "use": finite(constraint.use()),
        "lower": finite([constraint.lower])[0],
        "upper": finite([constraint.upper])[0],
    }


def _design_charts(history: RecordedOptimization, name: str) -> list[dict]:
    """One chart for a design variable; for the offsets one for each boundary that they move."""
    rows = history.design[name].reshape(len(history.objective), -1)
    parts = [(label(name), slice(None))]
    own = name.rsplit(".", 1)[-1] == "boundary_offsets"
    if own and history.seal is not None and rows.shape[1] == history.seal.n_offsets:
        parts = [(f"{name} offsets", part) for name, part in offset_parts(history.seal)]
    low, high = history.bounds[name]
    return [
        {
            "label": words,
            "unit": unit_of(history, name),
            "values": [finite(column) for column in rows[:, part].T],
            "lower": finite([low[part].min()])[0],
            "upper": finite([high[part].max()])[0],
        }
        for words, part in parts
    ]


def offset_parts(seal) -> list[tuple[str, slice]]:
    """Neighbouring offsets that move the same edge of the boundary, with its name."""
    edges = {name: edge.particles for name, edge in seal.body.edges.items()}
    moved = np.linalg.norm(seal.design_velocity, axis=2)
    names = [max(edges, key=lambda name: own[edges[name]].sum()) for own in moved]
    first = [i for i, name in enumerate(names) if i == 0 or names[i - 1] != name]
    return [(names[i], slice(i, j)) for i, j in zip(first, [*first[1:], len(names)], strict=True)]


def finite(values) -> list:
    """Numbers for JSON: None where they are infinite or not a number."""
    return [float(v) if np.isfinite(v) else None for v in values]
