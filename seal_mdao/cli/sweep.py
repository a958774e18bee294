"""Vary one number of a seal: load-deflection curves in one figure, every measure in a CSV file."""

import argparse
import csv
import math
from pathlib import Path

import numpy as np
from tqdm import tqdm

import seal_mdao as sm
from seal_mdao import plotting
from seal_mdao.cli.arguments import (
    NAME_OF_FILE,
    WrongArgumentError,
    announce,
    parser,
    write_summary,
)
from seal_mdao.cli.seal_files import file_errors, file_of
from seal_mdao.cli.varied import Varied, varied
from seal_mdao.export.csv_tables import write_sweep_curves
from seal_mdao.plotting.captions import name_varied
from seal_mdao.progress import hidden
from seal_mdao.recording.recorded_optimization import label, shown_unit
from seal_mdao.seals.profiles import moving_parts
from seal_mdao.seals.result import frozen_measures

MOST_VALUES = 200
STATE = ("value", "converged", "trustworthy")
"""Columns of a row that are no results."""
PER_MM = "N_per_mm"
"""End of the names of forces on a ring per mm of its circumference at the mean radius."""


def main(arguments) -> int:
    file = file_of(arguments.file)
    own, values = varied(file, arguments.vary[0]), arguments.vary[1]
    if any(measure.name == own.name for measure in file.measures):
        raise WrongArgumentError(
            f"--vary: {own.name} is also the name of a [[measure]], and sweep.csv would have two "
            "columns of this name; give the measure another name"
        )
    name_varied([own.name])
    results, rows, measures, units, words = {}, [], None, {}, {}
    with tqdm(values, desc=own.name, unit="analysis", disable=hidden(), leave=False) as bar:
        for value, (seal, parameters) in zip(bar, own.seals(file, values), strict=True):
            if not results:
                # the time of one analysis, and what the sweep leaves empty
                announce(seal)
                for line in own.notes():
                    print(line)
            with file_errors(file.path):
                if parameters and measures is None:
                    measures = measures_of(seal)
                result = sm.analyze(seal, parameters=parameters)
                # a file with another number is a nominal seal of its own
                chosen = measures if parameters else measures_of(seal, result)
            rows.append(row(float(value), result, chosen))
            results[float(value)] = result
            units |= units_of(seal, chosen)
            words |= titles(seal, chosen)
            # after every analysis, so that an interrupted sweep leaves what was computed
            write_table(arguments.out / "sweep.csv", own.name, rows)
            write_sweep_curves(own.name, results, arguments.out / "curves.csv")
    # measures that some rows do not have are None there
    rows = [{key: line.get(key) for key in columns_of(rows)} for line in rows]
    warned = warnings_of(results)
    summary = {
        "parameter": own.name, "unit": own.unit, "values": rows, "units": units, "warnings": warned,
    }  # fmt: skip
    write_summary(arguments.out, summary)
    draw(own, results, rows, words, arguments.out)
    for line in rows:
        # "value" is the parameter in the printed line
        numbers = {own.name if key == "value" else key: value for key, value in line.items()}
        print(", ".join(f"{key} = {shown(value)}" for key, value in numbers.items()))
    for found in warned:
        which = ", ".join(shown(value) for value in found["at"])
        print(f"WARNING ({own.name} = {which}): {found['text']}")
    print(f"sweep.png, measures.png, sweep.csv, curves.csv and summary.json in {arguments.out}")
    return 0 if all(result.trustworthy for result in results.values()) else 1


def warnings_of(results: dict) -> list[dict]:
    """List the warnings and failures of all analyses: each ``text`` once, with the values that have it
    (``at``)."""
    found = {}
    for value, result in results.items():
        for text in result.warnings if result.converged else (result.failure,):
            found.setdefault(text, []).append(value)
    return [{"text": text, "at": values} for text, values in found.items()]


