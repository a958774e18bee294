"""Calibrate parameters of a seal to its measured force over travel or time: values, standard errors."""

import time
from pathlib import Path

import numpy as np
from tqdm import tqdm

from seal_mdao import plotting
from seal_mdao.calibration.measurement_files import MaterialDataError, read_rows
from seal_mdao.cli.arguments import (
    NAME_OF_FILE,
    WrongArgumentError,
    announce,
    checked_arguments,
    parser,
    write_summary,
)
from seal_mdao.cli.seal_files import file_of, filled, seal_of
from seal_mdao.cli.varied import parameter_name
from seal_mdao.force_calibration import ForceCalibration, calibrate_force
from seal_mdao.geometry.motion import ROUNDING
from seal_mdao.measures.reaction import Reaction, travel_direction
from seal_mdao.progress import hidden
from seal_mdao.seals.profiles import contacts

TRAVEL, TIME = "travel_mm", "time_s"
FORCE = "force_{}"
"""Column of the force, with the end ``ResultUnits.force_key``."""
TOGETHER = 0.95
"""Correlation of two parameters above which the readings tell little but a combination of them."""


def main(arguments) -> int:
    begun = time.perf_counter()
    file = file_of(arguments.file)
    unchosen = filled(file)
    names = [parameter_name("--find", name, unchosen.scalars) for name in arguments.find]
    along, where, measured = readings(arguments.csv, unchosen.units)
    force = force_of(unchosen, arguments, where, along)
    _, seal = seal_of(file, unchosen=unchosen)
    announce(seal)
    with tqdm(unit="analysis", disable=hidden(), leave=False, desc="calibrating") as bar:

        def progress(count, rms):
            bar.set_postfix_str(f"difference {100 * rms:.3g} %")
            bar.update(count - bar.n)

        with checked_arguments():
            found = calibrate_force(seal, force, measured, names, progress)
    units = {name: seal.scalars[name].units or "" for name in names}
    summary = summarize(found, units, arguments, time.perf_counter() - begun)
    write_summary(arguments.out, summary)
    write_readings(found, where, along, seal.units.force_key, arguments.out / "readings.csv")
    figure = plotting.force_calibration(found, along, where == TIME, seal.units.force)
    plotting.save(figure, arguments.out / "calibration.png")
    report(found, units, arguments.out)
    return 0 if found.converged else 1


def readings(path: Path, units) -> tuple[np.ndarray, str, np.ndarray]:
    """Read travels or times, the name of their column and measured forces of a CSV file.

    Raises
    ------
    WrongArgumentError
        For a file that has no such table, travels that do not increase, or times that are not positive.
    """
    force = FORCE.format(units.force_key)
    try:
        rows = read_rows(path, ((TRAVEL, TIME), force))
    except MaterialDataError as error:
        raise WrongArgumentError(str(error)) from None
    column = TIME if TIME in rows[0][1] else TRAVEL
    along = np.array([row[column] for _, row in rows])
    measured = np.array([row[force] for _, row in rows])
    for values, name in ((along, column), (measured, force)):
        wrong = np.flatnonzero(~np.isfinite(values))
        if wrong.size:
            raise WrongArgumentError(
                f"{rows[wrong[0]][0]}, column {name}: the value is not finite; correct or remove "
                "this line"
            )
    wrong = np.flatnonzero(along <= 0.0)
    if wrong.size:
        raise WrongArgumentError(
            f"{rows[wrong[0]][0]}, column {column}: {along[wrong[0]]:g} must be above 0, because 0 "
            "is the start of the analysis; remove this line or correct the zero point"
        )
    back = np.flatnonzero(np.diff(along) <= 0.0)
    if back.size:
        raise WrongArgumentError(
            f"{rows[back[0] + 1][0]}, column {column}: {along[back[0] + 1]:g} is not above "
            f"{along[back[0]]:g} of the previous line; {TRAVEL} is the accumulated distance that "
            "the profile has moved, which increases during unloading, too"
        )
    return along, column, measured


