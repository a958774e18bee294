"""Optimise a seal over its tolerances, and compare it with the nominal optimum on fresh samples."""

from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

import numpy as np
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.analysis_cache import AnalysisCache
from seal_mdao.cli.arguments import (
    SEAL_OPTIONS,
    WrongArgumentError,
    add_seal_arguments,
    announce,
    checked_arguments,
    design_from,
    existing_file,
    parser,
    positive_integer,
    seal_from,
    write_summary,
)
from seal_mdao.cli.executors import add_executor_arguments, executor
from seal_mdao.cli.history_figures import history_rows
from seal_mdao.cli.recorded_runs import continued_file, recorder_file
from seal_mdao.cli.running_optimization import judged, optimize, report_run
from seal_mdao.cli.seal_files import file_errors, file_of, seal_of
from seal_mdao.door_optimization import FORCE_BAND, DoorProblem, door_task, robust_door_task
from seal_mdao.file_optimization import file_task, require_problem
from seal_mdao.optimization import (
    OPTIMIZERS,
    Limit,
    RunOptions,
    Task,
    continue_run,
    optimization_problem,
)
from seal_mdao.progress import LoadStepProgress, hidden
from seal_mdao.recording.recorded_optimization import label, read_optimization, shown_unit
from seal_mdao.report.sample_section import samples_section
from seal_mdao.report.write import write_report
from seal_mdao.robust_optimization import GOALS, Robust, RobustGoal
from seal_mdao.seals.result import frozen_measures
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.sampled_designs import SampledDesign, SampledLimit
from seal_mdao.tolerances.study import ToleranceStudy
from seal_mdao.tolerances.tolerance_set import Tolerances

NOMINAL = "nominal.sql"
"""Recorder file of the nominal optimisation in the output folder."""


def main(arguments) -> int:
    kept = AnalysisCache()
    # an existing recorder file is refused before load steps are chosen
    recorder_file(arguments)
    subject = subject_of(arguments, kept)
    seal, tolerances, task, goal = subject.seal, subject.tolerances, subject.task, subject.goal
    with checked_arguments():
        # fixed sample of tolerances: the same in every iteration
        scenarios = goal.scenarios(tolerances, seal, arguments.scenarios, arguments.seed)
    announce(seal)
    # recorder file of the robust run
    cases = continued_file(arguments) if arguments.restart else recorder_file(arguments)
    # start of the robust run and base of the comparison
    nominal = nominal_design(subject, arguments, kept)
    with executor(arguments) as workers:
        with checked_arguments():
            # robust problem: statistics of the measures over all scenarios
            driver = OPTIMIZERS[arguments.optimizer](*max_iterations(arguments))
            options = RunOptions(
                driver, None if arguments.restart else cases, work_dir=arguments.out
            )
            robust = Robust(goal, scenarios, workers, label_of(scenarios, nominal))
            problem = optimization_problem(task, options, robust)
            begin(problem, nominal, cases if arguments.restart else None)
        # run, then read the last design back from the recorder
        numbers = optimize(problem)
        history = read_optimization(cases)
        robust = history.design_at(-1)
        # both designs on the same fresh samples
        designs = {
            label: sampled(subject, label, design, arguments, workers)
            for label, design in (("nominal optimum", nominal), ("robust optimum", robust))
        }
    # a run that ends infeasible is not a success
    numbers = judged(numbers, history)
    ends = {
        "boundary_offsets": robust[0], **robust[1],
        "nominal": {"boundary_offsets": nominal[0], **nominal[1]}, "history": history_rows(history),
    }  # fmt: skip
    compared = compare(designs, task, subject.limits)
    write_summary(arguments.out, numbers | settings_of(arguments) | compared | subject.said | ends)
    write_comparison(arguments.out, cases, designs, subject, kept)
    report_run(arguments.optimizer, numbers, arguments.restart)
    print(f"report.html, comparison.png, summary.json, cases.sql and samples in {arguments.out}")
    return 0 if numbers["success"] else 1


