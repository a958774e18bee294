"""``[optimize]``: what is made small, and what has to hold."""

from seal_mdao.errors import SealFileError
from seal_mdao.seals.file.checks import LIST, TEXT, Key, number, table, tables
from seal_mdao.seals.file.measures import implied_measure, is_single
from seal_mdao.seals.file.tables import Constraint, OptimizeTable

OPTIMIZE_KEYS = {"minimize": Key(TEXT), "constraint": Key(LIST, None)}
CONSTRAINT_KEYS = {"measure": Key(TEXT), "lower": Key(number(), None), "upper": Key(number(), None)}


def read_optimize(given, measures: tuple, profiles: tuple) -> tuple[OptimizeTable, tuple]:
    """The problem, and all measures: the declared ones and those that it names by their type.

    Raises
    ------
    SealFileError
    """
    where = "[optimize]"
    values, measures = table(where, given, OPTIMIZE_KEYS), list(measures)
    aim = _measure(where, "minimize", values["minimize"], measures, profiles)
    if not is_single(aim):
        raise SealFileError(
            f"{where}: minimize = {aim.name!r} is of the type {aim.type}, which has several values; "
            "minimise a single number, such as stress_norm or gap_square_sum"
        )
    constraints = []
    rows = [] if values["constraint"] is None else values["constraint"]
    for i, row in enumerate(tables("optimize.constraint", rows) if rows else [], 1):
        constraints.append(_constraint(f"[[optimize.constraint]] {i}", row, measures, profiles))
    return OptimizeTable(aim.name, tuple(constraints)), tuple(measures)


def _measure(where, key, name, measures, profiles):
    measure, new = implied_measure(where, key, name, measures, profiles)
    if new:
        measures.append(measure)
    return measure


def _constraint(where, given, measures, profiles) -> Constraint:
    values = table(where, given, CONSTRAINT_KEYS)
    lower, upper = values["lower"], values["upper"]
    if lower is None and upper is None:
        raise SealFileError(f"{where}: needs lower, upper or both; it has neither")
    if lower is not None and upper is not None and lower > upper:
        raise SealFileError(f"{where}: lower = {lower:g} is above upper = {upper:g}")
    measure = _measure(where, "measure", values["measure"], measures, profiles)
    return Constraint(measure.name, lower, upper)
