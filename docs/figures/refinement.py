"""Refinement of the load steps and of the particles, and other frames and units.

The refinements are stored by ``verification.accuracy_study``; computed here are the frames.
"""

from pathlib import Path

import numpy as np
from matplotlib.ticker import NullLocator
from verification import accuracy_study as study
from verification.accuracy_study import stored, stored_date
from verification.flat_door_reference import BOUNDARY, REACTION
from verification.frames import Frame, analyze_in_frame
from verification.seal_refinement import LEVELS, FlatLevel, SealLevel
from verification.step_refinement import StepStudy

from figures.drawing import DOOR_SEAL, picture
from figures.tables import percent, power, table
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, MARKERS, VERMILION
from seal_mdao.seals.door.door_seal import door_seal, options_of
from seal_mdao.seals.result import analyze

FRAMES = {
    "rotated by 0.7 rad": Frame(angle=0.7),
    "shifted by (30, −50) mm": Frame(shift=(30.0, -50.0)),
    "mirrored": Frame(mirrored=True),
    "in metres and pascals": Frame(size=1e-3, stress=1e3),
    "all at once": Frame(2.0, True, (3.0, 4.0), 1e-3, 1e3),
}
NAMES = ("horizontal reaction", "vertical reaction", "sum of squared gaps")


@captioned(DOOR_SEAL, stored_date())
def make(out: Path, reduced: bool) -> dict:
    """Pictures, tables and numbers."""
    return _steps(out) | _frames(reduced) | _seal(out) | _flat(out)


# ---- load steps ----


def _step_study(rule: str, steps) -> StepStudy:
    """The stored ends of paths with different numbers of steps."""
    ends = [stored("refined_steps", friction_history=rule, steps=n) for n in steps]
    names = "reaction", "gap_square_sum"
    return StepStudy(np.array(steps), *(np.array([end[name] for end in ends]) for name in names))


def _steps(out: Path) -> dict:
    found = {rule: _step_study(rule, steps) for rule, steps in study.REFINED_STEPS.items()}
    _step_picture(out / "step_refinement.png", found)
    numbers = {}
    for rule, own in found.items():
        rows = [
            [str(n), *(f"{v:.5g}" for v in row)]
            for n, row in zip(own.steps, own.columns, strict=True)
        ]
        head = ["steps", "$F_x$ (N/m)", "$F_y$ (N/m)", "$\\sum g_n^2$ (mm²)"]
        numbers[f"{rule}_table"] = table(head, rows)
    own = found["accumulated"]
    numbers["orders"] = ", ".join(f"{order:.2f}" for order in own.orders)
    numbers["first_order"] = f"{own.first_order:.2f}"
    for name, column in (("steps_reaction", 1), ("steps_gap", 2)):
        numbers[name] = percent(own.errors[-1, column], 3)
    numbers["steps_drawn"] = percent(np.interp(105, own.steps[:-1], own.errors[:, 2]))
    return numbers


def _step_picture(path: Path, found: dict) -> None:
    finest = found["accumulated"]
    steps = finest.steps[:-1]
    with picture(path, 1, 2, width=9.6, height=3.6) as (left, right):
        for rule, color, style in (("accumulated", BLUE, "o-"), ("incremental", VERMILION, "s--")):
            own = found[rule]
            left.loglog(own.steps, own.gap_square_sum, style, color=color, label=rule, base=2)
        looks = zip(NAMES, MARKERS, CYCLE, finest.errors.T, strict=False)
        for name, marker, color, errors in looks:
            right.loglog(steps, errors, marker=marker, color=color, label=name, base=2)
        # first order: error ~ 1 / n
        line = finest.errors[0].max() * steps[0] / steps
        right.loglog(steps, line, "--", color=GREY, linewidth=1.0, label="order 1")
        for axes, own in ((left, found["incremental"].steps), (right, steps)):
            axes.set_xticks(own, [str(n) for n in own])
            axes.set_yscale("log", base=10)
            axes.xaxis.set_minor_locator(NullLocator())
            axes.set_xlabel("load steps")
            axes.legend()
        left.set_ylabel("sum of squared gaps (mm²)")
        right.set_ylim(bottom=finest.errors.min() / 60.0)
        right.set_title("accumulated", fontsize=10)
        right.set_ylabel(f"relative difference from {finest.steps[-1]} steps")


# ---- frames ----


def _frames(reduced: bool) -> dict:
    tight = NewtonOptions(tolerance=1e-11)
    model = door_seal(newton=tight, **({"n_steps": 42, "depth": 4.0} if reduced else {}))
    base, rows, worst = analyze_in_frame(model, Frame()), [], 0.0
    for name, frame in FRAMES.items():
        found = analyze_in_frame(model, frame)
        force = np.abs(found.reaction - base.reaction).max() / np.abs(base.reaction).max()
        place = np.abs(found.displacement - base.displacement).max()
        same = "the same" if np.array_equal(found.state, base.state) else "other"
        rows.append([name, power(force), power(place), same])
        worst = max(worst, force)
    head = ["problem", "reaction, relative", "displacement (mm)", "contact states"]
    return {"frames_table": table(head, rows), "frames": power(worst)}


