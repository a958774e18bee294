"""The report's page: template, style, script and data in one file."""

import json
from dataclasses import dataclass
from datetime import datetime
from html import escape
from importlib.resources import files
from string import Template
from urllib.parse import quote

from seal_mdao._version import __version__
from seal_mdao.plotting.captions import caption, caption_of, seal_text
from seal_mdao.recording.recorded_optimization import KINDS, RecordedOptimization, label
from seal_mdao.recording.recorded_seals import RecordedSeal
from seal_mdao.report import html_tables as tables
from seal_mdao.report.picture_data import Pictures
from seal_mdao.report.recorded_charts import history_data
from seal_mdao.report.scenarios_table import NOMINAL, nominal_note, scenarios_table
from seal_mdao.seals.door.door_seal import DOOR_SEAL
from seal_mdao.seals.gaps import gaps_unmeasured_by
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.seals.result import SealResult

ASSETS = files("seal_mdao.report") / "assets"
SCRIPTS = ("chart.js", "shape.js", "page.js")
RECORD_ALL = '<code>driver.recording_options["includes"] = ["*"]</code>'
WORDS = {
    True: ("Start", "End", "Iterations"),
    False: ("First point", "Last point", "Points"),
}
"""Names of the ends and of what lies between, by whether the points are those of an optimiser."""


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
    def caption(self) -> str:
        """Small print below the pictures: the seal's name, its materials and the date."""
        seal = self.recorded.seal
        name = self.recorded.name or ("door seal" if DOOR_SEAL in seal.description else "seal")
        # a command names the seal file that it has read
        return caption() or caption_of({name: seal_text(seal)})

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
    """Format the page as HTML that needs no other file.

    Parameters
    ----------
    history : RecordedOptimization
    source : str
        Name of the recorder file.
    seals : list of ShownSeal
        Empty when no shapes are known.
    numbers : list of int
        Which points of the history these are.
    further : str
        HTML of further sections.
    figures, notes : sequence
        Further figures and warnings, as of ``write_report``.
    """
    # one entry of shapes for each seal; the page shows the first one at the start
    kind, short, long = status(history)
    shapes = [
        Pictures(*s.ends, s.designs).as_data() | {"numbers": numbers, "caption": s.caption}
        for s in seals
    ]
    first, last, through = WORDS[history.kind == "optimisation"]
    ends = first.lower(), last.lower()
    data = {
        "history": history_data(history), "seals": [seal.name for seal in seals], "ends": ends,
        "shapes": shapes[0] if shapes else None, "others": shapes[1:],
    }  # fmt: skip
    notes = [*warnings(history, seals), *(escape(f"{note}.") for note in notes)]
    several = len(seals) > 1
    # the template's names with their HTML; text from the file is escaped
    return Template(_asset("page.html")).substitute(
        title=escape(title(history)),
        source=escape(source),
        written=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"),
        version=escape(__version__),
        status_kind=kind,
        status=escape(short),
        message=escape(long),
        figures="".join(_figure(*own) for own in [*key_figures(history, seals), *figures]),
        warning="".join(f'<p class="warning">{text}</p>' for text in notes),
        choice=_choice(seals) if several else "",
        nominal="".join(
            nominal_note(own.name, own.recorded.scenarios)
            for own in seals
            if own.recorded.scenarios
        ),
        shapes="" if seals else "hidden",
        first=first,
        last=last,
        through=through,
        limits=tables.limits_table(history),
        further=further,
        analyses="".join(
            tables.analysis_table(*own.ends, own.recorded.measures, ends, _caption(own, several))
            for own in seals
        ),
        scenarios="".join(
            scenarios_table(own.scenarios, own.name if len(history.seals) > 1 else "")
            for own in history.seals
            if own.scenarios
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
    """List restrictions of the pictures and warnings of the analyses, as HTML."""
    found = []
    if history.run_starts:
        found.append(
            f"The recorder file contains {len(history.run_starts) + 1} runs of the driver, which the "
            "charts separate by dotted lines. The first design is that of the first run, the last "
            "design that of the last run."
        )
    # seals without shapes, and with assumed inputs
    for seal in history.seals:
        name, assumed = escape(seal.name or "the model"), escape(", ".join(seal.assumed))
        # reasons why the shapes of a seal cannot be shown, or not exactly
        hidden = f"The shapes of {name} are not shown: the file does not"
        if seal.seal is None:
            found.append(f"{hidden} describe its kind of seal.")
        elif not seal.drawable:
            found.append(
                f"{hidden} contain its inputs. Record with <code>sm.RestartRecorder</code>, or "
                f"with {RECORD_ALL}."
            )
        elif seal.assumed:
            found.append(
                f"The file does not contain {assumed} of {name}: the pictures show the values of the "
                f"nominal seal. Record with {RECORD_ALL}."
            )
    found += [
        f"The analyses of {escape(seal.name)} for this report do not give the recorded values of "
        f"{escape(', '.join(map(label, changed)))}, so the pictures are not of the recorded designs. "
        f"Perhaps the package has changed since, or inputs were not recorded ({RECORD_ALL})."
        for seal in seals
        if (changed := seal.changed)
    ]
    for seal in seals:
        # warnings of the analyses, and gaps that the objective does not see
        texts = [("First", text) for text in seal.ends[0].warnings]
        texts += [("Last", text) for text in seal.ends[1].warnings]
        objective = history.objective_name.rsplit(".", 1)[-1]
        texts += [("Last", text) for text in gaps_unmeasured_by(seal.ends[1], objective)]
        found += [f"{end} design of {escape(seal.name)}: {escape(text)}." for end, text in texts]
    return found


def _choice(seals: list[ShownSeal]) -> str:
    # the page's script shows the seal that the address names
    links = (f'<a href="#{quote(seal.name)}">{escape(seal.name)}</a>' for seal in seals)
    return f'<nav class="choice" aria-label="Seals">Shapes of {" ".join(links)}</nav>'


def _caption(seal: ShownSeal, several: bool) -> str:
    """Name a seal in the caption of its analyses, where there are several seals or conditions."""
    if seal.recorded.scenarios:
        return f"{seal.name} in the {NOMINAL}"
    return seal.name if several else ""


def title(history: RecordedOptimization) -> str:
    """Return the heading: the optimisation of a seal's shape, else the kind of run and its objective."""
    # settings of seal_problem or of a seal file are in the file
    if history.settings and history.kind == "optimisation":
        return "Shape of a seal"
    kind, name = KINDS[history.kind].capitalize(), history.objective_name
    if not name:
        return kind
    return f"{kind} {'of' if history.kind == 'optimisation' else 'with'} {label(name)}"


def status(history: RecordedOptimization) -> tuple[str, str, str]:
    """Return class, word and sentence on how the optimisation ended."""
    worst = history.max_violation[-1]
    feasible = history.feasible[-1]
    limits = f"A constraint is violated by {tables.percent(worst)}."
    if feasible:
        limits = "All constraints are satisfied."
    if history.kind != "optimisation":
        # points of a design of experiments or of single runs have no end state
        points = _counted(len(history.objective), "point", "points")
        text = f"{points} with values, {history.failed} failed."
        return "unknown", "No optimisation", text
    if not history.runs:
        text = f"The recorder file does not say how the optimisation ended. {limits}"
        return "unknown", "End not recorded", text
    last = history.runs[-1]
    if last.cut_off:
        # the process ended before the driver did
        analyses = _counted(history.evaluations, "recorded analysis", "recorded analyses")
        return "stopped", "Cut off", f"The optimisation was interrupted after {analyses}. {limits}"
    # the driver's own claim counts only at a feasible point
    kind = ("stopped", "Not converged")
    if last.success and feasible:
        kind = ("converged", "Converged")
    return *kind, f"{last.message}. {limits}"


def _counted(count: int, one: str, several: str) -> str:
    return f"{count} {one if count == 1 else several}"


def key_figures(
    history: RecordedOptimization, seals: list[ShownSeal]
) -> list[tuple[str, str, str]]:
    """List name, value and explanation of the figures at the top of the page."""
    name, values, short = label(history.objective_name), history.objective, tables.number
    if history.kind != "optimisation":
        points = ("points", str(len(values)), f"{history.failed} failed")
        if not history.objective_name:
            return [points]
        return [
            points,
            (f"lowest {name}", short(values.min(), 3), f"point {values.argmin()}"),
            (f"highest {name}", short(values.max(), 3), f"point {values.argmax()}"),
        ]
    # order of the figures: objective, gaps, work of the driver, violation, forces
    first, last = values[[0, -1]]
    gaps, forces = [], []
    for seal in seals:
        start, end = map(tables.measures, seal.ends)
        # of every profile the component that is larger at the start
        histories, units = profile_histories(seal.ends[0]), seal.ends[1].seal.units
        for profile in histories:
            at = f", {profile.label}" if len(histories) > 1 else ""
            force = f"{units.directions[profile.main_component]} force"
            of = (f", {seal.name}" if len(seals) > 1 else "") + at
            of += f", {NOMINAL}" if seal.recorded.scenarios else ""
            # rows of ``tables.measures`` of this profile: (unit, value)
            old, new = (own[f"largest gap between contacts{at}"][1] for own in (start, end))
            before = f"between the contacts; start {short(old, 2)} mm"
            gaps.append((f"largest gap{of}", f"{short(new, 2)} mm", before))
            old, new = (own[f"{force} on the profile{at}"][1] for own in (start, end))
            change = f"{tables.percent(new / old)} of its start" if old else ""
            if units.radius:
                around = f"{short(units.per_mm * new, 3)} N {units.along}"
                change = f"{around}; {change}" if change else around
            forces.append((f"{force}{of}", f"{short(new, 3)} {units.force}", change))
    kind, done, count = "evaluations", history.evaluations, len(values) - 1
    if history.major:
        kind, count = "iterations", history.iterations
    # relative to the limit
    worst = tables.percent(history.max_violation[-1])
    return [
        (name, tables.percent(last / first) if first else short(last),
         f"of its start: {short(first, 3)} → {short(last, 3)}"),
        *gaps,
        (kind, str(count), f"{done} evaluations recorded"),
        ("largest violation", worst, "of a constraint at the end"),
        *forces,
    ]  # fmt: skip


def _figure(name: str, value: str, text: str) -> str:
    # name above the value, explanation below
    parts = (escape(part) for part in (name, value, text))
    return "<li><span>{}</span><strong>{}</strong><small>{}</small></li>".format(*parts)


def _asset(name: str) -> str:
    return (ASSETS / name).read_text(encoding="utf-8")
