"""Validation of numerical options of drivers, in OpenMDAO's signature (name, value)."""

from seal_mdao import values

MOST_ITERATIONS = 10**9
"""Limit of the 32-bit counters of the libraries."""
MOST = 1e20
"""Value that the libraries treat as infinite."""


def tolerance(name: str, value) -> None:
    """Require a finite number of at least zero."""
    values.real(f"option {name!r}", value, 0.0, below=MOST)


def positive(name: str, value) -> None:
    """Require a finite number above zero."""
    values.real(f"option {name!r}", value, above=0.0, below=MOST)


def count(name: str, value) -> None:
    """Require an integer of at least zero."""
    values.integer(f"option {name!r}", value, 0, MOST_ITERATIONS)


def positive_count(name: str, value) -> None:
    """Require an integer of at least one."""
    values.integer(f"option {name!r}", value, 1, MOST_ITERATIONS)
