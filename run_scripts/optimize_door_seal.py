"""Close the gap of the door seal by changing its shape and the door: problem (71)."""

import sys

from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import (
    CASES,
    add_seal_arguments,
    checked_arguments,
    parser,
    print_design_warnings,
    run,
    seal_from,
    write_summary,
)
from seal_mdao.cli.history_figures import draw_history, end_numbers, gap_warnings, report_end
from seal_mdao.cli.recorded_runs import recorded_run
from seal_mdao.cli.running_optimization import (
    add_optimization_arguments,
    report_run,
    run_optimization,
)
from seal_mdao.door_optimization import DoorProblem, door_task
from seal_mdao.optimization import RunOptions
from seal_mdao.report.write import write_report

PROBLEM_FLAGS = {
    "keep_force": "keep the vertical reaction at the final travel within 10 % of its initial value",
    "clamp_load": "keep the reaction at 2, 4, 6, 8 and 10 mm within 10 % of its initial values",
    "pressure_floor": "keep half of the nominal seal's contact pressure in each patch",
    "stress_norm": "limit the p-norm of the stress of all particles, not seven stresses",
    "gap_integral": "minimise the integral of g^2 over the gap region, not a sum over points",
}


def main(arguments) -> int:
    settings = {name: getattr(arguments, name) for name in PROBLEM_FLAGS}
    optimizer = arguments.optimizer
    if arguments.restart:
        recorded, optimizer = recorded_run(arguments)
        seal, settings = recorded.seal, recorded.settings
    else:
        seal = seal_from(arguments)

    def task_of(run: RunOptions):
        with checked_arguments():
            return door_task(run.analyze(seal), DoorProblem(**settings))

    cache = AnalysisCache()
    history, run_numbers = run_optimization(arguments, seal, task_of, optimizer, cache)
    cases = (arguments.out / CASES).absolute()
    initial, final = cache.analyze(seal), cache.analyze(seal, *history.design_at(-1))
    numbers = end_numbers(history, initial, final)
    summary = {"optimizer": optimizer, **settings, "recorded_evaluations": history.evaluations}
    write_summary(arguments.out, run_numbers | summary | numbers)
    draw_history(history, initial, final, arguments.out)
    write_report(cases, arguments.out / "report.html", cache=cache)
    report_run(optimizer, run_numbers, arguments)
    report_end(history, numbers)
    print_design_warnings(initial, final, gap_warnings(history, final))
    print(f"report.html, figures, summary.json and cases.sql in {arguments.out}")
    return 0 if run_numbers["success"] else 1


def arguments_parser():
    made = parser(__doc__, "out/optimization")
    add_seal_arguments(made)
    for name, text in PROBLEM_FLAGS.items():
        flag = f"--{name.replace('_', '-')}"
        made.add_argument(flag, action="store_true", help=text.replace("%", "%%"))
    add_optimization_arguments(
        made, "continue the run recorded in this file, with its seal, problem and optimiser; without "
        "--out in its folder",
    )  # fmt: skip
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
