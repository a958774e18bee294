"""The tables of the report: figures at the start and at the end, settings, runs."""

import json
import math
import re
from html import escape

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.recording.recorded_optimization import (
    RecordedOptimization,
    label,
    shown_unit,
    unit_of,
)
from seal_mdao.report import history as words
from seal_mdao.seals.file.described import FILE
from seal_mdao.seals.gaps import largest_gap
from seal_mdao.seals.profiles import contacts, nominal_pressure, profile_histories, true_pressure
from seal_mdao.seals.result import SealResult, is_empty
from seal_mdao.seals.settings import described

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
NO_VALUE = "–"
AGREEMENT = 1e-5
"""Difference from a recorded value, over value plus start, that rounding may explain."""


def number(value, digits: int = 4) -> str:
    """A number for reading: rounded, real minus sign, powers of ten."""
    if value is None or not math.isfinite(value):
        return NO_VALUE
    text = f"{value:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    mantissa = mantissa.replace("-", "−")
    return (
        f"{mantissa}\u00a0·\u00a010{str(int(exponent)).translate(SUPERSCRIPTS)}"
        if exponent
        else mantissa
    )


def share(value: float) -> str:
    """A ratio in percent."""
    return f"{number(100.0 * value, 3)}\u00a0%"


def table(head: list[str], rows: list[list], caption: str, first: str = "row") -> str:
    """An HTML table; cells are text, or (text, class); the first of a row is its heading."""
    lines = [f"<table><caption>{escape(caption)}</caption><thead><tr>"]
    lines += [f'<th scope="col">{escape(cell)}</th>' for cell in head]
    lines += ["</tr></thead><tbody>"]
    for heading, *cells in rows:
        lines += [f'<tr><th scope="{first}">{escape(heading)}</th>']
        for cell in cells:
            text, kind = cell if isinstance(cell, tuple) else (cell, "")
            lines += [
                f'<td class="{kind}">{escape(text)}</td>' if kind else f"<td>{escape(text)}</td>"
            ]
        lines += ["</tr>"]
    return "".join([*lines, "</tbody></table>"])


def limits_table(history: RecordedOptimization) -> str:
    """Objective and constraints at the first and at the last point, from the recorder file."""
    first, last = history.objective[[0, -1]]
    name, unit = label(history.objective_name), unit_of(history, history.objective_name)
    ratio = share(last / first) if first else NO_VALUE
    rows = [[_with_unit(name, unit), number(first), number(last), "", ratio, "of its start"]]
    for constraint in history.constraints:
        use = constraint.use()[-1]
        violated = constraint.violation()[-1] > words.FEASIBLE
        rows.append(
            [
                _with_unit(label(constraint.name), unit_of(history, constraint.name)),
                *map(number, constraint.values[[0, -1]]), _limits(constraint), share(use),
                ("violated", "bad") if violated else ("satisfied", "good"),
            ]
        )  # fmt: skip
    head = ["recorded quantity", "start", "end", "limit", "end / limit", ""]
    return table(head, rows, "Objective and constraints, as the optimiser saw them")


def _with_unit(name: str, unit: str) -> str:
    return f"{name} ({unit})" if unit else name


def _limits(constraint) -> str:
    low, high = (number(v) for v in (constraint.lower, constraint.upper))
    if low == NO_VALUE:
        return f"≤ {high}"
    if high == NO_VALUE:
        return f"≥ {low}"
    return f"= {low}" if low == high else f"{low} to {high}"


def analysis_table(start: SealResult, end: SealResult, recorded: dict, name="") -> str:
    """Measures of both designs, from their analyses.

    Parameters
    ----------
    recorded : dict of str to ndarray
        Values of measures at every point as recorded, by name.
    name : str
        Of the seal where there are several.
    """
    rows, last = [], measures(end)
    for what, (unit, value) in measures(start).items():
        rows.append([what, number(value), number(last.get(what, (unit, math.nan))[1]), unit])
        own = next((key for key in recorded if label(key) == what), None)
        if own is not None:
            cells = [
                number(value)
                if agrees(recorded[own], value, own, result)
                else (number(value), "bad")
                for value, result in zip(recorded[own][[0, -1]], (start, end), strict=True)
            ]
            rows.append(["the same, as recorded", *cells, unit])
    head = ["measure at the end of the path", "start", "end", "unit"]
    of = f" of {name}" if name else ""
    return table(head, rows, f"First and last design{of}, from their analyses")


def agrees(recorded: np.ndarray, value: float, name: str, result: SealResult) -> bool:
    """Whether the analysis of a design gives a recorded value of a measure."""
    allowed = AGREEMENT * (abs(value) + abs(recorded[0]))
    return result.converged and abs(result.value(result.measure(name))[0] - value) <= allowed


def measures(result: SealResult) -> dict[str, tuple[str, float]]:
    """Unit and value of what an engineer asks about a design, by name; nan where it is not known."""
    found = _own_measures(result)
    profiles = contacts(result.seal)
    for contact, history in zip(profiles, profile_histories(result), strict=True):
        at = f", {contact.label}" if len(profiles) > 1 else ""
        found |= {name + at: row for name, row in _at_profile(result, contact, history).items()}
    for name in result.seal.inputs:
        scalar = result.seal.scalars[name]
        found[label(name)] = shown_unit(scalar.units), float(scalar.value)
    return found | {
        "highest von Mises stress at a particle": ("kPa", float(result.stress_field().max())),
        "area of the section": ("mm²", _area(result)),
        "travel reached": ("mm", float(result.travel[-1])),
        "times that stability was lost": ("", len(result.critical_points)),
    } | _penalty_errors(result)  # fmt: skip


