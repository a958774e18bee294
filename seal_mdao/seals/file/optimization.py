"""``[optimize]``: what is made small, and what has to hold."""

from pydantic import model_validator

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.forms import Text, number
from seal_mdao.seals.file.measures import implied_measure
from seal_mdao.seals.file.schema import Table, key, rows, table


@table
class Constraint(Table):
    """What has to hold: a measure between bounds."""

    measure: Text = key("name of a measure, or a type that needs no further key")
    lower: number() | None = key("least value, in the units of the measure", None)
    upper: number() | None = key("largest value, in the units of the measure", None)

    @model_validator(mode="after")
    def _bounds(self):
        if self.lower is None and self.upper is None:
            raise ValueError("needs lower, upper or both; it has neither")
        if self.lower is not None and self.upper is not None and self.lower > self.upper:
            raise ValueError(f"lower = {self.lower:g} is above upper = {self.upper:g}")
        return self


@table
class OptimizeTable(Table):
    """What is made small, and what has to hold."""

    minimize: Text = key("name of a measure, or a type that needs no further key")
    constraints: rows(Constraint) = key("what has to hold", (), alias="constraint")


def with_implied(optimize: OptimizeTable, measures: tuple, profiles: tuple) -> tuple:
    """All measures: the declared ones and those that the problem names by their type.

    Raises
    ------
    SealFileError
        For a name of no measure; an aim with several values.
    """
    where, every = "[optimize]", list(measures)
    aim, new = implied_measure(where, "minimize", optimize.minimize, every, profiles)
    every += [aim] * new
    if not aim.single:
        raise SealFileError(
            f"{where}: minimize = {aim.name!r} is of the type {aim.type}, which has several values; "
            "minimise a single number, such as stress_norm or gap_square_sum"
        )
    for i, constraint in enumerate(optimize.constraints, 1):
        where = f"[[optimize.constraint]] {i}"
        own, new = implied_measure(where, "measure", constraint.measure, every, profiles)
        every += [own] * new
    return tuple(every)
