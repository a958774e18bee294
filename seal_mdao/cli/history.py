"""Draw the history of an optimisation and its designs from an OpenMDAO recorder file.

Of a design of experiments, and of other cases that no optimiser has chosen, the command prints the range
of every quantity and draws the best design.
"""

from pathlib import Path

from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import (
    add_seal_arguments,
    checked_arguments,
    parser,
    penalty_table,
    print_design_warnings,
    seal_from,
    write_summary,
)
from seal_mdao.cli.history_cases import show_cases
from seal_mdao.cli.history_figures import (
    draw_designs,
    draw_history,
    end_numbers,
    gap_warnings,
    history_rows,
    limit_numbers,
    report_end,
    report_limits,
)
from seal_mdao.plotting.captions import name_seal
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.seals.door.door_seal import DOOR_SEAL
from seal_mdao.seals.gaps import largest_gaps


def main(arguments) -> int:
    with checked_arguments():
        history = read_optimization(arguments.cases)
        ends = history.design_at(0), history.design_at(-1)
    # the recorded seal; the options only for files without settings
    seal, cache = history.seal or seal_from(arguments), AnalysisCache()
    if history.seal:
        known = DOOR_SEAL in seal.description
        name_seal("door seal" if known else arguments.cases.name, seal)
    if history.kind != "optimisation":
        return show_cases(history, seal, cache, arguments.out)
    if history.run_starts:
        print(
            f"{len(history.run_starts) + 1} runs of the driver, separated in the figures; the first "
            "design is that of the first run, the last design that of the last run"
        )
    initial, final = (cache.analyze(seal, *end) for end in ends)
    # any seal but the door seal: objective and constraints of its own
    if DOOR_SEAL not in seal.description:
        return show_own_problem(history, (initial, final), arguments.out)
    # door seal: gap, area, reaction and door radius
    numbers = end_numbers(history, initial, final)
    write_summary(arguments.out, numbers | {"recorded_evaluations": history.evaluations})
    draw_history(history, initial, final, arguments.out)
    report_end(history, numbers)
    print_design_warnings(initial, final, gap_warnings(history, final))
    print(f"figures and summary.json in {arguments.out}")
    return 0


def show_own_problem(history, results, out: Path) -> int:
    """Print and draw the recorded run of a seal file, or of a user's own model around one, as
    ``seal-mdao optimize FILE`` does."""
    ends, design = limit_numbers(history), history.design_at(-1)
    first, last = map(largest_gaps, results)
    gaps = {label: (first[label], last[label]) for label in first}
    found = {"largest_gap_mm": gaps, "penalty_error": penalty_table(results[1])}
    more = {"boundary_offsets": design[0], **design[1], "history": history_rows(history)}
    write_summary(out, ends | found | more)
    draw_designs(history, results, out)
    report_limits(history, ends, None)
    print_design_warnings(*results)
    print(f"figures and summary.json in {out}")
    return 0


def arguments_parser():
    made = parser(__doc__, "out/history", "CASES.sql", "seal-mdao history out/best/cases.sql")
    made.add_argument(
        "cases",
        type=Path,
        metavar="CASES.sql",
        help="recorder file (SqliteRecorder of OpenMDAO) of an optimisation, or of a design of "
        "experiments",
    )
    add_seal_arguments(made)
    made.epilog += ". Options that describe the seal are used only if the recorder file does not "
    "contain the settings of the seal."
    return made
