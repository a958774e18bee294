"""Animation of a seal that closes: deformed section with stress and load-deflection curve."""

from functools import partial
from pathlib import Path

import numpy as np
from matplotlib.animation import FFMpegWriter, HTMLWriter, PillowWriter

from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.several_seals import draw_forces, force_against_travel
from seal_mdao.plotting.style import BLUE, VERMILION, add_caption, styled, subplots
from seal_mdao.seals.result import SealResult

MOST_FRAMES = 80
"""Load steps that are drawn at most; of more, evenly spread ones."""
HOLD = 12
"""Times that the last frame is repeated."""
WRITERS = {
    ".gif": (PillowWriter, 90), ".mp4": (FFMpegWriter, 130),
    ".html": (partial(HTMLWriter, embed_frames=True), 100),
}  # fmt: skip
"""Writer and dots per inch of every file format."""


def check_format(path: Path) -> None:
    """Check that an animation can be written to a path.

    Raises
    ------
    ValueError
        For another format, or mp4 without ffmpeg.
    """
    if path.suffix not in WRITERS:
        raise ValueError(
            f"{path}: unknown file format of an animation; the name must end with "
            f"{' or '.join(WRITERS)}"
        )
    if path.suffix == ".mp4" and not FFMpegWriter.isAvailable():
        raise ValueError(
            f"{path}: an mp4 animation needs the program ffmpeg, which was not found; install "
            "ffmpeg, or use .gif or .html"
        )


@styled
def save_animation(
    result: SealResult, path: Path, frames_per_second: int = 12, callback=None
) -> Path:
    """Write an animation of a path: von Mises stress on the section, force against travel beside it.

    Parameters
    ----------
    result : SealResult
        With at least one converged step.
    path : Path
        Ending in .gif, .mp4 or .html.
    frames_per_second : int
    callback : callable, optional
        Called with the number of the frame, from 0, and the number of frames.

    Returns
    -------
    Path

    Raises
    ------
    ValueError
        As ``check_format``; for a result without converged steps or without profiles.
    """
    check_format(path)
    count = len(result.path.nominal_steps)
    if count == 0:
        raise ValueError(
            "the result has no converged load step to draw; result.failure gives the cause"
        )
    steps = np.unique(np.linspace(0, count - 1, min(count, MOST_FRAMES)).round().astype(int))
    fine = fine_grid(result)
    scales = section.stress_scales([fine], steps)
    low, high = section.window([fine.undeformed(), *map(fine.deformed, steps)], seal=result.seal)
    width, height = section.panel_size(low, high)
    bars = section.BAR_WIDTH * len(scales)
    figure, (left, right) = subplots(
        1, 2, width=1.1 * width + 4.7 + bars, height=max(1.1 * height, 3.6)
    )
    draw_forces(right, {"": result}, {"": BLUE})
    # points of the curve at the start of the path and after each step
    travel, force, ends, _ = force_against_travel(result)
    (marker,) = right.plot([], [], "o", color=VERMILION)

    def draw(step: int):
        left.clear()
        section.draw_stress(left, fine, step, scales)
        section.frame(left, low, high, result.seal)
        left.set_title(result.caption(step))
        here = ends[step + 1]
        marker.set_data(travel[here : here + 1], force[here : here + 1])

    contours = section.draw_stress(left, fine, count - 1, scales)
    section.draw_colorbars(figure, left, contours, fine, shrink=0.8, pad=0.02)
    add_caption(figure)
    # layout of the last frame for all frames: each layout takes as long as drawing
    draw(count - 1)
    figure.draw_without_rendering()
    figure.set_layout_engine("none")
    frames = [*steps.tolist(), *[count - 1] * HOLD]
    make_writer, dpi = WRITERS[path.suffix]
    writer = make_writer(fps=frames_per_second)
    # each frame is drawn once; ``FuncAnimation.save`` draws it twice
    with writer.saving(figure, path, dpi):
        for number, step in enumerate(frames):
            draw(step)
            writer.grab_frame()
            if callback is not None:
                callback(number, len(frames))
    return path