def _own_measures(result: SealResult) -> dict:
    """Measures of the seal that are single numbers; nan for a path that was not completed."""
    own = [
        m for m in result.measures() if not is_empty(m, result.seal) and m.size(result.seal) == 1
    ]
    return {
        label(m.name): (
            shown_unit(m.units), float(result.value(m)[0]) if result.converged else math.nan
        )
        for m in own
    }  # fmt: skip


def _at_profile(result: SealResult, contact, history) -> dict:
    """What happens at one profile after the last load step."""
    last = result.path.at_nominal(contact.label)[-1]
    touching = last.state != OPEN
    true, nominal = true_pressure(result, contact), nominal_pressure(contact, last)
    return {
        "largest gap between contacts": ("mm", largest_gap(result, contact.label).size),
        "contact points in contact": ("", int(touching.sum())),
        "width in contact, deformed": ("mm", float(history.width[-1])),
        "width in contact, nominal (undeformed)": ("mm", float(history.nominal_width[-1])),
        "patches in contact": ("", patches(touching)),
        "highest contact pressure, true (force over deformed length)": ("kPa", float(true.max())),
        "highest contact pressure, nominal (over undeformed length)": ("kPa", float(nominal.max())),
        "deepest penetration": ("mm", max(0.0, -float(last.gap.min()))),
        "vertical force on the profile": ("N/m", float(history.force[-1, 1])),
        "horizontal force on the profile": ("N/m", float(history.force[-1, 0])),
    }


def _penalty_errors(result: SealResult) -> dict:
    """Estimated errors of the measures by the contact penalties, relative."""
    if not result.converged:
        return {}
    return {
        f"error of {label(name)} by contact penalties, estimated": ("%", 100.0 * error.relative)
        for name, error in result.penalty_error.items()
        if error.estimable
    }


def _area(result: SealResult) -> float:
    """Of the design; that of the cells where only the particles are known."""
    if result.boundary_offsets is None:
        return float(result.path.discretization.weights.sum())
    return result.area


def patches(touching: np.ndarray) -> int:
    """Stretches of neighbouring points in contact."""
    return int(np.sum(np.diff(np.concatenate([[False], touching]).astype(int)) == 1))


def settings_table(history: RecordedOptimization) -> str:
    """The attributes of the seals, and the further settings of the problem."""
    known = [seal for seal in history.seals if seal.seal is not None]
    rows = []
    for seal in known:
        settings = described(json.loads(seal.seal.settings()))
        rows += _flat(settings, f"{seal.name}: " if len(known) > 1 else "")
    rows += [
        [f"problem: {name}", str(value)] for name, value in history.settings.items() if name != FILE
    ]
    return table(["setting", "value"], rows, "Model and problem (mm, kPa, N/m)")


def _flat(settings, prefix: str = ""):
    """Rows of settings that hold others."""
    for name, value in settings.items() if isinstance(settings, dict) else enumerate(settings, 1):
        inside = isinstance(value, dict) or (isinstance(value, list) and _holds_tables(value))
        if inside:
            yield from _flat(value, f"{prefix}{name}: ")
        else:
            yield [f"{prefix}{name}", str(value)]


def _holds_tables(values: list) -> bool:
    return any(isinstance(value, dict) for value in values)


def runs_table(history: RecordedOptimization) -> str:
    """When the file was written, by what, and how each run ended."""
    head = ["run begun", "ended", "driver", "iterations", "analyses", "time", "result"]
    rows = []
    for run in history.runs:
        begun, ended = (re.sub("T", " ", stamp)[:19] for stamp in (run.begun, run.ended))
        if run.cut_off:
            rows.append(
                [begun, "cut off", run.driver, NO_VALUE, NO_VALUE, NO_VALUE, ("cut off", "bad")]
            )
            continue
        kind = "good" if run.success else "bad"
        rows.append(
            [begun, ended, run.driver, str(run.iterations), str(run.analyses),
             f"{number(run.seconds, 3)} s", (run.message, kind)]
        )  # fmt: skip
    return table(head, rows, "Runs that wrote the recorder file")


def options_table(history: RecordedOptimization) -> str:
    """Options of the last driver and versions it ran with."""
    last = history.runs[-1]
    rows = [[name, str(value)] for name, value in last.options.items()]
    rows += [[f"version of {name}", value] for name, value in last.versions.items()]
    return table(["option or version", "value"], rows, f"Options of {last.driver}; versions")


def history_table(history: RecordedOptimization) -> str:
    """Objective and largest violation of every point, for reading and copying."""
    kind = "iteration" if history.major else "evaluation"
    unit = unit_of(history, history.objective_name)
    rows = [
        [str(i), str(analysis), number(value, 6), share(violation)]
        for i, (analysis, value, violation) in enumerate(
            zip(history.analyses, history.objective, history.max_violation, strict=True)
        )
    ]
    objective = f"{label(history.objective_name)} ({unit})" if unit else "objective"
    head = [kind, "evaluation number", objective, "largest violation"]
    return table(head, rows, "The history in figures")
