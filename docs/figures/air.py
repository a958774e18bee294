"""The bulb of the examples with its hole sealed and open."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.seal_files import begun
from seal_mdao.plotting import field
from seal_mdao.plotting.section import (
    draw_held,
    draw_profiles,
    fill_outline,
    frame,
    window,
)
from seal_mdao.plotting.style import BLUE, GREY, VERMILION, save, styled, subplots

FILE = Path(__file__).resolve().parents[2] / "examples" / "sealed_bulb.toml"


def make(out: Path, reduced: bool) -> dict:
    """The picture, and what the air does."""
    file = sm.read_seal_file(FILE)
    file = begun(file) if reduced else file
    sealed, vented = (sm.analyze(sm.build_seal(f)) for f in (file, without_air(file)))
    for result in (sealed, vented):
        result.require_converged()
    save(air_picture(sealed, vented), out / "trapped_air.png")
    pressure, area = sealed.response("air").outputs[0]
    forces = [abs(result.path.reaction("door")[-1, 1]) for result in (sealed, vented)]
    drawn = sealed.term("air").drawn_area
    return {
        "pressure": f"{pressure:.1f}", "area": f"{100 * (1 - area / drawn):.0f}",
        "sealed": f"{forces[0]:.0f}", "vented": f"{forces[1]:.0f}",
    }  # fmt: skip


def without_air(file):
    """The file with its holes open."""
    measures = tuple(m for m in file.measures if m.type != "cavity_pressure")
    return replace(file, cavities=(), measures=measures)


@styled
def air_picture(sealed, vented):
    figure, (left, middle, right) = subplots(
        1, 3, width=11.0, height=3.7, gridspec_kw={"width_ratios": [1.0, 1.0, 1.1]}
    )
    shapes = [(sealed, "sealed", VERMILION), (vented, "open", BLUE)]
    fine = field.fine_grid(sealed)
    low, high = window(
        [field.undeformed(sealed, fine), *(field.deformed(r, fine, -1) for r, *_ in shapes)]
    )
    for axes, (result, name, colour) in zip((left, middle), shapes, strict=True):
        for loop in fine.loops:
            x, y = field.undeformed(result, fine)[np.append(loop, loop[0])].T
            axes.plot(x, y, color=GREY, linewidth=0.8, linestyle="--")
        fill_outline(
            axes, field.deformed(result, fine, -1), fine.loops, facecolor=colour, alpha=0.35,
            edgecolor=colour,
        )  # fmt: skip
        draw_held(axes, result)
        draw_profiles(axes, result, result.path.steps[-1].fraction)
        frame(axes, low, high)
        axes.set_title(f"hole {name}")
    _curves(right, sealed, vented)
    return figure


def _curves(axes, sealed, vented):
    """Force and pressure over the door's travel."""
    motion = sealed.term("door").motion
    fractions = [0.0, *(step.fraction for step in sealed.path.nominal_steps)]
    travel = [motion.pose(0.0).position[1] - motion.pose(f).position[1] for f in fractions]
    for result, name, colour in (
        (sealed, "force, sealed", VERMILION),
        (vented, "force, open", BLUE),
    ):
        force = np.append(0.0, result.path.reaction("door")[:, 1])
        axes.plot(travel, force, color=colour, label=name)
    axes.set_xlabel("travel (mm)")
    axes.set_ylabel("force (N/m)")
    beside = axes.twinx()
    beside.spines["right"].set_visible(True)
    beside.grid(False)
    pressures = [0.0, *(response.outputs[0, 0] for response in sealed.path.at_nominal("air"))]
    beside.plot(travel, pressures, color=GREY, linestyle="--", label="pressure")
    beside.set_ylabel("pressure of the air (kPa)")
    for own in (axes, beside):
        own.set_ylim(0.0, None)
    axes.set_xlim(0.0, None)
    lines = [*axes.get_lines(), *beside.get_lines()]
    axes.legend(lines, [line.get_label() for line in lines], loc="upper left")
