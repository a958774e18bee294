"""Make the report of a recorder file."""

from pathlib import Path

from tqdm import tqdm

from seal_mdao import plotting
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.progress import hidden
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.recording.recorded_seals import RecordedSeal
from seal_mdao.report.embedded_figure import figure_section
from seal_mdao.report.page import ShownSeal, render
from seal_mdao.report.picture_data import evenly_spread
from seal_mdao.seals.profiles import path_stages
from seal_mdao.seals.result import SealResult, frozen_measures

DESIGNS = 40
"""Largest number of points whose designs are analysed again; of more, evenly spread ones."""


def write_report(
    cases,
    outfile=None,
    given: dict | None = None,
    cache: AnalysisCache | None = None,
    further: str = "",
    figures=(),
    notes=(),
) -> Path:
    """Write the HTML report of an optimisation.

    A recorder file holds no displacements, so the designs in the pictures are analysed again, but for
    those that are in ``cache``. A tqdm bar shows the progress on a terminal.

    Parameters
    ----------
    cases : str or Path
        File of a ``RestartRecorder`` or ``SqliteRecorder`` of the driver. Of a problem without a
        ``SealGroup`` or ``ScenarioGroup`` the report shows the histories only.
    outfile : str or Path, optional
        ``report.html`` beside the recorder file when left out.
    given : dict of str to ndarray, optional
        Inputs of seals that are the same at all points and may not be in the file, by absolute names.
    cache : AnalysisCache, optional
        Analyses of the run that wrote the file.
    further : str
        HTML of further sections, such as ``report.sample_section.samples_section``.
    figures : sequence of (str, str, str)
        Further figures at the top of the page: name, value and explanation.
    notes : sequence of str
        Further warnings.

    Raises
    ------
    ValueError
        When the file cannot be read or holds no good case.
    OSError
        When the report cannot be written.
    """
    cases = Path(cases)
    # histories from the recorder file, shapes from new analyses
    history, cache = read_optimization(cases, given), AnalysisCache() if cache is None else cache
    seals = [seal for seal in history.seals if seal.drawable]
    numbers = evenly_spread(len(history.objective), DESIGNS).tolist() if seals else []
    shown = [ShownSeal(seal, analyze_points(seal, numbers, cache)) for seal in seals]
    further += "".join(
        section(number, own)
        for number, own in enumerate(shown)
        for section in (ring_section, time_section)
    )
    text = render(history, cases.name, shown, numbers, further, figures, notes)
    # the report is written beside the recorder file by default
    out = cases.with_name("report.html") if outfile is None else Path(outfile)
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_text(text, encoding="utf-8")
    return out


def ring_section(number: int, seal: ShownSeal) -> str:
    """Show the last design of a ring in space, as a section of the report; empty in plane strain."""
    _, last = seal.ends
    if not last.seal.body.axisymmetric or not len(last.path.nominal_steps):
        return ""
    note = "Last design at the end of the path, with the von Mises stress on the cuts."
    return figure_section(
        plotting.ring_view(last), f"ring-{number}", f"Deformed ring: {seal.name}", note
    )


def time_section(number: int, seal: ShownSeal) -> str:
    """Show the force of the last design over time, as a section of the report; empty where the stages
    take no time."""
    _, last = seal.ends
    if path_stages(last.seal) is None or not len(last.path.nominal_steps):
        return ""
    note = "Last design; dotted lines are ends of stages."
    return figure_section(
        plotting.force_over_time(last), f"time-{number}", f"Force over time: {seal.name}", note
    )


def analyze_points(
    recorded: RecordedSeal, numbers: list[int], cache: AnalysisCache
) -> list[SealResult]:
    """Analyse designs of a seal; all are measured where the recorded run did."""
    # points of the measures on the nominal seal, once for all designs
    measures = frozen_measures(recorded.seal, None, cache.analyze)
    results = []
    for number in tqdm(numbers, desc="report", unit="analysis", disable=hidden(), leave=False):
        offsets, parameters = recorded.design(number)
        seal = recorded.seal.with_parameters(parameters)
        result = cache.analyze_particles(seal, recorded.particles(number), offsets)
        results.append(result.at(measures))
    return results
