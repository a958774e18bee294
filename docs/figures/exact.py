"""Benchmarks with exact solutions: patch, compression, cylinder, rotation, flexure."""

from pathlib import Path

import numpy as np
from verification.bodies import Grid, scattered
from verification.cylinder import inflate_cylinder, inflation_pressure
from verification.flexure import bend_block
from verification.patch import GRADIENT, compress_block, patch_test
from verification.rotation import rotate_body, rotation_matrix

from figures.tables import percent, power, table
from seal_mdao.plotting.style import (
    BLUE,
    CYCLE,
    GREY,
    MARKERS,
    VERMILION,
    save,
    styled,
    subplots,
)

RATIOS = (1e3, 1e4, 1e5, 1e6)


def make(out: Path, reduced: bool) -> dict:
    """Pictures and numbers of the five benchmarks."""
    ratios = RATIOS[:1] if reduced else RATIOS
    numbers = _patch(out) | _compression(out) | _rotation(out)
    return numbers | _cylinder(out, ratios) | _flexure(out, reduced)


# ---- patch test ----


def _patch(out: Path) -> dict:
    rows, worst = [], 0.0
    for traction in (False, True):
        for order in (1, 2):
            found = patch_test(traction, order)
            worst = max(worst, *found)
            where = "displacements and tractions" if traction else "displacements all round"
            basis = ("linear", "quadratic")[order - 1]
            rows.append([where, basis, power(found.displacement), power(found.stress)])
    save(patch_picture(), out / "patch.png")
    head = ["imposed", "basis", "displacement error", "stress error"]
    return {"patch_table": table(head, rows), "patch": power(worst)}


def _draw_cells(axes, x, cells, **line):
    closed = np.concatenate([x[cells], x[cells[:, :1]]], axis=1)
    axes.plot(*closed.transpose(2, 1, 0), **line)


@styled
def patch_picture():
    figure, axes = subplots(width=4.6, height=3.6)
    grid = Grid(6, 6)
    X = scattered(grid, 0.3, 5)
    for x, color in ((X, GREY), (X @ (np.eye(2) + GRADIENT).T, BLUE)):
        _draw_cells(axes, x, grid.cells, color=color, linewidth=0.8)
        axes.plot(*x.T, "o", color=color, markersize=3)
    axes.set_aspect("equal")
    axes.set_axis_off()
    return figure


# ---- homogeneous compression ----


def _compression(out: Path) -> dict:
    found = {ratio: compress_block(ratio) for ratio in (1e3, 1.0)}
    worst = max(
        max(np.abs(f.pressure / f.exact_pressure - 1.0).max(),
            np.abs(f.width / f.exact_width - 1.0).max())
        for f in found.values()
    )  # fmt: skip
    save(compression_picture(next(iter(found.values()))), out / "compression.png")
    return {"compression": power(worst)}


@styled
def compression_picture(found):
    figure, axes = subplots(width=5.2, height=3.4)
    axes.plot(found.stretch, found.exact_pressure, color=GREY, label="exact")
    axes.plot(found.stretch, found.pressure, "o", color=BLUE, label="computed")
    axes.invert_xaxis()
    axes.set_xlabel("height / undeformed height")
    axes.set_ylabel("pressure / shear modulus")
    axes.legend()
    return figure


# ---- rotation ----


def _rotation(out: Path) -> dict:
    found = rotate_body()
    save(rotation_picture(found), out / "rotation.png")
    return {
        "rotation_stress": power(found.stress.max()),
        "rotation_place": power(found.misplacement.max()),
    }


@styled
def rotation_picture(found):
    figure, (left, right) = subplots(1, 2, width=8.6, height=3.4)
    grid = Grid(6, 6)
    X = scattered(grid, 0.3, 5)
    for i, angle in enumerate([0.0, *found.angle[[5, 11, 16]]]):
        turn = rotation_matrix(angle)
        _draw_cells(left, X @ turn.T, grid.cells, color=CYCLE[i], linewidth=0.8)
        label = f"{np.degrees(angle):.0f}°"
        left.text(*turn @ [1.14, 0.5], label, color=CYCLE[i], ha="center", va="center")
    left.plot(*X[grid.left].T, "s", color="black", markersize=3, zorder=3)
    left.set_aspect("equal")
    left.set_axis_off()
    right.semilogy(np.degrees(found.angle), found.stress, "o-", color=BLUE)
    right.axhline(1e-9, color=VERMILION, linestyle="--", label="tolerance")
    right.set_xlabel("rotation (degrees)")
    right.set_ylabel("largest stress / shear modulus")
    right.legend(loc="center right")
    return figure


# ---- cylinder ----


def _cylinder(out: Path, ratios) -> dict:
    found = {ratio: inflate_cylinder(ratio) for ratio in ratios}
    rows = [
        [power(ratio, 0), percent(np.abs(f.error).max(), 3), percent(f.error[-1], 3)]
        for ratio, f in found.items()
    ]
    worst = max(np.abs(f.error).max() for f in found.values())
    drift = np.ptp([f.error for f in found.values()], axis=0)
    save(cylinder_picture(found), out / "cylinder.png")
    head = ["bulk / shear modulus", "largest error of the pressure", "error at stretch 2"]
    return {
        "cylinder_table": table(head, rows),
        "cylinder": percent(worst, 2),
        "cylinder_drift": percent(drift.max(), 3),
    }


@styled
def cylinder_picture(found):
    figure, (left, right) = subplots(1, 2, width=9.2, height=3.4)
    stretch = np.linspace(1.0, 2.0, 101)
    left.plot(stretch, inflation_pressure(stretch), color=GREY, label="closed form")
    for (ratio, f), color, marker in zip(found.items(), CYCLE, MARKERS, strict=False):
        label = f"$K/\\mu$ = $10^{{{np.log10(ratio):.0f}}}$"
        look = {"color": color, "marker": marker, "linestyle": "none", "label": label}
        left.plot(f.stretch, f.pressure, **look)
        right.plot(f.stretch, 100 * f.error, **look | {"linestyle": "-"})
    left.set_ylabel("bore pressure / shear modulus")
    right.set_ylabel("error of the pressure (%)")
    for axes in (left, right):
        axes.set_xlabel("bore stretch")
    left.legend()
    return figure


# ---- flexure ----


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
    save(flexure_picture(found[1e4]), out / "flexure.png")
    head = ["bulk / shear modulus", "largest error of the moment", "misplacement / thickness"]
    return {"flexure": percent(worst), "flexure_table": table(head, rows)}


@styled
def flexure_picture(found):
    figure, axes = subplots(width=5.4, height=3.4)
    axes.plot(np.degrees(found.angle), found.exact, color=GREY, label="exact")
    axes.plot(np.degrees(found.angle), found.moment, "o", color=BLUE, label="computed")
    axes.set_xlabel("angle between the end faces (degrees)")
    axes.set_ylabel("moment / ($\\mu H^2$)")
    axes.legend()
    return figure
