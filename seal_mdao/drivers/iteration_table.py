"""The table of major iterations, kept as history and printed on request."""

from __future__ import annotations

from dataclasses import dataclass, fields

HEADER_EVERY = 20


@dataclass(frozen=True)
class IpoptIteration:
    """One iteration of Ipopt; values in driver scaling.

    ``analyses`` counts model runs so far, ``infeasibility`` and ``optimality`` are Ipopt's
    inf_pr and inf_du, ``step`` is its ||d|| and ``trials`` the trial points of the line search.
    """

    iteration: int
    analyses: int
    objective: float
    infeasibility: float
    optimality: float
    barrier: float
    step: float
    alpha: float
    trials: int
    phase: str


@dataclass(frozen=True)
class SlsqpIteration:
    """One major iteration of SLSQP; values in driver scaling.

    ``analyses`` counts model runs so far, ``step`` is the largest change of a design variable,
    ``radius`` the largest change that was allowed, ``trials`` counts points that were tried and
    ``failed`` those among them at which the analysis failed.
    """

    iteration: int
    analyses: int
    objective: float
    infeasibility: float
    step: float
    radius: float
    trials: int
    failed: int


def format_header(row_type: type) -> str:
    """Return the heading of the table of a row type."""
    return " ".join(f"{_title(field.name):>{_width(field)}}" for field in fields(row_type))


def format_row(row: IpoptIteration | SlsqpIteration) -> str:
    """Return a row of the table."""
    cells = []
    for field in fields(row):
        value = getattr(row, field.name)
        text = f"{value:.6e}" if field.name == "objective" else _short(value)
        cells.append(f"{text:>{_width(field)}}")
    return " ".join(cells)


class IterationTable:
    """Collects rows in a list and prints them while the run goes on.

    Parameters
    ----------
    rows : list
        The history to extend.
    printer : callable or None
        Called with every line; None keeps the table silent.
    """

    def __init__(self, rows: list, printer=None):
        self.rows = rows
        self._print = printer

    def add(self, row: IpoptIteration | SlsqpIteration) -> None:
        """Append a row, printing it (and the heading now and then) if asked to."""
        if self._print is not None:
            if len(self.rows) % HEADER_EVERY == 0:
                self._print(format_header(type(row)))
            self._print(format_row(row))
        self.rows.append(row)


def _title(name: str) -> str:
    return {"iteration": "iter", "infeasibility": "infeas"}.get(name, name)


def _width(field) -> int:
    if field.name == "objective":
        return 14
    return 10 if field.type == "float" else 8


def _short(value) -> str:
    return f"{value:.2e}" if isinstance(value, float) else str(value)
