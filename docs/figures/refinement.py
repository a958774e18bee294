"""Refinement of the load steps and of the particles, and other frames and units."""

from pathlib import Path

import numpy as np
from matplotlib.ticker import NullLocator
from verification.flat_door_reference import BOUNDARY, REACTION
from verification.frames import Frame, analyze_in_frame
from verification.seal_refinement import LEVELS, corner_level, flat_level
from verification.step_refinement import STEPS, refine_steps

from figures.tables import percent, power, table
from seal_mdao.analysis.newton import NewtonOptions
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, MARKERS, VERMILION, save, styled, subplots
from seal_mdao.seals.door.door_seal import door_seal, options_of
from seal_mdao.seals.result import analyze

FRAMES = {
    "rotated by 0.7 rad": Frame(angle=0.7),
    "shifted by (30, −50) mm": Frame(shift=(30.0, -50.0)),
    "mirrored": Frame(mirrored=True),
    "in metres and pascals": Frame(size=1e-3, stress=1e3),
    "all at once": Frame(2.0, True, (3.0, 4.0), 1e-3, 1e3),
}
FINEST = (232, 9)
"""Beyond what the tests run."""
NAMES = ("horizontal reaction", "vertical reaction", "sum of squared gaps")


def make(out: Path, reduced: bool) -> dict:
    """Pictures, tables and numbers."""
    return _steps(out, reduced) | _frames(reduced) | _seal(out, reduced) | _flat(out, reduced)


# ---- load steps ----


def _steps(out: Path, reduced: bool) -> dict:
    steps = STEPS[:2] if reduced else STEPS
    more = () if reduced else (800, 1600, 3200)
    found = {"incremental": refine_steps("incremental", (*steps, *more))}
    found["accumulated"] = refine_steps("accumulated", (*steps, 4 * steps[-1]))
    save(step_picture(found), out / "step_refinement.png")
    numbers = {}
    for rule, study in found.items():
        rows = [
            [str(n), *(f"{v:.5g}" for v in row)]
            for n, row in zip(study.steps, study.columns, strict=True)
        ]
        head = ["steps", "$F_x$ (N/m)", "$F_y$ (N/m)", "$\\sum g_n^2$ (mm²)"]
        numbers[f"{rule}_table"] = table(head, rows)
    if reduced:
        return numbers
    study = found["accumulated"]
    numbers["orders"] = ", ".join(f"{order:.2f}" for order in study.orders)
    numbers["first_order"] = f"{study.first_order:.2f}"
    for name, column in (("steps_reaction", 1), ("steps_gap", 2)):
        numbers[name] = percent(study.errors[-1, column], 3)
    numbers["steps_drawn"] = percent(np.interp(105, study.steps[:-1], study.errors[:, 2]))
    return numbers


@styled
def step_picture(found: dict):
    figure, (left, right) = subplots(1, 2, width=9.6, height=3.6)
    looks = (("accumulated", BLUE, "o-"), ("incremental", VERMILION, "s--"))
    for rule, color, style in looks:
        study = found[rule]
        left.loglog(study.steps, study.gap_square_sum, style, color=color, label=rule, base=2)
    left.set_ylabel("sum of squared gaps (mm²)")
    study = found["accumulated"]
    for column, name in enumerate(NAMES):
        right.loglog(
            study.steps[:-1], study.errors[:, column], marker=MARKERS[column],
            color=CYCLE[column], label=name, base=2,
        )  # fmt: skip
    line = study.errors[0].max() * study.steps[0] / study.steps[:-1]
    right.loglog(study.steps[:-1], line, "--", color=GREY, linewidth=1.0, label="order 1")
    right.set_xticks(study.steps[:-1], [str(n) for n in study.steps[:-1]])
    right.set_yscale("log", base=10)
    right.set_ylim(bottom=study.errors.min() / 60.0)
    left.set_yscale("log", base=10)
    steps = found["incremental"].steps
    left.set_xticks(steps, [str(n) for n in steps])
    right.set_title("accumulated", fontsize=10)
    right.set_ylabel(f"distance from {study.steps[-1]} steps, relative")
    for axes in (left, right):
        axes.xaxis.set_minor_locator(NullLocator())
        axes.set_xlabel("load steps")
        axes.legend()
    return figure


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


