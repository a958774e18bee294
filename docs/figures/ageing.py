"""The optimum for a force after ten years beside that for the same force of the closed seal."""

from pathlib import Path

import numpy as np
from verification.example_optima import BLIND, LIMITED, stored

import seal_mdao as sm
from figures.drawing import captioned_files, picture
from figures.seal_files import example, example_seal, sketched
from figures.tables import table
from seal_mdao.plotting.style import BLUE, GREY, VERMILION
from seal_mdao.plotting.time_curves import READABLE
from seal_mdao.seals.path_times import times_at

NAME, _ = LIMITED[BLIND]
SHOWN = {
    f"after ten years ({NAME})": (NAME, BLUE, "-"),
    "at closing": (BLIND, VERMILION, "--"),
}
"""Time of the limit: the stored optimum, color and line."""
MEASURES = "section_area", "closing_force", "force_after_ten_years"
TICKS = 1.0, 60.0, 3600.0, 86_400.0, 365.25 * 86_400.0, 10.0 * 365.25 * 86_400.0


def make(out: Path, reduced: bool) -> dict:
    """The picture, and the table of both optima."""
    file = example(NAME, reduced)
    seal = example_seal(file, reduced)
    limit = file.optimize.constraints[0].lower
    rows = []
    with (
        captioned_files(file),
        picture(out / "ten_year_optima.png", width=6.4, height=3.6) as axes,
    ):
        axes.axhline(limit, color=GREY, linewidth=0.9, linestyle=":")
        for when, (stem, color, line) in SHOWN.items():
            offsets = sketched(file, seal)[0] if reduced else np.array(stored()[stem]["offsets"])
            result = sm.analyze(seal, offsets)
            result.require_converged()
            time = times_at(seal, range(1, seal.n_steps + 1))
            force = result.path.reaction("door")[:, 1]
            axes.plot(time, force, line, color=color, label=f"limit {when.split(' (')[0]}")
            for at in (int(np.argmax(force)), -1):
                axes.annotate(
                    f"{force[at]:.1f}", (time[at], force[at]), xytext=(4, 4), color=color,
                    textcoords="offset points",
                )  # fmt: skip
            values = [result.value(name)[0] for name in MEASURES]
            rows.append([when, *(f"{value:.4g}" for value in values)])
        axes.set_xscale("log")
        axes.set_xticks(TICKS, [READABLE[tick] for tick in TICKS])
        axes.minorticks_off()
        axes.set(xlabel="time", ylabel="force on door (N/m)", xlim=(0.1, 5.0 * TICKS[-1]))
        axes.set_ylim(0.0, 1.1 * axes.get_ylim()[1])
        axes.legend()
    head = (
        "limit on the force", "area (mm²)", "force at closing (N/m)",
        "force after ten years (N/m)",
    )  # fmt: skip
    return {"optima": table(head, rows)}
