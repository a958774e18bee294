"""Fit the constants of a rubber to tests: summary.json, a picture, a table for a seal file.

The file decides what is fitted: a law of stress over stretch, with softening (Mullins effect) if the
stretch goes back in the order of the file, or relaxation (column time_s).
"""

import sys
import time
from dataclasses import asdict
from pathlib import Path

from tqdm import tqdm

from seal_mdao import plotting
from seal_mdao.calibration.data import MaterialDataError, read_tests
from seal_mdao.calibration.families import MAX_TERMS, OF_TERMS
from seal_mdao.calibration.fit_errors import residual_table, write_residuals
from seal_mdao.calibration.law_fit import Fit, fit
from seal_mdao.calibration.material_stability import MARGIN, UnstableMaterialError
from seal_mdao.calibration.measurement_files import columns_of
from seal_mdao.calibration.relaxation_data import TIME
from seal_mdao.calibration.relaxation_shift import SHIFTS
from seal_mdao.calibration.residuals import WEIGHTINGS
from seal_mdao.calibration.seal_file import MODULI, material_table, softening_table
from seal_mdao.calibration.softening_fit import BETA, fit_softening
from seal_mdao.cli import fit_relaxation
from seal_mdao.cli.arguments import (
    WrongArgumentError,
    checked_arguments,
    parser,
    positive_integer,
    write_summary,
)
from seal_mdao.materials.by_name import LAWS
from seal_mdao.seals.outline.unusual_values import unusual_moduli

MOST_TOLD = 10
"""Largest number of outliers that are printed."""


OF_LAWS = (
    "law",
    "nu",
    "weighting",
    "stretches",
    "bulk_modulus",
    "margin",
    "allow_unstable",
    "seed",
)
"""Options of tests of stress over stretch."""
OF_RELAXATION = ("tau", "ramp", "shift", "reference", "entropic", "moduli")
"""Options of relaxation tests."""


def main(arguments) -> int:
    try:
        relaxation = TIME in columns_of(arguments.csv)
        require_options(arguments, relaxation)
        return (fit_relaxation.main if relaxation else fit_law)(arguments)
    except (MaterialDataError, UnstableMaterialError) as error:
        # data or material are at fault, not the arguments
        print(f"seal-mdao fit: {' '.join(str(error).split())}", file=sys.stderr)
        return 2


def require_options(arguments, relaxation: bool) -> None:
    """Raise an error for options that belong to the other kind of test."""
    kinds = "relaxation tests (column time_s)", "tests of stress over stretch (column stretch)"
    own, other = kinds if relaxation else kinds[::-1]
    for name in OF_LAWS if relaxation else OF_RELAXATION:
        if name in arguments.given:
            option = f"--{name.replace('_', '-')}"
            raise WrongArgumentError(
                f"{option} is for {other}, but {arguments.csv} has {own}; leave this option out"
            )
    if not relaxation and arguments.law is None:
        raise WrongArgumentError(f"--law is missing; name the law to fit, one of {', '.join(LAWS)}")


def fit_law(arguments) -> int:
    """Fit a law to tests of stress over stretch."""
    begun = time.perf_counter()
    found = fitted(arguments)
    with checked_arguments():
        # table [material] for a seal file
        table = material_table(found.law, found.name, arguments.name, notes(found, arguments))
        if found.softening is not None:
            lines = softening_notes(found)
            table += "\n" + softening_table(found.softening, arguments.name, lines)
    # computed minus measured stress at every reading
    rows = residual_table(found)
    # deviations far beyond the standard deviation of the others
    outliers = [row for row in rows if row.outlier]
    unusual = list(unusual_moduli("the fitted law", found.law))
    summary = summarize(found, arguments, time.perf_counter() - begun)
    summary |= {"outliers": [asdict(row) for row in outliers], "warnings": unusual}
    write_summary(arguments.out, summary)
    write_residuals(rows, arguments.out / "residuals.csv")
    (arguments.out / "material.toml").write_text(table, encoding="utf-8")
    figure = plotting.material_fit if found.softening is None else plotting.softening_fit
    plotting.save(figure(found), arguments.out / "fit.png")
    report(found, table, arguments.out)
    report_outliers(outliers)
    for text in unusual:
        print(f"WARNING: {text}")
    return 0


