"""Continue a recorded optimisation, of any OpenMDAO problem."""

import openmdao.api as om

from seal_mdao import openmdao_access as access
from seal_mdao import values
from seal_mdao.recording.evaluations import RecordedEvaluations
from seal_mdao.recording.recorded_setup import require_same_setup
from seal_mdao.recording.recorder import RestartRecorder, record_all


def restart(problem, path) -> None:
    """Make ``problem.run_driver()`` continue the run recorded in ``path``.

    The driver begins at the recorded start and takes the values and derivatives of all recorded
    points from the file, which brings it to the last recorded point as it was there; new cases are
    appended to the file. Call it after ``setup``, and with no other recorder on the driver, for the
    problem and driver that wrote the file.

    Parameters
    ----------
    problem : Problem
    path : str or Path
        As it was given to the recorder: a bare name is in the problem's output folder.
        File of a ``RestartRecorder`` or ``SqliteRecorder``, which has recorded the derivatives
        (``recording_options["record_derivatives"]``). Without them every point is analysed again.

    Raises
    ------
    TypeError
        For no problem, or one whose driver is neither UnoDriver nor IpoptDriver.
    RestartError
        A ValueError: when the file cannot be read, or is not that of this problem: another driver,
        other design variables or responses, other bounds or scaling, each named. That it is not that
        of this model shows when the run begins.

    Warns
    -----
    RestartWarning
        For other options of the driver; those that end a run may be changed.
    """
    values.instance("problem", problem, om.Problem)
    driver = problem.driver
    if "hotstart_file" not in driver.options:
        raise TypeError(
            f"only UnoDriver and IpoptDriver can continue a run, not {type(driver).__name__}; "
            "Problem.load_case takes any driver to a recorded point, from which it begins anew"
        )
    problem.final_setup()
    path = access.recorder_path(problem, path)
    recorded = RecordedEvaluations(path, driver)
    require_same_setup(path, driver)
    recorded.load_start()
    driver.options["hotstart_file"] = str(path)
    record_all(driver, RestartRecorder(path, append=True))
