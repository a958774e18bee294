"""Benchmarks with exact solutions: patch, contact patch, compression, cylinder, rotation, flexure."""

from pathlib import Path

import numpy as np
from verification.bodies import Grid, scattered
from verification.contact_patch import pressed, slid
from verification.cylinder import inflate_cylinder, inflation_pressure
from verification.flexure import bend_block
from verification.patch import GRADIENT, compress_block, patch_test
from verification.rotation import rotate_body, rotation_matrix

from figures.drawing import captioned_body, curves, picture
from figures.tables import percent, power, table
from seal_mdao.plotting.section_drawing import draw_cells
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, MARKERS, VERMILION

RATIOS = (1e3, 1e4, 1e5, 1e6)


def make(out: Path, reduced: bool) -> dict:
    """Pictures and numbers of the six benchmarks."""
    ratios = RATIOS[:1] if reduced else RATIOS
    numbers = _patch(out) | _contact_patch(out) | _compression(out) | _rotation(out)
    return numbers | _cylinder(out, ratios) | _flexure(out, reduced)


# ---- patch test ----


def _patch(out: Path) -> dict:
    rows, worst = [], 0.0
    for traction in (False, True):
        for order in (1, 2):
            found = patch_test(traction, order)
            worst = max(worst, *found)
            where = "displacements and tractions" if traction else "displacements on all sides"
            basis = ("linear", "quadratic")[order - 1]
            rows.append([where, basis, power(found.displacement), power(found.stress)])
    _patch_picture(out / "patch.png")
    head = ["imposed", "basis", "displacement error", "stress error"]
    return {"patch_table": table(head, rows), "patch": power(worst)}


def _patch_picture(path: Path) -> None:
    grid = Grid(6, 6)
    X = scattered(grid, 0.3, 5)
    with picture(path, width=4.6, height=3.6) as axes:
        for x, color in ((X, GREY), (X @ (np.eye(2) + GRADIENT).T, BLUE)):
            draw_cells(axes, x, grid.cells, color=color, linewidth=0.8)
            axes.plot(*x.T, "o", color=color, markersize=3)
        axes.set_aspect("equal")
        axes.set_axis_off()


# ---- contact patch test ----


@captioned_body("pressed block")
def _contact_patch(out: Path) -> dict:
    found = {kind: pressed(kind, 0.25) for kind in ("particles", "averages")}
    worst = found["averages"].deviation
    for order in (1, 2):
        patch, error = slid("averages", 0.25, order)
        worst = max(worst, pressed("averages", 0.25, order).deviation, patch.deviation, error)
    curves(out / "contact_patch.png", "position along the plate (mm)", "contact pressure / mean", [
        (own.place, own.pressure / own.pressure.mean(), style, color, f"contact at {kind}")
        for (kind, own), style, color in zip(
            found.items(), ("s--", "o-"), (VERMILION, BLUE), strict=True
        )
    ], (5.2, 3.4))  # fmt: skip
    return {
        "contact_patch": power(worst),
        "contact_patch_at_particles": percent(found["particles"].deviation),
    }


# ---- homogeneous compression ----


@captioned_body("compressed block")
def _compression(out: Path) -> dict:
    found = {ratio: compress_block(ratio) for ratio in (1e3, 1.0)}
    worst = max(
        max(np.abs(f.pressure / f.exact_pressure - 1.0).max(),
            np.abs(f.width / f.exact_width - 1.0).max())
        for f in found.values()
    )  # fmt: skip
    own = found[1e3]
    curves(out / "compression.png", "height / undeformed height", "pressure / shear modulus", [
        (own.stretch, own.exact_pressure, "-", GREY, "exact"),
        (own.stretch, own.pressure, "o", BLUE, "computed"),
    ], (5.2, 3.4), xinverted=True)  # fmt: skip
    return {"compression": power(worst)}


# ---- rotation ----


