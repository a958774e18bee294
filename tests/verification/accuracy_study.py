"""Errors over the discretisation, the load steps and the penalties, and refinements of all three.

The pages on accuracy, on the path and on the door seal show them. They take a quarter of an hour of a
processor, so their values are stored:

    python tests/verification/accuracy_study.py [QUANTITY ...]

computes the named quantities, or all, and writes them to ``references/accuracy.json``. A long test
computes some of them again.
"""

import argparse
import json
import multiprocessing
import os
import sys
from functools import cache
from pathlib import Path

import numpy as np

if __name__ in ("__main__", "__mp_main__"):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from seal_mdao.plotting.captions import today
from seal_mdao.seals.door.door_seal import ACCURACIES, door_seal
from verification.error_sources import FUNCTIONS, flat_errors, worst_error
from verification.ray_bulb import COMPARED
from verification.seal_refinement import LEVELS
from verification.step_refinement import STEPS
from verification.study_quantities import (
    EXAMPLES,
    REFERENCES,
    SCHEMES,
    bending_error,
    bulb_errors,
    chosen_steps,
    corner_error,
    difference,
    disc_modulus,
    equal_steps,
    example_choice,
    example_steps,
    file_errors,
    inflated_error,
    large_ring_error,
    limit_error,
    opened_gap,
    outline_error,
    pressed_ring_error,
    refined_corner,
    refined_flat,
    refined_steps,
    ring_error,
    section_error,
    squeezed_ring,
)

VALUES = REFERENCES / "accuracy.json"
DIGITS, EXACT = 6, {"difference": 16, "example_choice": 16}
"""Digits of stored floats, and where they are more."""

# ---- cases ----

LAYERS = (3, 4, 5, 7)
PRODUCT, ROUND = (1.8, 2.5), 2.0
BY_CELL = {"support": ROUND}, {"support": PRODUCT}
ENGINEERING = {
    name: value for name, value in ACCURACIES["engineering"].items() if name != "n_steps"
}
WIDE = {name: value for name, value in ENGINEERING.items() if name != "layers"}
THROUGH = WIDE | {"support": PRODUCT, "basis_order": 1}, WIDE | {"basis_order": 1}, WIDE
SUPPORTS, CLOUDS = (1.5, 1.75, 2.0, 2.5, 3.0), ((58, 3), (58, 5), (116, 3))
BY_LAYERS = [
    *((rays, scheme) for scheme in BY_CELL for rays in (58, 116)),
    *((rays, scheme) for scheme in THROUGH for rays in (58, 116, 174)),
]
"""Rays and schemes whose errors are compared over the layers of particles."""
INTEGRATION = [
    (order, points, rays)
    for order in (1, 2)
    for points in ((2, 2), (2, 3), (3, 3))
    for rays in (58, 116)
]
"""Order of the basis, Gauss points of a cell, rays."""
ACROSS, PENALTIES = (2, 3, 4), (3e2, 1e3, 3e3, 1e4, 3e4, 1e5)
REFINEMENTS = ((58, 4, 1), (58, 4, 2), (116, 4, 1), (116, 4, 2), (116, 5, 2), (174, 5, 2))
"""Rays of the even ring, layers, parts of an interval where the door presses."""
SECTIONS = ("half_disc", "o_ring", "bonded_gasket", "half_ring")
EQUAL_STEPS, TOLERANCES = (10, 20, 35, 50, 105), (2e-2, 5e-3, 2e-3)
SPACINGS, RAYS = (1.2, 0.9, 0.7, 0.5), (24, 36, 48, 72)
FILES = (
    "lip", "weatherstrip", "o_ring", "sealed_bulb", "slipping_lip", "o_ring_under_pressure",
)  # fmt: skip
NOMINAL_PARAMETERS = range(26)
AWAY_SEEDS, AWAY_PARAMETERS = (1, 3), (4, 9, 16, 25)
"""Random designs and the parameters of their finite differences."""
REFINED_STEPS = {
    "incremental": (*STEPS, 800, 1600, 3200), "accumulated": (*STEPS, 4 * STEPS[-1]),
}  # fmt: skip
RINGS = {
    "ring_disc_2": (0.2,), "ring_disc_5": (0.4, 0.3), "ring_squeezed": (0.3, 0.2, 0.15),
    "ring_sleeve": (0.4, 0.3, 0.2), "ring_foam": (0.4, 0.3),
    "shaft_lip": (0.5, 0.375, 0.25),
}  # fmt: skip
"""Spacings of bodies of revolution, mm; those of the files are the first, of the O-ring the second."""
SQUEEZED = (0.4, 0.25, 0.15)
"""Spacings of the O-ring between planes, mm."""
DISCS = {"ring_disc_2": 2.0, "ring_disc_5": 5.0}
INNER, RING_RADII, WALL_CELLS = (0.0, 1.0), (40.0, 400.0, 4000.0, 40000.0), (8, 16, 32, 64)
FINEST = (232, 9)
"""Rays and layers, beyond what the tests run."""


