"""Differences between the tables of two seal files, in words."""

from collections.abc import Iterator

MOST_LISTED = 5
"""Largest number of differences that are listed."""
MOST_LETTERS = 60
"""Of a value that is written."""


def differences(before: dict, after: dict) -> str:
    """List the keys of seal files whose values differ, such as ``section.spacing was 0.5 and is 0.4``;
    empty for equal tables."""
    old, new = dict(_values(before)), dict(_values(after))
    found = []
    for key in dict.fromkeys([*old, *new]):
        if key not in new:
            found.append(f"{key} is missing (was {_shortened(old[key])})")
        elif key not in old:
            found.append(f"{key} = {_shortened(new[key])} was not in it")
        elif old[key] != new[key]:
            found.append(f"{key} was {_shortened(old[key])} and is {_shortened(new[key])}")
    more = [f"{len(found) - MOST_LISTED} more"] if len(found) > MOST_LISTED else []
    return "; ".join(found[:MOST_LISTED] + more)


def _values(tables: dict, path: tuple = ()) -> Iterator[tuple[str, object]]:
    """List the values of all keys by their paths; rows of a list of tables by name or number."""
    for key, value in tables.items():
        here = (*path, key)
        if isinstance(value, dict):
            yield from _values(value, here)
        elif isinstance(value, list) and any(isinstance(own, dict) for own in value):
            for number, row in enumerate(value, 1):
                name = row.get("name", number) if isinstance(row, dict) else number
                yield from _values({str(name): row}, here)
        else:
            yield ".".join(here), value


def _shortened(value) -> str:
    text = repr(value)
    return text if len(text) <= MOST_LETTERS else f"{text[: MOST_LETTERS - 3]}..."
