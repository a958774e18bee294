"""``[optimize]``: objective and constraints."""

from typing import Annotated

import numpy as np
from pydantic import TypeAdapter, model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.forms import Form, Text, many, number
from seal_mdao.seals.file.measure_table import MeasureTable, OfProfile
from seal_mdao.seals.file.measure_types import EXTENSIONS, KINDS
from seal_mdao.seals.file.schema import Table, checked, key, rows, suggestion, table

Bound = Annotated[
    number() | many(number(), "a list of numbers"),
    Form("a number, or a list with one for every value of the measure"),
]


@table
class Constraint(Table):
    """Constraint: bounds of a measure."""

    measure: Text = key("name of a measure, or a type that needs no further key")
    lower: Bound | None = key("least value, in the units of the measure", None)
    upper: Bound | None = key("largest value, in the units of the measure", None)

    @model_validator(mode="after")
    def _bounds(self):
        # lower <= c <= upper, one of them at least
        if self.lower is None and self.upper is None:
            raise ValueError(
                "a constraint needs a lower limit (lower), an upper limit (upper) or both, but has "
                "neither"
            )
        if self.lower is None or self.upper is None:
            return self
        low, high = np.atleast_1d(self.lower), np.atleast_1d(self.upper)
        if low.size != high.size and 1 not in (low.size, high.size):
            raise ValueError(
                f"the lower limits (lower) are {low.size} numbers, but the upper limits (upper) "
                f"are {high.size}; both lists must have the same length"
            )
        low, high = np.broadcast_arrays(low, high)
        for above in np.flatnonzero(low > high)[:1]:
            raise ValueError(
                f"the lower limit lower = {low[above]:g} is above the upper limit upper = "
                f"{high[above]:g}"
            )
        return self

    def check_size(self, where: str, count: int) -> None:
        """Raise SealFileError for a list of bounds that are not one for each of ``count`` values."""
        for side in ("lower", "upper"):
            own = getattr(self, side)
            if isinstance(own, tuple) and len(own) != count:
                raise SealFileError(
                    f"{where}: {side} has {len(own)} numbers, but the measure {self.measure!r} has "
                    f"{count} value{'s' if count != 1 else ''}"
                )


@table
class OptimizeTable(Table):
    """Objective and constraints of the optimisation."""

    minimize: Text = key("name of a measure, or a type that needs no further key")
    constraints: rows(Constraint) = key("limits on measures", (), alias="constraint")


def implied_measures(optimize: OptimizeTable, measures: tuple, profiles: tuple) -> dict:
    """Return the measures that the problem names by their type, beside those of ``[[measure]]``.

    Returns
    -------
    dict of str to MeasureTable
        By the key that names each, as it stands in messages, such as "[optimize]: minimize = 'mass'".

    Raises
    ------
    SealFileError
        For a name of no measure; an objective with several values.
    """
    # a measure that is named twice is added once
    every, found = list(measures), {}

    def named(key: str, name: str) -> MeasureTable:
        where, names = f"{key} = {name!r}", [measure.name for measure in every]
        if name not in names:
            found[where] = _implied(where, name, names, profiles)
            every.append(found[where])
            return found[where]
        return every[names.index(name)]

    aim = named("[optimize]: minimize", optimize.minimize)
    if not aim.single:
        raise SealFileError(
            f"[optimize]: minimize = {aim.name!r} (type {aim.type}) has several values; minimise a "
            "measure with a single value, such as stress_norm or gap_square_sum"
        )
    for i, constraint in enumerate(optimize.constraints, 1):
        where = f"[[optimize.constraint]] {i}"
        own = named(f"{where}: measure", constraint.measure)
        if own.count is not None:
            constraint.check_size(where, own.count)
    return found


def _implied(where: str, name: str, names: list, profiles: tuple) -> MeasureTable:
    """Make the measure of a type, beside declared measures with these ``names``."""
    # a type of the package or an extension
    try:
        kind = EXTENSIONS.found(name) or KINDS.get(name)
    except ValueError as error:
        raise SealFileError(f"{where}: {error}") from None
    if kind is None:
        close = suggestion(name, [*names, *KINDS])
        raise SealFileError(
            f"{where}, but there is no such measure{close}; it must be the name of a "
            f"[[measure]] ({', '.join(names) or 'the file has none'}), or a type that needs no further "
            "keys, such as section_area or reaction"
        )
    cure = "; add a [[measure]] of this type with its keys"
    try:
        # the name of a type is enough where its table needs no other key
        own = checked(TypeAdapter(kind), {"type": name})
    except SealFileError as error:
        raise SealFileError(f"{where}: {error}{cure}") from None
    try:
        return own.settled(where, profiles)
    except SealFileError as error:
        # a file without profiles needs one first
        lacks_profile = isinstance(own, OfProfile) and not any(map(own.takes, profiles))
        raise SealFileError(f"{error}{'' if lacks_profile else cure}") from None
