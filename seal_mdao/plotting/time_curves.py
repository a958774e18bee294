"""Forces over time: a row of panels for each profile, a column for each load and its dwells."""

import numpy as np
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator, NullLocator, PercentFormatter

from seal_mdao.analysis.cost import duration
from seal_mdao.plotting.style import GREY, mark_failure, signed, styled, subplots
from seal_mdao.plotting.travel_curves import COMPONENTS, WIDTHS, add_length_axis
from seal_mdao.seals.path_times import StageEnds, times_at
from seal_mdao.seals.profiles import moving_histories, path_stages
from seal_mdao.seals.result import SealResult

DAY, YEAR = 86_400.0, 365.25 * 86_400.0
READABLE = {
    1e-6: "1 µs", 1e-5: "10 µs", 1e-4: "0.1 ms", 1e-3: "1 ms", 1e-2: "10 ms", 0.1: "0.1 s",
    1.0: "1 s", 10.0: "10 s", 60.0: "1 min", 600.0: "10 min", 3600.0: "1 h", DAY: "1 day",
    10.0 * DAY: "10 days", 100.0 * DAY: "100 days", YEAR: "1 year", 10.0 * YEAR: "10 years",
    100.0 * YEAR: "100 years",
}  # fmt: skip
"""Labels of the upper axis, by seconds."""
MOST_LABELS = 8
NARROW = 0.12
"""Part of the logarithmic axis below which a stage has no label."""
HEAD = 0.16
"""Part of the height above the curves, for the names of the stages."""


@styled
def force_over_time(result: SealResult) -> Figure:
    """Plot the force on every profile over the logarithm of time, in the units of ``load_deflection``,
    and on an axis of its own the main component over that at the end of the closing.

    The closing ends with the first stage after which nothing moves. Every load after a dwell begins a
    panel, in which time is counted from its beginning: in the logarithm of the time of the path it could
    not be seen. Dotted lines are ends of stages.

    Parameters
    ----------
    result : SealResult
        Of a seal whose stages take time; complete, or up to the step at which the path ended.

    Raises
    ------
    ValueError
        For a result without profiles, without any converged step or without times.
    """
    histories, stages = moving_histories(result), path_stages(result.seal)
    if not histories or not len(result.path.nominal_steps):
        raise ValueError(
            "the result has no rigid profile, or no converged load step to draw (result.failure "
            "gives the cause)"
        )
    if stages is None:
        raise ValueError(
            "the force cannot be drawn over time, because no material is viscoelastic and no stage "
            "has a duration; use the curves over travel instead"
        )
    # t after every nominal step, 0 at the start
    fractions = [step.fraction for step in result.path.nominal_steps]
    time = times_at(result.seal, [0.0, *fractions])
    groups = _loads(stages, len(fractions))
    width = WIDTHS[min(len(groups), len(WIDTHS)) - 1] + 0.8
    figure, grid = subplots(
        len(histories), len(groups), width=width, height=0.8 + 3.6 * len(histories), squeeze=False,
        sharey="row", sharex="col",
    )  # fmt: skip
    for history, row in zip(histories, grid, strict=True):
        row[0].set_ylabel(f"force on {history.label} ({result.seal.units.force})")
        for numbers, axes in zip(groups, row, strict=True):
            _draw_load(axes, history, time, stages, numbers, result.seal.units)
        low, high = row[0].get_ylim()
        row[0].set_ylim(low, high + HEAD * (high - low))
        _add_right_axes(row[-1], history, stages, result.seal.units, len(groups))
    for numbers, axes in zip(groups, grid[-1], strict=True):
        since = f" since the beginning of stage {numbers[0] + 1}" if len(groups) > 1 else ""
        axes.set_xlabel(f"time{since} (s)")
    grid[0, 0].legend(loc="best", title="component")
    mark_failure(figure, result)
    return figure


def _loads(stages: StageEnds, n_steps: int) -> list[list[int]]:
    """Group the stages, from 0, that begin within ``n_steps``: loads with the dwells after them."""
    groups = [[0]]
    for number in range(1, int(np.searchsorted(stages.steps, n_steps))):
        # a load after a dwell
        if stages.dwells[number - 1] and not stages.dwells[number]:
            groups.append([])
        groups[-1].append(number)
    return groups


