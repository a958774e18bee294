"""Sources of error of the door seal, one figure each, and what the accurate discretisation costs.

The values come from ``verification.accuracy_study``, which takes a quarter of an hour and stores them;
computed here are the times of the accuracies.
"""

import json
from pathlib import Path
from time import process_time

import numpy as np
from verification import accuracy_study as study
from verification.accuracy_study import stored, stored_date
from verification.error_sources import FUNCTIONS
from verification.flat_door_reference import REACTION
from verification.pressed_elements import CORNER, FLAT, GAP
from verification.ray_bulb import COMPARED

from figures.drawing import DOOR_SEAL, captioned_body, picture
from figures.tables import percent, table
from seal_mdao.plotting.captions import captioned
from seal_mdao.plotting.style import BESIDE, CYCLE, GREY, MARKERS
from seal_mdao.seals.door.door_seal import ACCURACIES, door_seal, options_of
from seal_mdao.seals.result import analyze

BASES = {1: "linear", 2: "quadratic"}


@captioned(DOOR_SEAL, stored_date())
def make(out: Path, reduced: bool) -> dict:
    """All figures of the page on accuracy."""
    parts = _support, _layers, _bending, _integration, _refinement, _penalty, _steps, _outline
    numbers = _penalties() | _rays() | _files() | _preset(1 if reduced else 3)
    return numbers | {name: value for part in parts for name, value in part(out).items()}


WORST = "largest error of the reaction (%)"


def _lines(path: Path, label: str, lines: dict, value: str = WORST, ticks=None) -> None:
    """Lines {name: (x, y)} of errors in percent, logarithmic; integer ``ticks`` of x."""
    with picture(path, width=5.8, height=3.5) as axes:
        for (name, (x, y)), color, marker in zip(lines.items(), CYCLE, MARKERS, strict=False):
            axes.semilogy(x, 100 * np.array(y), marker=marker, color=color, label=name)
        axes.axhline(0.5, color=GREY, linestyle="--", linewidth=1.0)
        if ticks is not None:
            axes.set_xticks(ticks, [str(n) for n in ticks])
        axes.yaxis.set_major_formatter("{x:g}")
        axes.yaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else "")
        axes.set(xlabel=label, ylabel=value)
        axes.legend(**BESIDE)


def _by_layers(path: Path, lines: dict, rows: list, heads, words=" across the wall") -> str:
    """Write the picture of errors over the layers of particles, and return their table."""
    _lines(path, f"layers of particles{words}", lines, ticks=study.LAYERS)
    return table([*heads, *(f"{n} layers" for n in study.LAYERS)], rows)


def _support(out: Path) -> dict:
    """Round supports see rows and columns of a cell alike; product ones follow its two directions."""
    lines, rows = {}, []
    for rays, layers in study.CLOUDS:
        *found, product = (
            stored("worst_error", rays=rays, layers=layers, support=s)
            for s in (*study.SUPPORTS, study.PRODUCT)
        )
        lines[f"{rays} × {layers}, round"] = study.SUPPORTS, found
        rows.append([f"{rays} × {layers}", *map(percent, found), percent(product)])
    _lines(out / "error_support.png", "support of round kernels", lines)
    head = ["particles", *(f"round {s:g}" for s in study.SUPPORTS), "product 1.8, 2.5"]
    return {"support_table": table(head, rows)}


def _over_layers(quantity: str, **options) -> list[float]:
    """Stored errors for every number of layers."""
    return [stored(quantity, layers=n, **options) for n in study.LAYERS]


def _layers(out: Path) -> dict:
    """Rays and layers, for every kernel, basis, pressure and place of the contact."""
    lines, rows = {}, []
    for rays, scheme in study.BY_LAYERS:
        found = _over_layers("worst_error", rays=rays, **scheme)
        support = scheme["support"]
        kernel = "round 2" if np.ndim(support) == 0 else "product {:g}, {:g}".format(*support)
        basis = BASES[scheme.get("basis_order", 1)]
        pressure = scheme.get("pressure", "cell")
        drawn = study.BY_CELL[0], study.THROUGH[0], study.THROUGH[2]
        if rays < 174 and scheme in drawn:
            lines[f"{rays} radial rows, {kernel}, {basis}, {pressure}"] = study.LAYERS, found
        rows.append([rays, kernel, basis, pressure, *map(percent, found)])
    heads = ["radial rows", "kernels", "basis", "pressure"]
    return {"layers_table": _by_layers(out / "error_layers.png", lines, rows, heads)}


@captioned_body("block bent to a half circle", stored_date())
def _bending(out: Path) -> dict:
    """Bending without contact: what one pressure a cell and the kernels leave."""
    lines = {
        name: (study.ACROSS, [stored("bending_error", across=n, support=s) for n in study.ACROSS])
        for name, s in (("round 2", study.ROUND), ("product 1.8, 2.5", study.PRODUCT))
    }
    value = "largest error of the moment (%)"
    _lines(out / "error_bending.png", "cells across the block", lines, value, study.ACROSS)
    rows = [[name, *map(percent, found)] for name, (_, found) in lines.items()]
    return {"bending_table": table(["kernels", *(f"{n} cells" for n in study.ACROSS)], rows)}


