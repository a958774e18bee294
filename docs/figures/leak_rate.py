"""Leak rate by Persson's theory: against simulated rough surfaces, and of a bulb that closes."""

from pathlib import Path

import numpy as np
from verification.rough_contact import simulated

import seal_mdao as sm
from figures.drawing import picture
from figures.seal_files import example, example_seal
from seal_mdao.measures.contact_pressure import PeakPressure
from seal_mdao.measures.leak_rate import LeakRate
from seal_mdao.measures.roughness import Roughness
from seal_mdao.plotting.style import BLUE, GREEN, VERMILION

ROUGH = Roughness(0.01, 1.0 / 4.0, 1.0 / 32.0)
"""Of the simulated surfaces, in units of their period; the result in units of the roughness does not
depend on its size."""
FRACTIONS = np.array([0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
"""Pressures over that of percolation."""
HEIGHTS = {2.0: BLUE, 5.0: GREEN, 10.0: VERMILION}
"""Root-mean-square roughness of the bulb, um."""


def make(out: Path, reduced: bool) -> dict:
    """The picture, and how far the theory is from the simulations."""
    ratios = FRACTIONS * ROUGH.percolation_ratio
    n, seeds = (64, 1) if reduced else (256, 3)
    found = np.array([simulated(ROUGH, n, seed, ratios) for seed in range(seeds)])
    bulb = sm.analyze(example_seal(example("d_bulb", reduced), reduced))
    bulb.require_converged()
    with picture(out / "leak_rate.png", 1, 2, width=9.6, height=3.8) as panels:
        _simulations(panels[0], found)
        _closing(panels[1], bulb)
    theory = ROUGH.constriction(ratios)[0]
    # leak rates go with the third power of the height; the mean of several surfaces
    factors = theory**3 / (found[:, :, 2] ** 3).mean(axis=0)
    areas = found[:, :, 0].mean(axis=0) / ROUGH.contact_area(ratios)
    return {
        "least": f"{factors.min():.1f}", "most": f"{factors.max():.1f}",
        "decades": f"{np.log10((theory[0] / theory[-1]) ** 3):.1f}",
        "area_low": f"{areas.min():.1f}", "area_high": f"{areas.max():.1f}",
        "surfaces": f"{seeds}", "points": f"{n}",
        "peak": f"{bulb.value(PeakPressure('door'))[0]:.0f}",
    }  # fmt: skip


def _simulations(axes, found) -> None:
    """Height of the slit that conducts as the interface, over pressure."""
    fine, size = np.linspace(0.02, 0.75, 200), ROUGH.rms_roughness
    theory = ROUGH.constriction(fine * ROUGH.percolation_ratio)[0] / size
    axes.semilogy(fine, theory, color=BLUE, label="theory, $u_c$")
    for number, surface in enumerate(found):
        label = {"label": "simulated surfaces"} if number == 0 else {}
        axes.semilogy(FRACTIONS, surface[:, 2] / size, "o", color=VERMILION, **label)
    axes.set(xlabel="pressure / pressure of percolation", ylabel="height / rms roughness")
    axes.set_ylim(0.02, 3.0)
    axes.legend()


def _closing(axes, bulb) -> None:
    """Leak rate of a bulb over travel, for several heights of its roughness."""
    parts = list(bulb.up_to_each_step())
    for rms, color in HEIGHTS.items():
        own = LeakRate("door", rms, 500.0, 1.0, 10.0)
        rates = np.array([float(part.value(own)[0]) for part in parts])
        rates[~np.isfinite(rates) | (rates <= 0.0)] = np.nan
        axes.semilogy(bulb.travel, rates, color=color, label=f"{rms:g} µm")
    axes.set(xlabel="travel of the door (mm)", ylabel="leak rate (mm³/s per m)")
    axes.legend(title="rms roughness")
