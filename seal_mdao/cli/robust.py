"""Optimise a seal over its tolerances, and compare it with the nominal optimum on fresh samples."""

from hashlib import sha256
from pathlib import Path

import numpy as np

from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import (
    CASES,
    NAME_OF_FILE,
    add_seal_arguments,
    announce,
    checked_arguments,
    design_from,
    existing_file,
    parser,
    positive_integer,
    write_summary,
)
from seal_mdao.cli.executors import add_executor_arguments, executor
from seal_mdao.cli.history_figures import history_rows
from seal_mdao.cli.recorded_runs import continued_file, recorder_file
from seal_mdao.cli.robust_comparison import (
    compared,
    report_comparison,
    sampled,
    write_comparison,
)
from seal_mdao.cli.robust_subject import Subject, subject_of
from seal_mdao.cli.running_optimization import (
    add_optimization_arguments,
    driver_of,
    judged,
    optimize,
    report_run,
)
from seal_mdao.cli.varied_seals import add_tolerance_arguments
from seal_mdao.door_optimization import FORCE_BAND
from seal_mdao.drivers.optimizer_driver import INTERRUPTED
from seal_mdao.optimization import RunOptions, continue_run, optimization_problem
from seal_mdao.progress import LoadStepProgress, SampleProgress
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.robust_optimization import GOALS, Robust, RobustGoal
from seal_mdao.scenarios.variation import Scenarios

NOMINAL = "nominal.sql"
"""Recorder file of the nominal optimisation in the output folder."""
WRITTEN = (CASES, NOMINAL, "nominal.sqlite", "robust.sqlite")
"""Files with which a second start continues."""


def main(arguments) -> int:
    begin_anew_or_continue(arguments)
    cache = AnalysisCache()
    # the file of another run is refused before load steps are chosen
    cases = recorder_file(arguments)
    subject = subject_of(arguments, cache)
    with checked_arguments():
        # fixed sample of tolerances: the same in every iteration
        scenarios = subject.goal.scenarios(
            subject.tolerances, subject.seal, arguments.scenarios, arguments.seed
        )
    announce(subject.seal)
    if arguments.restart:
        cases = continued_file(arguments)
    # start of the robust run and base of the comparison
    nominal = nominal_design(subject, arguments, cache)
    with executor(arguments) as workers:
        numbers = optimize_robustly(subject, scenarios, nominal, arguments, cases, workers)
        # the last design, from the recorder
        history = read_optimization(cases)
        robust = history.design_at(-1)
        # both designs on the same fresh samples
        pairs = (("nominal optimum", nominal), ("robust optimum", robust))
        with checked_arguments():
            designs = [sampled(subject, name, own, arguments, workers) for name, own in pairs]
    # a run that ends infeasible is not a success
    numbers = judged(numbers, history)
    ends = {
        "boundary_offsets": robust[0], **robust[1],
        "nominal": {"boundary_offsets": nominal[0], **nominal[1]}, "history": history_rows(history),
    }  # fmt: skip
    found = compared(designs, subject)
    write_summary(arguments.out, numbers | settings_of(arguments) | found | subject.said | ends)
    write_comparison(arguments.out, cases, designs, subject, cache)
    report_run(arguments.optimizer, numbers, arguments)
    report_comparison(designs, subject)
    print(f"report.html, comparison.png, summary.json, cases.sql and samples in {arguments.out}")
    # neither is an optimum whose fresh samples fail too often
    return 0 if numbers["success"] and found["limits_met"] else 1


def begin_anew_or_continue(arguments) -> None:
    """Remove the files of an earlier run (``--overwrite``), or continue that of the same folder."""
    if arguments.overwrite:
        for name in WRITTEN:
            (arguments.out / name).unlink(missing_ok=True)
    cases = arguments.out / CASES
    if arguments.restart is None and cases.is_file():
        arguments.restart = cases
        print(f"continuing {cases} (--overwrite begins a new run)")


def optimize_robustly(
    subject: Subject, scenarios: Scenarios, nominal: tuple, arguments, cases: Path, workers
) -> dict:
    """Minimise over all scenarios from the nominal optimum, or continue; return numbers of the run."""
    with SampleProgress(len(scenarios), "robust optimisation") as progress:
        with checked_arguments():
            # robust problem: statistics of the measures over all scenarios
            recorder = None if arguments.restart else cases
            driver = driver_of(arguments.optimizer, arguments.max_iterations)
            options = RunOptions(driver, recorder, progress, work_dir=arguments.out)
            robust = Robust(subject.goal, scenarios, workers, label_of(scenarios, nominal))
            problem = optimization_problem(subject.task, options, robust)
            begin(problem, nominal, cases if arguments.restart else None)
        return not_interrupted(optimize(problem))


