"""Checks of numbers among the options of drivers, as OpenMDAO calls them: name and value."""

from seal_mdao import values

MOST_ITERATIONS = 10**9
"""The libraries count in 32 bits."""
MOST = 1e20
"""What the libraries take for infinite."""


def tolerance(name: str, value) -> None:
    """A finite number from zero on."""
    values.real(f"option {name!r}", value, 0.0, below=MOST)


def positive(name: str, value) -> None:
    """A finite number above zero."""
    values.real(f"option {name!r}", value, above=0.0, below=MOST)


def count(name: str, value) -> None:
    """An integer from zero on."""
    values.integer(f"option {name!r}", value, 0, MOST_ITERATIONS)


def positive_count(name: str, value) -> None:
    """An integer from one on."""
    values.integer(f"option {name!r}", value, 1, MOST_ITERATIONS)
