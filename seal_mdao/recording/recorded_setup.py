"""How the run in a recorder file was set up, compared with a problem that is to continue it."""

import json
import sqlite3
import warnings
import zlib
from contextlib import closing

import numpy as np
import openmdao

from seal_mdao import openmdao_access as access
from seal_mdao.recording import run_log
from seal_mdao.recording.evaluations import RestartError
from seal_mdao.recording.plain_reading import reading

COMPARED = (
    "lower",
    "upper",
    "equals",
    "ref",
    "ref0",
    "scaler",
    "adder",
    "units",
    "indices",
    "size",
)
"""What of a design variable, objective or constraint decides the steps of an optimiser."""
FREE_OPTIONS = (
    "maxiter", "tol", "feas_tol", "disp", "debug_print", "hotstart_file", "max_failures",
    "invalid_desvar_behavior", "singular_jac_behavior", "singular_jac_tol",
)  # fmt: skip
"""Options of a driver that end a run, or are about messages: its steps are the same."""
SAME = 1e-9
"""Relative difference of numbers that count as equal: computed limits may differ in rounding."""


class RestartWarning(UserWarning):
    """A run is continued with options under which the optimiser may take other steps."""


def require_same_setup(path, driver) -> None:
    """Check that a driver is set up as that of the last run in a recorder file.

    Parameters
    ----------
    path : str or Path
    driver : Driver
        After its final setup.

    Raises
    ------
    RestartError
        For another driver, other design variables, objectives or constraints, other bounds or scaling
        of them: with all that differs.

    Warns
    -----
    RestartWarning
        For other options of the driver, but those that end a run.
    """
    runs = run_log.read(path)
    different = _drivers(runs[-1], driver) if runs else []
    different += _variables(_recorded(path), access.variable_settings(driver))
    if different:
        raise RestartError(
            f"{path} was recorded with another problem, so the optimiser would not come by its "
            f"points: {'; '.join(different)}"
        )
    changed = _options(runs[-1], driver) if runs else []
    if changed:
        warnings.warn(
            f"{path} was recorded with other options of the driver, under which it may take other "
            f"steps: {'; '.join(changed)}",
            RestartWarning,
            stacklevel=3,
        )


def _recorded(path) -> dict | None:
    """Settings of the variables of the driver by name; None where the file does not tell, or was
    recorded with another version of OpenMDAO, which may have kept them in other units."""
    with reading(path), closing(sqlite3.connect(path)) as connection:
        row = connection.execute("SELECT openmdao_version, var_settings FROM metadata").fetchone()
        if row is None or row[0] != openmdao.__version__ or not row[1]:
            return None
        found = json.loads(zlib.decompress(row[1]))
    return {name: meta for name, meta in found.items() if isinstance(meta, dict)}


def _drivers(run: run_log.LoggedRun, driver) -> list:
    here = type(driver).__name__
    return [] if run.driver == here else [f"the driver was {run.driver} and is {here}"]


def _options(run: run_log.LoggedRun, driver) -> list:
    here = run_log.options_of(driver)
    names = sorted((run.options.keys() | here.keys()).difference(FREE_OPTIONS))
    return [
        f"{name} was {run.options.get(name)!r} and is {here.get(name)!r}"
        for name in names
        if run.options.get(name) != here.get(name)
    ]


def _variables(recorded: dict | None, here: dict) -> list:
    if recorded is None:
        return []
    found = [f"{name!r} was not in it" for name in here if name not in recorded]
    found += [f"{name!r} is not in this one" for name in recorded if name not in here]
    for name in (name for name in here if name in recorded):
        old, new = (access.with_unscaled_bounds(table[name]) for table in (recorded, here))
        for key in COMPARED:
            was, now = old.get(key), new.get(key)
            if not _same(was, now):
                found.append(f"{key} of {name!r} was {_shown(was)} and is {_shown(now)}")
    return found


def _same(one, other) -> bool:
    if one == other:
        return True
    try:
        return bool(np.allclose(np.array(one, float), np.array(other, float), rtol=SAME, atol=0.0))
    except (TypeError, ValueError):  # no numbers, or of other shapes
        return False


def _shown(value) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
