"""Optimise the seal of a seal file: figures, report, summary.json, the best seal as a seal file."""

import warnings
from pathlib import Path

import numpy as np

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.accuracy.force_error import ForceError, force_error
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import (
    CASES,
    CTRL_C,
    NAME_OF_FILE,
    WrongArgumentError,
    checked_arguments,
    largest_penalty_error,
    parser,
    penalty_table,
    print_design_warnings,
    write_summary,
)
from seal_mdao.cli.history_figures import draw_designs, history_rows, limit_numbers, report_limits
from seal_mdao.cli.optimum_warnings import meaningless_limits, violated_anew
from seal_mdao.cli.recorded_runs import recorded_optimizer, recorder_file
from seal_mdao.cli.running_optimization import (
    add_optimization_arguments,
    report_run,
    run_optimization,
)
from seal_mdao.cli.seal_files import file_errors, file_of, filled, seal_of
from seal_mdao.drivers.optimizer_driver import INTERRUPTED
from seal_mdao.export.csv_tables import write_boundary
from seal_mdao.file_optimization import (
    CHECKSUMS,
    CHOSEN,
    design_warnings,
    file_task,
    force_targets,
    measure_names,
    on_new_cloud,
    problem_settings,
    require_problem,
)
from seal_mdao.optimization import RunOptions
from seal_mdao.progress import LoadStepProgress
from seal_mdao.recording.recorded_optimization import label
from seal_mdao.recording.recorded_seals import recorded_settings
from seal_mdao.recording.recorder_file import open_model
from seal_mdao.report.embedded_figure import figure_section
from seal_mdao.report.write import write_report
from seal_mdao.seals.file.described import FILE, FILE_NAME
from seal_mdao.seals.file.differences import differences
from seal_mdao.seals.file.export import require_writers, write_design
from seal_mdao.seals.gaps import largest_gaps, unmeasured_gaps
from seal_mdao.seals.outline.outline_seal import OutlineSeal
from seal_mdao.seals.result import frozen_measures


def main(arguments) -> int:
    file = file_of(arguments.file)
    optimizer, chosen = arguments.optimizer, None
    # a continued run uses its own optimiser, particles, load steps and penalties
    if arguments.restart:
        optimizer, chosen = continued(arguments.restart, file, arguments)
    file, seal = seal_of(file, chosen, checked_seal(arguments, file))
    for text in design_warnings(file, seal):
        print(f"WARNING: {text}")
    cache = AnalysisCache()

    def task_of(run: RunOptions):
        with file_errors(arguments.file):
            # the task is built inside, with analyses that report progress
            return file_task(file, run.analyze(seal))

    # the warnings of the first and the last design are printed at the end
    warnings.simplefilter("ignore", sm.UntrustworthyResultWarning)
    history, numbers = run_optimization(arguments, seal, task_of, optimizer, cache)
    cases = (arguments.out / CASES).absolute()
    # last design; both analyses are usually in the cache
    offsets = history.design["boundary_offsets"][-1]
    results = cache.analyze(seal), cache.analyze(seal, offsets)
    # objective and constraints at first and last design
    ends = limit_numbers(history)
    gaps = gap_numbers(seal, file, results, cache)
    how = {"optimizer": optimizer, "status": status(numbers)} | numbers
    designs = {"boundary_offsets": offsets, "history": history_rows(history)}
    # summary before the new cloud, whose analysis may fail or take long
    write_summary(arguments.out, how | ends | {"on_new_cloud": None} | designs)
    write_boundary(seal, offsets, arguments.out / "optimum.csv")
    # seal file of the optimum, analysed with new particles
    drawing, anew, inexact = write_best(file, seal, offsets, cache, arguments.out)
    # second time, complete
    penalties = {"penalty_error": penalty_table(results[1])}
    # limits that do not hold with other particles, or limit a meaningless stress
    measures = frozen_measures(seal, measure_names(file), cache.analyze)
    doubts = [*violated_anew(ends["constraints"], anew), *meaningless_limits(results[1], measures)]
    doubts += gaps["unmeasured_gaps"]
    if inexact is not None and inexact.warning:
        doubts.append(inexact.warning)
    warned = {"warnings": [*results[1].warnings, *doubts]}
    new = {"on_new_cloud": anew}
    if inexact is not None:
        new["force_error_by_spacing"] = inexact.relative
    write_summary(arguments.out, how | ends | gaps | penalties | warned | new | designs)
    draw_designs(history, results, arguments.out)
    # key figures of the report
    own_figures = [
        *gap_figures(gaps), *penalty_figures(results[1]), *spacing_figures(inexact)
    ]  # fmt: skip
    targets = force_section(file, seal, results, arguments.out)
    # the page has the warnings of both designs itself
    write_report(
        cases, arguments.out / "report.html", cache=cache, further=targets, figures=own_figures,
        notes=doubts,
    )  # fmt: skip
    # console: run, limits, key figures, warnings
    report_run(optimizer, numbers, arguments)
    report_limits(history, ends, numbers["kkt"])
    for name, value, text in own_figures:
        print(f"{name}: {value} {text}")
    report_anew(ends, anew)
    print_design_warnings(*results, doubts)
    print(f"figures, report.html, summary.json, cases.sql, optimum.csv{drawing} in {arguments.out}")
    # after Ctrl-C the best design so far has been written
    if numbers["message"].startswith(INTERRUPTED):
        return CTRL_C
    return 0 if numbers["success"] else 1


