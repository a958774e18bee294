"""Loading the library of an optimiser, and handing it the settings of a user."""

from __future__ import annotations

from importlib import import_module

import numpy as np


def import_library(name: str, driver: str, install: str):
    """Import a library when it is needed.

    Raises
    ------
    ImportError
        With one line that says how to install it.
    """
    try:
        return import_module(name)
    except ImportError as error:
        raise ImportError(
            f"{driver} needs {name}, which is not installed: pip install {install}"
        ) from error


def set_option(set_one, name: str, value) -> None:
    """Set an option; an integer where the optimiser wants a real number is taken as one.

    Parameters
    ----------
    set_one : callable
        Sets an option, given its name and value.

    Raises
    ------
    ValueError
        If the optimiser does not know the name or refuses the value.
    """
    value = value.item() if isinstance(value, np.generic) else value
    whole = isinstance(value, int) and not isinstance(value, bool)
    for candidate in (value, float(value)) if whole else (value,):
        try:
            set_one(name, candidate)
        except (ValueError, TypeError, LookupError, RuntimeError) as error:
            reason = error
        else:
            return
    raise ValueError(f"opt_settings['{name}']: {value!r} is refused ({reason}).") from reason
