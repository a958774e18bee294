"""Convergence under refinement: shape functions alone, the whole analysis, Cook's membrane."""

from pathlib import Path

import numpy as np
from verification.approximation import interpolation_convergence
from verification.cook import CONVERGED, cook_deflection
from verification.manufactured import Convergence, manufactured_convergence

from figures.drawing import captioned_body, picture
from figures.tables import percent, power, table
from seal_mdao.plotting.style import BLUE, GREY, VERMILION


def make(out: Path, reduced: bool) -> dict:
    """Pictures, tables and numbers."""
    return _manufactured(out, reduced) | _interpolation(out, reduced) | _cook(out, reduced)


def convergence_table(found: Convergence) -> str:
    """Spacings, errors and slopes."""
    rows = []
    for i, spacing in enumerate(found.spacing):
        slopes = ["", ""]
        if i > 0:
            slopes = [f"{found.l2_slopes[i - 1]:.2f}", f"{found.h1_slopes[i - 1]:.2f}"]
        l2, h1 = power(found.l2[i], 2), power(found.h1[i], 2)
        rows.append([f"1/{round(1 / spacing)}", l2, slopes[0], h1, slopes[1]])
    return table(["spacing", "L2 error", "slope", "H1 error", "slope"], rows)


def _convergence_picture(path: Path, found: dict) -> None:
    """Errors over the spacing; ``found`` maps a basis order to its ``Convergence``."""
    count = len(found)
    with picture(path, 1, count, width=4.6 * count, height=3.6, squeeze=False) as panels:
        for axes, (order, c) in zip(panels[0], found.items(), strict=True):
            for errors, slope, color, name in (
                (c.l2, order + 1, BLUE, "L2"), (c.h1, order, VERMILION, "H1"),
            ):  # fmt: skip
                axes.loglog(c.spacing, errors, "o-", color=color, label=name)
                # C h^slope below the error at the finest spacing
                line = errors[-1] * 0.6 * (c.spacing / c.spacing[-1]) ** slope
                axes.loglog(c.spacing, line, "--", color=GREY, linewidth=1.0)
                axes.annotate(
                    f"slope {slope}", (c.spacing[0], line[0]), xytext=(5, -3),
                    textcoords="offset points", color=GREY, fontsize=9, ha="left",
                )  # fmt: skip
            axes.set_title(("linear basis", "quadratic basis")[order - 1])
            axes.set_xlim(0.88 * c.spacing[-1], 1.45 * c.spacing[0])
            axes.set_xticks(c.spacing, [f"1/{round(1 / h)}" for h in c.spacing])
            axes.minorticks_off()
            axes.set(xlabel="particle spacing / side", ylabel="error")
            axes.legend()


@captioned_body("square with a prescribed displacement field")
def _manufactured(out: Path, reduced: bool) -> dict:
    cells, seeds = ((4, 8), (1,)) if reduced else ((8, 16, 32), (1, 2, 3))
    found = {order: manufactured_convergence(order, order, cells, seeds) for order in (1, 2)}
    _convergence_picture(out / "convergence.png", found)
    slopes = {order: f"{c.l2_slopes[-1]:.2f}, {c.h1_slopes[-1]:.2f}" for order, c in found.items()}
    return {
        "linear_slopes": slopes[1],
        "quadratic_slopes": slopes[2],
        "linear_table": convergence_table(found[1]),
        "quadratic_table": convergence_table(found[2]),
    }


def _interpolation(out: Path, reduced: bool) -> dict:
    cells = (8, 16) if reduced else (8, 16, 32, 64)
    found = {order: interpolation_convergence(order, cells) for order in (1, 2)}
    _convergence_picture(out / "interpolation.png", found)
    return {f"interpolation_{order}": convergence_table(c) for order, c in found.items()}


@captioned_body("Cook's membrane")
def _cook(out: Path, reduced: bool) -> dict:
    cells = (4, 8) if reduced else (4, 8, 16, 32)
    tip = np.array([cook_deflection(n) for n in cells])
    error = np.abs(tip / CONVERGED - 1.0)
    with picture(out / "cook.png", width=5.2, height=3.3) as axes:
        axes.axhline(CONVERGED, color=GREY, linestyle="--", label="limit of finite elements")
        axes.semilogx(cells, tip, "o-", color=BLUE, base=2, label="particles")
        axes.set(xlabel="cells along a side", ylabel="vertical deflection of the corner")
        axes.set_xticks(cells, [str(n) for n in cells])
        axes.minorticks_off()
        axes.legend()
    rows = [
        [f"{n} × {n}", f"{t:.4f}", percent(e, 2)] for n, t, e in zip(cells, tip, error, strict=True)
    ]
    return {
        "cook_table": table(["cells", "deflection", "difference"], rows),
        "cook_reference": f"{CONVERGED:.4f}",
        "cook": percent(error[-1], 2),
    }