def integrated(order: int, points: tuple) -> dict:
    """Options of a scheme with a basis and Gauss points."""
    return WIDE | {"basis_order": order, "n_gauss": points}


def gap_options(rays: int, layers: int, parts: int) -> dict:
    """Options of a refined ring."""
    return WIDE | {"layers": layers, "rays": rays, "refinement": parts, "n_steps": 105}


def cases() -> dict:
    """Arguments of every quantity; equal ones may repeat."""
    clouds = [
        {"rays": rays, "layers": layers, "support": support}
        for rays, layers in CLOUDS for support in (*SUPPORTS, PRODUCT)
    ]  # fmt: skip
    schemes = [*BY_LAYERS, *((rays, integrated(*own)) for *own, rays in INTEGRATION)]
    layered = [{"rays": rays, "layers": n, **own} for rays, own in schemes for n in LAYERS]
    at = [ENGINEERING | {"contact_points": points} for points in COMPARED]
    named = [{"accuracy": name} for name in ACCURACIES]
    examples = [{"name": path.stem} for path in sorted(EXAMPLES.glob("*.toml"))]
    return {
        "worst_error": clouds + layered + at,
        "limit_error": [
            {"rays": rays, "layers": n, **functions}
            for functions in FUNCTIONS for rays in (58, 116, 174) for n in LAYERS
        ],
        "bending_error": [{"across": n, "support": s} for s in (ROUND, PRODUCT) for n in ACROSS],
        "flat_errors": [
            *({"normal_penalty": w, **ENGINEERING} for w in PENALTIES),
            *(own | {"n_steps": door_seal(**own).n_steps} for own in named),
        ],
        "corner_error": named,
        "opened_gap": [
            *named, *(gap_options(*own) for own in REFINEMENTS),
            *({"accuracy": "engineering", "contact_points": p} for p in COMPARED),
        ],
        "section_error": [{"name": n, "soft": soft} for n in SECTIONS for soft in (False, True)],
        "equal_steps": [{"steps": n} for n in EQUAL_STEPS],
        "chosen_steps": [{"tolerance": t} for t in TOLERANCES],
        "example_steps": examples,
        "example_choice": examples,
        "outline_error": [{"spacing": s, "scheme": name} for s in SPACINGS for name in SCHEMES],
        "bulb_errors": [{"rays": rays} for rays in RAYS],
        "file_errors": [{"name": name} for name in FILES],
        "refined_steps": [
            {"friction_history": rule, "steps": n} for rule, own in REFINED_STEPS.items() for n in own
        ],
        "refined_corner": [{"rays": r, "layers": n} for r, n in (*LEVELS, FINEST)],
        "refined_flat": [{"rays": r, "layers": n} for r, n in LEVELS],
        "difference": [
            *({"parameter": p, "seed": None} for p in NOMINAL_PARAMETERS),
            *({"parameter": p, "seed": seed} for seed in AWAY_SEEDS for p in AWAY_PARAMETERS),
        ],
        "ring_error": [{"name": n, "spacing": s} for n, own in RINGS.items() for s in own],
        "disc_modulus": [{"name": n, "thickness": t} for n, t in DISCS.items()],
        "pressed_ring_error": [
            {"inner": r, "share": s, "kind": k}
            for k in ("averages", "particles") for r in INNER for s in (0.0, 0.3)
        ],
        "squeezed_ring": [{"spacing": s} for s in SQUEEZED],
        "inflated_error": [{"kind": k, "cells": n} for k in ("tube", "sphere") for n in WALL_CELLS],
        "large_ring_error": [{"radius": r} for r in RING_RADII],
    }  # fmt: skip