def fitted(arguments) -> Fit:
    """Fit the law that the options describe, with a progress bar on a terminal."""
    tests = read_tests(arguments.csv)
    if arguments.stretches is not None:
        # fit only the stretches of the application
        tests = tests.between(*arguments.stretches)
    # only series laws have a number of terms
    if arguments.terms is not None and arguments.law not in OF_TERMS:
        raise WrongArgumentError(
            f"--terms is for {' and '.join(OF_TERMS)} only, not for {arguments.law}; leave it out"
        )
    with tqdm(unit="start", disable=None, leave=False, desc=arguments.law) as bar:

        def progress(done, of):
            # the number of starts is known at the first call
            bar.total = of
            bar.update(done - bar.n)

        try:
            # least squares from several starts, with the check of stability
            return (fit_softening if tests.cyclic else fit)(
                arguments.law, tests, terms=arguments.terms or 1, nu=arguments.nu,
                bulk_modulus=arguments.bulk_modulus, weighting=arguments.weighting,
                margin=arguments.margin, seed=arguments.seed,
                allow_unstable=arguments.allow_unstable, progress=progress,
            )  # fmt: skip
        except (MaterialDataError, UnstableMaterialError):
            raise
        except ValueError as error:
            raise WrongArgumentError(str(error)) from error


def summarize(found: Fit, arguments, wall: float) -> dict:
    """Collect summary.json: constants, errors, correlation and stability."""
    cyclic = {} if found.softening is None else {
        "softening": asdict(found.softening),
        "unloadings": {name: data.unloadings for name, data in found.tests.modes.items()},
    }  # fmt: skip
    return {
        "data": str(arguments.csv),
        "readings": {name: data.stretch.size for name, data in found.tests.modes.items()},
        "law": found.name,
        "constants": found.law.constants,
        **cyclic,
        "standard_errors": found.standard_errors,
        "correlation": dict(zip(found.unknowns, found.correlation.tolist(), strict=True)),
        "initial_shear_modulus_kPa": found.law.shear_modulus,
        "weighting": found.weighting,
        # errors by loading mode
        "errors": {name: error.as_dict() for name, error in found.errors.items()},
        "stable": found.stable,
        "stability_margin": found.margin,
        # ranges of stretch checked by Drucker's postulate: d(tau) : d(ln lambda) > 0
        "stability": {
            name: {
                "from": s.lower, "to": s.upper, "stable": s.stable,
                "begins_below": s.begins_below, "begins_above": s.begins_above,
            }
            for name, s in found.stability.items()
        },
        "starts": found.starts,
        "agreeing_starts": found.agreeing,
        "wall_s": wall,
    }  # fmt: skip


def notes(found: Fit, arguments) -> list[str]:
    """Write the comment lines above the constants in the seal file: units, source, ranges."""
    # tested range of stretch by loading mode
    parts = [f"{name} {data.range[0]:.3g} to {data.range[1]:.3g}" for name, data in
             found.tests.modes.items()]  # fmt: skip
    lines = [f"kPa; fitted to {Path(arguments.csv).name}", f"stretches: {', '.join(parts)}"]
    # isochoric tests determine no bulk modulus
    if found.law.bulk_modulus:
        lines.append("bulk_modulus is not determined by these tests")
    if not found.stable:
        lines.append("NOT STABLE over the tested stretches")
    return lines


def softening_notes(found: Fit) -> list[str]:
    """Write the comment lines above the constants of the softening."""
    lines = ["Mullins effect, law of Ogden and Roxburgh; m in kPa"]
    if BETA not in found.unknowns:
        lines.append("a single amplitude determines only m + beta W_max, so beta is set to 0")
    return lines


def report(found: Fit, table: str, out: Path) -> None:
    if found.softening is not None:
        print(
            f"{found.tests.cycles}: softening is fitted, too (if the order of the readings has no "
            "meaning, sort them by stretch)"
        )
    for name, value in found.tested_law.constants.items():
        # fixed constants have no standard error
        error = found.standard_errors.get(name)
        print(f"{name:14s} {value:12.6g}" + ("" if error is None else f"  +- {error:.2g}"))
    # table of errors, one row per loading mode
    print("mode           RMS kPa  max kPa  at stretch  RMS %      R2")
    for name, error in found.errors.items():
        print(
            f"{name:12s} {error.rms_kPa:9.3g} {error.max_kPa:8.3g} {error.max_at_stretch:11.3g} "
            f"{100 * error.rms_relative:6.2f}  {error.r2:.4f}"
        )
    # stability of every loading mode in words
    for stability in found.stability.values():
        print(stability.text)
    print(f"{found.agreeing} of {found.starts} starts agree; files in {out}\n\n{table}", end="")


