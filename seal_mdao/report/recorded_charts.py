"""Recorded history of an optimisation as data of the report's charts."""

import numpy as np

from seal_mdao.recording.recorded_optimization import RecordedOptimization, label, unit_of


def history_data(history: RecordedOptimization) -> dict:
    """Return the history in types of JSON."""
    name = history.objective_name
    return {
        "major": history.major,
        "run_starts": history.run_starts,
        "analyses": history.analyses.tolist(),
        "objective": _named(history, name) | {"values": finite(history.objective)}
        if name
        else None,
        "violation": finite(history.max_violation),
        "constraints": [
            _named(history, own.name)
            | {"values": finite(own.values), "use": finite(own.use())}
            | _bounds(own.lower, own.upper)
            for own in history.constraints
        ],
        "design": [chart for own in history.design for chart in _design_charts(history, own)],
    }


def _named(history: RecordedOptimization, name: str) -> dict:
    return {"label": label(name), "unit": unit_of(history, name)}


def _bounds(lower, upper) -> dict:
    return dict(zip(("lower", "upper"), finite([lower, upper]), strict=True))


def _design_charts(history: RecordedOptimization, name: str) -> list[dict]:
    """One chart for a design variable; for the offsets one for each boundary that they move."""
    # one row a point, one column an entry of the design variable
    rows = history.design[name].reshape(len(history.objective), -1)
    parts = [(label(name), slice(None))]
    own = name.rsplit(".", 1)[-1] == "boundary_offsets"
    if own and history.seal is not None and rows.shape[1] == history.seal.n_offsets:
        parts = [(f"{edge} offsets", part) for edge, part in offset_parts(history.seal)]
    # bounds common to a chart: the widest of its entries
    low, high = history.bounds[name]
    return [
        {
            "label": words,
            "unit": unit_of(history, name),
            "values": [finite(column) for column in rows[:, part].T],
            **_bounds(low[part].min(), high[part].max()),
        }
        for words, part in parts
    ]


def offset_parts(seal) -> list[tuple[str, slice]]:
    """Find runs of neighbouring offsets that move the same edge of the boundary, with its name."""
    edges = {name: edge.particles for name, edge in seal.body.edges.items()}
    # |V| of every particle: an offset belongs to the edge that it moves most
    moved = np.linalg.norm(seal.design_velocity, axis=2)
    names = [max(edges, key=lambda name: own[edges[name]].sum()) for own in moved]
    # indices at which the edge changes
    first = [i for i, name in enumerate(names) if i == 0 or names[i - 1] != name]
    return [(names[i], slice(i, j)) for i, j in zip(first, [*first[1:], len(names)], strict=True)]


def finite(values) -> list:
    """Return numbers for JSON: None where they are infinite or not a number."""
    return [float(v) if np.isfinite(v) else None for v in values]