# ---- particles ----


def _seal(out: Path) -> dict:
    levels = (*LEVELS, study.FINEST)
    found = [SealLevel(**stored("refined_corner", rays=r, layers=n)) for r, n in levels]
    rows = [
        [f"{s.rays} × {s.layers}", f"{s.reaction[0]:.3f}", f"{s.reaction[1]:.3f}",
         f"{s.max_gap:.4f}", f"{s.gap_square_integral:.5f}"]
        for s in found
    ]  # fmt: skip
    head = ["particles", "$F_x$ (N/m)", "$F_y$ (N/m)", "largest gap (mm)",
            "$\\int g_n^2\\,\\mathrm ds$ (mm³)"]  # fmt: skip
    numbers = {"seal_table": table(head, rows)}
    _corner_picture(out / "corner_levels.png", found)
    return numbers | _last_changes(*found[1:])


def _last_changes(middle, fine, finest) -> dict:
    """Relative changes from the second level on; the tolerances are those of the first of them."""
    values = {
        "corner_reaction": lambda level: level.reaction[1],
        "corner_gap": lambda level: level.max_gap,
        "corner_integral": lambda level: level.gap_square_integral,
    }

    def changes(a, b, suffix=""):
        return {name + suffix: percent(abs(of(a) / of(b) - 1.0)) for name, of in values.items()}

    numbers = changes(middle, fine)
    changed = ", ".join(numbers.values())
    return numbers | changes(fine, finest, "_last") | {"corner_changes": changed}


def _corner_picture(path: Path, found) -> None:
    """Every quantity over its value on the finest particles, against the spacing of the rays."""
    spacing = np.array([58.0 / s.rays for s in found])
    columns = {
        "vertical reaction": [s.reaction[1] for s in found],
        "largest gap": [s.max_gap for s in found],
        "integral of squared gap": [s.gap_square_integral for s in found],
    }
    with picture(path, width=5.8, height=3.5) as axes:
        for (name, own), color, marker in zip(columns.items(), CYCLE, MARKERS, strict=False):
            axes.plot(spacing, np.array(own) / own[-1], marker=marker, color=color, label=name)
        axes.axhline(1.0, color=GREY, linewidth=1.0, zorder=1)
        axes.set_xlim(0.0, 1.05)
        axes.set_xticks(spacing, [f"{s.rays} × {s.layers}" for s in found], rotation=25)
        axes.set(
            xlabel="particles, positioned by the spacing around the ring",
            ylabel="value / finest value",
        )
        axes.legend()


def _flat(out: Path) -> dict:
    found = [FlatLevel(**stored("refined_flat", rays=r, layers=n)) for r, n in LEVELS]
    rows = [
        [f"{travel:g}", f"{force:.3f}", *(percent(s.reaction_error[i]) for s in found)]
        for i, (travel, force) in enumerate(REACTION)
    ]
    _flat_picture(out / "flat_door.png", found)
    names = [f"{s.rays} × {s.layers}" for s in found]
    worst = ", ".join(percent(np.abs(s.reaction_error).max()) for s in found)
    return {
        "flat_table": table(["door travel (mm)", "reference (N/m)", *names], rows),
        "flat_errors": worst,
        "flat_mm": ", ".join(f"{s.boundary_error:.3f}" for s in found),
    }


def _flat_picture(path: Path, found) -> None:
    result = analyze(door_seal(door="flat"))
    with picture(path, 1, 3, width=12.4, height=3.6) as panels:
        left, middle, right = panels
        left.plot(result.travel, result.reaction[:, 1], color=BLUE, label="58 × 3 particles")
        left.plot(*REACTION.T, "s", color=VERMILION, label="finite elements")
        left.set(xlabel="door travel (mm)", ylabel="vertical reaction (N/m)")
        for s, color, marker in zip(found, CYCLE, MARKERS, strict=False):
            look = {"marker": marker, "color": color, "label": f"{s.rays} × {s.layers}"}
            middle.plot(REACTION[:, 0], 100 * np.array(s.reaction_error), **look)
        middle.axhline(0.0, color=GREY, linewidth=1.0)
        middle.set(xlabel="door travel (mm)", ylabel="difference (%)")
        _flat_shape(right, result)
        for axes in panels:
            axes.legend()


def _flat_shape(axes, result) -> None:
    """The right half of the outer boundary at 10 mm."""
    outer = options_of(result.seal).grid.free_outer
    x = result.deformed()[outer][result.particles[outer, 0] > -1e-9]
    axes.plot(*x.T, color=BLUE, label="58 × 3 particles")
    axes.plot(*BOUNDARY[:, 2:].T, "s", color=VERMILION, markersize=3.5, label="finite elements")
    axes.axhline(-0.5, color=GREY, linewidth=1.0, zorder=1)
    axes.set(aspect="equal", xlabel="x (mm)", ylabel="y (mm)")
