"""Analyse several seals and compare them: load-deflection, contact pressure and sections in a figure."""

from pathlib import Path

import numpy as np

from seal_mdao import plotting
from seal_mdao.cli.analyze import analyzed, summarize
from seal_mdao.cli.arguments import WrongArgumentError, parser, write_summary
from seal_mdao.cli.seal_files import file_of
from seal_mdao.export.csv_tables import write_curves
from seal_mdao.seals.profiles import moving_parts

KEYS = ("area_mm2", "true_peak_pressure_kPa", "largest_gap_mm", "largest_von_mises_kPa")
"""Keys of the summary of ``seal-mdao analyze`` that are printed, at the end of the path: the largest
values over all profiles and the section."""
WIDTH = "deformed_contact_width_mm"
"""Key of the width in contact with a profile."""


def main(arguments) -> int:
    names = names_of(arguments.files)
    # read all files before the first analysis: errors come early
    files = {name: file_of(path) for name, path in zip(names, arguments.files, strict=True)}
    results, summary = {}, {}
    for name, file in files.items():
        print(f"{name}: {file.path}")
        _, results[name], _ = analyzed(file)
        summary[name] = summarize(results[name])
        # after every seal, so that an interruption loses one analysis at most
        write_summary(arguments.out, summary)
        folder = arguments.out / name
        folder.mkdir(exist_ok=True)
        write_curves(results[name], folder)
    # seals with at least one converged load step
    nominal = {name: result for name, result in results.items() if len(result.path.nominal_steps)}
    if nominal:
        plotting.save(plotting.seals_compared(nominal), arguments.out / "comparison.png")
    moving = {
        name: [own.label for own in moving_parts(result.seal) if own.motion.moves]
        for name, result in results.items()
    }
    units = {name: result.seal.units for name, result in results.items()}
    print_table(summary, moving, units)
    print(f"comparison.png, curves of every seal and summary.json in {arguments.out}")
    return 0 if all(result.trustworthy for result in results.values()) else 1


def names_of(paths) -> list[str]:
    """Name the files by their stems, with the folder where stems are the same."""
    for number, path in enumerate(paths):
        if path in paths[:number]:
            raise WrongArgumentError(f"the seal file {path} is given twice; name every file once")
    stems = [path.stem for path in paths]
    names = [
        path.stem if stems.count(path.stem) == 1 else f"{path.parent.name}_{path.stem}"
        for path in paths
    ]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise WrongArgumentError(
            f"two of the seal files have the same label {twice!r} (folder_name) in the figures; "
            "rename one of the files"
        )
    return names


def print_table(summary: dict, moving: dict, units: dict) -> None:
    """Print the numbers of all seals, a line each.

    ``moving`` has the labels of the profiles and edges that move, and ``units`` the ``ResultUnits``, by
    the name of the seal.
    """
    width = max(map(len, summary))
    for name, own in summary.items():
        # force on every profile that moves, and on moved edges
        key = f"force_{units[name].force_key}"
        forces = own["profiles"] | own.get("moved_edges", {})
        parts = [
            "force on {} {:.2f}, {:.2f} {}".format(label, *forces[label][key], units[name].force)
            for label in moving[name]
            if forces[label]
        ]
        # the width in contact of every profile, also of those that stand still
        parts += [
            f"{end[WIDTH]:.4g} mm in contact with {label}"
            for label, end in own["profiles"].items()
            if WIDTH in end
        ]
        # of inverted material there is no stress
        known = [key for key in KEYS if own[key] is not None and np.isfinite(own[key])]
        parts += [f"{key} {own[key]:.4g}" for key in known]
        for text in own["warnings"] or ():
            print(f"WARNING ({name}): {text}")
        if not own["converged"]:
            parts.append(f"NOT CONVERGED: {own['failure']}")
        print(f"{name:{width}}  {', '.join(parts)}")


def arguments_parser():
    made = parser(
        __doc__, "out/comparison", "FILE FILE ...", "seal-mdao compare bulb.toml best/optimum.toml"
    )
    made.add_argument("files", type=Path, nargs="+", metavar="FILE", help="seal files (TOML)")
    return made
