"""Errors of contact pressure against finite elements: ``python tests/benchmarks/contact_pressure.py``.

Not collected by pytest. It prints a table in Markdown: sections of ``tests/verification/references`` at
the spacing of their files, and the door seal of engineering accuracy, and both at half of their spacing,
with every kind of contact points. Numbers are those of the ends of the stages, in per cent.
"""

import argparse
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from verification.contact_profiles import (
    DOOR,
    REFERENCES,
    SECTIONS,
    pressure_errors,
    stored,
    uncertainty,
)

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.door.door_seal import door_seal, options_of
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.result import analyze
from seal_mdao.terms.points import CONTACT_POINTS

PARTS = (1, 2)
"""The default spacing over that of the section."""


def seal_of(name: str, parts: int, points: str):
    """The section of a file, or the door seal, of a divided spacing."""
    if name == DOOR:
        return finer_door(parts, contact_points=points)
    file = read_seal_file(REFERENCES / f"{name}.toml")
    section = replace(file.section, spacing=file.section.spacing / parts)
    profiles = tuple(replace(profile, contact_points=points) for profile in file.profiles)
    return build_seal(replace(file, section=section, profiles=profiles))


def finer_door(parts: int, **changes):
    """The door seal of engineering accuracy under a flat door, its distances of particles divided."""
    given = {"door": "flat", "accuracy": "engineering", **changes}
    options = options_of(door_seal(**given))
    return door_seal(**given, rays=parts * options.rays, layers=1 + parts * (options.layers - 1))


def errors(name: str, parts: int, points: str):
    """Errors at the ends of the stages."""
    result = analyze(seal_of(name, parts, points))
    result.require_converged()
    return pressure_errors(result, stored(name))


def row(*cells) -> str:
    """A row of a table in Markdown."""
    return "| " + " | ".join(map(str, cells)) + " |"


def per_cent(values) -> str:
    """The values of all stages."""
    return " ".join(f"{100.0 * value:.2f}" for value in values)


def main(names, points) -> None:
    print(row("section", "spacing", "contact points", "rms over peak", "peak", "width"))
    print(row(*["---"] * 6))
    for name in names:
        print(row(name, "", "uncertainty", *map(per_cent, np.transpose(uncertainty(name)))))
        for parts in PARTS:
            for own in points:
                label = name, f"1/{parts}", own
                try:
                    found = map(per_cent, np.transpose(errors(*label[:1], parts, own)))
                except RuntimeError as error:
                    found = (f"failed: {error}".splitlines()[0], "", "")
                print(row(*label, *found), flush=True)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("sections", nargs="*", default=(*SECTIONS, DOOR), metavar="SECTION")
    parser.add_argument("--points", nargs="*", default=CONTACT_POINTS)
    arguments = parser.parse_args()
    main(arguments.sections, arguments.points)
