"""Compare the analytic sensitivities of all measures with finite differences (Table 1)."""

import csv
import sys
import time
from pathlib import Path

import numpy as np
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.arguments import (
    add_seal_arguments,
    parser,
    positive_integer,
    run,
    seal_from,
    write_summary,
)

# the difference quotients are those of the tests
sys.path.append(str(Path(__file__).resolve().parents[1] / "tests"))

from verification.differences import (
    STEPS,
    Design,
    Differences,
    evaluation_noise,
    measure_names,
    measure_rates,
)
from verification.estimates import error_scale

TAU = 1e-6
"""Perturbation to which the printed table refers, as in the paper, mm."""
TABLE_1_PARAMETERS = 5
AMPLITUDE = 0.2
GROUPS = {
    "von_mises": "seven stresses",
    "gap": "single gaps",
    "gap_square_sum": "sum of squared gaps",
}
"""Names of groups of measures in the picture of the step study."""


def main(arguments) -> int:
    seal = seal_from(arguments, newton=sm.NewtonOptions(tolerance=1e-11))
    design = chosen_design(seal, arguments)
    base = design.analyze(keep_factors=True)
    if not base.converged:
        write_summary(arguments.out, {"worst_relative_error": None, "table": []})
    base.require_converged()
    analytic = measure_rates(base, sm.differentiate(base, method="direct"))
    columns = np.arange(analytic.shape[1])[arguments.parameters or slice(None)]
    differences = run_differences(design, base, columns, arguments.steps)
    rows = table_rows(base, differences, columns, analytic)
    summary = summarize(rows, differences, columns) | cost_shares(design, arguments.repeats)
    write_summary(arguments.out, summary)
    write_csv(rows, arguments.out / "table.csv")
    draw(base, differences, columns, analytic, arguments)
    report(rows, summary, arguments.out)
    return 0 if summary["worst_relative_error"] is not None else 1


def chosen_design(seal, arguments) -> Design:
    """The nominal seal, or a random design when a seed or an amplitude is given."""
    nominal = np.append(np.zeros(seal.n_offsets), seal.scalars["door_radius"].value)
    if arguments.seed is None and arguments.amplitude is None:
        return Design(seal, nominal)
    amplitude = AMPLITUDE if arguments.amplitude is None else arguments.amplitude
    generator = np.random.default_rng(arguments.seed or 0)
    return Design(seal, nominal + generator.uniform(-amplitude, amplitude, nominal.size))


def run_differences(design, base, columns, steps) -> list[Differences]:
    noise = evaluation_noise(design)
    least = 2 * len(steps) * len(columns)
    with tqdm(total=least, unit="analysis", disable=None, leave=False, desc="differences") as bar:

        def tick():
            bar.total = max(bar.total, bar.n + 1)
            bar.update()

        return [Differences(design, base, int(p), noise, steps, tick) for p in columns]


def table_rows(base, differences, columns, analytic) -> list[dict]:
    """One row for every parameter and measure."""
    names, scale, rows = measure_names(base), error_scale(analytic), []
    for difference, p in zip(differences, columns, strict=True):
        estimate = difference.estimate()
        for i, measure in enumerate(names):
            value, exact = estimate.value[i], analytic[i, p]
            rows.append(
                {
                    "measure": measure,
                    "parameter": parameter_name(base.seal, p),
                    "fd": value,
                    "analytic": exact,
                    "ratio_percent": 100.0 * value / exact if exact != 0.0 else None,
                    "same_contact_sequence": bool(difference.same.any()),
                    "scheme": difference.scheme,
                    "step": estimate.step[i],
                    "fd_uncertainty": estimate.uncertainty[i],
                    "relative_error": abs(value - exact) / scale[i, p],
                }
            )
    return rows


def parameter_name(seal: sm.Seal, p: int) -> str:
    return f"boundary_offsets[{p}]" if p < seal.n_offsets else "door_radius"


def summarize(rows, differences, columns) -> dict:
    judged = [row for row in rows if row["same_contact_sequence"]]

    def worst(measure=None):
        errors = [row["relative_error"] for row in judged if measure in (None, row["measure"])]
        return max(errors, default=None)

    return {
        "worst_relative_error": worst(),
        "worst_relative_error_gap_square_sum": worst("gap_square_sum"),
        "n_parameters": len(columns),
        "n_entries": len(rows),
        "n_entries_same_contact_sequence": len(judged),
        "n_one_sided_parameters": sum(d.scheme != "central" for d in differences),
        "table": rows,
    }