def _seal(out: Path, reduced: bool) -> dict:
    levels = LEVELS[:1] if reduced else (*LEVELS, FINEST)
    found = [corner_level(*level) for level in levels]
    rows = [
        [f"{s.rays} × {s.layers}", f"{s.reaction[0]:.3f}", f"{s.reaction[1]:.3f}",
         f"{s.max_gap:.4f}", f"{s.gap_square_integral:.5f}"]
        for s in found
    ]  # fmt: skip
    head = ["particles", "$F_x$ (N/m)", "$F_y$ (N/m)", "largest gap (mm)",
            "$\\int g_n^2\\,\\mathrm ds$ (mm³)"]  # fmt: skip
    numbers = {"seal_table": table(head, rows)}
    save(corner_picture(found), out / "corner_levels.png")
    return numbers if reduced else numbers | _last_changes(*found[1:])


def _last_changes(middle, fine, finest) -> dict:
    """Relative changes from the second level on; the tolerances are those of the first of them."""
    changes = {"corner_reaction": [], "corner_gap": [], "corner_integral": []}
    for a, b in ((middle, fine), (fine, finest)):
        changes["corner_reaction"].append(abs(a.reaction[1] / b.reaction[1] - 1.0))
        changes["corner_gap"].append(abs(a.max_gap / b.max_gap - 1.0))
        changes["corner_integral"].append(abs(a.gap_square_integral / b.gap_square_integral - 1.0))
    numbers = {name: percent(first) for name, (first, _) in changes.items()}
    last = {f"{name}_last": percent(value) for name, (_, value) in changes.items()}
    return numbers | last | {"corner_changes": ", ".join(numbers.values())}


@styled
def corner_picture(found):
    """Every quantity over its value on the finest particles, against the spacing of the rays."""
    figure, axes = subplots(width=5.8, height=3.5)
    spacing = np.array([58.0 / s.rays for s in found])
    columns = {
        "vertical reaction": [s.reaction[1] for s in found],
        "largest gap": [s.max_gap for s in found],
        "integral of squared gap": [s.gap_square_integral for s in found],
    }
    for (name, values), color, marker in zip(columns.items(), CYCLE, MARKERS, strict=False):
        axes.plot(spacing, np.array(values) / values[-1], marker=marker, color=color, label=name)
    axes.axhline(1.0, color=GREY, linewidth=1.0, zorder=1)
    axes.set_xlim(0.0, 1.05)
    axes.set_xticks(spacing, [f"{s.rays} × {s.layers}" for s in found], rotation=25)
    axes.set_xlabel("particles, placed at their spacing")
    axes.set_ylabel("value / value on the finest")
    axes.legend()
    return figure


def _flat(out: Path, reduced: bool) -> dict:
    found = [flat_level(*level) for level in (LEVELS[:1] if reduced else LEVELS)]
    rows = [
        [f"{travel:g}", f"{force:.3f}", *(percent(s.reaction_error[i]) for s in found)]
        for i, (travel, force) in enumerate(REACTION)
    ]
    save(flat_picture(found), out / "flat_door.png")
    names = [f"{s.rays} × {s.layers}" for s in found]
    worst = ", ".join(percent(np.abs(s.reaction_error).max()) for s in found)
    return {
        "flat_table": table(["door travel (mm)", "reference (N/m)", *names], rows),
        "flat_errors": worst,
        "flat_mm": ", ".join(f"{s.boundary_error:.3f}" for s in found),
    }


@styled
def flat_picture(found):
    figure, (left, middle, right) = subplots(1, 3, width=12.4, height=3.6)
    result = analyze(door_seal(door="flat"))
    left.plot(result.travel, result.reaction[:, 1], color=BLUE, label="58 × 3 particles")
    left.plot(*REACTION.T, "s", color=VERMILION, label="finite elements")
    left.set_ylabel("vertical reaction (N/m)")
    for s, color, marker in zip(found, CYCLE, MARKERS, strict=False):
        middle.plot(
            REACTION[:, 0], 100 * s.reaction_error, marker=marker, color=color,
            label=f"{s.rays} × {s.layers}",
        )  # fmt: skip
    middle.set_ylabel("difference (%)")
    middle.axhline(0.0, color=GREY, linewidth=1.0)
    for axes in (left, middle):
        axes.set_xlabel("door travel (mm)")
    _flat_shape(right, result)
    for axes in (left, middle, right):
        axes.legend()
    return figure


def _flat_shape(axes, result):
    """The right half of the outer boundary at 10 mm."""
    outer = options_of(result.seal).grid.free_outer
    place = (result.particles + result.path.displacement())[outer]
    place = place[result.particles[outer, 0] > -1e-9]
    axes.plot(*place.T, color=BLUE, label="58 × 3 particles")
    axes.plot(*BOUNDARY[:, 2:].T, "s", color=VERMILION, markersize=3.5, label="finite elements")
    axes.axhline(-0.5, color=GREY, linewidth=1.0, zorder=1)
    axes.set_aspect("equal")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