def report_outliers(outliers) -> None:
    """Print readings that deviate from the fit by more than the scatter, largest deviation first."""
    # largest standardised residual first
    for row in sorted(outliers, key=lambda row: -row.score)[:MOST_TOLD]:
        print(
            f"OUTLIER: {row.mode} at stretch {row.stretch:.4g}: {row.measured_kPa:.4g} kPa measured, "
            f"{row.computed_kPa:.4g} kPa by the law, {row.score:.3g} standard deviations"
        )
    if outliers:
        print(
            f"{len(outliers)} outliers are included in the fit; correct them if they are errors of "
            "measurement, otherwise the law does not describe these stretches (all residuals are "
            "in residuals.csv)"
        )


def arguments_parser():
    made = parser(__doc__, "out/material", "CSV", "seal-mdao fit tests.csv --law yeoh")
    made.add_argument(
        "csv", type=Path, metavar="CSV",
        help="test data with columns mode (uniaxial, planar, equibiaxial), stretch, stress_kPa "
        "(nominal; cyclic tests in the order of measurement) and optionally lateral_stretch "
        "(hyperfoam); or a relaxation test with columns time_s, one of stress_kPa, force_N, "
        "ratio, and optionally temperature_degC and test",
    )  # fmt: skip
    made.add_argument(
        "--terms", type=positive_integer, metavar="N",
        help=f"terms of {' and '.join(OF_TERMS)}, at most {MAX_TERMS}, default 1; or of the Prony "
        "series, default as many as the data justify",
    )  # fmt: skip
    made.add_argument(
        "--name",
        default="rubber",
        metavar="NAME",
        help="name of the material in the seal file",
    )
    add_law_options(made.add_argument_group("stress over stretch").add_argument)
    add_relaxation_options(made.add_argument_group("relaxation").add_argument)
    return made


def add_law_options(add) -> None:
    add("--law", choices=tuple(LAWS), help="law to fit")
    add(
        "--nu",
        type=float,
        metavar="NU",
        help="Poisson's ratio of hyperfoam, if lateral stretches were not measured",
    )
    add(
        "--weighting",
        choices=WEIGHTINGS,
        default="relative",
        help="differences between computed and measured stress that the fit minimises",
    )
    add(
        "--stretches", type=float, nargs=2, metavar=("FROM", "TO"),
        help="use only readings between these two stretches",
    )  # fmt: skip
    add(
        "--bulk-modulus", type=float, default=80_000.0, metavar="KPA",
        help="bulk modulus (kPa) to write into the seal file, because the tests do not determine it",
    )  # fmt: skip
    add(
        "--margin", type=float, default=MARGIN, metavar="FRACTION",
        help="check material stability in the tested ranges of ln(stretch) widened by this fraction",
    )  # fmt: skip
    add(
        "--allow-unstable",
        action="store_true",
        help="accept constants of a material that is not stable",
    )
    add("--seed", type=int, default=0, metavar="N", help="seed of the random start values")


def add_relaxation_options(add) -> None:
    add(
        "--tau",
        type=float,
        nargs="+",
        metavar="S",
        help="relaxation times (s) of the Prony series; only the fractions g are fitted",
    )
    add(
        "--ramp", type=float, default=0.0, metavar="S",
        help="duration (s) of the loading ramp at a constant rate; readings during the ramp are "
        "ignored",
    )  # fmt: skip
    add(
        "--shift", choices=tuple(SHIFTS),
        help="law of the shift of the relaxation times with temperature; default: the law that "
        "fits better",
    )  # fmt: skip
    add(
        "--reference", type=float, metavar="DEGC",
        help="reference temperature (°C), one of the tested temperatures; default: the tested "
        "temperature nearest to 23 °C",
    )  # fmt: skip
    add(
        "--entropic", action="store_true",
        help="fit moduli proportional to the absolute temperature; needs tests at several "
        "temperatures",
    )  # fmt: skip
    add(
        "--moduli", choices=MODULI, default=MODULI[0],
        help="whether the constants of the law in the seal file are long-term or instantaneous "
        "moduli",
    )  # fmt: skip