def _integration(out: Path) -> dict:
    """Gauss points of a cell, for both bases."""
    lines, rows = {}, []
    for order, points, rays in study.INTEGRATION:
        found = _over_layers("worst_error", rays=rays, **study.integrated(order, points))
        name = "{} × {}".format(*points)
        rows.append([BASES[order], name, rays, *map(percent, found)])
        if order == 2:
            lines[f"{rays} radial rows, {name}"] = study.LAYERS, found
    path, heads = out / "error_integration.png", ["basis", "Gauss points", "radial rows"]
    words = ", quadratic basis"
    return {"integration_table": _by_layers(path, lines, rows, heads, words)}


def _refinement(out: Path) -> dict:
    """Rays, layers, support and basis, with integration that matches, from the limit of elements."""
    every_rays = (58, 116, 174)
    lines, rows, errors = {}, [], []
    for functions in FUNCTIONS:
        basis = BASES[functions["basis_order"]]
        name = "{}, {:g} and {:g}".format(basis, *functions["support"])
        for rays in every_rays:
            found = _over_layers("limit_error", rays=rays, **functions)
            rows.append([name, rays, *map(percent, found)])
            errors.append(found)
            if rays < 174 and functions is not FUNCTIONS[1]:
                lines[f"{rays} radial rows, {name}"] = study.LAYERS, found
    path, heads = out / "error_refinement.png", ["basis and support", "radial rows"]
    made = _by_layers(path, lines, rows, heads)
    shares = FLAT / REACTION[:, 1] - 1.0
    limits = f"{percent(-shares.max(), 1)} to {percent(-shares.min(), 1)}"
    errors = np.reshape(errors, (len(FUNCTIONS), len(every_rays), -1))
    changes = np.concatenate([np.diff(errors, axis=axis).ravel() for axis in range(3)])
    return {
        "refinement_table": made, "limits": limits,
        "pairs": changes.size, "better": int(np.sum(changes < 0.0)),
        "corner_force": f"{CORNER[-1]:.2f}", "corner_gap": f"{GAP:.4f}",
    }  # fmt: skip


def _penalty(out: Path) -> dict:
    """Change of the reaction against the hardest penalty."""
    penalties = study.PENALTIES
    errors = np.array(
        [stored("flat_errors", normal_penalty=w, **study.ENGINEERING) for w in penalties]
    )
    change = np.abs(errors[:-1] - errors[-1]).max(axis=1)
    figure = {"normal penalty": (np.log10(penalties[:-1]), change)}
    value = "largest change of the reaction (%)"
    _lines(out / "error_penalty.png", "log₁₀ w (kPa/mm)", figure, value)
    place = penalties.index(1e4)
    return {"penalty": percent(change[place], 3), "hardest": f"{penalties[-1]:g}"}


def _steps(out: Path) -> dict:
    """Load steps: equal ones, chosen ones, and those of the examples."""
    equal = [stored("equal_steps", steps=n) for n in study.EQUAL_STEPS]
    chosen = [stored("chosen_steps", tolerance=t) for t in study.TOLERANCES]
    measures, forces = ([own[name] for own in equal] for name in ("measures", "forces"))
    lines = {
        "measures, equal steps": (study.EQUAL_STEPS, measures),
        "forces, equal steps": (study.EQUAL_STEPS, forces),
        "measures and forces, automatic steps": ([own["steps"] for own in chosen],
                                                 [own["own"] for own in chosen]),
    }  # fmt: skip
    value = "difference from four times as many (%)"
    _lines(out / "error_steps.png", "load steps", lines, value)
    rows = [[f"{own['steps']} equal", *_differences(own)] for own in equal]
    rows += [
        [f"{own['steps']} automatic, tolerance {percent(t, 1)}", *_differences(own)]
        for t, own in zip(study.TOLERANCES, chosen, strict=True)
    ]
    examples = []
    for path in sorted(study.EXAMPLES.glob("*.toml")):
        own = stored("example_steps", name=path.stem)
        ratio = f"{own['ratio']:.3g}"
        examples.append([f"`{path.stem}`", own["steps"], ratio, *_differences(own), own["solved"]])
    head = [
        "file", "load steps", "longest over shortest", "error of measures", "error of forces",
        "steps solved for the choice",
    ]  # fmt: skip
    return {
        "steps_table": table(["load steps", "error of measures", "error of forces"], rows),
        "examples_steps_table": table(head, examples),
    }


def _differences(own: dict) -> list[str]:
    return [percent(own["measures"]), percent(own["forces"])]


