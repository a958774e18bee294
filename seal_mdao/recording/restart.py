"""Continue a recorded optimisation, of any OpenMDAO problem."""

import warnings

import numpy as np
import openmdao
import openmdao.api as om

from seal_mdao import openmdao_access as access
from seal_mdao import values
from seal_mdao.recording import run_log
from seal_mdao.recording.evaluations import RecordedEvaluations, RestartError
from seal_mdao.recording.plain_reading import reading, unpacked
from seal_mdao.recording.recorder import RestartRecorder, record_all

COMPARED = (
    "lower", "upper", "equals", "ref", "ref0", "scaler", "adder", "units", "indices", "size",
)  # fmt: skip
"""Settings of design variables, objectives and constraints that determine the steps of an optimiser."""
FREE_OPTIONS = (
    "maxiter", "tol", "feas_tol", "disp", "debug_print", "hotstart_file", "max_failures",
    "invalid_desvar_behavior", "singular_jac_behavior", "singular_jac_tol",
)  # fmt: skip
"""Options of a driver that do not change its steps: limits, and messages."""
SAME = 1e-9
"""Relative difference of numbers that count as equal: computed limits may differ in rounding."""


class RestartWarning(UserWarning):
    """Warning that a run is continued with options under which the optimiser may take other
    steps."""


def restart(problem, path) -> None:
    """Make ``problem.run_driver()`` continue the run recorded in ``path``.

    The driver begins at the recorded start and takes the values and derivatives of all recorded
    points from the file, which brings it to the last recorded point in the recorded state; new cases are
    appended to the file. Call it after ``setup``, without another recorder on the driver, for the
    problem and driver that wrote the file.

    Parameters
    ----------
    problem : Problem
    path : str or Path
        As it was given to the recorder: a bare name is in the problem's output folder.
        File of a ``RestartRecorder`` or ``SqliteRecorder`` with recorded derivatives
        (``recording_options["record_derivatives"]``). Without them every point is analysed again.

    Raises
    ------
    TypeError
        For an object that is no problem, or a driver that is neither UnoDriver nor IpoptDriver.
    RestartError
        A ValueError: if the file cannot be read, or belongs to another problem: another driver, other
        design variables or responses, other bounds or scaling, each named. A different model is
        detected when the run begins.

    Warns
    -----
    RestartWarning
        For other options of the driver, except ``FREE_OPTIONS``.
    """
    values.instance("problem", problem, om.Problem)
    driver = problem.driver
    if "hotstart_file" not in driver.options:
        raise TypeError(
            "only UnoDriver and IpoptDriver can continue a recorded optimisation, not "
            f"{type(driver).__name__}; with another driver, load a recorded design with "
            "Problem.load_case and start a new optimisation from this design"
        )
    # variables and scaling of the driver are known after the final setup
    problem.final_setup()
    path = access.recorder_path(problem, path)
    recorded = RecordedEvaluations(path, driver)
    _require_same_setup(path, driver)
    # the driver begins at the recorded start and finds all later points in the file
    recorded.load_start()
    driver.options["hotstart_file"] = str(path)
    record_all(driver, RestartRecorder(path, append=True))


def _require_same_setup(path, driver) -> None:
    """Compare a driver with that of the last run in a recorder file; see ``restart``."""
    # errors first: other steps would be taken for certain
    runs = run_log.read(path)
    different, here = [], type(driver).__name__
    if runs and runs[-1].driver != here:
        different.append(f"the driver was {runs[-1].driver} and is {here}")
    different += _different_variables(_recorded_settings(path), access.variable_settings(driver))
    if different:
        raise RestartError(
            f"{path} was recorded with another problem and cannot be continued: "
            f"{'; '.join(different)}"
        )
    # other options may lead to other steps: a warning
    changed = _different_options(runs[-1].options, run_log.options_of(driver)) if runs else []
    if changed:
        warnings.warn(
            f"{path} was recorded with other options of the driver, so the continued run may take "
            f"other steps: {'; '.join(changed)}",
            RestartWarning,
            stacklevel=3,
        )


def _recorded_settings(path) -> dict | None:
    """Read the settings of the driver's variables by name; None if the file does not contain them, or
    comes from another version of OpenMDAO, whose units may differ."""
    columns = {"openmdao_version": str | None, "var_settings": bytes | None}
    with reading(path) as database:
        rows = database.rows("metadata", columns)
        if not rows or rows[0][0] != openmdao.__version__ or not rows[0][1]:
            return None
        found = unpacked(rows[0][1])
    # without the execution order, a list
    return {name: meta for name, meta in found.items() if isinstance(meta, dict)}


def _different_options(recorded: dict, here: dict) -> list:
    names = sorted((recorded.keys() | here.keys()).difference(FREE_OPTIONS))
    return [
        f"{name} was {recorded.get(name)!r} and is {here.get(name)!r}"
        for name in names
        if recorded.get(name) != here.get(name)
    ]


def _different_variables(recorded: dict | None, here: dict) -> list:
    if recorded is None:
        return []
    found = [
        f"{name!r} was not part of the recorded problem" for name in here if name not in recorded
    ]
    found += [f"{name!r} is not part of this problem" for name in recorded if name not in here]
    for name in (name for name in here if name in recorded):
        # bounds before scaling: recorded ones may be scaled
        old, new = (access.with_unscaled_bounds(table[name]) for table in (recorded, here))
        for key in COMPARED:
            was, now = old.get(key), new.get(key)
            if not _same(was, now):
                found.append(f"{key} of {name!r} was {_shortened(was)} and is {_shortened(now)}")
    return found


def _same(one, other) -> bool:
    if one == other:
        return True
    try:
        return bool(np.allclose(np.array(one, float), np.array(other, float), rtol=SAME, atol=0.0))
    except (TypeError, ValueError):  # no numbers, or of other shapes
        return False


def _shortened(value) -> str:
    text = str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
