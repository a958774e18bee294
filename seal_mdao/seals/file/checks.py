"""Checks of the values of a seal file: what is allowed, and one line that says so."""

import sys
from collections.abc import Callable
from difflib import get_close_matches
from math import inf
from typing import NamedTuple

from seal_mdao.errors import GeometryError, SealFileError
from seal_mdao.values import shown

REQUIRED = object()
LARGEST = sys.float_info.max
MOST_ROWS = 10_000
"""Tables of one list."""
MOST_POINTS = 20_000
"""Of a line or spline."""


class Check(NamedTuple):
    """A value's form.

    Attributes
    ----------
    allowed : str
        What it must be.
    convert : callable
        Gives the value as it is kept; raises ValueError or TypeError for another form.
    """

    allowed: str
    convert: Callable


class Key(NamedTuple):
    """A key of a table: its check, and what it is unless given."""

    check: Check
    default: object = REQUIRED


def _number(value) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError
    if not -LARGEST <= value <= LARGEST:  # nor is nan
        raise ValueError
    return float(value)


def number(above: float | None = None, least: float | None = None, most: float = inf) -> Check:
    """A finite number, above or not below a bound, and at most another one."""
    limit = "" if above is None else f" above {above:g}"
    limit += "" if least is None else f" of at least {least:g}"
    limit += f" and at most {most:g}" if most < inf else ""

    def convert(value):
        found = _number(value)
        if (above is not None and found <= above) or (least is not None and found < least):
            raise ValueError
        if found > most:
            raise ValueError
        return found

    return Check("a number" + limit, convert)


def whole(least: int, most: int) -> Check:
    """A whole number between two bounds."""

    def convert(value):
        if isinstance(value, bool) or not isinstance(value, int) or not least <= value <= most:
            raise ValueError
        return value

    return Check(f"a whole number from {least} to {most}", convert)


def _text(value):
    if not isinstance(value, str) or not value.strip():
        raise TypeError
    return value


TEXT = Check("a text that is not empty", _text)


def _name(value):
    if not _text(value).isidentifier():
        raise ValueError
    return value


NAME = Check("a name of letters, digits and _ that begins with no digit", _name)


def one_of(*names: str) -> Check:
    """One of some texts."""

    def convert(value):
        if value not in names:
            raise ValueError
        return value

    return Check("one of " + ", ".join(names), convert)


def _point(value):
    if not isinstance(value, list) or len(value) != 2:
        raise TypeError
    return _number(value[0]), _number(value[1])


POINT = Check("a point [x, y] of two numbers", _point)


def point(most: float) -> Check:
    """A point with coordinates up to ``most`` in size."""

    def convert(value):
        found = _point(value)
        if max(map(abs, found)) > most:
            raise ValueError
        return found

    return Check(f"a point [x, y] of two numbers, at most {most:g} in size", convert)


def many(one: Check, what: str, least: int = 1) -> Check:
    """A list of values of one form."""

    def convert(value):
        if not isinstance(value, list) or len(value) < least:
            raise TypeError
        return tuple(one.convert(entry) for entry in value)

    return Check(what, convert)


NAMES = many(TEXT, 'a list of names, such as ["base"]')


def _points(value):
    if isinstance(value, list) and len(value) > MOST_POINTS:
        raise GeometryError(f"{len(value)} points, but at most {MOST_POINTS} are read")
    return many(POINT, "", 2).convert(value)


POINTS = Check("a list of at least two points [[x, y], [x, y], ...]", _points)
NUMBERS = many(number(), "a list of numbers")

LIST = Check("a list of tables", lambda value: value)
"""Looked at by ``tables``."""


def table(where: str, given, keys: dict[str, Key]) -> dict:
    """The values of a table, checked and with defaults.

    Parameters
    ----------
    where : str
        Its name for messages.
    given : object
        What the file has there.
    keys : dict of str to Key

    Raises
    ------
    SealFileError
        For what is no table, an unknown key, one that is missing, a value of another form.
    """
    if not isinstance(given, dict):
        written = f", written [{where.strip('[]')}]" if isinstance(given, list) else ""
        raise SealFileError(f"{where} must be one table{written}, got {shown(given)}")
    for name in given:
        if name not in keys:
            raise SealFileError(
                f"{where}: unknown key {name!r}{suggestion(name, keys)}; known are {', '.join(keys)}"
            )
    values = {}
    for name, key in keys.items():
        if name in given:
            values[name] = _converted(where, name, given[name], key.check)
        elif key.default is REQUIRED:
            raise SealFileError(
                f"{where}: the key {name!r} is missing; it must be {key.check.allowed}"
            )
        else:
            values[name] = key.default
    return values


def _converted(where, name, value, check):
    try:
        return check.convert(value)
    except GeometryError as error:
        raise SealFileError(f"{where}: {name}: {error}") from None
    except SealFileError as error:
        raise SealFileError(f"{where}: {error}") from None
    except (TypeError, ValueError):
        raise SealFileError(
            f"{where}: {name} = {shown(value)}, but it must be {check.allowed}"
        ) from None


def tables(where: str, given) -> list:
    """The tables of a list, written ``[[where]]``.

    Raises
    ------
    SealFileError
        For what is no list of tables.
    """
    if not isinstance(given, list) or not given or not all(isinstance(g, dict) for g in given):
        raise SealFileError(
            f"{where} must be a list of tables, each written [[{where}]], got {shown(given)}"
        )
    if len(given) > MOST_ROWS:
        raise SealFileError(f"[[{where}]]: {len(given)} of them, but at most {MOST_ROWS} are read")
    return given


def known(where: str, key: str, name: str, names, what: str) -> None:
    """Refuse a name that is not among ``names``.

    Raises
    ------
    SealFileError
    """
    if name not in names:
        raise SealFileError(
            f"{where}: {key} = {name!r}, but there is no such {what}{suggestion(name, names)}; "
            f"there {'are' if len(names) != 1 else 'is'} {', '.join(names) or 'none'}"
        )


def suggestion(name, names) -> str:
    """ ", did you mean ...?" where a known name is close."""
    close = get_close_matches(str(name), list(names), 1, 0.6)
    return f" (did you mean {close[0]!r}?)" if close else ""
