"""Fit a Prony series to relaxation tests: the part of ``seal-mdao fit`` for files with ``time_s``."""

import csv
import time
from pathlib import Path

from tqdm import tqdm

from seal_mdao import plotting
from seal_mdao.calibration.measurement_files import MaterialDataError
from seal_mdao.calibration.relaxation_data import read_relaxation
from seal_mdao.calibration.relaxation_fit import fit_relaxation
from seal_mdao.calibration.relaxation_result import RelaxationFit
from seal_mdao.calibration.seal_file import viscoelastic_table
from seal_mdao.cli.arguments import WrongArgumentError, checked_arguments, write_summary

POOR = 2.0
"""Ratio of the scatter with shift function to that without above which the function is questioned."""


def main(arguments) -> int:
    """Fit, write the files, print constants and the table of the seal file."""
    begun = time.perf_counter()
    found = fitted(arguments)
    with checked_arguments():
        table = viscoelastic_table(found, arguments.moduli, arguments.name, notes(found, arguments))
    write_summary(arguments.out, summarize(found, arguments, time.perf_counter() - begun))
    write_differences(found, arguments.out / "residuals.csv")
    (arguments.out / "viscoelastic.toml").write_text(table, encoding="utf-8")
    plotting.save(plotting.relaxation_fit(found), arguments.out / "fit.png")
    report(found, table, arguments.out)
    return 0


def fitted(arguments) -> RelaxationFit:
    """Fit the series that the options describe, with a progress bar on a terminal."""
    with tqdm(unit="fit", disable=None, leave=False, desc="terms") as bar:
        try:
            return fit_relaxation(
                read_relaxation(arguments.csv, arguments.ramp), terms=arguments.terms,
                tau=arguments.tau, shift=arguments.shift, reference=arguments.reference,
                entropic=arguments.entropic, progress=lambda n: bar.update(),
            )  # fmt: skip
        except MaterialDataError:
            # the file is at fault, not the arguments
            raise
        except ValueError as error:
            raise WrongArgumentError(str(error)) from error


def notes(found: RelaxationFit, arguments) -> list[str]:
    """Write the comment lines above the constants in the seal file: source, range, accuracy."""
    low, high = found.time_range
    degrees = "" if found.reference is None else f" at {found.reference:g} degrees Celsius"
    lines = [
        f"fitted to {Path(arguments.csv).name}; tested times {low:.3g} to {high:.3g} s{degrees}",
        "standard errors of g: " + ", ".join(f"{error:.2g}" for error in errors_of_g(found)),
    ]
    return lines


def errors_of_g(found: RelaxationFit) -> list[float]:
    """Return the standard errors of g."""
    return [found.standard_errors[f"g_{i}"] for i in range(1, found.g.size + 1)]


def summarize(found: RelaxationFit, arguments, wall: float) -> dict:
    """Collect summary.json: constants, errors, correlation, shift, numbers of terms that were tried."""
    tests = found.tests
    return {
        "data": str(arguments.csv),
        "readings": {own.label: own.time.size for own in tests.curves},
        "unused_readings": tests.unused,
        "ramp_s": tests.ramp,
        "g": found.g,
        "tau_s": found.tau,
        "long_term_fraction": found.long_term,
        "reference_degC": found.reference,
        "shift": None if found.shift is None else {found.shift.name: found.shift.table()},
        # the standard error of ln_tau is relative to tau
        "standard_errors": found.standard_errors,
        "correlation": dict(zip(found.names, found.correlation.tolist(), strict=True)),
        "log10_factors": {
            f"{degrees:g}": {"value": own / LN10, "standard_error": error / LN10}
            for degrees, (own, error) in found.factors.items()
        },
        "time_range_s": list(found.time_range),
        "rms_of_largest_force": found.rms,
        "rms_without_shift_function": found.rms_free,
        "fall_in_last_decade": found.fall_at_end,
        "terms_tried": found.trials,
        "wall_s": wall,
    }  # fmt: skip


LN10 = 2.302585092994046


def write_differences(found: RelaxationFit, path: Path) -> None:
    """Write all readings with computed force and difference as CSV."""
    model, away, reduced = found.model, found.differences(), found.reduced_time()
    columns = ("curve", "time_s", "reduced_time_s", "measured", "computed", "difference")
    with path.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        # forces are divided by the largest of their test
        table.writerow(columns)
        for k, own in enumerate(model.curve):
            numbers = (model.time[k], reduced[k], model.force[k], model.force[k] + away[k], away[k])
            table.writerow([found.tests.curves[own].label, *map(float, numbers)])


def shares_no_force(found: RelaxationFit) -> bool:
    """Return whether no test has curves at several temperatures."""
    tests = found.tests
    pairs = {(k, own.temperature) for k, own in zip(tests.scales, tests.curves, strict=True)}
    return len({k for k, _ in pairs}) == len(pairs)


def report(found: RelaxationFit, table: str, out: Path) -> None:
    """Print constants with standard errors, the scatter, notes on what the data do not determine."""
    errors = found.standard_errors
    for i, (g, tau) in enumerate(zip(found.g, found.tau, strict=True), 1):
        relative = errors.get(f"ln_tau_{i}")
        given = "given" if relative is None else f"+- {100 * relative:.2g} %"
        print(f"g_{i:<3d} {g:9.5f}  +- {errors[f'g_{i}']:<8.2g} tau_{i:<3d} {tau:10.4g} s  {given}")
    print(f"ratio of long-term to instantaneous modulus: {found.long_term:.4f}")
    if found.shift is not None:
        for name, value in zip(found.shift.names, found.shift.constants, strict=True):
            print(f"{found.shift.name}: {name} {value:.5g}  +- {errors[name]:.2g}")
    print(
        f"{found.tests.count} readings, RMS difference {100 * found.rms:.2g} % of the largest force "
        "(every decade of time has the same weight)"
    )
    if found.tests.unused:
        print(f"{found.tests.unused} readings before the end of the loading ramp are left out")
    if found.shift is not None and shares_no_force(found):
        print(
            "WARNING: the curve of every temperature has its own force scale, so the temperature "
            "shift is determined by the curvature of the curves alone and its standard error may "
            "be too small; if one specimen was tested at several temperatures, give these curves "
            "the same name in the column test"
        )
    if found.shift is not None and found.rms > POOR * found.rms_free:
        print(
            f"WARNING: the law {found.shift.name} does not describe the shift of the relaxation "
            "times at the tested temperatures: with a free shift factor for every temperature the "
            f"RMS difference is only {100 * found.rms_free:.2g} %"
        )
    print(
        f"in the last tested decade, up to {found.time_range[1]:.3g} s, the modulus decreases by "
        f"{100 * found.fall_at_end:.2g} %; the Prony series assumes no further decrease later"
    )
    print(f"files in {out}\n\n{table}", end="")
