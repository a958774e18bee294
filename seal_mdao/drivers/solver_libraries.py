"""Import of optimiser libraries, and checks of settings of drivers and optimisers."""

from importlib import import_module

import numpy as np

from seal_mdao import values

MOST_ITERATIONS = 10**9
"""Limit of the 32-bit counters of the libraries."""
MOST = 1e20
"""Value that the libraries treat as infinite."""


def tolerance(name: str, value) -> None:
    """Require a finite number of at least zero; signature as OpenMDAO's ``check_valid``."""
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


def import_library(name: str, driver: str, install: str):
    """Import an optional library; the ImportError has the command that installs it."""
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(
            f"{driver} needs {name}, which is not installed: pip install {install}"
        ) from error


def set_option(set_one, name: str, value) -> None:
    """Set an option of an optimiser with ``set_one(name, value)``; convert integers where required.

    Raises
    ------
    ValueError
        If the optimiser does not know the name or rejects the value.
    """
    # the libraries refuse NumPy scalars
    value = value.item() if isinstance(value, np.generic) else value
    # first as given, then as a float: the libraries do not convert 1 to 1.0
    integer = isinstance(value, int) and not isinstance(value, bool)
    for candidate in (value, float(value)) if integer else (value,):
        try:
            set_one(name, candidate)
        except (ValueError, TypeError, LookupError, RuntimeError) as error:
            reason = error
        else:
            return
    raise ValueError(
        f"opt_settings['{name}'] = {value!r} is not accepted by the optimiser: {reason}"
    ) from reason
