"""The report's page: template, style, script and data in one file."""

import json
from dataclasses import dataclass
from datetime import datetime
from html import escape
from importlib.resources import files
from string import Template
from urllib.parse import quote

from seal_mdao._version import __version__
from seal_mdao.recording.recorded_optimization import RecordedOptimization, label
from seal_mdao.recording.recorded_seals import RecordedSeal
from seal_mdao.report import tables
from seal_mdao.report.history import FEASIBLE, history_data
from seal_mdao.report.shapes import Pictures
from seal_mdao.seals.gaps import gaps_unmeasured_by
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import SealResult

ASSETS = files("seal_mdao.report") / "assets"
SCRIPTS = ("chart.js", "shape.js", "page.js")
RECORD_ALL = '<code>driver.recording_options["includes"] = ["*"]</code>'
KINDS = {
    "optimisation": "Optimisation of",
    "doe": "Design of experiments with",
    "runs": "Runs of a model with",
}


WORDS = {
    True: ("Start", "End", "Through the iterations"),
    False: ("First point", "Last point", "Through the points"),
}
"""Headings, by whether the points are those of an optimiser."""


@dataclass(frozen=True, eq=False)
class ShownSeal:
    """A seal of the recorded model whose shapes are shown.

    Attributes
    ----------
    recorded : RecordedSeal
    designs : list of SealResult
        Designs of some points of the history, the first and the last among them.
    """

    recorded: RecordedSeal
    designs: list

    @property
    def name(self) -> str:
        return self.recorded.name or "seal"

    @property
    def ends(self) -> tuple[SealResult, SealResult]:
        return self.designs[0], self.designs[-1]

    @property
    def changed(self) -> tuple[str, ...]:
        """Measures of which the analyses of the ends do not give the recorded values."""
        return tuple(
            name
            for name, values in self.recorded.measures.items()
            if not all(
                tables.agrees(values, value, name, result)
                for value, result in zip(values[[0, -1]], self.ends, strict=True)
            )
        )


def render(
    history: RecordedOptimization,
    source: str,
    seals: list[ShownSeal],
    numbers: list[int],
    further: str = "",
    figures=(),
    notes=(),
) -> str:
    """The page as text.

    Parameters
    ----------
    history : RecordedOptimization
    source : str
        Name of the recorder file.
    seals : list of ShownSeal
        None when no shapes are known.
    numbers : list of int
        Which points of the history these are.
    further : str
        HTML of further sections.
    figures, notes : sequence
        Further figures and warnings, as of ``write_report``.

    Returns
    -------
    str
        HTML that needs no other file.
    """
    kind, short, long = status(history)
    first, last, through = WORDS[history.kind == "optimisation"]
    shapes = [Pictures(*s.ends, s.designs).as_data() | {"numbers": numbers} for s in seals]
    data = {
        "history": history_data(history), "seals": [seal.name for seal in seals],
        "shapes": shapes[0] if shapes else None, "others": shapes[1:],
    }  # fmt: skip
    return Template(_asset("page.html")).substitute(
        title=escape(title(history)),
        source=escape(source),
        written=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"),
        version=escape(__version__),
        status_kind=kind,
        status=escape(short),
        message=escape(long),
        figures="".join(_figure(*own) for own in [*key_figures(history, seals), *figures]),
        warning="".join(
            f'<p class="warning">{text}</p>'
            for text in [*warnings(history, seals), *(escape(f"{note}.") for note in notes)]
        ),
        choice=_choice(seals) if len(seals) > 1 else "",
        shapes="" if seals else "hidden",
        first=first,
        last=last,
        through=through,
        limits=tables.limits_table(history),
        further=further,
        analyses="".join(
            tables.analysis_table(
                *seal.ends, seal.recorded.measures, seal.name if len(seals) > 1 else ""
            )
            for seal in seals
        ),
        history=tables.history_table(history),
        runs=tables.runs_table(history) if history.runs else "",
        settings=tables.settings_table(history) if any(s.seal for s in history.seals) else "",
        options=tables.options_table(history) if history.runs else "",
        style=_asset("page.css"),
        script="\n".join(_asset(name) for name in SCRIPTS),
        data=json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
    )


