"""Draw the history of an optimisation and its designs from an OpenMDAO recorder file."""

import sys
from pathlib import Path

from _common import (
    add_seal_arguments,
    checked_arguments,
    parser,
    print_warnings,
    run,
    seal_from,
    write_summary,
)
from _history_figures import draw_history, end_numbers, gap_warnings, report_end

from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.recording.recorded_optimization import read_optimization


def main(arguments) -> int:
    with checked_arguments():
        history = read_optimization(arguments.cases)
        ends = history.design_at(0), history.design_at(-1)
    seal, kept = history.seal or seal_from(arguments), KeptAnalyses()
    initial, final = (kept.analyze(seal, *end) for end in ends)
    numbers = end_numbers(history, initial, final)
    write_summary(arguments.out, numbers | {"recorded_evaluations": history.evaluations})
    draw_history(history, initial, final, arguments.out)
    report_end(history, numbers)
    print_warnings(initial, " (first design)")
    print_warnings(final, " (last design)", gap_warnings(history, final))
    print(f"figures and summary.json in {arguments.out}")
    return 0


def arguments_parser():
    made = parser(__doc__, "out/history", "CASES.sql")
    made.add_argument("cases", type=Path, metavar="CASES.sql", help="file of a SqliteRecorder")
    add_seal_arguments(made)
    made.epilog = "Options of the seal are used only when the file does not hold its settings."
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
