"""The tables of the report: figures at the start and at the end, settings, runs."""

import json
import math
from html import escape

import numpy as np

from seal_mdao.contact.friction import OPEN
from seal_mdao.measures.boundary_line import is_closed
from seal_mdao.recording.recorded_optimization import (
    RecordedOptimization,
    label,
    shown_unit,
    unit_of,
)
from seal_mdao.seals.file.described import FILE
from seal_mdao.seals.gaps import largest_gap
from seal_mdao.seals.profiles import contacts, nominal_pressure, profile_histories, true_pressure
from seal_mdao.seals.result import SealResult, is_empty
from seal_mdao.seals.settings import described

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
NO_VALUE = "–"
AGREEMENT = 1e-5
"""Difference from a recorded value, over value plus start, that rounding may explain."""


# ---- one table ----


def number(value, digits: int = 4) -> str:
    """Format a number for reading: rounded, real minus sign, powers of ten."""
    if value is None or not math.isfinite(value):
        return NO_VALUE
    # format g switches to an exponent for large and small numbers
    mantissa, _, exponent = f"{value:.{digits}g}".partition("e")
    power = f"\u00a0·\u00a010{str(int(exponent)).translate(SUPERSCRIPTS)}" if exponent else ""
    return mantissa.replace("-", "−") + power


def percent(value: float) -> str:
    """Format a ratio in percent."""
    return f"{number(100.0 * value, 3)}\u00a0%"


def with_unit(name: str, unit: str) -> str:
    """Format a name with its unit in brackets, if it has one."""
    return f"{name} ({unit})" if unit else name


def table(head: list[str], rows: list[list], caption: str) -> str:
    """Format an HTML table; cells are text, or (text, class); the first of a row is its heading."""
    # all text is escaped here: names in a recorder file are data of others
    columns = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
    body = "".join(
        f'<tr><th scope="row">{escape(heading)}</th>{"".join(map(_cell, cells))}</tr>'
        for heading, *cells in rows
    )
    return (
        f'<div class="scroll"><table><caption>{escape(caption)}</caption><thead><tr>{columns}</tr>'
        f"</thead><tbody>{body}</tbody></table></div>"
    )


def _cell(cell) -> str:
    text, kind = cell if isinstance(cell, tuple) else (cell, "")
    return f'<td class="{kind}">{escape(text)}</td>' if kind else f"<td>{escape(text)}</td>"


# ---- the history ----


def limits_table(history: RecordedOptimization) -> str:
    """Tabulate objective and constraints at the first and at the last point of an optimisation; of other
    cases their ranges."""
    if history.kind != "optimisation":
        return _ranges_table(history)
    first, last = history.objective[[0, -1]]
    # the objective has no limit: its ratio to the start in that column
    ratio = percent(last / first) if first else NO_VALUE
    rows = [[_heading(history, history.objective_name), number(first), number(last), "", ratio,
             "of its start"]]  # fmt: skip
    for own in history.constraints:
        verdict = ("satisfied", "good") if own.satisfied()[-1] else ("violated", "bad")
        rows.append([
            _heading(history, own.name), *map(number, own.values[[0, -1]]), _limits(own),
            percent(own.use()[-1]), verdict,
        ])  # fmt: skip
    head = ["recorded quantity", "start", "end", "limit", "end / limit", ""]
    return table(head, rows, "Recorded objective and constraints")


def _ranges_table(history: RecordedOptimization) -> str:
    """Tabulate the ranges of objective and constraints, and how many points satisfy each constraint."""
    rows = []
    if history.objective_name:
        rows.append([_heading(history, history.objective_name), *_range(history.objective), "", ""])
    for own in history.constraints:
        satisfied = f"{own.satisfied().sum()} of {len(own.values)}"
        rows.append([_heading(history, own.name), *_range(own.values), _limits(own), satisfied])
    head = ["recorded quantity", "lowest", "highest", "limit", "satisfied by"]
    return table(head, rows, "Recorded objective and constraints") if rows else ""


def _range(values: np.ndarray) -> tuple[str, str]:
    return number(values.min()), number(values.max())


def _heading(history: RecordedOptimization, name: str) -> str:
    return with_unit(label(name), unit_of(history, name))


def _limits(constraint) -> str:
    # an infinite limit, which number() shows as NO_VALUE, is none
    low, high = number(constraint.lower), number(constraint.upper)
    if low == NO_VALUE:
        return f"≤ {high}"
    if high == NO_VALUE:
        return f"≥ {low}"
    return f"= {low}" if low == high else f"{low} to {high}"