def checked_seal(arguments, file) -> OutlineSeal:
    """Check what needs no analysis before load steps are chosen: the problem and the recorder file.

    Libraries that are missing to write the optimum are reported. Returns the seal before the choice.

    Raises
    ------
    SealFileError, WrongArgumentError
    """
    seal = filled(file)
    with file_errors(file.path):
        require_problem(file, seal)
    recorder_file(arguments)
    try:
        require_writers()
    except ImportError as error:
        print(f"WARNING: the optimised design will not be written as a seal file: {error}")
    return seal


def continued(cases: Path, file, arguments) -> tuple[str, dict | None]:
    """Optimiser, and what was chosen for the run to continue, when its seal file is the same.

    Raises
    ------
    WrongArgumentError
    """
    with checked_arguments():
        # seal file and settings as recorded
        recorded = recorded_settings(open_model(cases))
        require_same_file(file, cases, recorded)
    chosen = recorded.get(CHOSEN)
    optimizer = recorded_optimizer(cases) or arguments.optimizer
    # the recorded iterations belong to one optimiser
    if "optimizer" in arguments.given and optimizer != arguments.optimizer:
        raise WrongArgumentError(
            f"--optimizer {arguments.optimizer}: {cases} was recorded with {optimizer}, and a "
            "restart uses the recorded optimiser; leave this argument out"
        )
    return optimizer, chosen


def require_same_file(file, cases: Path, recorded: dict) -> None:
    """Require that a seal file has the contents of the file in the ``recorded`` settings of a run: the
    design variables mean the same only then.

    Raises
    ------
    ValueError
    """
    if not isinstance(recorded.get(FILE), dict):
        raise ValueError(f"--restart: {cases} does not contain the tables of a seal file")
    now, name = problem_settings(file), recorded.get(FILE_NAME)
    found = [differences(recorded[FILE], now[FILE])]
    before, after = (dict(own.get(CHECKSUMS, ())) for own in (recorded, now))
    found += [f"the content of {own} differs" for own in after if before.get(own) != after[own]]
    found = "; ".join(filter(None, found))
    if not found:
        return
    if name == file.path.name:
        what = f"{file.path} has changed since {cases} was recorded with it"
        cure = "restore the file of the recorded run"
    else:
        what = (
            f"{cases} was recorded with another seal file, {name}, from which {file.path} differs"
        )
        cure = "give the file of the recorded run"
    raise ValueError(f"--restart: {what} ({found}); {cure}, or begin a new run without --restart")


def force_section(file, seal, results, out: Path) -> str:
    """Draw targets and bounds of forces with the curves of both designs; return the section of the
    report, empty where the file asks for no force at a travel."""
    targets = force_targets(file, seal)
    if not targets or not all(result.converged for result in results):
        return ""
    designs = dict(zip(("start", "optimum"), results, strict=True))
    figure = plotting.force_targets(designs, targets)
    plotting.save(figure, out / "force_targets.png")
    note = "Targets and bounds of the seal file, with the curves of the first and the last design."
    return figure_section(figure, "targets", "Load-deflection curve", note)


def status(numbers: dict) -> str:
    """Return the status of the run for summary.json."""
    return "converged" if numbers["success"] else "not converged"


