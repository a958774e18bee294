"""Sample the tolerances of a seal: recorded analyses, distributions, correlations, linear estimate."""

import time
from pathlib import Path

import numpy as np
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.arguments import (
    SAMPLES,
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
from seal_mdao.cli.seal_files import file_errors, file_of, seal_of
from seal_mdao.progress import hidden
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances
from seal_mdao.tolerances.placement import with_clearance
from seal_mdao.tolerances.statistics import described, rank_correlations
from seal_mdao.tolerances.study import Sampled, ToleranceStudy
from seal_mdao.tolerances.tolerance_set import METHODS

MOST_FAILED = 0.01
"""Fraction of failed samples above which the study is reported as failed."""
OF_THE_DOOR_SEAL = ("gap_square_integral", "reaction", "patch_pressure", "stress_norm")
"""Measures of the door seal that are sampled."""


def main(arguments) -> int:
    # an existing file is refused before load steps are chosen
    file, study = samples_file(arguments), study_of(arguments)
    announce(study.seal)
    with checked_arguments():
        # the mean values must be valid before the samples begin
        study.seal.with_parameters(study.nominal)
        # gradients at the mean design: J(z) ~ J(z_0) + dJ/dz (z - z_0)
        estimate = study.first_order()
    begun = time.perf_counter()
    with (
        executor(arguments) as workers,
        checked_arguments(),
        tqdm(total=arguments.samples, unit="sample", disable=hidden(), leave=False) as bar,
    ):
        # every sample is recorded at once, so that --resume can continue
        sampled = study.run(
            file, arguments.samples, method=arguments.method, seed=arguments.seed,
            workers=workers, callback=lambda *_: bar.update(),
        )  # fmt: skip
    wall = time.perf_counter() - begun
    # all failed: the first message says why
    if not sampled.completed.any():
        raise sm.LoadPathError(f"no sample could be analysed; the first: {sampled.messages[0]}")
    # statistics, then figures, then text
    summary = summarize(study, sampled, estimate)
    write_summary(arguments.out, summary | {"wall_s": wall})
    draw(study, sampled, estimate, arguments.out)
    report(summary, wall, arguments.out)
    # few failures do not change the statistics
    return 1 if summary["share_failed"] > MOST_FAILED else 0


def study_of(arguments) -> ToleranceStudy:
    """Set up the study: seal, tolerances and sampled measures."""
    if arguments.file is None:
        # profiles start farther back: scattered seals begin free of contact
        seal = with_clearance(seal_from(arguments))
        tolerances = read_tolerances(arguments.tolerances or OF_THE_DOOR)
        design = (None, None)
        if arguments.design is not None:
            # an optimised design in place of the nominal one
            design = design_from(arguments.design, seal)
        measures, label = OF_THE_DOOR_SEAL, ""
    else:
        seal, tolerances, label = of_file(arguments)
        measures, design = None, (None, None)
    # measures None: all of the seal file
    study = ToleranceStudy(seal, tolerances, measures, *design, label)
    with checked_arguments():
        # tolerances must name parameters of this seal
        tolerances.middle(seal).check(seal)
        if not study.task.measures:
            raise ValueError("the seal has no measures; its file needs a table [[measure]]")
    return study


def of_file(arguments):
    """Read seal, tolerances and label for a seal file."""
    # options of the door seal have no meaning for a file
    wrong = sorted(arguments.given.intersection((*SEAL_OPTIONS, "accuracy", "design")))
    if wrong:
        name = wrong[0].replace("_", "-")
        raise WrongArgumentError(f"--{name} is for the door seal, and {arguments.file} is given")
    if arguments.tolerances is None:
        raise WrongArgumentError("a seal file needs tolerances of its own: --tolerances FILE.toml")
    with file_errors(arguments.file):
        # placement of the section becomes a parameter that can vary
        seal = seal_of(file_of(arguments.file)).with_placements()
        label = arguments.file.read_text(encoding="utf-8")
    return seal, read_tolerances(arguments.tolerances), label


def samples_file(arguments) -> Path:
    """Return the path of the sample database, after checking that this run may write it."""
    path = arguments.out / SAMPLES
    # never mix the samples of two studies
    if path.exists() and not arguments.resume:
        raise WrongArgumentError(
            f"{path} is there already; --resume goes on with it, another --out begins anew"
        )
    if arguments.resume and not path.exists():
        raise WrongArgumentError(f"--resume: there is no {path} to go on with")
    return path


def summarize(study: ToleranceStudy, sampled: Sampled, estimate) -> dict:
    """Collect summary.json: statistics of every measure, sampled and to first order.

    Failed samples are left out; ``effect_of_failures`` is the change by leaving them out of the same
    statistics of the first-order estimate, which exists for all samples.
    """
    # mask of completed samples
    there = sampled.completed
    # first-order value of every sample, failed ones included
    every = estimate.at(sampled.scenarios)
    # rows: samples, columns: scalar inputs and boundary offsets
    inputs = np.hstack([sampled.scenarios.numbers, sampled.scenarios.offsets])[there]
    inputs = inputs[:, : len(study.inputs)]
    values, linear = sampled.values[there], every[there]
    # Spearman correlation of every input with every measure
    ranks = rank_correlations(inputs, values)
    # fraction of the first-order variance by each input
    shares = estimate.variances / np.maximum(estimate.variances.sum(axis=1), 1e-300)[:, None]
    names = [variation.name for variation in study.tolerances.variations]
    found = {}
    for m, name in enumerate(study.outputs):
        # statistics: sampled, linear on the same samples, linear on all
        own, line, of_all = (described(t[:, m]) for t in (values, linear, every))
        found[name] = {
            "unit": study.units[m],
            "middle": estimate.values[m],
            "sampled": own,
            "first_order": line | {"std_from_gradient": estimate.std[m]},
            "difference": {key: line[key] - own[key] for key in own},
            # with and without the failed samples, to first order
            "effect_of_failures": {key: line[key] - of_all[key] for key in own},
            "rank_correlation": dict(zip(study.inputs, ranks[m], strict=True)),
            "share_of_first_order_variance": dict(
                zip([*names, "boundary"], shares[m], strict=True)
            ),
        }
    # number and message of every failed sample
    failures = [
        {"sample": number, "message": message}
        for number, message in enumerate(sampled.messages) if message
    ]  # fmt: skip
    return {
        "samples": len(there), "failed": len(failures), "share_failed": float(np.mean(~there)),
        "measures": found, "failures": failures,
        "seconds_per_analysis": {"mean": sampled.seconds.mean(), "longest": sampled.seconds.max()},
    }  # fmt: skip


def draw(study: ToleranceStudy, sampled: Sampled, estimate, out: Path) -> None:
    there = sampled.completed
    values, linear = sampled.values[there], estimate.at(sampled.scenarios)[there]
    # histograms of the samples with the linear estimate
    figure = plotting.distributions(values, study.outputs, study.units, linear)
    plotting.save(figure, out / "distributions.png")
    # matrix of rank correlations
    names, table = correlation_table(study, sampled, estimate)
    plotting.save(plotting.correlations(table, study.outputs, names), out / "correlations.png")


def correlation_table(study: ToleranceStudy, sampled: Sampled, estimate):
    """Compute rank correlations of measures and inputs; the boundary enters by its first-order effect on
    each measure."""
    there = sampled.completed
    values = sampled.values[there]
    names = [variation.name for variation in study.tolerances.variations]
    table = rank_correlations(sampled.scenarios.numbers[there], values)
    if study.tolerances.boundary is not None:
        # one number per sample: effect of all offsets on each measure
        effect = sampled.scenarios.offsets[there] @ estimate.by_offset.T
        table = np.column_stack([table, np.diag(rank_correlations(effect, values))])
        names = [*names, "boundary"]
    return names, table


def report(summary: dict, wall: float, out: Path) -> None:
    # cost of the study
    print(
        f"{summary['samples']} samples, {summary['failed']} failed, {wall:.1f} s "
        f"({summary['seconds_per_analysis']['mean']:.2f} s an analysis)"
    )
    for name, found in summary["measures"].items():
        # sampled and first-order statistics side by side
        own, line = found["sampled"], found["first_order"]
        print(
            f"{name}: mean {own['mean']:.4g}, std {own['std']:.3g}, 5 to 95 % {own['q05']:.4g} to "
            f"{own['q95']:.4g} {found['unit'] or ''}; first order: mean {line['mean']:.4g}, std "
            f"{line['std']:.3g}, 5 to 95 % {line['q05']:.4g} to {line['q95']:.4g}"
        )
    # failed samples bias the statistics: report by how much
    if summary["failed"]:
        report_failures(summary)
    print(f"{SAMPLES}, summary.json, distributions.png and correlations.png in {out}")


def report_failures(summary: dict) -> None:
    """Report the effect of failed samples on the statistics, one line per measure."""
    first = summary["failures"][0]
    print(
        f"WARNING: {summary['failed']} of {summary['samples']} samples ({summary['share_failed']:.2%}) "
        f"failed and are in none of these numbers; the first is sample {first['sample']}: "
        f"{first['message']}"
    )
    for name, found in summary["measures"].items():
        change = found["effect_of_failures"]
        print(
            f"WARNING: to first order, leaving them out changes of {name} the mean by "
            f"{change['mean']:+.3g}, std by {change['std']:+.3g}, 5 % by {change['q05']:+.3g} and 95 % "
            f"by {change['q95']:+.3g} {found['unit'] or ''}".rstrip()
        )


def arguments_parser():
    made = parser(__doc__, "out/tolerances", "[FILE]", "seal-mdao study bulb.toml --samples 1000")
    made.add_argument(
        "file", type=Path, nargs="?", metavar="FILE", help="seal file (TOML); the door seal without"
    )
    made.add_argument(
        "--tolerances", type=existing_file, metavar="FILE",
        help="tolerances (TOML); without, those of the door seal",
    )  # fmt: skip
    made.add_argument(
        "--samples", type=positive_integer, default=1000, metavar="N", help="how many"
    )
    # design of experiments
    made.add_argument("--method", choices=METHODS, default=METHODS[0], help="how they are spread")
    made.add_argument("--seed", type=int, default=0, metavar="N", help="of the samples")
    made.add_argument("--resume", action="store_true", help="go on with the samples in --out")
    made.add_argument(
        "--design", type=existing_file, metavar="FILE",
        help="summary.json of an optimisation whose design is studied",
    )  # fmt: skip
    add_executor_arguments(made)
    add_seal_arguments(made)
    return made
