"""The report's page: template, style, script and data in one file."""

import json
from datetime import datetime
from html import escape
from importlib.resources import files
from string import Template

from seal_mdao._version import __version__
from seal_mdao.plotting.recorded import RecordedOptimization, label
from seal_mdao.report import tables
from seal_mdao.report.history import FEASIBLE, history_data
from seal_mdao.report.shapes import Pictures
from seal_mdao.seals.door.result import DoorSealResult

ASSETS = files("seal_mdao.report") / "assets"
SCRIPTS = ("chart.js", "shape.js", "page.js")
WARNING = (
    '<p class="warning">The analyses for this report do not give the recorded cost, so the pictures are '
    "not of the recorded designs. Perhaps inputs of the seal that are no design variables were not "
    'recorded (<code>driver.recording_options["includes"] = ["*"]</code>), or the package has changed '
    "since.</p>"
)


def render(
    history: RecordedOptimization, source: str, designs: list[DoorSealResult], numbers: list[int]
) -> str:
    """The page as text.

    Parameters
    ----------
    history : RecordedOptimization
    source : str
        Name of the recorder file.
    designs : list of DoorSealResult
        Designs of some points of the history, the first and the last among them; empty when the
        file is not that of a seal.
    numbers : list of int
        Which points of the history these are.

    Returns
    -------
    str
        HTML that needs no other file.
    """
    kind, short, long = status(history)
    data = {"history": history_data(history), "shapes": None}
    if designs:
        data["shapes"] = Pictures(designs[0], designs[-1], designs).as_data() | {"numbers": numbers}
    return Template(_asset("page.html")).substitute(
        title=escape(title(history)),
        source=escape(source),
        written=datetime.now().astimezone().strftime("%Y-%m-%d %H:%M"),
        version=escape(__version__),
        status_kind=kind,
        status=escape(short),
        message=escape(long),
        figures="".join(_figure(*figure) for figure in key_figures(history, designs)),
        warning=_warnings(history, designs),
        shapes="" if designs else "hidden",
        limits=tables.limits_table(history),
        analyses=tables.analysis_table(history, designs[0], designs[-1]) if designs else "",
        history=tables.history_table(history),
        runs=tables.runs_table(history) if history.runs else "",
        settings=tables.settings_table(history) if history.seal else "",
        options=tables.options_table(history) if history.runs else "",
        style=_asset("page.css"),
        script="\n".join(_asset(name) for name in SCRIPTS),
        data=json.dumps(data, separators=(",", ":"), allow_nan=False).replace("<", "\\u003c"),
    )


def pictures_are_of_the_record(
    history: RecordedOptimization, designs: list[DoorSealResult]
) -> bool:
    """Whether the analyses of the first and the last design give the recorded cost."""
    if not designs or not tables.is_gap_sum(history.objective_name):
        return True
    ends = zip(history.objective[[0, -1]], (designs[0], designs[-1]), strict=True)
    return all(tables.agrees(history, recorded, design) for recorded, design in ends)


def title(history: RecordedOptimization) -> str:
    """What was optimised."""
    return "Shape of a door seal" if history.seal else f"Optimisation of {history.objective_name}"


def status(history: RecordedOptimization) -> tuple[str, str, str]:
    """Class, word and sentence on how the optimisation ended."""
    worst = history.max_violation[-1]
    feasible = worst <= FEASIBLE
    limits = (
        "All constraints are satisfied."
        if feasible
        else f"A constraint is violated by {tables.share(worst)}."
    )
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


def key_figures(history: RecordedOptimization, designs) -> list[tuple[str, str, str]]:
    """Name, value and explanation of the figures at the top of the page."""
    first, last = history.objective[[0, -1]]
    kind = "major iterations" if history.major else "evaluations"
    found = [
        (
            label(history.objective_name),
            tables.share(last / first) if first else tables.number(last),
            f"of its start: {tables.number(first, 3)} → {tables.number(last, 3)}",
        ),
        (kind, str(len(history.objective) - 1), f"{history.evaluations} evaluations recorded"),
        ("largest violation", tables.share(history.max_violation[-1]), "of a constraint at the end"),
    ]  # fmt: skip
    if designs:
        start, end = ({n: v for n, _, v in tables.measures(d)} for d in (designs[0], designs[-1]))
        gap, force = "largest gap between contacts", "vertical force on the door"
        before = f"between the contacts; start {tables.number(start[gap], 2)} mm"
        found.insert(1, ("largest gap", f"{tables.number(end[gap], 2)} mm", before))
        change = f"{tables.share(end[force] / start[force])} of its start"
        found.append(("vertical force", f"{tables.number(end[force], 3)} N/m", change))
    return found


def _warnings(history: RecordedOptimization, designs: list[DoorSealResult]) -> str:
    """What the reader has to know before looking at the pictures, as paragraphs."""
    found = [] if pictures_are_of_the_record(history, designs) else [WARNING]
    for name, ends in (("First", designs[:1]), ("Last", designs[1:][-1:])):
        for text in (text for design in ends for text in design.warnings):
            found.append(f'<p class="warning">{name} design: {escape(text)}.</p>')
    return "".join(found)


def _figure(name: str, value: str, text: str) -> str:
    parts = (escape(part) for part in (name, value, text))
    return "<li><span>{}</span><strong>{}</strong><small>{}</small></li>".format(*parts)


def _asset(name: str) -> str:
    return (ASSETS / name).read_text(encoding="utf-8")