def _penalties() -> dict:
    """Sections whose force independent finite elements know: error and its estimate, by penalties."""
    rows = []
    for name in study.SECTIONS:
        known = json.loads((study.REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
        exact, uncertain = known["force_N_per_m"][-1], known["relative_uncertainty"][-1]
        both = [stored("section_error", name=name, soft=soft) for soft in (False, True)]
        cells = [percent(own[value]) for own in both for value in ("error", "estimate")]
        largest = f"{both[0]['penalty']:.2g}"
        rows.append([f"`{name}`", f"{exact:.1f}", percent(uncertain, 2), largest, *cells])
    head = [
        "section", "finite elements (N/m)", "their uncertainty", "automatic normal penalty (kPa/mm)",
        "error", "estimated error of the penalties", "error with 10⁴, 10² kPa/mm",
        "estimated error of the penalties",
    ]  # fmt: skip
    return {"sections_table": table(head, rows)}


def _times(seals: dict, repeats: int) -> dict[str, float]:
    """Median time of an analysis; the first is left out for what it compiles."""
    times = {name: [] for name in seals}
    for _ in range(repeats + 1):
        for name, seal in seals.items():
            start = process_time()
            analyze(seal)
            times[name].append(process_time() - start)
    return {name: float(np.median(own[1:])) for name, own in times.items()}


def _preset(repeats: int) -> dict:
    """Error and time of all accuracies side by side, and the gap along the boundary."""
    seals = {name: door_seal(accuracy=name) for name in ACCURACIES}
    times = _times(seals, repeats)
    gaps = [stored("opened_gap", **study.gap_options(*own)) for own in study.REFINEMENTS]
    rows_of_gaps = [
        [f"{rays} × {layers}", parts, f"{gap:.4f}", percent(gap / gaps[-1] - 1.0)]
        for (rays, layers, parts), gap in zip(study.REFINEMENTS, gaps, strict=True)
    ]
    gap_head = ["uniform ring", "refinement", "largest gap (mm)", "difference from the last row"]
    rows, reached = [], {}
    for name, seal in seals.items():
        error = np.abs(stored("flat_errors", accuracy=name, n_steps=seal.n_steps)).max()
        away, gap = (stored(of, accuracy=name) for of in ("corner_error", "opened_gap"))
        size = f"{options_of(seal).grid.rays} × {options_of(seal).layers}, {seal.n_steps} steps"
        reached[name] = ", ".join(map(percent, (error, away, abs(gap / GAP - 1.0))))
        rows.append([
            name, size, percent(error), percent(away), f"{gap:.4f}", percent(gap / GAP - 1.0),
            f"{times[name] / times['paper']:.2f}",
        ])  # fmt: skip
    head = [
        "accuracy", "particles", "largest error, flat door", "error, corner door", "largest gap (mm)",
        "error of the gap", "relative time",
    ]  # fmt: skip
    at = {
        f"at_{points}": percent(
            stored("worst_error", **study.ENGINEERING | {"contact_points": points})
        )
        for points in COMPARED
    }
    return at | {
        "gap_table": table(gap_head, rows_of_gaps),
        "preset_table": table(head, rows),
        "engineering": reached["engineering"],
        "fine": reached["fine"],
    }


def _outline(_: Path) -> dict:
    """The same section filled as that of a seal file."""
    rows = []
    for spacing in study.SPACINGS:
        found = [stored("outline_error", spacing=spacing, scheme=name) for name in study.SCHEMES]
        errors = [percent(own["error"]) for own in found]
        rows.append([f"{spacing:g}", found[0]["particles"], *errors])
    return {"outline_table": table(["spacing (mm)", "particles", *study.SCHEMES], rows)}


def _rays() -> dict:
    """Walls on rays: a bulb, and the door seal, touched at the particles or between them."""
    found = {rays: stored("bulb_errors", rays=rays) for rays in study.RAYS}
    rows = [[rays, *(percent(own[p]) for p in COMPARED)] for rays, own in found.items()]
    gaps = {
        points: stored("opened_gap", accuracy="engineering", contact_points=points)
        for points in COMPARED
    }
    return {
        "rays_table": table(["radial rows", "contact at particles", "contact at edges"], rows),
        "rays_apart": percent(found[study.RAYS[0]]["apart"]),
        **{f"gap_at_{points}": percent(abs(gap / GAP - 1.0)) for points, gap in gaps.items()},
    }


def _files() -> dict:
    """Examples against half their spacing: kernels, and where the contact is."""
    rows = []
    for name in study.FILES:
        own = stored("file_errors", name=name)
        found = [percent(error) for error in own["errors"]]
        rows.append([name, own["particles"], *found, *["–"] * (3 - len(found))])
    head = [
        "file", "particles", "linear, support 2.2 (default)", "quadratic, support 2.6",
        "linear, contact at edges",
    ]  # fmt: skip
    return {"files_table": table(head, rows)}
