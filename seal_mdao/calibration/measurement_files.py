"""Read CSV files of tests: named columns of numbers and words, with errors that name line and column."""

import csv
from collections.abc import Sequence

from seal_mdao.input_files import filled_lines

Choice = str | tuple[str, ...]
"""A column, or several of which a file has one."""


class MaterialDataError(ValueError):
    """Error in a file of test data, with file, line and column."""


def read_rows(
    path, required: Sequence[Choice], optional: Sequence[str] = (), words: Sequence[str] = ()
) -> list[tuple[str, dict]]:
    """Read the rows of a CSV file in UTF-8; empty lines and comments (#) are left out.

    Parameters
    ----------
    path : path-like
    required, optional : sequence
        Names of columns, in any order in the file. A tuple stands for columns of which a file has
        exactly one.
    words : sequence of str
        Columns of text; all others are numbers.

    Returns
    -------
    list of (str, dict)
        File and line for messages, and the values by column.

    Raises
    ------
    MaterialDataError
        In one line: file, line, column, what is wrong and what is allowed.
    """
    filled = filled_lines(path, MaterialDataError)
    if not filled:
        head = ",".join(own if isinstance(own, str) else own[0] for own in required)
        raise MaterialDataError(
            f"{path}: the file is empty; its first line must name the columns, {head}"
        )
    columns = _header(*filled[0], required, optional)
    rows = [(where, _row(where, line, columns, words)) for where, line in filled[1:]]
    if not rows:
        raise MaterialDataError(
            f"{path}: the file has column names but no readings; add at least one line of numbers "
            "below the column names"
        )
    return rows


def columns_of(path) -> list[str]:
    """Read the names of the columns of a CSV file; empty for an empty file.

    Raises
    ------
    MaterialDataError
        For a file that cannot be read.
    """
    filled = filled_lines(path, MaterialDataError)
    return _cells(filled[0][1]) if filled else []


def _cells(line: str) -> list[str]:
    try:
        return [cell.strip() for cell in next(csv.reader([line]))]
    except csv.Error:  # a cell beyond csv's limit of length cannot be a number
        return [""]


def _header(where: str, line: str, required, optional) -> list[str]:
    """Parse and validate the names of the columns.

    The message quotes the line only if it has the columns of test data, because a seal file may name
    any file of the machine."""
    columns = _cells(line)
    choices = [(own,) if isinstance(own, str) else own for own in required]
    allowed = [*(name for own in choices for name in own), *optional]
    needed = ", ".join(" or ".join(own) for own in choices)
    missing = [own for own in choices if not set(own) & set(columns)]
    if missing:
        further = f" and optionally {', '.join(optional)}" if optional else ""
        raise MaterialDataError(
            f"{where}: there is no column {' or '.join(map(repr, missing[0]))}; the columns are "
            f"{needed}{further}, separated by commas"
        )
    unknown = [column for column in columns if column not in allowed]
    if unknown:
        raise MaterialDataError(
            f"{where}: unknown column {unknown[0][:40]!r}; allowed are {', '.join(allowed)}, "
            "separated by commas"
        )
    twice = [column for column in columns if columns.count(column) > 1]
    if twice:
        raise MaterialDataError(
            f"{where}: the column {twice[0]!r} occurs twice; remove or rename one"
        )
    several = [own for own in choices if len(set(own) & set(columns)) > 1]
    if several:
        raise MaterialDataError(
            f"{where}: the columns {', '.join(several[0])} exclude each other; keep one of them"
        )
    return columns


def _row(where: str, line: str, columns: list[str], words) -> dict:
    """Parse one line: its values by column."""
    cells = _cells(line)
    if len(cells) != len(columns):
        raise MaterialDataError(
            f"{where}: {len(cells)} values for {len(columns)} columns ({', '.join(columns)}); "
            "separate columns by commas and write decimals with a point"
        )
    found = dict(zip(columns, cells, strict=True))
    for column in columns:
        try:
            # Python alone reads 1_0 as a number: refuse it
            if column not in words:
                found[column] = float(found[column].replace("_", "?"))
        except ValueError:
            raise MaterialDataError(
                f"{where}, column {column}: {found[column][:40]!r} is not a number"
            ) from None
    return found
