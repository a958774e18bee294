"""The lip of the examples bent over a corner and let go, with friction and without."""

from dataclasses import replace
from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.seal_files import begun
from seal_mdao.measures.work import FrictionWork
from seal_mdao.plotting.style import BLUE, GREY, VERMILION, save, styled, subplots

FILE = Path(__file__).resolve().parents[2] / "examples" / "lip.toml"
FRICTIONS = {0.0: GREY, 0.15: BLUE, 0.3: VERMILION}


def make(out: Path, reduced: bool) -> dict:
    """The loops, and what friction takes from each."""
    file = sm.read_seal_file(FILE)
    file = begun(file) if reduced else file
    results = {friction: sm.analyze(sm.build_seal(cycle(file, friction))) for friction in FRICTIONS}
    for result in results.values():
        result.require_converged()
    save(loops(results), out / "hysteresis.png")
    lost = [result.value(FrictionWork())[0] for result in results.values()]
    return {f"lost_{i}": f"{abs(value):.2g}" for i, value in enumerate(lost)}


def cycle(file, friction):
    """The file with the panel going back all the way that it came."""
    panel = file.profiles[0]
    there = panel.stages[0]
    back = replace(there, translate=tuple(-x for x in there.translate))
    return replace(file, profiles=(replace(panel, friction=friction, stages=(there, back)),))


@styled
def loops(results):
    """Force on the panel over its way there and back."""
    figure, axes = subplots(width=6.0, height=3.6)
    for friction, result in results.items():
        motion, steps = result.term("panel").motion, len(result.path.nominal_steps)
        places = np.array([motion.pose(float(n)).position[0] for n in range(steps + 1)])
        force = np.append(0.0, np.abs(result.path.reaction("panel")[:, 0]))
        half, colour = steps // 2, FRICTIONS[friction]
        way = np.abs(places - places[0])
        axes.plot(way[: half + 1], force[: half + 1], color=colour, label=f"friction {friction:g}")
        axes.plot(way[half:], force[half:], color=colour, linestyle="--")
    axes.set_xlabel("travel of the panel (mm)")
    axes.set_ylabel("horizontal force (N/m)")
    axes.legend(title="solid: there, dashed: back")
    return figure
