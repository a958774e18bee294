"""Load-deflection curves as text: force on every moving profile, or moved edges, over the travel; where
nothing moves over the pressure of a fluid."""

import numpy as np

from seal_mdao.seals.profiles import ROTATION, TRAVEL, moving_histories, moving_parts

MOST_ROWS = 10
"""Largest number of rows for a load-unload segment; the last load step is always one of them."""
BAR = 30
"""Characters of the longest bar: the largest force on the profile."""


def print_forces(result) -> None:
    """Print the tables of the profiles and edges that move, complete or up to where the path ended."""
    # flushed: the tables are there to read while figures are drawn
    for line in force_lines(result):
        print(line, flush=True)


def force_lines(result) -> list[str]:
    """Tabulate the force on moving profiles and edges over their travel, with a bar for its size.

    Parameters
    ----------
    result : SealResult

    Returns
    -------
    list of str
        For each load-unload segment a heading with units and at most ``MOST_ROWS`` rows, those of a
        ring with the force per mm of circumference beside it; empty where nothing moves or without a
        converged load step.
    """
    found, units = [], result.seal.units
    names = " and ".join(units.directions)
    beside = f", the same in N {units.along}" if units.radius else ""
    for part, history in zip(moving_parts(result.seal), moving_histories(result), strict=True):
        # none for a profile at rest, unless nothing moves and a fluid presses
        pressed = any(own.axis not in (TRAVEL, ROTATION) for own in history.load_segments)
        if not (part.motion.moves or pressed) or not len(history.stage):
            continue
        size = np.hypot(*history.force.T)
        for segment in history.load_segments:
            along = "turn (deg)" if segment.axis == ROTATION else segment.axis
            stages = ", ".join(map(str, segment.stages))
            found.append(
                f"{history.label}, stage {stages}: {along}, {names} force ({units.force}){beside}"
            )
            # evenly distributed load steps up to the last one
            first, last = segment.steps.start, segment.steps.stop - 1
            rows = np.unique(np.linspace(first, last, MOST_ROWS + 1).round().astype(int)[1:])
            for step in rows:
                # |F| / max |F|
                bar = "#" * round(BAR * size[step] / max(size.max(), 1e-300))
                across, up = history.force[step]
                here = segment.along[step - first]
                numbers = f"{here:9.3f} {across:10.2f} {up:10.2f}"
                if units.radius:
                    numbers += f" {units.per_mm * across:10.4f} {units.per_mm * up:10.4f}"
                found.append(f"{numbers}  {bar}".rstrip())
    return found
