"""The bulb of the examples with its hole sealed and open."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import picture
from figures.seal_files import example
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import BLUE, GREY, VERMILION


def make(out: Path, reduced: bool) -> dict:
    """The picture, and what the air does."""
    file = example("sealed_bulb", reduced)
    sealed, vented = (sm.analyze(sm.build_seal(f)) for f in (file, without_air(file)))
    for result in (sealed, vented):
        result.require_converged()
    _picture(out / "trapped_air.png", sealed, vented)
    pressure, area = sealed.response("air").outputs[0]
    forces = [abs(result.path.reaction("door")[-1, 1]) for result in (sealed, vented)]
    nominal = sealed.term("air").nominal_area
    return {
        "pressure": f"{pressure:.1f}", "area": f"{100 * (1 - area / nominal):.0f}",
        "sealed": f"{forces[0]:.0f}", "vented": f"{forces[1]:.0f}",
    }  # fmt: skip


def without_air(file):
    """The file with its holes open."""
    measures = tuple(m for m in file.measures if m.type != "cavity_pressure")
    return replace(file, cavities=(), measures=measures)


def _picture(path: Path, sealed, vented) -> None:
    """Both deformed shapes over the undeformed one, and the curves."""
    grids = fine_grid(sealed), fine_grid(vented)
    low, high = section.window([grids[0].undeformed(), *(fine.deformed() for fine in grids)])
    looks = ("sealed", VERMILION), ("open", BLUE)
    ratios = {"width_ratios": [1.0, 1.0, 1.1]}
    with picture(path, 1, 3, width=11.0, height=3.7, gridspec_kw=ratios) as panels:
        for axes, fine, (name, color) in zip(panels[:2], grids, looks, strict=True):
            dashed = {"color": GREY, "linewidth": 0.8, "linestyle": "--"}
            section.draw_outline(axes, fine.undeformed(), fine.loops, **dashed)
            section.draw_section(axes, fine, -1, facecolor=color, alpha=0.35, edgecolor=color)
            section.frame(axes, low, high)
            axes.set_title(f"hole {name}")
        _curves(panels[2], sealed, vented)


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
    axes.set(xlabel="travel (mm)", ylabel="force (N/m)")
    beside = axes.twinx()
    beside.spines["right"].set_visible(True)
    beside.grid(False)
    pressures = [0.0, *(response.outputs[0, 0] for response in sealed.path.at_nominal("air"))]
    beside.plot(travel, pressures, color=GREY, linestyle="--", label="pressure")
    beside.set_ylabel("pressure of the air (kPa)")
    axes.set(xlim=(0.0, None), ylim=(0.0, None))
    beside.set_ylim(0.0, None)
    lines = [*axes.get_lines(), *beside.get_lines()]
    axes.legend(lines, [line.get_label() for line in lines], loc="upper left")
