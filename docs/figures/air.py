"""The bulb of the examples with its hole sealed, open and with vents."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import captioned_files, picture
from figures.seal_files import example
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import BLUE, GREEN, GREY, VERMILION


def make(out: Path, reduced: bool) -> dict:
    """The picture, and what the air does."""
    file = example("sealed_bulb", reduced)
    files = file, without_air(file), example("vented_bulb", reduced)
    sealed, opened, vented = (sm.analyze(sm.build_seal(f)) for f in files)
    for result in (sealed, opened, vented):
        result.require_converged()
    with captioned_files(file):
        _picture(out / "trapped_air.png", sealed, opened)
    with captioned_files(file, files[2]):
        _vents(out / "vented_air.png", {"sealed": sealed, "vents": vented, "open": opened})
    pressure, area = sealed.response("air").outputs[0]
    left, _ = vented.response("air").outputs[0]
    forces = [abs(result.path.reaction("door")[-1, 1]) for result in (sealed, opened, vented)]
    nominal = sealed.term("air").nominal_volume
    return {
        "pressure": f"{pressure:.1f}", "area": f"{100 * (1 - area / nominal):.0f}",
        "sealed": f"{forces[0]:.0f}", "open": f"{forces[1]:.0f}", "vented": f"{forces[2]:.0f}",
        "vented_pressure": f"{left:.1f}",
        "lost": f"{100.0 * (1.0 - vented.response('air').history.mass):.0f}",
    }  # fmt: skip


def without_air(file):
    """The file with its holes open."""
    measures = tuple(m for m in file.measures if m.type != "cavity_pressure")
    return replace(file, cavities=(), measures=measures)


def _picture(path: Path, sealed, opened) -> None:
    """Both deformed shapes over the undeformed one, and the curves."""
    grids = fine_grid(sealed), fine_grid(opened)
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
        _curves(panels[2], sealed, opened)


def _vents(path: Path, results: dict) -> None:
    """Pressure and force over travel for a sealed hole, one with vents and an open one."""
    with picture(path, 1, 2, width=9.0, height=3.5) as (pressures, forces):
        for (name, result), colour in zip(results.items(), (VERMILION, GREEN, BLUE), strict=True):
            travel = _travel(result)
            if name != "open":
                found = [response.outputs[0, 0] for response in result.path.at_nominal("air")]
                pressures.plot(travel, [0.0, *found], color=colour, label=name)
            force = np.append(0.0, result.path.reaction("door")[:, 1])
            forces.plot(travel, force, color=colour, label=name)
        pressures.set(xlabel="travel (mm)", ylabel="pressure of the air (kPa)")
        forces.set(xlabel="travel (mm)", ylabel="force (N/m)")
        for axes in (pressures, forces):
            axes.set(xlim=(0.0, None), ylim=(0.0, None))
            axes.legend(loc="upper left")


def _travel(result) -> list:
    """Of the door, at the start and after every nominal step, mm."""
    motion = result.term("door").motion
    fractions = [0.0, *(step.fraction for step in result.path.nominal_steps)]
    return [motion.pose(0.0).position[1] - motion.pose(f).position[1] for f in fractions]


def _curves(axes, sealed, opened):
    """Force and pressure over the door's travel."""
    travel = _travel(sealed)
    for result, name, colour in (
        (sealed, "force, sealed", VERMILION),
        (opened, "force, open", BLUE),
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
