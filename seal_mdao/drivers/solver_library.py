"""Import of optimiser libraries, and conversion of user settings."""

from __future__ import annotations

from importlib import import_module

import numpy as np


def import_library(name: str, driver: str, install: str):
    """Import an optional library.

    Raises
    ------
    ImportError
        With the command that installs it.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(
            f"{driver} needs {name}, which is not installed: pip install {install}"
        ) from error


def set_option(set_one, name: str, value) -> None:
    """Set an option of an optimiser; an integer is converted where a real number is required.

    Parameters
    ----------
    set_one : callable
        Sets an option by name and value.

    Raises
    ------
    ValueError
        If the optimiser does not know the name or rejects the value.
    """
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
    raise ValueError(f"opt_settings['{name}']: {value!r} is refused ({reason}).") from reason