def force_of(seal, arguments, where: str, along) -> Reaction:
    """Create the measure of the force at the readings: against the first movement of the profile,
    or along the requested axis.

    Raises
    ------
    WrongArgumentError
        For a profile that there is not, and readings beyond the end of the path.
    """
    moving = {own.label: own for own in contacts(seal) if own.motion.travel > 0.0}
    if not moving:
        raise WrongArgumentError(
            f"{arguments.file}: no profile moves, so there is no computed force to compare with "
            "the measured one; add a [[profile.stage]] to a [[profile]]"
        )
    profile = arguments.profile
    if profile is None and len(moving) > 1:
        raise WrongArgumentError(
            "--profile is missing; name the profile on which the force was measured: "
            f"{' or '.join(moving)}"
        )
    profile = next(iter(moving)) if profile is None else profile
    if profile not in moving:
        raise WrongArgumentError(
            f"--profile: {profile!r} is not a moving profile; the moving profiles are "
            f"{', '.join(moving)}"
        )
    places = {"times" if where == TIME else "travels": tuple(along.tolist())}
    direction = -travel_direction(moving[profile].motion, 0.0)[0]
    if arguments.axis is not None:
        direction = np.eye(2)["xy".index(arguments.axis)]
    force = Reaction(profile, direction=tuple(direction.tolist()), name="force", **places)
    if where == TIME:
        with checked_arguments():
            force.check(seal)
    else:
        motion = moving[profile].motion
        end = motion.travel - seal.before_touch
        if along[-1] > end + ROUNDING * motion.travel:
            raise WrongArgumentError(
                f"{arguments.csv}: the readings end at a travel of {along[-1]:g} mm, but {profile} "
                f"moves only {end:.6g} mm from its start; leave out the readings at larger travels, or "
                f"extend the motion of the profile in {arguments.file}"
            )
    return force


def summarize(found: ForceCalibration, units: dict, arguments, wall: float) -> dict:
    """Collect summary.json."""
    rows = zip(found.names, found.start, found.values, found.standard_errors, strict=True)
    return {
        "data": str(arguments.csv),
        "readings": found.measured.size,
        "parameters": {
            name: {"unit": units[name], "start": start, "value": value, "standard_error": error}
            for name, start, value, error in rows
        },
        "correlation": dict(zip(found.names, found.correlation.tolist(), strict=True)),
        "rms_of_largest_force": found.rms,
        "at_bounds": list(found.at_bounds),
        "converged": found.converged,
        "analyses": found.analyses,
        "wall_s": wall,
    }


def write_readings(found: ForceCalibration, where: str, along, unit: str, path: Path) -> None:
    """Write all readings with the forces computed before and after as CSV."""
    columns = where, *(f"{name}_{unit}" for name in ("measured", "first", "calibrated"))
    rows = np.column_stack([along, found.measured, found.before, found.after])
    np.savetxt(path, rows, "%.12g", ",", header=",".join(columns), comments="")


def report(found: ForceCalibration, units: dict, out: Path) -> None:
    """Print values with standard errors, the difference that is left, and what is not determined."""
    rows = zip(found.names, found.start, found.values, found.standard_errors, strict=True)
    for name, start, value, error in rows:
        print(f"{name:20s} {start:10.5g} -> {value:10.6g} +- {error:.2g} {units[name]}".rstrip())
    print(
        f"{found.measured.size} readings, {found.analyses} analyses; RMS difference "
        f"{100.0 * found.rms:.2g} % of the largest force"
    )
    for name in found.at_bounds:
        print(
            f"WARNING: {name} reached the limit of the search, ten times or a tenth of its start "
            "value; give a better start value in the seal file"
        )
    lost = [n for n, e in zip(found.names, found.standard_errors, strict=True) if np.isinf(e)]
    if lost:
        print(
            f"WARNING: the measured forces do not determine {', '.join(lost)}; identify fewer "
            "parameters"
        )
    for i, j in np.argwhere(np.triu(np.abs(found.correlation), 1) > TOGETHER):
        print(
            f"WARNING: {found.names[i]} and {found.names[j]} are correlated "
            f"({found.correlation[i, j]:.4f}): the readings determine only a combination of them"
        )
    if not found.converged:
        print(
            "WARNING: the calibration has not converged; choose start values in the seal file "
            "whose force is closer to the measured one"
        )
    print(f"calibration.png, readings.csv and summary.json in {out}")


def arguments_parser():
    made = parser(
        __doc__, f"out/{NAME_OF_FILE}_calibration", "FILE CSV --find NAME ...",
        "seal-mdao calibrate seal.toml force.csv --find c10 friction",
    )  # fmt: skip
    made.add_argument(
        "file",
        type=Path,
        metavar="FILE",
        help="seal file (TOML) with the start values of the parameters",
    )
    made.add_argument(
        "csv", type=Path, metavar="CSV",
        help=f"measured forces: columns {TRAVEL} (accumulated distance of the profile since the start "
        f"of its motion, which increases during unloading, too) or {TIME} (from the start of the "
        "motion), and force_N_per_m, for a body of revolution force_N",
    )  # fmt: skip
    made.add_argument(
        "--find", nargs="+", required=True, metavar="NAME",
        help="parameters of the seal to identify, or the ends of their names (c10, friction, g_1, "
        "tau_1); an unknown name prints a list of all parameters",
    )  # fmt: skip
    made.add_argument("--profile", metavar="NAME", help="profile on which the force was measured")
    made.add_argument(
        "--axis", choices=("x", "y"),
        help="axis of the measured force on the profile; default: against its first movement",
    )  # fmt: skip
    return made
