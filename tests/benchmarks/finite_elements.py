"""Time of an analysis beside biquadratic finite elements of the same section, and errors of both."""

import sys
import time
from pathlib import Path

import numpy as np

import seal_mdao as sm

if __package__ in (None, ""):
    sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from verification.error_sources import at_travels
from verification.pressed_elements import CORNER, FLAT, PressedElements

LIMITS = {"flat door": FLAT, "corner door": CORNER}
"""Reaction of refined elements at 2, 4, 6, 8 and 10 mm, N/m."""
MESH = 2, 58
"""Elements across and around: the coarsest mesh within 0.5 %; 1 x 58 and 1 x 116 are off by 1.8 and
2.6 %."""


def _seconds(function) -> float:
    """Processor time of a call, s."""
    start = time.process_time()
    function()
    return time.process_time() - start


def compared(door: str, repeats: int = 5) -> dict[str, float]:
    """Compare ``accuracy="engineering"`` with elements under one door, by time and error.

    Both have the same load steps, contact law and penalties. They are timed alternately, and the
    shortest time of each counts.

    Parameters
    ----------
    door : str
        A key of ``LIMITS``.
    repeats : int

    Returns
    -------
    dict of str to float
        Rows of the table.
    """
    seal = sm.door_seal(accuracy="engineering", door=door.split()[0])

    def press():
        return PressedElements(seal, *MESH).press()

    # the first runs compile kernels
    errors = [
        100.0 * float(np.abs(found / LIMITS[door] - 1.0).max())
        for found in (at_travels(sm.analyze(seal)), press().curve)
    ]
    times = [(_seconds(lambda: sm.analyze(seal)), _seconds(press)) for _ in range(repeats)]
    analysis, elements = map(min, zip(*times, strict=True))
    return {
        f"{door}: analysis (ms)": 1e3 * analysis,
        f"{door}: finite elements, same steps (ms)": 1e3 * elements,
        f"{door}: analysis / finite elements": analysis / elements,
        f"{door}: largest error of the force, analysis (%)": errors[0],
        f"{door}: largest error of the force, finite elements (%)": errors[1],
    }


def elements_figures() -> dict[str, float]:
    """Compare under both doors."""
    return {name: value for door in LIMITS for name, value in compared(door).items()}
