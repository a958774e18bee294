"""Nominal and robust optimum on the same fresh samples: fractions, quantiles, figure, report."""

from pathlib import Path

import numpy as np

from seal_mdao import plotting
from seal_mdao.cli.robust_subject import Subject
from seal_mdao.progress import SampleProgress
from seal_mdao.recording.recorded_optimization import label
from seal_mdao.report.sample_section import samples_section
from seal_mdao.report.write import write_report
from seal_mdao.tolerances.design_comparison import SampledDesign
from seal_mdao.tolerances.record import count_finished, other_settings
from seal_mdao.tolerances.tolerance_study import ToleranceStudy


def sampled(subject: Subject, name: str, design: tuple, arguments, workers) -> SampledDesign:
    """Evaluate a design on samples independent of the scenarios.

    Parameters
    ----------
    name : str
        Of the design; its first word is that of the file of samples, in which a second start continues.
        A continued optimisation with another optimum replaces the samples of the earlier one.
    design : (ndarray, dict)
        Boundary offsets and parameters.
    """
    # objective and limited measures, each once
    names = dict.fromkeys([subject.task.minimize, *(own.measure for own in subject.limits)])
    wanted = tuple(map(subject.measure, names))
    study = ToleranceStudy(subject.seal, subject.tolerances, wanted, *design, subject.source)
    file = arguments.out / f"{name.split()[0]}.sqlite"
    # next seed: samples independent of the scenarios
    sampling = {"method": "sobol", "seed": arguments.seed + 1, "count": arguments.samples}
    if arguments.restart and other_settings(file, study.settings(**sampling)) == ["design"]:
        file.unlink()
    with SampleProgress(arguments.samples, name, count_finished(file)) as progress:
        found = study.run(file, **sampling, workers=workers, callback=progress)
    # failed samples satisfy no limit, and are in no quantile
    there = found.completed
    parts = study.task.by_measure(found.values[there])
    return SampledDesign(name, subject.task.minimize, parts, int(np.sum(~there)))


def compared(designs: list[SampledDesign], subject: Subject) -> dict:
    """Return the comparison as part of summary.json; ``limits_met`` is that of the last design."""
    # mean, quantiles, and fraction of samples within each limit
    found = {own.label: own.summary(subject.limits) for own in designs}
    cost = subject.task.minimize
    # improvement of the 95 % quantile
    nominal, robust = (own[cost]["q95"] for own in found.values())
    gaps = cost == "gap_square_integral"
    key = "ratio_of_95_percent_gaps" if gaps else "ratio_of_95_percent"
    met = all(designs[-1].meets(limit) for limit in subject.limits)
    return {"compared": found, key: robust / nominal if nominal else None, "limits_met": met}


def report_comparison(designs: list[SampledDesign], subject: Subject) -> None:
    """Print quantiles of the objective and the fractions that satisfy the limits, for every design."""
    for design in designs:
        cost = design.summary(())[design.cost]
        print(
            f"{design.label}, {design.samples} new samples, {design.failed} failed: "
            f"{label(design.cost)} mean {cost['mean']:.4g}, median {cost['q50']:.4g}, 95 % below "
            f"{cost['q95']:.4g}"
        )
        for limit in subject.limits:
            print(f"  {limit.text}: {design.in_words(limit)}")
    # a band that no design can keep to, however it is placed in it
    for limit in subject.limits:
        width = designs[-1].too_wide(limit)
        if width is not None:
            print(
                f"WARNING: {limit.text}: the range of {100.0 * limit.required:g} % of the samples "
                f"is {width:.3g} wide, but the limit allows only {limit.band:.3g}; widen the limit "
                "or narrow the tolerances"
            )


def write_comparison(
    out: Path, cases: Path, designs: list[SampledDesign], subject: Subject, cache
) -> None:
    """Write ``comparison.png``, and the report with the same table and figure."""
    figure = _figure(designs, subject)
    plotting.save(figure, out / "comparison.png")
    # statistics of the samples as a section of the report
    cost = subject.described(subject.task.minimize)
    section = samples_section(designs, subject.limits, cost, figure)
    write_report(cases, out / "report.html", cache=cache, further=section)


def _figure(designs: list[SampledDesign], subject: Subject):
    """Draw the distributions of cost and of the first scalar measure with limits, for all designs."""
    cost = subject.measure(subject.task.minimize)
    # first limited measure that has one number per sample
    limited, band, text = None, (None, None), ""
    for limit, own in zip(subject.limits, subject.task.sampled, strict=True):
        values = {d.label: limit.numbers(d.values[limit.measure]) for d in designs}
        if all(numbers is not None for numbers in values.values()):
            limited, band = values, (own.lower, own.upper)
            text = subject.described(limit.measure)
            break
    # distribution of the objective
    costs = {design.label: design.costs for design in designs}
    return plotting.designs_compared(
        costs, label(cost.name), subject.seal.units.of(cost.units) or "", limited, band, text
    )
