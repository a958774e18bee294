"""Branches of the door seal without friction, and the snap of a shallow arch."""

from pathlib import Path

import numpy as np
from verification.patch import squeeze
from verification.shallow_arch import critical_load, press_arch

from figures.drawing import DOOR_SEAL, captioned_body, picture
from figures.tables import percent, table
from seal_mdao import plotting
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.materials.mooney_rivlin import MooneyRivlin
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.style import BLUE, GREY, LIGHT_GREY, VERMILION
from seal_mdao.seals.door.door_seal import door_seal, with_options
from seal_mdao.seals.result import analyze

CORNERS, SHOWN = (0.0, 2.0, 4.0), 2.0
RISES = (2.0, 3.0)
CLOUDS = ((58, 3), (116, 5), (174, 5), (232, 5))
FIRST_DEPTH = 4.9
"""mm; the upright branch has ended there."""


def make(out: Path, reduced: bool) -> dict:
    """Pictures and numbers."""
    numbers = _flat(out, reduced) | _corners(out, reduced) | _clouds(reduced) | _arch(out, reduced)
    return numbers | _block(reduced)


@captioned(DOOR_SEAL)
def _flat(out, reduced) -> dict:
    seal = door_seal(door="flat", friction=0.0, n_steps=60 if reduced else 105)
    stable = analyze(seal)
    upright = analyze(with_options(seal, newton=NewtonOptions(branch="primary")))
    _branches(out / "stability_branches.png", stable, upright)
    return {
        "stable_force": f"{stable.reaction[-1, 1]:.1f}",
        "upright_force": f"{upright.reaction[-1, 1]:.1f}",
        "first_travel": f"{stable.critical_points[0].travel:.2f}",
    }


def _branches(path: Path, stable, upright) -> None:
    first = [point.travel for point in stable.critical_points]
    at_loss = np.interp(first, stable.travel, stable.reaction[:, 1])
    with picture(path, width=6.0, height=3.8) as axes:
        force = upright.reaction[:, 1]
        axes.plot(upright.travel, force, "--", color=GREY, label="upright, not stable")
        axes.plot(stable.travel, stable.reaction[:, 1], color=BLUE, label="stable")
        hollow = {"color": "black", "markerfacecolor": "white", "zorder": 5}
        axes.plot(first, at_loss, "D", label="stability lost", **hollow)
        axes.set(xlim=(0.0, 10.5), ylim=(0.0, None), xlabel="door travel (mm)")
        axes.set_ylabel("force on the flat door without friction (N/m)")
        axes.legend(loc="upper left")


@captioned(DOOR_SEAL)
def _corners(out, reduced) -> dict:
    rows = []
    for corner in CORNERS[1:2] if reduced else CORNERS:
        result = analyze(door_seal(friction=0.0, corner_x=corner))
        points = result.critical_points
        if corner == SHOWN:
            plotting.save(plotting.critical_modes(result), out / "stability_modes.png")
        largest = max(points, key=lambda point: point.released)
        rows.append([
            f"{corner:g}", f"{points[0].travel:.2f}", str(len(points)), f"{largest.travel:.2f}",
            f"{largest.released:.2f}", f"{result.reaction[-1, 1]:.1f}",
        ])  # fmt: skip
    head = [
        "`corner_x` (mm)", "first critical travel (mm)", "critical points",
        "travel at the largest jump (mm)", "its released energy (mJ/m)", "force at 10 mm (N/m)",
    ]  # fmt: skip
    return {"corner_table": table(head, rows)}


def _clouds(reduced) -> dict:
    rows = []
    for rays, layers in CLOUDS[:1] if reduced else CLOUDS:
        seal = door_seal(
            door="flat", friction=0.0, rays=rays, layers=layers, depth=FIRST_DEPTH, n_steps=54
        )
        points = analyze(seal).critical_points
        rows.append([f"{rays} × {layers}", ", ".join(f"{p.travel:.2f}" for p in points)])
    return {"cloud_table": table(["particles", "critical travel (mm), up to 4.9 mm"], rows)}


@captioned_body("shallow arch")
def _arch(out, reduced) -> dict:
    rows, arches = [], []
    for rise in RISES:
        arch = press_arch(rise, (60, 4) if reduced else (100, 4))
        arches.append(arch)
        first = arch.path.critical_points[0]
        rows.append([
            f"{rise:g}", "snaps" if first.kind == "limit" else "sways", f"{critical_load(rise):.3f}",
            percent(arch.load - 1.0),
        ])  # fmt: skip
    _shapes(out / "stability_arch.png", arches)
    head = ["rise", "instability", "R of Fung and Kaplan", "error of the load"]
    return {"arch_table": table(head, rows), "arch_energy": percent(arches[0].released - 1.0)}


def _block(reduced) -> dict:
    """Stretch at which the free sides of a block wrinkle."""
    block = squeeze(MooneyRivlin(0.4, 0.1, 1000.0), n_steps=5 if reduced else 20)
    first = next(i for i, step in enumerate(block.path.nominal_steps) if not step.stable)
    return {"wrinkled": f"{block.stretch[first]:.2f}"}


def _shapes(path: Path, arches) -> None:
    """Middle lines of the arches before the first critical point, their mode, and after."""
    with picture(path, len(arches), 1, width=6.2, height=3.8, squeeze=False, sharex=True) as panels:
        for axes, arch, rise in zip(panels[:, 0], arches, RISES, strict=True):
            disc, first = arch.path.discretization, arch.path.critical_points[0]
            rows = int(disc.body.cells[0, 1])  # particles are numbered column by column
            middle = np.arange(rows // 2, disc.body.n_particles, rows)
            k = int(first.fraction) - 1
            before, after = (
                (disc.particles + arch.path.displacement(step))[middle] for step in (k, k + 1)
            )
            wide = {"color": LIGHT_GREY, "linewidth": 3.0, "label": "undeformed"}
            axes.plot(*disc.particles[middle].T, **wide)
            axes.plot(*before.T, color="black", label="before")
            mode = before + 0.5 * first.mode[middle]
            axes.plot(*mode.T, "--", color=VERMILION, label="critical mode")
            axes.plot(*after.T, color=BLUE, label="after")
            axes.set(ylabel="y over the thickness", title=f"rise {rise:g}")
        panels[-1, 0].set_xlabel("x over the thickness")
        panels[0, 0].legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