@captioned_body("rotated block")
def _rotation(out: Path) -> dict:
    found = rotate_body()
    _rotation_picture(out / "rotation.png", found)
    return {
        "rotation_stress": power(found.stress.max()),
        "rotation_place": power(found.misplacement.max()),
    }


def _rotation_picture(path: Path, found) -> None:
    grid = Grid(6, 6)
    X = scattered(grid, 0.3, 5)
    with picture(path, 1, 2, width=8.6, height=3.4) as (left, right):
        for i, angle in enumerate([0.0, *found.angle[[5, 11, 16]]]):
            turn, label = rotation_matrix(angle), f"{np.degrees(angle):.0f}°"
            draw_cells(left, X @ turn.T, grid.cells, color=CYCLE[i], linewidth=0.8)
            left.text(*turn @ [1.14, 0.5], label, color=CYCLE[i], ha="center", va="center")
        left.plot(*X[grid.left].T, "s", color="black", markersize=3, zorder=3)
        left.set_aspect("equal")
        left.set_axis_off()
        right.semilogy(np.degrees(found.angle), found.stress, "o-", color=BLUE)
        right.axhline(1e-9, color=VERMILION, linestyle="--", label="tolerance")
        right.set(xlabel="rotation (degrees)", ylabel="largest stress / shear modulus")
        right.legend(loc="center right")


# ---- cylinder ----


@captioned_body("inflated cylinder")
def _cylinder(out: Path, ratios) -> dict:
    found = {ratio: inflate_cylinder(ratio) for ratio in ratios}
    rows = [
        [power(ratio, 0), percent(np.abs(f.error).max(), 3), percent(f.error[-1], 3)]
        for ratio, f in found.items()
    ]
    worst = max(np.abs(f.error).max() for f in found.values())
    drift = np.ptp([f.error for f in found.values()], axis=0)
    _cylinder_picture(out / "cylinder.png", found)
    head = ["bulk / shear modulus", "largest error of the pressure", "error at stretch 2"]
    return {
        "cylinder_table": table(head, rows),
        "cylinder": percent(worst, 2),
        "cylinder_drift": percent(drift.max(), 3),
    }


def _cylinder_picture(path: Path, found) -> None:
    stretch = np.linspace(1.0, 2.0, 101)
    with picture(path, 1, 2, width=9.2, height=3.4) as (left, right):
        left.plot(stretch, inflation_pressure(stretch), color=GREY, label="closed form")
        for (ratio, f), color, marker in zip(found.items(), CYCLE, MARKERS, strict=False):
            label = f"$K/\\mu$ = $10^{{{np.log10(ratio):.0f}}}$"
            left.plot(f.stretch, f.pressure, marker, color=color, label=label)
            right.plot(f.stretch, 100 * f.error, f"{marker}-", color=color, label=label)
        left.set(xlabel="bore stretch", ylabel="bore pressure / shear modulus")
        right.set(xlabel="bore stretch", ylabel="error of the pressure (%)")
        left.legend()


# ---- flexure ----


@captioned_body("block bent to a ring")
def _flexure(out: Path, reduced: bool) -> dict:
    if reduced:
        found = {1e4: bend_block(degrees=180.0, n_steps=18)}
    else:
        found = {ratio: bend_block(bulk_ratio=ratio) for ratio in (1e3, 1e4)}
    rows = [
        [power(ratio, 0), percent(np.abs(f.error).max()), percent(f.misplacement)]
        for ratio, f in found.items()
    ]
    worst = max(np.abs(f.error).max() for f in found.values())
    own, degrees = found[1e4], np.degrees(found[1e4].angle)
    labels = "angle between the end faces (degrees)", "moment / ($\\mu H^2$)"
    curves(out / "flexure.png", *labels, [
        (degrees, own.exact, "-", GREY, "exact"), (degrees, own.moment, "o", BLUE, "computed"),
    ])  # fmt: skip
    head = ["bulk / shear modulus", "largest error of the moment", "position error / thickness"]
    return {"flexure": percent(worst), "flexure_table": table(head, rows)}
