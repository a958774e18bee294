"""Panels of curves over travel: a row for each profile, a column for each load-unload segment."""

import numpy as np

from seal_mdao.plotting.style import subplots
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.seals.result import SealResult

WIDTHS = (6.6, 9.0, 11.0)
"""Widths of figures with one, two or three and more columns, inches."""


def course_panels(result: SealResult, text: str):
    """Create a figure with axes for every load-unload segment of every profile.

    Axes of a row share their y axis.

    Parameters
    ----------
    result : SealResult
    text : str
        Label of the y axes, with {} for the name of the profile.

    Returns
    -------
    figure : Figure
    panels : list of (ProfileHistory, Course, Axes, bool)
        The flag marks the last axes of a row.

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    histories = profile_histories(result)
    if not histories or not len(histories[0].stage):
        raise ValueError("the result has no profile, or no converged load step to draw")
    # one grid for all profiles: as many columns as the longest row needs
    columns = max(len(history.courses) for history in histories)
    figure, grid = subplots(
        len(histories), columns, width=WIDTHS[min(columns, len(WIDTHS)) - 1],
        height=0.6 + 3.4 * len(histories), squeeze=False, sharey="row",
    )  # fmt: skip
    panels = []
    for history, row in zip(histories, grid, strict=True):
        row[0].set_ylabel(text.format(history.label))
        # profiles may have different numbers of load-unload segments
        for axes in row[len(history.courses) :]:
            axes.set_visible(False)
        for number, (course, axes) in enumerate(zip(history.courses, row, strict=False), start=1):
            _label(axes, history, course)
            panels.append((history, course, axes, number == len(history.courses)))
    if not result.converged:
        figure.suptitle("path not completed: up to the last converged step", fontsize=10.5)
    return figure, panels


def _label(axes, history, course) -> None:
    axes.set_xlabel("turn (°)" if course.turns else "travel (mm)")
    if len(history.courses) > 1 or len(course.stages) > 1:
        numbers = ", ".join(map(str, course.stages))
        axes.set_title(f"stage{'s' if len(course.stages) > 1 else ''} {numbers}", fontsize=9.5)
    room = 0.2 * (np.ptp(course.along) or 1.0)
    low, high = min(course.begin, course.along.min()), max(0.0, course.along.max())
    axes.set_xlim(low - room * (low < course.begin), high + room)


def with_start(course, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return travel (k + 1,) and values (k + 1, ...) of a load-unload segment with its initial state.

    Parameters
    ----------
    course : Course
    values : ndarray, shape (n, ...)
        At every nominal step; zero before the first.
    """
    # before[k]: values at the beginning of step k; the segment begins at the end of the step before it
    before = np.concatenate([np.zeros_like(values[:1]), values])
    begun = slice(course.steps.start, course.steps.stop + 1)
    return np.append(course.begin, course.along), before[begun]