@dataclass(frozen=True, eq=False)
class Subject:
    """Optimisation problem: seal, tolerances, goal and limits.

    Attributes
    ----------
    seal : Seal
    tolerances : Tolerances
    goal : RobustGoal
    task : Task
    limits : tuple of SampledLimit
    said : dict
        The limits in summary.json.
    file : SealFile or None
        None for the door seal.
    """

    seal: sm.Seal
    tolerances: Tolerances
    goal: RobustGoal
    task: Task
    limits: tuple
    said: dict
    file: sm.SealFile | None = None


def subject_of(arguments, kept: AnalysisCache) -> Subject:
    """Set up the problem of the door seal or of a seal file, with its nominal analysis."""
    with checked_arguments():
        # mean + K std, or smooth maximum over the scenarios
        goal = RobustGoal(
            arguments.minimize, arguments.deviations, arguments.band, widen=arguments.widen
        )
    of = door_of if arguments.file is None else file_seal_of
    return of(arguments, goal, kept)


def door_of(arguments, goal: RobustGoal, kept: AnalysisCache) -> Subject:
    """Set up problem (71) of the door seal."""
    # profiles start farther back: scattered seals begin free of contact
    seal = with_clearance(seal_from(arguments))
    tolerances = tolerances_for(seal, arguments.tolerances or OF_THE_DOOR)
    with checked_arguments():
        # limits relative to the nominal seal's pressure and reaction
        task = robust_door_task(nominal_result(seal, kept), goal)
    pressure, reaction = task.sampled
    # the reaction stays in a band, the pressure above a floor
    low, high = band = reaction.lower, reaction.upper
    least = " and ".join(f"{value:.3g}" for value in pressure.lower)
    limits = (
        SampledLimit(
            "share_above_pressure_floor", f"contact pressure of at least {least} kPa",
            "patch_pressure", pressure.kept,
        ),
        SampledLimit(
            "share_in_reaction_band", f"reaction within {low:.3g} to {high:.3g} N/m",
            "reaction", reaction.kept, reaction.entry,
        ),
    )  # fmt: skip
    said = {"reaction_band_N_per_m": band, "pressure_floor_kPa": pressure.lower}
    return Subject(seal, tolerances, goal, task, limits, said)


def file_seal_of(arguments, goal: RobustGoal, kept: AnalysisCache) -> Subject:
    """Set up the problem of table ``[optimize]`` of a seal file."""
    # options of the door seal have no meaning for a file
    wrong = sorted(arguments.given.intersection((*SEAL_OPTIONS, "accuracy", "band", "nominal")))
    if wrong:
        raise WrongArgumentError(f"--{wrong[0].replace('_', '-')} is for the door seal alone")
    if arguments.tolerances is None:
        raise WrongArgumentError("a seal file needs tolerances of its own: --tolerances FILE.toml")
    file = file_of(arguments.file)
    with file_errors(arguments.file):
        # placement of the section becomes a parameter that can vary
        seal = with_clearance(seal_of(file).with_placements())
        require_problem(file, seal)
        task = file_task(file, nominal_result(seal, kept))
    tolerances = tolerances_for(seal, arguments.tolerances)
    # fraction of samples that satisfies each limit
    limits = tuple(
        SampledLimit(f"share_{own.measure}_{number}", _said(own), own.measure, own.kept)
        for number, own in enumerate(task.sampled, 1)
    )
    said = {"limits": [[own.measure, own.lower, own.upper] for own in task.sampled]}
    return Subject(seal, tolerances, goal, task, limits, said, file)


def _said(limit: Limit) -> str:
    # limits in words, for the report
    sides = (("at least", limit.lower), ("at most", limit.upper))
    words = [f"{word} {value:.4g}" for word, value in sides if value is not None]
    return f"{label(limit.measure)} {' and '.join(words)}"