def history_table(history: RecordedOptimization) -> str:
    """Tabulate objective and largest violation of every point, for reading and copying."""
    name = history.objective_name
    rows = [
        [str(i), str(analysis), *([number(value, 6)] if name else []), percent(violation)]
        for i, (analysis, value, violation) in enumerate(
            zip(history.analyses, history.objective, history.max_violation, strict=True)
        )
    ]
    # without a unit the column is named by its role
    objective = _heading(history, name) if unit_of(history, name) else "objective"
    kind = "iteration" if history.major else "evaluation"
    head = [kind, "evaluation number", *([objective] if name else []), "largest violation"]
    if history.run_starts:
        head.append("run")
        for i, row in enumerate(rows):
            row.append(str(1 + sum(start <= i for start in history.run_starts)))
    return table(head, rows, "History")


def runs_table(history: RecordedOptimization) -> str:
    """Tabulate when the file was written, by what, and how each run ended."""
    rows = []
    for run in history.runs:
        # ISO time stamps without fractions of a second
        begun, ended = (stamp.replace("T", " ")[:19] for stamp in (run.begun, run.ended))
        if run.cut_off:
            # a run that was cut off has no counts
            cells = ["cut off", run.driver, *[NO_VALUE] * 3, ("cut off", "bad")]
        else:
            iterations = NO_VALUE if run.iterations is None else str(run.iterations)
            numbers = iterations, str(run.analyses), f"{number(run.seconds, 3)} s"
            cells = [ended, run.driver, *numbers, (run.message, "good" if run.success else "bad")]
        rows.append([begun, *cells])
    head = ["run begun", "ended", "driver", "iterations", "analyses", "time", "result"]
    return table(head, rows, "Runs that wrote the recorder file")


def options_table(history: RecordedOptimization) -> str:
    """Tabulate options of the last driver and versions it ran with."""
    last = history.runs[-1]
    rows = [[name, str(value)] for name, value in last.options.items()]
    # versions of the packages with which the run was made
    rows += [[f"version of {name}", value] for name, value in last.versions.items()]
    return table(["option or version", "value"], rows, f"Options of {last.driver}; versions")


def settings_table(history: RecordedOptimization) -> str:
    """Tabulate the attributes of the seals, and the further settings of the problem."""
    known, rows = [seal for seal in history.seals if seal.seal is not None], []
    for seal in known:
        # attributes of the seal, or tables of its seal file
        settings = described(json.loads(seal.seal.settings()))
        rows += _flat(settings, f"{seal.name}: " if len(known) > 1 else "")
    rows += [
        [f"problem: {name}", str(value)] for name, value in history.settings.items() if name != FILE
    ]
    force = " or ".join(dict.fromkeys(own.seal.units.force for own in known)) or "N/m"
    return table(["setting", "value"], rows, f"Model and problem (mm, kPa, {force})")


def _flat(settings, prefix: str = ""):
    """Generate rows of settings that hold others."""
    for name, value in settings.items() if isinstance(settings, dict) else enumerate(settings, 1):
        # a list of tables is numbered from 1, other lists are values
        tables = isinstance(value, list) and any(isinstance(own, dict) for own in value)
        if isinstance(value, dict) or tables:
            yield from _flat(value, f"{prefix}{name}: ")
        else:
            yield [f"{prefix}{name}", str(value)]


# ---- analyses of designs ----


def analysis_table(
    start: SealResult, end: SealResult, recorded: dict, ends=("start", "end"), name=""
) -> str:
    """Tabulate measures of both designs, from their analyses.

    Parameters
    ----------
    recorded : dict of str to ndarray
        Values of measures at every point as recorded, by name.
    ends : tuple of str
        Headings of both designs.
    name : str
        Of the seal where there are several.
    """
    rows, last = [], measures(end)
    # of measures with one label the first recorded one
    by_label = {label(key): key for key in reversed(recorded)}
    for what, (unit, value) in measures(start).items():
        # the measure from both analyses
        rows.append([what, number(value), number(last.get(what, (unit, math.nan))[1]), unit])
        if what in by_label:
            # the recorded values below it; those that differ are marked
            own = by_label[what]
            cells = [
                number(value)
                if agrees(recorded[own], value, own, result)
                else (number(value), "bad")
                for value, result in zip(recorded[own][[0, -1]], (start, end), strict=True)
            ]
            rows.append(["the same, as recorded", *cells, unit])
    head = ["measure at the end of the analysis", *ends, "unit"]
    of = f" of {name}" if name else ""
    return table(head, rows, f"First and last design{of}, from their analyses")