FUNCTION = {
    f.__name__: f
    for f in (
        worst_error, limit_error, bending_error, flat_errors, corner_error, opened_gap,
        section_error, equal_steps, chosen_steps, example_steps, example_choice, outline_error,
        bulb_errors, file_errors, refined_steps, refined_corner, refined_flat, difference, ring_error,
        disc_modulus, pressed_ring_error, squeezed_ring, inflated_error, large_ring_error,
    )
}  # fmt: skip

# ---- stored values ----


def key(arguments: dict) -> str:
    """Arguments as text."""
    return json.dumps(arguments, sort_keys=True)


def compute(quantity: str, arguments: dict):
    """Compute one value, its floats rounded to ``DIGITS`` digits."""
    return _plain(FUNCTION[quantity](**arguments), EXACT.get(quantity, DIGITS))


def _plain(value, digits: int):
    """As JSON holds it."""
    if isinstance(value, dict):
        return {name: _plain(own, digits) for name, own in value.items()}
    if isinstance(value, list | tuple | np.ndarray):
        return [_plain(own, digits) for own in value]
    return value if isinstance(value, int | str) else float(f"{value:.{digits}g}")


@cache
def _file() -> dict:
    return json.loads(VALUES.read_text(encoding="utf-8")) if VALUES.exists() else {"date": ""}


def _values() -> dict:
    return {name: own for name, own in _file().items() if name != "date"}


def stored_date() -> str:
    """Return the day on which the values were computed."""
    return _file()["date"]


def stored(quantity: str, **arguments):
    """Look up a value.

    Raises
    ------
    KeyError
        When it was not computed: its case is missing, or the script has not run since.
    """
    values, own = _values().get(quantity, {}), key(arguments)
    if own not in values:
        raise KeyError(f"{quantity} of {own}: add the case, run {Path(__file__).name} {quantity}")
    return values[own]


def _compute(task):
    return compute(*task)


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("quantities", nargs="*", metavar="QUANTITY", help=", ".join(FUNCTION))
    options = parser.parse_args(arguments)
    known, failed = cases(), []
    # spawned, for numba's threads do not survive a fork
    with multiprocessing.get_context("spawn").Pool(min(2, os.cpu_count() or 1)) as pool:
        for name in options.quantities or FUNCTION:
            own = {key(arguments): arguments for arguments in known[name]}
            tasks = [(name, arguments) for arguments in own.values()]
            try:
                found = pool.map(_compute, tasks, chunksize=1)
            except Exception as error:
                # the other quantities are computed and stored
                failed.append(f"{name}: {type(error).__name__}: {error}")
                continue
            _store(name, dict(zip(own, found, strict=True)))
    if failed:
        raise SystemExit("\n".join(failed))


def _store(quantity: str, values: dict) -> None:
    """Write the values of a quantity beside those that are stored."""
    known = _values() | {quantity: values}
    ordered = {"date": today()} | {name: known[name] for name in FUNCTION if name in known}
    VALUES.write_text(json.dumps(ordered, indent=1) + "\n", encoding="utf-8")
    _file.cache_clear()


if __name__ == "__main__":
    main()