def nominal_result(seal, kept) -> sm.SealResult:
    """Analyse the nominal seal with a progress bar."""
    with LoadStepProgress(seal) as progress:
        nominal = kept.analyze(seal, callback=progress)
    nominal.require_converged()
    return nominal


def tolerances_for(seal, path) -> Tolerances:
    """Read the tolerances of a file and check that they fit the seal."""
    found = read_tolerances(path)
    with checked_arguments():
        # the mean values have to be valid parameters of the seal
        found.middle(seal).check(seal)
    return found


def write_comparison(out: Path, cases: Path, designs, subject: Subject, kept) -> None:
    """Write the figure and the report that compare both designs."""
    # axis label
    unit = shown_unit(measure_of(subject, subject.task.minimize).units)
    cost = f"{label(subject.task.minimize)} ({unit})" if unit else label(subject.task.minimize)
    figure = comparison(designs, subject)
    plotting.save(figure, out / "comparison.png")
    # statistics of the samples as a section of the report
    section = samples_section(list(designs.values()), subject.limits, cost, figure)
    write_report(cases, out / "report.html", kept=kept, further=section)


def measure_of(subject: Subject, name: str):
    """Return a measure of the optimisation with its evaluation points."""
    measures = frozen_measures(subject.seal, subject.task.measures)
    return next(measure for measure in measures if measure.name == name)


def max_iterations(arguments) -> tuple:
    """Return the positional arguments of the driver: the iteration limit, if given."""
    return () if arguments.max_iterations is None else (arguments.max_iterations,)


def nominal_design(subject: Subject, arguments, kept: AnalysisCache) -> tuple[np.ndarray, dict]:
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
        driver = OPTIMIZERS[arguments.optimizer]()
        options = RunOptions(driver, recorded, kept=kept, work_dir=arguments.out)
        task = subject.task
        if subject.file is None:
            # the door seal's problem without tolerances, same measures
            flags = DoorProblem(True, pressure_floor=True, stress_norm=True, gap_integral=True)
            task = door_task(options.analyze(subject.seal), flags)
        # a nominal run that does not converge is a warning only
        numbers = optimize(optimization_problem(task, options))
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


def sampled(subject: Subject, name, design, arguments, workers) -> SampledDesign:
    """Evaluate a design on samples independent of the scenarios."""
    # objective and limited measures, each once
    limited = [limit.measure for limit in subject.limits]
    wanted = tuple(
        measure_of(subject, own) for own in dict.fromkeys([subject.task.minimize, *limited])
    )
    # text of the seal file identifies the study in its database
    source = "" if subject.file is None else subject.file.path.read_text(encoding="utf-8")
    study = ToleranceStudy(subject.seal, subject.tolerances, wanted, *design, source)
    # samples of an earlier run are reused only by a restart
    file = arguments.out / f"{name.split()[0]}.sqlite"
    if file.exists() and not arguments.restart:
        file.unlink()
    with tqdm(
        total=arguments.samples, desc=name, unit="sample", disable=hidden(), leave=False
    ) as bar:
        # next seed: samples independent of the scenarios
        found = study.run(
            file, arguments.samples, seed=arguments.seed + 1, workers=workers,
            callback=lambda *_: bar.update(),
        )  # fmt: skip
    # failed samples are counted and left out
    there = found.completed
    parts = study.task.by_measure(found.values[there])
    return SampledDesign(name, subject.task.minimize, parts, int(np.sum(~there)))


