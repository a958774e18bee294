"""Optimise the door seal for all cars, and compare it with the nominal optimum on fresh samples."""

import json
import sys
from hashlib import sha256
from pathlib import Path

import numpy as np
from _common import (
    CASES,
    WrongArgumentError,
    add_seal_arguments,
    announce,
    checked_arguments,
    design_from,
    existing_file,
    parser,
    positive_integer,
    run,
    seal_from,
    write_summary,
)
from _executors import add_executor_arguments, executor
from _history_figures import history_rows
from _optimization import judged, optimize, report_run
from _restart import recorder_file
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.kept_analyses import KeptAnalyses
from seal_mdao.optimization import FORCE_BAND, OPTIMIZERS, PRESSURE_SHARE, seal_problem
from seal_mdao.progress import hidden
from seal_mdao.recording.recorded_optimization import read_optimization
from seal_mdao.recording.restart import restart
from seal_mdao.recording.settings import open_model, recorded_settings
from seal_mdao.report.samples import samples_section
from seal_mdao.report.write import write_report
from seal_mdao.robust_optimization import COST, GOALS, RobustGoal, robust_problem
from seal_mdao.tolerances.comparison import SampledDesign
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances
from seal_mdao.tolerances.placement import with_room
from seal_mdao.tolerances.study import ToleranceStudy

NOMINAL = "nominal.sql"
"""Recorder file of the nominal optimisation in the output folder."""
SAMPLED = (COST, "reaction", "patch_pressure")


def main(arguments) -> int:
    seal = with_room(seal_from(arguments))
    tolerances = read_tolerances(arguments.tolerances or OF_THE_DOOR)
    with checked_arguments():
        goal = RobustGoal(
            arguments.minimize, arguments.deviations, arguments.band, widen=arguments.widen
        )
        tolerances.middle(seal).check(seal)
        scenarios = goal.scenarios(tolerances, seal, arguments.scenarios, arguments.seed)
    announce(seal)
    cases, kept = robust_file(arguments), KeptAnalyses()
    nominal = nominal_design(seal, arguments, kept)
    with executor(arguments) as workers:
        with checked_arguments():
            driver = OPTIMIZERS[arguments.optimizer](*max_iterations(arguments))
            problem = robust_problem(
                seal, scenarios, goal, workers=workers, driver=driver, kept=kept,
                recorder=None if arguments.restart else cases, work_dir=arguments.out,
                label=label_of(scenarios, nominal),
            )  # fmt: skip
            begin(problem, nominal, cases if arguments.restart else None)
        numbers = optimize(problem)
        history = read_optimization(cases)
        robust = history.design_at(-1)
        designs = {
            label: sampled(seal, tolerances, label, design, arguments, workers)
            for label, design in (("nominal optimum", nominal), ("robust optimum", robust))
        }
    numbers = judged(numbers, history)
    ends = {
        "boundary_offsets": robust[0], **robust[1],
        "nominal": {"boundary_offsets": nominal[0], **nominal[1]}, "history": history_rows(history),
    }  # fmt: skip
    summary = numbers | settings_of(arguments)
    write_comparison(arguments.out, cases, designs, limits(seal, goal, kept), summary, ends, kept)
    report_run(arguments.optimizer, numbers, arguments.restart and cases)
    print(f"report.html, comparison.png, summary.json, cases.sql and samples in {arguments.out}")
    return 0 if numbers["success"] else 1


def write_comparison(out: Path, cases: Path, designs, within, summary, ends, kept) -> None:
    """summary.json, figure and report of both designs."""
    band, floor = within
    limited = {"reaction_band_N_per_m": band, "pressure_floor_kPa": floor}
    write_summary(out, summary | compare(designs, band, floor) | limited | ends)
    figure = comparison(designs, band)
    plotting.save(figure, out / "comparison.png")
    section = samples_section(list(designs.values()), band, floor, figure)
    write_report(cases, out / "report.html", kept=kept, further=section)


def max_iterations(arguments) -> tuple:
    """What a driver takes."""
    return () if arguments.max_iterations is None else (arguments.max_iterations,)


def robust_file(arguments) -> Path:
    """The recorder file of the robust optimisation, which this run may write or go on with."""
    cases = (arguments.out / CASES).absolute()
    arguments.restart = cases if arguments.restart else None
    if arguments.restart and not cases.is_file():
        raise WrongArgumentError(f"--restart: there is no {cases} to continue")
    return recorder_file(arguments)