def gap_numbers(seal, file, results, cache: AnalysisCache) -> dict:
    """Collect the largest gap of every profile at first and last design, and the gaps outside the range
    of the measures of the optimisation, for summary.json."""
    first, last = map(largest_gaps, results)
    # evaluation points frozen at the nominal seal
    measures = frozen_measures(seal, measure_names(file), cache.analyze)
    return {
        "largest_gap_mm": {label: (first[label], last[label]) for label in first},
        "unmeasured_gaps": unmeasured_gaps(results[1], measures),
    }


def gap_figures(gaps: dict) -> list[tuple[str, str, str]]:
    """List the largest gaps as name, value and explanation."""
    return [
        (
            f"largest gap to {name}",
            f"{end:.4f} mm",
            f"between the contacts, at the start {start:.4f} mm",
        )
        for name, (start, end) in gaps["largest_gap_mm"].items()
    ]


def penalty_figures(result) -> list[tuple[str, str, str]]:
    """List the largest penalty error as name, value and explanation; empty without an estimate."""
    largest, unknown = largest_penalty_error(result) if result.converged else (None, "")
    if largest is None:
        return []
    text = "estimated for the measures of the last design" + (f"; {unknown}" if unknown else "")
    return [("numerical error due to contact penalties alone", f"{largest[1]:.2%}", text)]


def spacing_figures(error: ForceError | None) -> list[tuple[str, str, str]]:
    """List the error of the forces due to the particle spacing as name, value and explanation; empty
    without an estimate."""
    if error is None or error.relative is None:
        return []
    name = "numerical error of the forces due to the particle spacing"
    return [(name, f"{error.relative:.2%}", "estimated for the optimum with new particles")]


def write_best(
    file, seal, offsets, cache: AnalysisCache, out: Path
) -> tuple[str, dict | None, ForceError | None]:
    """Write a design as a seal file with drawing and cloud, and analyse it with a new cloud.

    Returns
    -------
    str
        Text about the written files for the last line.
    dict or None
        Part of summary.json: value of every measure with new particles.
    ForceError or None
        Of the forces due to the spacing, where the file leaves it to its default.
    """
    try:
        # limits in the new file refer to the frozen measures
        measures = frozen_measures(seal, None, cache.analyze)
        paths = write_design(file, seal, offsets, measures, out, "optimum")
    except (sm.GeometryError, sm.SealFileError, ImportError) as error:
        return f" (no seal file: {error})", None, None
    said = "".join(f", {path.name}" for path in paths)
    try:
        # read the written file: the check a user would make
        design = sm.read_seal_file(paths[0])
        lost = len(file.designs) - len(design.designs)
        if lost:
            said += (
                f" ({paths[0].name} lacks {lost} of {len(file.designs)} [[design]]; its first lines "
                "give the reason)"
            )
        # discretisation error of the optimum: same outline, new particles
        anew, result = on_new_cloud(design, file)
    except (sm.GeometryError, sm.SealFileError) as error:
        return f"{said} (not verified with new particles: {error})", None, None
    if not result.converged:
        return said, None, None
    inexact = None
    if file.section.default_spacing:
        # nobody has chosen these particles
        with LoadStepProgress(None, "error of the forces") as progress:
            inexact = force_error(anew, result, progress)
    return said, {measure.name: result.value(measure) for measure in result.measures()}, inexact


def _change(value: float, before: float) -> str:
    """Format the change of a value relative to that with the optimiser's particles; empty where it has
    none."""
    if not before or not np.isfinite([value, before]).all():
        return ""
    return f" ({value / before - 1.0:+.2%})"


def report_anew(ends: dict, anew: dict | None) -> None:
    """Print objective and constraints as evaluated with new particles."""
    # objective first, then constraints
    rows = {ends["objective"]["name"]: ends["objective"]} | ends["constraints"]
    known = {} if anew is None else {n: anew[n][0] for n in rows if n in anew and len(anew[n]) == 1}
    if known:
        words = [
            f"{label(name)} {value:.4g} {rows[name]['unit']}{_change(value, rows[name]['end'])}"
            for name, value in known.items()
        ]
        print(f"with new particles: {', '.join(words)}")


def arguments_parser():
    made = parser(
        __doc__, f"out/{NAME_OF_FILE}_optimization", "FILE", "seal-mdao optimize bulb.toml"
    )
    made.add_argument(
        "file", type=Path, metavar="FILE", help="seal file (TOML) with [[design]] and [optimize]"
    )
    add_optimization_arguments(
        made, "continue the optimisation of the same FILE recorded in CASES.sql, with its "
        "particles, load steps, penalties and optimiser; default of --out: the folder of CASES.sql",
    )  # fmt: skip
    return made
