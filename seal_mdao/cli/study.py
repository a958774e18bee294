"""Sample the tolerances of a seal: recorded analyses, distributions, correlations, linear estimate."""

import time

import numpy as np

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.arguments import (
    NAME_OF_FILE,
    SAMPLES,
    add_seal_arguments,
    announce,
    checked_arguments,
    design_from,
    existing_file,
    parser,
    write_summary,
)
from seal_mdao.cli.executors import add_executor_arguments, executor
from seal_mdao.cli.varied_seals import (
    add_tolerance_arguments,
    door_with_tolerances,
    file_with_tolerances,
)
from seal_mdao.plotting.captions import name_varied
from seal_mdao.progress import SampleProgress
from seal_mdao.tolerances.record import count_finished
from seal_mdao.tolerances.statistics import described, rank_correlations
from seal_mdao.tolerances.tolerance_set import METHODS
from seal_mdao.tolerances.tolerance_study import Sampled, ToleranceStudy

MOST_FAILED = 0.01
"""Fraction of failed samples above which the study is reported as failed."""
OF_THE_DOOR_SEAL = ("gap_square_integral", "reaction", "patch_pressure", "stress_norm")
"""Measures of the door seal that are sampled."""
CONSTANT = 1e-9
"""Standard deviation over the mean that is rounding."""


def main(arguments) -> int:
    study, file = study_of(arguments), arguments.out / SAMPLES
    name_varied(tuple(study.nominal))
    if arguments.overwrite:
        file.unlink(missing_ok=True)
    announce(study.seal)
    with checked_arguments():
        # the mean values must be valid before the samples begin
        study.seal.with_parameters(study.nominal)
        # gradients at the mean design: J(z) ~ J(z_0) + dJ/dz (z - z_0)
        estimate = study.first_order()
    begun = time.perf_counter()
    # every sample is recorded at once: a second start continues with those that are left
    finished = count_finished(file)
    if finished:
        print(f"{finished} of {arguments.samples} samples are already in {file}")
    with (
        executor(arguments) as workers,
        checked_arguments(),
        SampleProgress(arguments.samples, "study", finished) as progress,
    ):
        sampled = study.run(
            file, arguments.samples, method=arguments.method, seed=arguments.seed,
            workers=workers, callback=progress,
        )  # fmt: skip
    wall = time.perf_counter() - begun
    # all failed: the first message says why
    if not sampled.completed.any():
        raise sm.LoadPathError(
            "none of the samples of the tolerance study could be analysed; the first one failed "
            f"with: {sampled.messages[0]}"
        )
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
        seal, tolerances = door_with_tolerances(arguments)
        # an optimised design in place of the nominal one
        given = arguments.design is not None
        design = design_from(arguments.design, seal) if given else (None, None)
        study = ToleranceStudy(seal, tolerances, OF_THE_DOOR_SEAL, *design)
    else:
        # all measures of the file; its text identifies the study
        _, seal, tolerances = file_with_tolerances(arguments, ("design",))
        label = arguments.file.read_text(encoding="utf-8")
        study = ToleranceStudy(seal, tolerances, label=label)
    with checked_arguments():
        if not study.task.measures:
            raise ValueError(
                "the seal has no measure whose scatter could be computed; add a [[measure]] to the "
                "seal file"
            )
    return study


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
            "infinite_samples": int(np.isinf(values[:, m]).sum()),
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


def draw(study: ToleranceStudy, sampled: Sampled, estimate, out) -> None:
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


def report(summary: dict, wall: float, out) -> None:
    # cost of the study
    print(
        f"{summary['samples']} samples, {summary['failed']} failed, {wall:.1f} s "
        f"({summary['seconds_per_analysis']['mean']:.2f} s an analysis)"
    )
    for name, found in summary["measures"].items():
        print(f"{name}: {statistics_text(found)}")
    # failed samples bias the statistics: report by how much
    if summary["failed"]:
        report_failures(summary)
    print(f"{SAMPLES}, summary.json, distributions.png and correlations.png in {out}")


def statistics_text(found: dict) -> str:
    """Describe a measure: sampled and first-order statistics, or its value where nothing varies it."""
    own, line = found["sampled"], found["first_order"]
    unit = found["unit"] or ""
    # a leak rate without contact
    infinite = found["infinite_samples"]
    if np.isinf(own["lowest"]):
        return "infinite in all samples (no contact)"
    if not infinite and max(own["std"], line["std"]) <= CONSTANT * abs(own["mean"]):
        return f"{own['mean']:.4g} {unit} in all samples".replace("  ", " ")
    some = f"infinite in {infinite} samples (no contact): " if infinite else ""
    return (
        f"{some}mean {own['mean']:.4g}, std {own['std']:.3g}, 5 to 95 % {own['q05']:.4g} to "
        f"{own['q95']:.4g} {unit}; first order: mean {line['mean']:.4g}, std "
        f"{line['std']:.3g}, 5 to 95 % {line['q05']:.4g} to {line['q95']:.4g}"
    )


def report_failures(summary: dict) -> None:
    """Report the effect of failed samples on the statistics, one line per measure."""
    first = summary["failures"][0]
    print(
        f"WARNING: {summary['failed']} of {summary['samples']} samples "
        f"({summary['share_failed']:.2%}) failed and are excluded from these statistics; the first "
        f"is sample {first['sample']}: {first['message']}"
    )
    for name, found in summary["measures"].items():
        change = found["effect_of_failures"]
        print(
            f"WARNING: to first order, the exclusion of failed samples changes the mean of {name} by "
            f"{change['mean']:+.3g}, its std by {change['std']:+.3g}, its 5 % quantile by "
            f"{change['q05']:+.3g} and its 95 % quantile by {change['q95']:+.3g} "
            f"{found['unit'] or ''}".rstrip()
        )


def arguments_parser():
    made = parser(
        __doc__,
        f"out/{NAME_OF_FILE}_tolerances",
        "[FILE]",
        "seal-mdao study bulb.toml --samples 1000",
    )
    add_tolerance_arguments(made)
    # design of experiments
    made.add_argument("--method", choices=METHODS, default=METHODS[0], help="method of sampling")
    made.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the random samples")
    made.add_argument(
        "--overwrite",
        action="store_true",
        help="start again instead of continuing the tolerance study in the folder --out",
    )
    made.add_argument(
        "--design", type=existing_file, metavar="FILE",
        help="summary.json of an optimisation; the tolerance study then refers to this optimum "
        "instead of the nominal seal",
    )  # fmt: skip
    add_executor_arguments(made)
    add_seal_arguments(made)
    return made