def compare(designs: dict, task: Task, limits) -> dict:
    """Print a line for each design; return the comparison as part of summary.json."""
    # mean, quantiles, and fraction of samples within each limit
    found = {name: design.summary(limits) for name, design in designs.items()}
    for name, own in found.items():
        cost = own[task.minimize]
        shares = "".join(f"; {limit.text} in {100 * own[limit.key]:.1f} %" for limit in limits)
        print(
            f"{name}: {label(task.minimize)} mean {cost['mean']:.4g}, median {cost['q50']:.4g}, 95 % "
            f"below {cost['q95']:.4g}{shares} of {own['samples']} samples"
        )
    # improvement of the 95 % quantile
    nominal, robust = (own[task.minimize]["q95"] for own in found.values())
    ratio = robust / nominal if nominal else None
    key = (
        "ratio_of_95_percent_gaps"
        if task.minimize == "gap_square_integral"
        else "ratio_of_95_percent"
    )
    return {"compared": found, key: ratio}


def comparison(designs: dict, subject: Subject):
    """Draw the distributions of cost and of the first scalar measure with limits, for all designs."""
    cost = measure_of(subject, subject.task.minimize)
    # first limited measure that has one number per sample
    limited, band, text = None, (None, None), ""
    for limit, own in zip(subject.limits, subject.task.sampled, strict=False):
        values = {name: limit.numbers(d.values[limit.measure]) for name, d in designs.items()}
        if all(numbers is not None for numbers in values.values()):
            unit = measure_of(subject, limit.measure).units
            limited, band = values, (own.lower, own.upper)
            text = f"{label(limit.measure)} ({shown_unit(unit)})" if unit else label(limit.measure)
            break
    # distribution of the objective
    costs = {name: design.costs for name, design in designs.items()}
    return plotting.designs_compared(costs, label(cost.name), cost.units or "", limited, band, text)


def settings_of(arguments) -> dict:
    names = ("optimizer", "scenarios", "samples", "seed", "minimize", "deviations", "band", "widen")
    return {name: getattr(arguments, name) for name in names}


def arguments_parser():
    made = parser(
        __doc__, "out/robust", "[FILE]", "seal-mdao robust bulb.toml --tolerances own.toml"
    )
    # defaults of the goal
    goal = RobustGoal()
    add = made.add_argument
    add(
        "file", type=Path, nargs="?", metavar="FILE",
        help="seal file (TOML) with [[design]] and [optimize]; the door seal without",
    )  # fmt: skip
    add(
        "--tolerances", type=existing_file, metavar="FILE",
        help="tolerances (TOML); without, those of the door seal",
    )  # fmt: skip
    add("--scenarios", type=positive_integer, default=32, metavar="N", help="of the optimisation")
    add("--samples", type=positive_integer, default=1000, metavar="N", help="fresh ones")
    add(
        "--seed", type=int, default=0, metavar="N", help="of scenarios; fresh samples have the next"
    )
    add(
        "--minimize", choices=GOALS, default=goal.minimize,
        help="mean + K std of what is minimised, or its smooth largest value over the scenarios",
    )  # fmt: skip
    add("--deviations", type=float, default=goal.deviations, metavar="K", help="of mean + K std")
    add(
        "--band", type=float, default=goal.band, metavar="SHARE",
        help="relative change of the nominal seal's reaction that is allowed",
    )  # fmt: skip
    add(
        "--widen", type=float, default=goal.widen, metavar="FACTOR",
        help="how many times as far as the tolerances the scenarios scatter",
    )  # fmt: skip
    names = list(OPTIMIZERS)
    add("--optimizer", choices=names, default=names[0], help="method")
    add("--max-iterations", type=int, metavar="N", help="largest number of iterations")
    add(
        "--nominal", type=existing_file, metavar="FILE",
        help="summary.json of the nominal optimum; found first when left out "
        f"(reaction within {100 * FORCE_BAND:.0f} %%, pressure floor)",
    )  # fmt: skip
    add(
        "--restart", type=existing_file, metavar="CASES.sql",
        help="continue the run recorded here, with the nominal optimum beside it; without --out in its "
        "folder, samples included",
    )  # fmt: skip
    add("--overwrite", action="store_true", help="replace the recorder file of an earlier run")
    add_executor_arguments(made)
    add_seal_arguments(made)
    return made
