"""Pictures of what happens at the profiles: a row for each, a column for each course of its motion."""

import numpy as np

from seal_mdao.plotting.style import subplots
from seal_mdao.seals.profiles import profile_histories
from seal_mdao.seals.result import SealResult

WIDTHS = (6.6, 9.0, 11.0)
"""Of figures with one, two or more columns, inches."""


def course_panels(result: SealResult, text: str):
    """A figure with axes for every course of every profile; those of a row share their y axis.

    Parameters
    ----------
    result : SealResult
    text : str
        Of the y axes, with a place for the name of the profile.

    Returns
    -------
    figure : Figure
    panels : list of (ProfileHistory, Course, Axes, bool)
        With whether the axes are the last of their row.

    Raises
    ------
    ValueError
        For a result without profiles or without any converged step.
    """
    histories = profile_histories(result)
    if not histories or not len(histories[0].stage):
        raise ValueError("the result has no profile, or no converged load step to draw")
    columns = max(len(history.courses) for history in histories)
    figure, grid = subplots(
        len(histories), columns, width=WIDTHS[min(columns, len(WIDTHS)) - 1],
        height=0.6 + 3.4 * len(histories), squeeze=False, sharey="row",
    )  # fmt: skip
    panels = []
    for history, row in zip(histories, grid, strict=True):
        row[0].set_ylabel(text.format(history.label))
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
    """Travel (k + 1,) and values (k + 1, ...) of a course with the state in which it begins.

    Parameters
    ----------
    course : Course
    values : ndarray, shape (n, ...)
        At every nominal step; zero before the first.
    """
    before = np.concatenate([np.zeros_like(values[:1]), values])
    begun = slice(course.steps.start, course.steps.stop + 1)
    return np.append(course.begin, course.along), before[begun]