def agrees(recorded: np.ndarray, value: float, name: str, result: SealResult) -> bool:
    """Return whether the analysis of a design gives a recorded value of a measure."""
    # |m - m_recorded| <= tolerance (|m_recorded| + |m at the start|)
    allowed = AGREEMENT * (abs(value) + abs(recorded[0]))
    return result.converged and abs(result.value(result.measure(name))[0] - value) <= allowed


def measures(result: SealResult) -> dict[str, tuple[str, float]]:
    """Return unit and value of the report's figures of a design, by name; NaN where not known."""
    found, units = {}, result.seal.units
    # the seal's own measures that are single numbers; a path that was not completed has none
    for m in result.measures():
        if not is_empty(m, result.seal) and m.size(result.seal) == 1:
            value = float(result.value(m)[0]) if result.converged else math.nan
            found[label(m.name)] = shown_unit(units.of(m.units)), value
            if units.is_ring_force(m.units):
                found[f"{label(m.name)}, {units.along}"] = "N/mm", units.per_mm * value
            # where it is taken, if at one point
            place = m.place(result)
            if place is not None:
                # what rounding leaves of a zero is shown as 0
                at = dict(zip(("x", "y"), np.round(place, 9).tolist(), strict=True))
                found |= {f"{label(m.name)}, at {own}": ("mm", at[own]) for own in at}
    profiles = contacts(result.seal)
    for contact, history in zip(profiles, profile_histories(result), strict=True):
        # figures of the contact, with the profile's name where there are several
        at = f", {contact.label}" if len(profiles) > 1 else ""
        found |= {name + at: row for name, row in _at_profile(result, contact, history).items()}
    for name in result.seal.inputs:
        # scalar parameters that are inputs of the seal's component
        scalar = result.seal.scalars[name]
        found[label(name)] = shown_unit(scalar.units), float(scalar.value)
    # area of the design; that of the cells where only the particles are known
    by_cells = result.boundary_offsets is None
    area = result.path.discretization.weights.sum() if by_cells else result.area
    found |= {
        "highest von Mises stress at a particle": ("kPa", float(result.stress_field().max())),
        "area of the section": ("mm²", float(area)),
        "travel reached": ("mm", float(result.travel[-1])),
        "number of losses of stability (buckling or snap-through)": (
            "",
            len(result.critical_points),
        ),
    }
    # effect of the contact penalties on the measures, in percent
    errors = result.penalty_error if result.converged else {}
    return found | {
        f"estimated numerical error of {label(name)} due to contact penalties alone": (
            "%",
            100.0 * error.relative,
        )
        for name, error in errors.items()
        if error.estimable
    }


def _at_profile(result: SealResult, contact, history) -> dict:
    """Figures of one profile after the last load step."""
    last = result.path.at_nominal(contact.label)[-1]
    touching = last.state != OPEN
    # force over deformed and over undeformed length
    true, nominal = true_pressure(result, contact), nominal_pressure(contact, last)
    units, (across, up) = result.seal.units, map(float, history.force[-1])
    x, y = units.directions
    forces = {
        f"{y} force on the profile": (units.force, up),
        f"{x} force on the profile": (units.force, across),
    }
    if units.radius:
        forces |= {
            f"{name}, {units.along}": ("N/mm", units.per_mm * force)
            for name, (_, force) in forces.items()
        }
    return {
        "largest gap between contacts": ("mm", largest_gap(result, contact.label).size),
        "contact points in contact": ("", int(touching.sum())),
        "width in contact, deformed": ("mm", float(history.width[-1])),
        "width in contact, nominal (undeformed)": ("mm", float(history.nominal_width[-1])),
        "patches in contact": ("", patches(touching, is_closed(contact.where))),
        "highest contact pressure, true (force over deformed length)": ("kPa", float(true.max())),
        "highest contact pressure, nominal (over undeformed length)": ("kPa", float(nominal.max())),
        "deepest penetration": ("mm", max(0.0, -float(last.gap.min()))),
    } | forces


def patches(touching: np.ndarray, closed: bool) -> int:
    """Count the groups of consecutive points in contact, on a ``closed`` boundary also across its
    first point."""
    # each begins at a point in contact behind an open one
    before = np.roll(touching, 1)
    before[0] &= closed
    return int(np.sum(touching & ~before)) or int(touching.any())
