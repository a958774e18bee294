"""Target load-deflection curve of a seal file: a CSV file beside it.

    # comments begin with a hash
    travel_mm,force
    2.0,20
    4.0,60

``force`` is in the units of the measure; the order of the columns is free.
"""

from pathlib import Path

import numpy as np

from seal_mdao.errors import SealFileError
from seal_mdao.input_files import filled_lines

COLUMNS = ("travel_mm", "force")
MOST_READINGS = 1000


def read_target(path: Path) -> tuple[tuple, tuple]:
    """Read travels (mm) and target forces from a CSV file.

    Raises
    ------
    SealFileError
        In one line: file, line, what is wrong. What is in a file of another kind is not quoted.
    """
    filled = [
        (where, [cell.strip() for cell in line.split(",")])
        for where, line in filled_lines(path, SealFileError)
    ]
    if not filled or sorted(filled[0][1]) != sorted(COLUMNS):
        raise SealFileError(
            f"{path}: the first line of a target curve must name the columns {','.join(COLUMNS)}"
        )
    columns = filled[0][1]
    rows = [_reading(*own) for own in filled[1:]]
    if not 1 <= len(rows) <= MOST_READINGS:
        raise SealFileError(
            f"{path}: the file has {len(rows)} readings, but must have 1 to {MOST_READINGS}"
        )
    found = dict(zip(columns, zip(*rows, strict=True), strict=True))
    return found[COLUMNS[0]], found[COLUMNS[1]]


def _reading(where: str, cells: list[str]) -> list[float]:
    """Parse the two numbers of a line."""
    try:
        # Python alone reads 1_0 as a number: refuse it
        numbers = [float(cell.replace("_", "?")) for cell in cells]
    except ValueError:
        numbers = []
    if len(numbers) != len(COLUMNS) or not np.isfinite(numbers).all():
        raise SealFileError(
            f"{where}: the line of a target curve must have two numbers separated by a comma, with "
            "decimal points"
        )
    return numbers