def cost_shares(design: Design, repeats: int) -> dict:
    """Median time of both methods for all parameters over that of the analysis, all warm."""
    times = []
    for _ in range(repeats + 1):
        stamps = [time.perf_counter()]
        result = design.analyze(keep_factors=True)
        stamps.append(time.perf_counter())
        for method in ("direct", "adjoint"):
            sm.differentiate(result, method=method)
            stamps.append(time.perf_counter())
        times.append(np.diff(stamps))
    analysis, direct, adjoint = np.median(times[1:], axis=0)
    return {
        "sensitivity_over_analysis_time": direct / analysis,
        "adjoint_over_analysis_time": adjoint / analysis,
        "analysis_s": analysis,
    }


def write_csv(rows, path) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, rows[0].keys())
        writer.writeheader()
        writer.writerows(rows)


def draw(base, differences, columns, analytic, arguments) -> None:
    names, scale = measure_names(base), error_scale(analytic)[:, columns]
    exact = analytic[:, columns]
    best = np.array([difference.estimate().value for difference in differences]).T
    figure = plotting.sensitivity_errors(
        np.abs(best - exact) / scale,
        names,
        [parameter_name(base.seal, p).replace("boundary_offsets", "offset") for p in columns],
        np.array([difference.same.any() for difference in differences]),
        np.array([difference.scheme != "central" for difference in differences]),
    )
    plotting.save(figure, arguments.out / "sensitivity_errors.png")
    steps = np.sort(arguments.steps)[::-1]
    errors = np.array([plain_errors(d, steps) for d in differences])
    errors = np.abs(errors - exact.T[:, None]) / scale.T[:, None]
    groups = {}
    for i, name in enumerate(names):
        groups.setdefault(GROUPS.get(name.rstrip("_0123456789"), name), []).append(errors[:, :, i])
    groups = {name: np.concatenate(parts) for name, parts in groups.items()}
    plotting.save(plotting.step_study(steps, groups), arguments.out / "step_study.png")


def plain_errors(difference: Differences, steps) -> np.ndarray:
    """Quotients (n, m) at the given steps, nan where the contact sequence changed."""
    at = [int(np.flatnonzero(difference.steps == step)[0]) for step in steps]
    return np.where(difference.same[at, None], difference.quotient[at], np.nan)


def print_table(rows) -> None:
    """The first parameters in the layout of the paper's Table 1."""
    print(f"{'measure':>16} {'dPsi':>14} {'Psi_prime':>14} {'(dPsi/Psi_prime) x 100':>23}")
    shown = list(dict.fromkeys(row["parameter"] for row in rows))[:TABLE_1_PARAMETERS]
    for parameter in shown:
        print(f"u = {parameter}, perturbation {TAU:g} mm")
        for row in rows:
            single_gap = row["measure"].startswith("gap_") and row["measure"] != "gap_square_sum"
            if row["parameter"] != parameter or single_gap:
                continue
            ratio = "-" if row["ratio_percent"] is None else f"{row['ratio_percent']:.4f}"
            change, exact = TAU * row["fd"], TAU * row["analytic"]
            print(f"{row['measure']:>16} {change:14.6e} {exact:14.6e} {ratio:>23}")


def report(rows, summary, out) -> None:
    print_table(rows)
    worst = summary["worst_relative_error"]
    print(
        f"worst relative error {'-' if worst is None else format(worst, '.2e')} over "
        f"{summary['n_entries_same_contact_sequence']} of {summary['n_entries']} entries with the "
        f"contact sequence of the design ({summary['n_one_sided_parameters']} parameters one-sided)"
    )
    print(
        f"all parameters cost {100 * summary['sensitivity_over_analysis_time']:.0f} % of the "
        f"analysis by direct differentiation, "
        f"{100 * summary['adjoint_over_analysis_time']:.0f} % by the adjoint method"
    )
    print(f"table.csv, figures and summary.json in {out}")


def arguments_parser():
    made = parser(__doc__, "out/sensitivities")
    add_seal_arguments(made)
    made.add_argument("--seed", type=int, metavar="N", help="verify a random design")
    made.add_argument(
        "--amplitude", type=float, metavar="MM",
        help=f"largest change of a parameter of the random design, default {AMPLITUDE}",
    )  # fmt: skip
    made.add_argument(
        "--steps", type=float, nargs="+", default=STEPS, metavar="MM",
        help="steps of the difference quotients",
    )  # fmt: skip
    made.add_argument(
        "--parameters", type=int, nargs="+", metavar="P",
        help="numbers of the parameters to verify, the last one is the door radius; default: all",
    )  # fmt: skip
    made.add_argument(
        "--repeats", type=positive_integer, default=5, metavar="N", help="repeats of the timing"
    )
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