def nominal_design(seal: sm.DoorSeal, arguments, kept: KeptAnalyses) -> tuple[np.ndarray, dict]:
    """Boundary offsets and door radius of the optimum without tolerances: given, or found now."""
    if arguments.nominal is not None:
        return design_from(arguments.nominal, seal)
    recorded = (arguments.out / NOMINAL).absolute()
    if not (arguments.restart and recorded.is_file()):
        problem = seal_problem(
            seal, keep_force=True, pressure_floor=True, stress_norm=True, gap_integral=True,
            driver=OPTIMIZERS[arguments.optimizer](), recorder=recorded, kept=kept,
            work_dir=arguments.out,
        )  # fmt: skip
        numbers = optimize(problem)
        if not numbers["success"]:
            print(f"WARNING (nominal optimum): {numbers['message']}")
    return read_optimization(recorded).design_at(-1)


def begin(problem, nominal, recorded: Path | None) -> None:
    """Put the nominal optimum into the model, or go on with what is recorded.

    Raises
    ------
    ValueError
        When another problem is recorded.
    """
    offsets, parameters = nominal
    problem.set_val("boundary_offsets", offsets)
    problem.set_val("door_radius", parameters["door_radius"])
    if recorded is None:
        return
    mine = json.loads(problem.model.options["problem_settings"])
    if recorded_settings(open_model(recorded)) != mine:
        raise ValueError(
            f"--restart: {recorded} was recorded with other scenarios or another goal; a run is "
            "continued with its own"
        )
    restart(problem, recorded)


def label_of(scenarios, nominal) -> str:
    """What the scenarios and the start are known by."""
    parts = scenarios.numbers, scenarios.offsets, nominal[0]
    return sha256(b"".join(np.ascontiguousarray(part).tobytes() for part in parts)).hexdigest()


def sampled(seal, tolerances, label, design, arguments, workers) -> SampledDesign:
    """A design on samples that no scenario has seen."""
    study = ToleranceStudy(seal, tolerances, SAMPLED, *design)
    file = arguments.out / f"{label.split()[0]}.sqlite"
    if file.exists() and not arguments.restart:
        file.unlink()
    with tqdm(
        total=arguments.samples, desc=label, unit="sample", disable=hidden(), leave=False
    ) as bar:
        found = study.run(
            file, arguments.samples, seed=arguments.seed + 1, workers=workers,
            callback=lambda *_: bar.update(),
        )  # fmt: skip
    there = found.completed
    parts = study.task.by_measure(found.values[there])
    return SampledDesign(
        label, parts[COST][:, 0], parts["reaction"][:, 1], parts["patch_pressure"],
        int(np.sum(~there)),
    )  # fmt: skip


def limits(seal: sm.DoorSeal, goal: RobustGoal, kept: KeptAnalyses) -> tuple:
    """Band of the reaction (N/m) and floor of the pressures (kPa), from the drawn seal."""
    drawn = kept.analyze(seal)
    (pressures,) = drawn.measures(["patch_pressure"])
    force = float(drawn.reaction[-1, 1])
    band = (1.0 - goal.band) * force, (1.0 + goal.band) * force
    return band, PRESSURE_SHARE * drawn.value(pressures)


def compare(designs: dict, band, floor) -> dict:
    """Print a line for each design; part of summary.json."""
    found = {label: design.summary(band, floor) for label, design in designs.items()}
    for label, own in found.items():
        cost = own["gap_square_integral"]
        print(
            f"{label}: gap integral mean {cost['mean']:.4g}, median {cost['q50']:.4g}, 95 % below "
            f"{cost['q95']:.4g} mm3; reaction in its band in "
            f"{100 * own['share_in_reaction_band']:.1f} %, pressure above its floor in "
            f"{100 * own['share_above_pressure_floor']:.1f} % of {own['samples']} samples"
        )
    nominal, robust = (own["gap_square_integral"]["q95"] for own in found.values())
    ratio = robust / nominal if nominal else None
    return {"compared": found, "ratio_of_95_percent_gaps": ratio}


def comparison(designs: dict, band):
    """The figure of all designs."""
    return plotting.designs_compared(
        {label: design.cost for label, design in designs.items()}, "gap integral", "mm**3",
        {label: design.reaction for label, design in designs.items()}, band,
    )  # fmt: skip


def settings_of(arguments) -> dict:
    names = ("optimizer", "scenarios", "samples", "seed", "minimize", "deviations", "band", "widen")
    return {name: getattr(arguments, name) for name in names}


def arguments_parser():
    made = parser(__doc__, "out/robust")
    goal = RobustGoal()
    add = made.add_argument
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
        help="mean + K std of the gap integral, or its smooth largest value over the scenarios",
    )  # fmt: skip
    add("--deviations", type=float, default=goal.deviations, metavar="K", help="of mean + K std")
    add(
        "--band", type=float, default=goal.band, metavar="SHARE",
        help="relative change of the drawn seal's reaction that is allowed",
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
    add("--restart", action="store_true", help="go on with what is in --out")
    add("--overwrite", action="store_true", help="replace the recorder file of an earlier run")
    add_executor_arguments(made)
    add_seal_arguments(made)
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
