"""The O-ring of the examples under a fluid; half of it glued to a flange, until that comes through."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import captioned_files, picture
from figures.seal_files import example
from seal_mdao.loads.pressed_sides import POINTS
from seal_mdao.measures.fluid import BlowOffPressure
from seal_mdao.plotting import section_drawing as section
from seal_mdao.plotting.field import fine_grid
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, VERMILION
from seal_mdao.seals.file.edge_tables import FixedTable

SHARES = 0.0, 0.5, 1.0
"""Of the fluid's pressure, at which the ring is looked at."""
SQUEEZES = 0.25, 0.35, 0.45
"""Of the half ring on its flange, mm."""
FLANGE_PRESSURE = 3750.0
WETTED = 0.5
"""Least weight of a side that is drawn as wetted."""


def make(out: Path, reduced: bool) -> dict:
    """The picture; how much of the pressure is passed on, and what blows off when."""
    file = example("o_ring_under_pressure", reduced)
    ring = sm.analyze(sm.build_seal(file))
    ring.require_converged()
    part = file.profiles[0].stages[0].translate[1] / -0.45
    glued = {part * s: sm.analyze(sm.build_seal(on_flange(file, part * s))) for s in SQUEEZES}
    with (
        captioned_files(file),
        picture(out / "fluid_pressure.png", 2, 2, width=9.6, height=6.6) as panels,
    ):
        _shapes(panels[0], ring)
        _along(panels[1, 0], ring)
        _blow_off(panels[1, 1], glued)
    own, under = (closing(ring, share).max() for share in (SHARES[0], SHARES[-1]))
    blown = [result.value(BlowOffPressure("fluid"))[0] for result in glued.values()]
    return {
        "pressure": f"{ring.term('fluid').pressure:.0f}", "own": f"{own:.0f}",
        "passed": f"{(lid_peak(ring, 1.0) - lid_peak(ring, 0.0)) / ring.term('fluid').pressure:.2f}",
        **{f"blown_{i}": f"{value:.0f}" for i, value in enumerate(blown)}, "under": f"{under:.0f}",
    }  # fmt: skip


def on_flange(file, squeeze):
    """The file without its wall, the middle of the ring glued."""
    lid, fluid = file.profiles[0], file.fluids[0]
    down, rest = lid.stages
    lid = replace(lid, stages=(replace(down, translate=(0.0, -squeeze)), rest))
    measures = tuple(m for m in file.measures if m.arguments.get("profile") != "wall")
    return replace(
        file, symmetries=(), fixed=FixedTable(("middle",)), profiles=(lid,), measures=measures,
        fluids=(replace(fluid, pressure=FLANGE_PRESSURE),),
    )  # fmt: skip


def step_at(result, share) -> int:
    """Number of the load step at which that share of the pressure acts."""
    return int(np.flatnonzero(result.term("fluid").ramp[1:] <= share + 1e-9)[-1])


def closing(result, share) -> np.ndarray:
    """Contact pressure along the edge, kPa."""
    return result.path.at_nominal("fluid")[step_at(result, share)].outputs[:, 1]


def lid_peak(result, share) -> float:
    """Highest contact pressure on the lid, kPa."""
    step, lid = step_at(result, share), result.term("lid")
    gap = result.path.at_nominal("lid")[step].gap
    return float(lid.law.normal_penalty * np.maximum(-gap, 0.0).max())


def _shapes(panels, result):
    fine, pressure = fine_grid(result), result.term("fluid").pressure
    steps = [step_at(result, share) for share in (SHARES[0], SHARES[-1])]
    low, high = section.window(map(fine.deformed, steps))
    for axes, step, value in zip(panels, steps, (0.0, pressure), strict=True):
        section.draw_section(axes, fine, step, facecolor=GREY, alpha=0.25, edgecolor=GREY)
        response = result.path.at_nominal("fluid")[step]
        wetted = np.flatnonzero(response.outputs[:, 0] >= WETTED)
        if value:
            axes.plot(*response.x[: POINTS * wetted[-1] + 1].T, color=BLUE, linewidth=3.5)
        section.frame(axes, low, high)
        axes.set_title(f"fluid {value:.0f} kPa{', wetted where blue' if value else ''}")


def _along(axes, result):
    """Contact pressure along the edge, in the colours of the fluid's."""
    term = result.term("fluid")
    places = term.reference[::POINTS]
    way = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(places, axis=0).T))])
    for share, colour in zip(SHARES, (GREY, BLUE, VERMILION), strict=True):
        pressure = share * term.pressure
        axes.plot(
            way, closing(result, share), ".-", color=colour, label=f"fluid {pressure:.0f} kPa"
        )
        if pressure:
            axes.axhline(pressure, color=colour, linestyle=":", linewidth=1.2)
    axes.set(
        xlabel="distance along the edge from the wet end (mm)", ylabel="contact pressure (kPa)"
    )
    axes.legend(loc="upper left")


def _blow_off(axes, glued):
    """Highest contact pressure over that of the fluid, and where it comes through."""
    for (squeeze, result), colour in zip(glued.items(), CYCLE, strict=False):
        term = result.term("fluid")
        steps = result.path.nominal_steps[step_at(result, 0.0) :]
        pressures = [term.pressure_at(step.fraction) for step in steps]
        highest = [result.response("fluid", step).outputs[:, 1].max() for step in steps]
        axes.plot(pressures, highest, color=colour, label=f"squeeze {squeeze:.3g} mm")
        blown = result.value(BlowOffPressure("fluid"))[0]
        axes.plot(blown, (1.0 + term.share) * blown, "o", color=colour)
    most = np.array([0.0, axes.get_xlim()[1]])
    axes.plot(
        most,
        (1.0 + term.share) * most,
        color=GREY,
        linestyle="--",
        label="1.05 fluid pressure",
    )
    axes.set(xlabel="fluid pressure (kPa)", ylabel="highest contact pressure (kPa)")
    axes.legend(loc="lower right")