def not_interrupted(numbers: dict) -> dict:
    """Raise KeyboardInterrupt for a run that Ctrl-C has ended, so that an unfinished design is not
    sampled."""
    if numbers["message"].startswith(INTERRUPTED):
        raise KeyboardInterrupt
    return numbers


def nominal_design(subject: Subject, arguments, cache: AnalysisCache) -> tuple[np.ndarray, dict]:
    """Return boundary offsets and parameters of the optimum without tolerances: read or computed."""
    if arguments.nominal is not None:
        # given as the summary of an earlier optimisation
        return design_from(arguments.nominal, subject.seal)
    recorded = (arguments.out / NOMINAL).absolute()
    if arguments.restart and (beside := arguments.restart.absolute().with_name(NOMINAL)).is_file():
        # a restart finds the nominal run beside its own recorder file
        recorded = beside
    else:
        # otherwise optimise the nominal seal first
        with LoadStepProgress(subject.seal, "nominal optimisation, analysis") as progress:
            driver = driver_of(arguments.optimizer, None)
            options = RunOptions(driver, recorded, progress, cache, arguments.out)
            numbers = not_interrupted(
                optimize(optimization_problem(subject.nominal_task(options), options))
            )
        # a nominal run that does not converge is a warning only
        if not numbers["success"]:
            print(f"WARNING (nominal optimum): {numbers['message']}")
    return read_optimization(recorded).design_at(-1)


def begin(problem, nominal, recorded: Path | None) -> None:
    """Start from the nominal optimum, or continue the recorded run.

    Raises
    ------
    ValueError
        When another problem is recorded.
    """
    offsets, parameters = nominal
    # initial design of the robust run
    problem.set_val("boundary_offsets", offsets)
    for name, value in parameters.items():
        problem.set_val(name, value)
    if recorded is not None:
        continue_run(problem, recorded)


def label_of(scenarios, nominal) -> str:
    """Compute a hash that identifies the scenarios and the start."""
    parts = scenarios.numbers, scenarios.offsets, nominal[0]
    return sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()


def settings_of(arguments) -> dict:
    names = (
        "optimizer", "scenarios", "samples", "seed", "minimize", "deviations", "band", "fraction",
        "widen",
    )  # fmt: skip
    return {name: getattr(arguments, name) for name in names}


def arguments_parser():
    made = parser(__doc__, f"out/{NAME_OF_FILE}_robust", "[FILE]", "seal-mdao robust bulb.toml")
    # defaults of the goal
    goal = RobustGoal()
    add = made.add_argument
    add_tolerance_arguments(made)
    add(
        "--scenarios",
        type=positive_integer,
        default=32,
        metavar="N",
        help="number of scenarios in the optimisation",
    )
    add(
        "--seed",
        type=int,
        default=0,
        metavar="N",
        help="seed of the random scenarios; the samples that verify the optimum use N + 1",
    )
    add(
        "--fraction", type=float, default=goal.share, metavar="F",
        help="required fraction of samples that satisfy each constraint",
    )  # fmt: skip
    add(
        "--minimize", choices=GOALS, default=goal.minimize,
        help="objective of the robust optimisation: mean plus K standard deviations over the "
        "scenarios, or a smooth maximum",
    )  # fmt: skip
    add(
        "--deviations",
        type=float,
        default=goal.deviations,
        metavar="K",
        help="factor K of the standard deviation in the robust objective",
    )
    add(
        "--band", type=float, default=goal.band, metavar="FRACTION",
        help="allowed relative deviation from the reaction of the nominal seal",
    )  # fmt: skip
    add(
        "--widen", type=float, default=goal.widen, metavar="FACTOR",
        help="standard deviations of the scenarios divided by those of the tolerances",
    )  # fmt: skip
    add(
        "--nominal", type=existing_file, metavar="FILE",
        help="summary.json of the nominal optimum; default: compute it first "
        f"(reaction within {100 * FORCE_BAND:.0f} %%, lower bound of the contact pressure)",
    )  # fmt: skip
    add_optimization_arguments(
        made, "continue the run recorded in CASES.sql, with the nominal optimum and the samples in "
        "the same folder; default: continue the run in --out, if there is one",
    )  # fmt: skip
    add_executor_arguments(made)
    add_seal_arguments(made)
    return made