def warnings(history: RecordedOptimization, seals: list[ShownSeal]) -> list[str]:
    """What the reader has to know before looking at the pictures, as HTML."""
    found = []
    for seal in history.seals:
        name = escape(seal.name or "the model")
        if seal.seal is None:
            found.append(
                f"The shapes of {name} are not shown: the file does not describe its kind of seal."
            )
        elif not seal.drawable:
            found.append(
                f"The shapes of {name} are not shown: the file does not hold what its inputs were. "
                f"Record with <code>sm.RestartRecorder</code>, or with {RECORD_ALL}."
            )
        elif seal.assumed:
            found.append(
                f"The file does not hold {escape(', '.join(seal.assumed))} of {name}: the pictures are "
                f"those with the values of the drawn seal. Record with {RECORD_ALL}."
            )
    found += [
        f"The analyses of {escape(seal.name)} for this report do not give the recorded values of "
        f"{escape(', '.join(map(label, changed)))}, so the pictures are not of the recorded designs. "
        f"Perhaps the package has changed since, or inputs were not recorded ({RECORD_ALL})."
        for seal in seals
        if (changed := seal.changed)
    ]
    for seal in seals:
        for name, design in zip(("First", "Last"), seal.ends, strict=True):
            found += [
                f"{name} design of {escape(seal.name)}: {escape(t)}." for t in design.warnings
            ]
        unseen = gaps_unmeasured_by(seal.ends[1], history.objective_name.rsplit(".", 1)[-1])
        found += [f"Last design of {escape(seal.name)}: {escape(text)}." for text in unseen]
    return found


def _choice(seals: list[ShownSeal]) -> str:
    links = (f'<a href="#{quote(seal.name)}">{escape(seal.name)}</a>' for seal in seals)
    return f'<nav class="choice" aria-label="Seals">Shapes of {" ".join(links)}</nav>'


def title(history: RecordedOptimization) -> str:
    """What was done: the optimisation of a seal's shape, else what the driver did with what."""
    if history.settings and history.kind == "optimisation":
        return "Shape of a seal"
    return f"{KINDS[history.kind]} {history.objective_name}"


def status(history: RecordedOptimization) -> tuple[str, str, str]:
    """Class, word and sentence on how the optimisation ended."""
    worst = history.max_violation[-1]
    feasible = worst <= FEASIBLE
    limits = (
        "All constraints are satisfied."
        if feasible
        else f"A constraint is violated by {tables.share(worst)}."
    )
    if history.kind != "optimisation":
        good, failed = len(history.objective), history.failed
        text = f"{good} {'point' if good == 1 else 'points'} with values, {failed} failed."
        return "unknown", "No optimisation", text
    if not history.runs:
        return "unknown", "End not recorded", f"The file does not say how the run ended. {limits}"
    last = history.runs[-1]
    if last.cut_off:
        many = "analysis" if history.evaluations == 1 else "analyses"
        text = f"The run was cut off after {history.evaluations} recorded {many}. {limits}"
        return "stopped", "Cut off", text
    if last.success and feasible:
        return "converged", "Converged", f"{last.message}. {limits}"
    return "stopped", "Not converged", f"{last.message}. {limits}"


def key_figures(
    history: RecordedOptimization, seals: list[ShownSeal]
) -> list[tuple[str, str, str]]:
    """Name, value and explanation of the figures at the top of the page."""
    if history.kind != "optimisation":
        return _range_figures(history)
    first, last = history.objective[[0, -1]]
    kind = "gradients" if history.major else "evaluations"
    found = [
        (
            label(history.objective_name),
            tables.share(last / first) if first else tables.number(last),
            f"of its start: {tables.number(first, 3)} → {tables.number(last, 3)}",
        ),
        (kind, str(len(history.objective) - 1), f"{history.evaluations} evaluations recorded"),
        ("largest violation", tables.share(history.max_violation[-1]), "of a constraint at the end"),
    ]  # fmt: skip
    place = 1
    for seal in seals:
        start, end = map(tables.measures, seal.ends)
        labels = [contact.label for contact in contacts(seal.ends[1].seal)]
        for profile in labels:
            at = f", {profile}" if len(labels) > 1 else ""
            of = (f", {seal.name}" if len(seals) > 1 else "") + at
            gap, force = f"largest gap between contacts{at}", f"vertical force on the profile{at}"
            before = f"between the contacts; start {tables.number(start[gap][1], 2)} mm"
            found.insert(place, (f"largest gap{of}", f"{tables.number(end[gap][1], 2)} mm", before))
            change = _change(start[force][1], end[force][1])
            found.append((f"vertical force{of}", f"{tables.number(end[force][1], 3)} N/m", change))
            place += 1
    return found


def _change(start: float, end: float) -> str:
    return f"{tables.share(end / start)} of its start" if start else ""


def _range_figures(history: RecordedOptimization) -> list[tuple[str, str, str]]:
    """Of points that no optimiser has chosen."""
    name, values = label(history.objective_name), history.objective
    return [
        ("points", str(len(values)), f"{history.failed} failed"),
        (f"lowest {name}", tables.number(values.min(), 3), f"point {values.argmin()}"),
        (f"highest {name}", tables.number(values.max(), 3), f"point {values.argmax()}"),
    ]


def _figure(name: str, value: str, text: str) -> str:
    parts = (escape(part) for part in (name, value, text))
    return "<li><span>{}</span><strong>{}</strong><small>{}</small></li>".format(*parts)


def _asset(name: str) -> str:
    return (ASSETS / name).read_text(encoding="utf-8")
