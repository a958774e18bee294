"""Vary one parameter of a seal: load-deflection curves in one figure, every measure in a CSV file."""

import argparse
import csv
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.arguments import WrongArgumentError, announce, parser, write_summary
from seal_mdao.cli.seal_files import file_errors, file_of, seal_of
from seal_mdao.progress import hidden
from seal_mdao.seals.file.build import unchosen_seal
from seal_mdao.seals.profiles import contacts
from seal_mdao.seals.result import frozen_measures

MOST_VALUES = 200


class Values(NamedTuple):
    """Values of a sweep, FROM:TO:COUNT."""

    first: float
    last: float
    count: int

    def array(self) -> np.ndarray:
        return np.linspace(self.first, self.last, self.count)


def main(arguments) -> int:
    file = file_of(arguments.file)
    with file_errors(file.path):
        # before steps and penalties are chosen, which takes some analyses
        parameter_of(unchosen_seal(file), arguments.vary[0])
    seal = seal_of(file)
    name = parameter_of(seal, arguments.vary[0])
    # one analysis per value: report the time of one
    announce(seal)
    values, results = arguments.vary[1].array(), {}
    with file_errors(file.path):
        # scalar measures only: one column each in the table
        measures = tuple(measure for measure in frozen_measures(seal) if measure.size(seal) == 1)
    with tqdm(values, desc=name, unit="analysis", disable=hidden(), leave=False) as bar:
        for value in bar:
            with file_errors(file.path):
                result = sm.analyze(seal, parameters={name: float(value)})
            results[float(value)] = result
            # after every analysis, so that an interrupted sweep leaves what was computed
            rows = [row(value, result, measures) for value, result in results.items()]
            write_table(arguments.out / "sweep.csv", name, rows)
    write_summary(arguments.out, {"parameter": name, "unit": unit_of(seal, name), "values": rows})
    # curves of all analyses with at least one converged load step
    nominal = {f"{v:.6g}": r for v, r in results.items() if len(r.path.nominal_steps)}
    if nominal and contacts(seal):
        figure = plotting.load_deflection_of(
            nominal, f"{name} ({unit_of(seal, name)})".replace(" ()", "")
        )
        plotting.save(figure, arguments.out / "sweep.png")
    for own in rows:
        # "value" is the parameter in the printed line
        numbers = {name if key == "value" else key: value for key, value in own.items()}
        print(", ".join(f"{key} = {shown(value)}" for key, value in numbers.items()))
    print(f"sweep.png, sweep.csv and summary.json in {arguments.out}")
    return 0 if all(result.converged for result in results.values()) else 1


def parameter_of(seal, name: str) -> str:
    """Find a parameter of the seal by its name or the end of it.

    Raises
    ------
    WrongArgumentError
        For a name that no parameter or more than one ends with.
    """
    # complete name
    if name in seal.scalars:
        return name
    # a unique ending is enough: friction for plate_friction
    found = [known for known in seal.scalars if known.endswith(f"_{name}")]
    if len(found) == 1:
        return found[0]
    several = f"{name!r} may be {', '.join(found)}" if found else f"there is no parameter {name!r}"
    raise WrongArgumentError(f"--vary: {several}; the parameters are {', '.join(seal.scalars)}")


def unit_of(seal, name: str) -> str:
    """Return the unit of a parameter; empty for a pure number."""
    return seal.scalars[name].units or ""


def row(value: float, result, measures) -> dict:
    """Collect the results at the end of the path of one analysis; None for a failed one."""
    numbers = {"value": value, "converged": result.converged}
    for contact in contacts(result.seal):
        # force on the profile at the end of the path, N/m
        force = result.path.reaction(contact.label)[-1] if result.converged else (None, None)
        numbers |= {
            f"{contact.label}_F{axis}_N_per_m": f for axis, f in zip("xy", force, strict=True)
        }
    for measure in measures:
        numbers[measure.name] = float(result.value(measure)[0]) if result.converged else None
    return numbers


def shown(value) -> str:
    """Format a number for the console."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def write_table(path: Path, name: str, rows: list[dict]) -> None:
    """Write the rows as CSV, the parameter by its name."""
    with path.open("w", newline="", encoding="utf-8") as file:
        # empty fields for failed analyses
        writer = csv.writer(file)
        writer.writerow([name if key == "value" else key for key in rows[0]])
        writer.writerows(
            ["" if v is None else f"{v:.12g}" if isinstance(v, float) else v for v in own.values()]
            for own in rows
        )


def vary(text: str) -> Values:
    """Parse values FROM:TO:COUNT for argparse."""
    try:
        # three numbers separated by colons
        first, last, count = text.split(":")
        values = Values(float(first), float(last), int(count))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} is not FROM:TO:COUNT") from None
    if not (math.isfinite(values.first) and math.isfinite(values.last)):
        raise argparse.ArgumentTypeError(f"{text!r} has a number that is not finite")
    if not 1 <= values.count <= MOST_VALUES:
        raise argparse.ArgumentTypeError(f"{text!r} has a count that is not in 1 to {MOST_VALUES}")
    return values


class _Vary(argparse.Action):
    """Parse NAME FROM:TO:COUNT to a pair."""

    def __call__(self, made, namespace, given, option=None):
        try:
            # both parts are checked here, since nargs=2 allows one type only
            setattr(namespace, self.dest, (given[0], vary(given[1])))
        except argparse.ArgumentTypeError as error:
            made.error(f"argument {option}: {error}")


def arguments_parser():
    made = parser(
        __doc__, "out/sweep", "FILE --vary NAME FROM:TO:COUNT",
        "seal-mdao sweep bulb.toml --vary friction 0.1:0.5:5",
    )  # fmt: skip
    made.add_argument("file", type=Path, metavar="FILE", help="seal file (TOML)")
    made.add_argument(
        "--vary", nargs=2, action=_Vary, required=True, metavar=("NAME", "FROM:TO:COUNT"),
        help="parameter, or the end of its name (friction, c10, ...), and its values, evenly spread; "
        "moduli in kPa, lengths in mm",
    )  # fmt: skip
    return made
