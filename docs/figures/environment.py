"""Radial force of the lip seal over the temperature, and force of the strip over its axial stretch."""

from pathlib import Path

import numpy as np

import seal_mdao as sm
from figures.drawing import picture
from figures.seal_files import example, example_seal
from seal_mdao.plotting.style import BLUE, VERMILION

TEMPERATURES = np.array([-25.0, 0.0, 23.0, 50.0, 80.0, 110.0])
STRETCHES = np.array([1.0, 1.02, 1.04, 1.06, 1.08])


def make(out: Path, reduced: bool) -> dict:
    """The picture, and the changes that the page names."""
    lip, strip = (
        example_seal(example(n, reduced), reduced) for n in ("shaft_lip", "stretched_strip")
    )
    hot = _forces(lip, "temperature", TEMPERATURES[1:4] if reduced else TEMPERATURES)
    longer = _forces(strip, "axial_stretch", STRETCHES[1:4] if reduced else STRETCHES)
    with picture(out / "environment.png", 1, 2, width=9.6, height=3.8) as panels:
        _draw(panels[0], hot, "temperature (°C)", "radial force of the lip (N)")
        _draw(panels[1], longer, "axial stretch", "force of the strip (N/m)")
    return {
        "cold": f"{hot[1][0] / hot[1][2 - reduced]:.2f}",
        "coldest": f"{hot[0][0]:.0f}",
        "hot": f"{hot[1][-1] / hot[1][2 - reduced]:.2f}", "hottest": f"{hot[0][-1]:.0f}",
        "longer": f"{100.0 * (longer[1][-1] / longer[1][0] - 1.0):.0f}",
        "longest": f"{100.0 * (longer[0][-1] - longer[0][0]):.0f}",
    }  # fmt: skip


def _forces(seal, name: str, values: np.ndarray):
    """Values, forces at the end, and their exact derivatives, of the first measure."""
    measure = seal.standard[0]
    found = [sm.analyze(seal, None, {name: value}) for value in values]
    forces = np.array([abs(result.value(measure)[0]) for result in found])
    slopes = np.array([
        float(np.ravel(sm.differentiate(result, (name,), (measure,))[measure.name])[-1])
        * np.sign(result.value(measure)[0])
        for result in found
    ])  # fmt: skip
    return values, forces, slopes


def _draw(axes, found, across: str, along: str) -> None:
    """Forces, and tangents at them of the length of a third of the distance to the next point."""
    values, forces, slopes = found
    axes.plot(values, forces, "o", color=BLUE, label="analyses")
    half = np.diff(values).min() / 3.0
    for number, (at, force, slope) in enumerate(zip(values, forces, slopes, strict=True)):
        label = {"label": "exact derivatives"} if number == 0 else {}
        ends = np.array([-half, half])
        axes.plot(at + ends, force + slope * ends, color=VERMILION, linewidth=2, **label)
    axes.set(xlabel=across, ylabel=along)
    axes.legend()