def measures_of(seal, nominal=None) -> tuple:
    """Return the measures of a seal, with their points on the nominal seal.

    None of them where the path of the analysed nominal seal was not completed.
    """
    if nominal is not None and not nominal.converged:
        return ()
    frozen = frozen_measures(seal, None, None if nominal is None else lambda _: nominal)
    return tuple(measure for measure in frozen if measure.size(seal))


def names_of(measure, seal) -> list[str]:
    """Name the values of a measure: by its name, with numbers from 1 where there are several."""
    count = measure.size(seal)
    return [measure.name] if count == 1 else [f"{measure.name}_{i + 1}" for i in range(count)]


def units_of(seal, measures) -> dict[str, str | None]:
    """Return the units of the values of ``measures`` of a seal, whose points are chosen, by the names of
    the values."""
    return {
        name: seal.units.of(measure.units)
        for measure in measures
        for name in names_of(measure, seal)
    }


def draw(own: Varied, results: dict, rows: list[dict], words: dict, out: Path) -> None:
    """Draw the load-deflection curves, and all numbers at the end of the path over the varied one.

    ``words`` describes the numbers of ``rows`` by their names (``titles``).
    """
    varied_one = f"{own.name} ({own.unit})".replace(" ()", "")
    # curves of all analyses with at least one converged load step
    nominal = {f"{v:.6g}": r for v, r in results.items() if len(r.path.nominal_steps)}
    if nominal and moving_parts(next(iter(nominal.values())).seal):
        plotting.save(plotting.load_deflection_of(nominal, varied_one), out / "sweep.png")
    done = [line for line in rows if line["converged"]]
    if done:
        names = [name for name in done[0] if name not in STATE]
        # rings of one circumference: N per mm of it on the right axis, not in panels of their own
        units = {result.seal.units for result in results.values()}
        ring = units.pop() if len(units) == 1 else None
        forces = [name for name in names if f"{_bare(name)}_{PER_MM}" in names] if ring else []
        beside = {f"{_bare(name)}_{PER_MM}" for name in forces}
        columns = {
            words[name]: [np.nan if line[name] is None else line[name] for line in done]
            for name in names
            if name not in beside
        }
        forces = [words[name] for name in forces]
        at = [line["value"] for line in done]
        figure = plotting.numbers_over(varied_one, at, columns, ring, forces)
        plotting.save(figure, out / "measures.png")


def titles(seal, measures) -> dict[str, str]:
    """Describe the numbers of ``row`` with these measures in words with units, by their names."""
    units = seal.units
    shown_units = {units.force_key: units.force, PER_MM: "N per mm"}
    found = {
        name: f"{direction} force on {part.label} ({unit})"
        for part in moving_parts(seal)
        for key, unit in shown_units.items()
        for name, direction in zip(_force_names(part.label, key), units.directions, strict=True)
    }
    for name, unit in units_of(seal, measures).items():
        found[name] = f"{label(name)} ({shown_unit(unit)})".replace(" ()", "")
        found[f"{name}_{PER_MM}"] = f"{label(name)} (N per mm)"
    return found


def _bare(name: str) -> str:
    """Remove the unit from the name of a force on a profile."""
    return name.removesuffix("_N")


def row(value: float, result, measures) -> dict:
    """Collect the results at the end of the path of one analysis; None for a failed one."""
    numbers = dict(zip(STATE, (value, result.converged, result.trustworthy), strict=True))
    units = result.seal.units
    for part in moving_parts(result.seal):
        # force on the profile or the moved edges at the end of the path, N/m or N
        force = result.path.reaction(part.label)[-1] if result.converged else (None, None)
        numbers |= _forces(part.label, units.force_key, force)
        if units.radius:
            around = [None if own is None else units.per_mm * own for own in force]
            numbers |= _forces(part.label, PER_MM, around)
    for measure in measures:
        names = names_of(measure, result.seal)
        values = result.value(measure).tolist() if result.converged else [None] * len(names)
        for name, value in zip(names, values, strict=True):
            numbers[name] = value
            if units.is_ring_force(measure.units):
                numbers[f"{name}_{PER_MM}"] = None if value is None else units.per_mm * value
    return numbers