def _draw_load(axes, history, time, stages: StageEnds, numbers, units) -> None:
    """Plot a load and its dwells over the time since its beginning, with the ends of its stages."""
    first = stages.steps[numbers[0]]
    last = min(stages.steps[numbers[-1] + 1], len(history.force))
    since = time[first + 1 : last + 1] - time[first]
    axes.set_xscale("log")
    axes.axhline(0.0, color="black", linewidth=0.8)
    for component, color, style in COMPONENTS:
        own = history.force[first:last, component]
        axes.plot(since, own, color=color, linestyle=style, label=units.directions[component])
    # 30 % of the decades are free for the last number
    decades = np.log10(since[-1] / since[0]) or 1.0
    low, high = since[0] / 10.0 ** (0.03 * decades), since[-1] * 10.0 ** (0.3 * decades)
    axes.set_xlim(low, high)
    _add_readable_axis(axes, low, high)
    _mark_stages(axes, history, time - time[first], stages, numbers)


def _mark_stages(axes, history, since, stages: StageEnds, numbers) -> None:
    """Mark the ends of stages with the main component of the force, and write their durations."""
    main = history.main_component
    color = {component: own for component, own, _ in COMPONENTS}[main]
    closed = _closing_force(history, stages)
    low, high = np.log10(axes.get_xlim())
    for number in numbers:
        begin, end = stages.steps[number], min(stages.steps[number + 1], len(history.force))
        x, force = since[end], history.force[end - 1, main]
        axes.axvline(x, color=GREY, linewidth=0.9, linestyle=":")
        axes.plot(x, force, "o", color=color)
        text = signed(force)
        if closed and number > stages.closing:
            text += f" ({100.0 * force / closed:.0f} %)"
        axes.annotate(
            text, (x, force), xytext=(5, 5), textcoords="offset points", color=color, fontsize=9.0,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.7, "pad": 0.5},
        )  # fmt: skip
        # name and duration in the middle of the stage, in the logarithm of time
        left = np.log10(since[begin]) if since[begin] > 0.0 else low
        right = np.log10(x)
        if right - left > NARROW * (high - low):
            axes.text(
                10.0 ** (0.5 * (left + right)), 0.985,
                f"stage {number + 1}\n{duration(stages.durations[number])}",
                transform=axes.get_xaxis_transform(), ha="center", va="top", color=GREY,
                fontsize=8.5, gid="stage",
            )  # fmt: skip


def _add_readable_axis(axes, low: float, high: float) -> None:
    """Add an axis above with seconds, minutes, hours, days and years."""
    ticks = [time for time in READABLE if low <= time <= high]
    # every k-th label, at most MOST_LABELS
    ticks = ticks[:: -(-len(ticks) // MOST_LABELS) or 1]
    upper = axes.secondary_xaxis("top")
    upper.xaxis.set_major_locator(FixedLocator(ticks))
    upper.xaxis.set_minor_locator(NullLocator())
    upper.set_xticks(ticks, [READABLE[tick] for tick in ticks], fontsize=8.5)


def _closing_force(history, stages: StageEnds) -> float:
    """Return the main component of the force at the end of the closing; zero before it is reached."""
    end = stages.steps[stages.closing + 1]
    return (
        float(history.force[end - 1, history.main_component]) if end <= len(history.force) else 0.0
    )


def _add_right_axes(axes, history, stages: StageEnds, units, columns: int) -> None:
    """Add axes on the right: force over that at the end of the closing, and force per length."""
    closed = _closing_force(history, stages)
    if closed:
        right = axes.secondary_yaxis(
            "right", functions=(lambda f: f / closed, lambda ratio: ratio * closed)
        )
        name = units.directions[history.main_component]
        right.set_ylabel(f"{name} force over that\nat the end of stage {stages.closing + 1}")
        right.yaxis.set_major_formatter(PercentFormatter(1.0, symbol=" %"))
    # beyond the labels of the first one, in widths of the axes, which are narrower in several columns
    beyond = (1.2, 1.28, 1.36)[min(columns, 3) - 1]
    add_length_axis(axes, units, beyond if closed else "right")
