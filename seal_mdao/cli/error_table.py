"""Estimated errors of measures: table on the console, and their part of summary.json."""

import numpy as np

from seal_mdao.accuracy.error_estimate import ErrorEstimate
from seal_mdao.seals.result import SealResult

PARTS = {"particles": "particles", "load_steps": "load steps", "penalties": "penalties"}
"""Parts of an error, by their names in summary.json, with their words."""
SMALLER = 1.1
"""Reference value over the value above which a table names the reference value."""


def print_errors(estimates: dict[str, ErrorEstimate], result: SealResult) -> None:
    """Print a table of every measure with its error bar and the parts of the error."""
    for line in error_lines(estimates, result):
        print(line)


def error_lines(estimates: dict[str, ErrorEstimate], result: SealResult) -> list[str]:
    """Tabulate values, half-widths of their error bars, and the parts of the errors.

    Returns
    -------
    list of str
        A heading, a row for every value, a line for bars that are longer than their parts, one for
        percentages that are not those of the value, and a line for every reason why measures have no
        estimate.
    """
    rows = [("measure", "value", "+-", "unit", "in %", *PARTS.values())]
    missing: dict[str, list] = {}
    for name, found in estimates.items():
        if found.unknown:
            missing.setdefault(found.unknown, []).append(name)
        for number, value in enumerate(found.value):
            label = name if found.value.size == 1 else f"{name}[{number}]"
            bar = None if found.bar is None else found.bar[number]
            relative = None if bar is None or not found.scale else 100.0 * bar / found.scale
            parts = (None if own is None else own[number] for own in found.parts.values())
            rows.append((
                label, f"{value:.6g}", _digits(bar), _unit(name, result), _digits(relative),
                *(_digits(part, "+") for part in parts),
            ))  # fmt: skip
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    # names and units on the left, numbers on the right
    lines = [
        "  ".join(
            text.ljust(width) if column in (0, 3) else text.rjust(width)
            for column, (text, width) in enumerate(zip(row, widths, strict=True))
        ).rstrip()
        for row in rows
    ]
    wider = [
        name for name, found in estimates.items()
        if found.bar is not None and (found.particle_bar > np.abs(found.particles)).any()
    ]  # fmt: skip
    if wider:
        lines.append(
            f"the error due to the particles oscillates along the path; +- of {', '.join(wider)} "
            "contains its root mean square"
        )
    others = [
        f"{name} to {found.scale:.4g} {_unit(name, result)}".rstrip()
        for name, found in estimates.items()
        if found.bar is not None and found.scale > SMALLER * np.abs(found.value).max(initial=0.0)
    ]
    if others:
        lines.append(
            f"in %: relative to the value, but of {', '.join(others)} (the force, or the largest "
            "value along the path)"
        )
    reasons = [f"not estimated (?) for {', '.join(own)}: {why}" for why, own in missing.items()]
    return ["estimated errors (computed minus exact value):", *lines, *reasons]


def _digits(number: float | None, sign: str = "") -> str:
    """Two digits of an error; a question mark where it is not known."""
    return "?" if number is None else f"{number:{sign}.2g}"


def _unit(name: str, result: SealResult) -> str:
    """Unit of a measure; that of forces for the force on a profile, which is no measure of the seal."""
    known = {own.name: own.units for own in result.seal.standard}
    return result.seal.units.of(known[name]) or "" if name in known else result.seal.units.force


def error_summary(estimates: dict[str, ErrorEstimate]) -> dict:
    """Collect the estimates for summary.json: ``bar``, signed ``error`` and parts, in the unit of the
    measure; None where not known, with the reason."""
    return {
        name: {
            "value": _plain(found.value), "bar": _plain(found.bar), "error": _plain(found.error),
            **{part: _plain(own) for part, own in found.parts.items()},
            "fluctuation": _plain(np.broadcast_to(found.fluctuation, found.value.shape)),
            "relative_to": found.scale, "not_estimated": found.unknown or None,
        }
        for name, found in estimates.items()
    }  # fmt: skip


def _plain(values: np.ndarray | None):
    """A single value as a number."""
    if values is None:
        return None
    return values[0] if values.size == 1 else values