def _forces(label: str, unit: str, force) -> dict:
    """Name both components of a force on a profile."""
    return dict(zip(_force_names(label, unit), force, strict=True))


def _force_names(label: str, unit: str) -> list[str]:
    """Name the components x and y of the force on a profile, with a unit."""
    return [f"{label}_F{axis}_{unit}" for axis in "xy"]


def shown(value) -> str:
    """Format a number for the console."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def columns_of(rows: list[dict]) -> list[str]:
    """List the keys of all rows in order. A failed analysis has no measures, and another nominal seal
    may have another number of values, such as contact pressures of one or two regions."""
    return list(dict.fromkeys(key for row in rows for key in row))


def write_table(path: Path, name: str, rows: list[dict]) -> None:
    """Write the rows as CSV, the varied number by its name."""
    columns = columns_of(rows)
    with path.open("w", newline="", encoding="utf-8") as file:
        # empty fields for failed analyses
        writer = csv.writer(file)
        writer.writerow([name if key == "value" else key for key in columns])
        for own in rows:
            found = [own.get(key) for key in columns]
            writer.writerow(
                ["" if v is None else f"{v:.12g}" if isinstance(v, float) else v for v in found]
            )


def vary(text: str) -> np.ndarray:
    """Parse values FROM:TO:COUNT or VALUE,VALUE,... for argparse; they are returned in ascending order
    where they are listed."""
    text = text.strip()
    try:
        if ":" in text:
            first, last, count = text.split(":")
            ends, count = [float(first), float(last)], int(count)
        else:
            ends = [float(own) for own in text.split(",")]
            count = len(ends)
    except ValueError:
        raise argparse.ArgumentTypeError(
            f"{text!r} is neither FROM:TO:COUNT nor a list VALUE,VALUE,..."
        ) from None
    if not all(map(math.isfinite, ends)):
        raise argparse.ArgumentTypeError(f"{text!r} contains a number that is not finite")
    if not 1 <= count <= MOST_VALUES:
        raise argparse.ArgumentTypeError(
            f"{text!r} must have a COUNT (number of values) from 1 to {MOST_VALUES}"
        )
    if ":" in text:
        return np.linspace(*ends, count)
    if len(set(ends)) < count:
        raise argparse.ArgumentTypeError(f"{text!r} contains a value twice")
    return np.sort(ends)


class _Vary(argparse.Action):
    """Parse NAME VALUES to a pair."""

    def __call__(self, made, namespace, given, option=None):
        # a pair from an earlier --vary
        if isinstance(getattr(namespace, self.dest), tuple):
            made.error(
                f"argument {option}: given twice, but a sweep varies one quantity; run one sweep for "
                "each value of the other"
            )
        try:
            # both parts are checked here, since nargs=2 allows one type only
            setattr(namespace, self.dest, (given[0], vary(given[1])))
        except argparse.ArgumentTypeError as error:
            made.error(f"argument {option}: {error}")


def arguments_parser():
    made = parser(
        __doc__, f"out/{NAME_OF_FILE}_sweep", "FILE --vary NAME VALUES",
        "seal-mdao sweep bulb.toml --vary friction 0.1:0.5:5",
    )  # fmt: skip
    made.add_argument("file", type=Path, metavar="FILE", help="seal file (TOML)")
    made.add_argument(
        "--vary", nargs=2, action=_Vary, required=True, metavar=("NAME", "VALUES"),
        help="varied quantity and its values, evenly spaced (FROM:TO:COUNT) or listed "
        "(0.1,0.2,0.5): a parameter of the seal or the end of its name (friction, c10), the "
        "travel of a profile in mm (travel: that of the first stage, other stages in "
        "proportion), or a number in the seal file by its tables and key "
        "(material.rubber.c10, section.spacing, profile.door.start.2). An unknown name prints "
        "a list of all quantities; `seal-mdao keys` has all keys with their units",
    )  # fmt: skip
    return made
