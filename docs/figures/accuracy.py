"""Sources of error of the door seal, one figure each, and what the accurate discretisation costs."""

import json
from dataclasses import replace
from pathlib import Path
from time import process_time

import numpy as np
from verification.error_sources import (
    FUNCTIONS,
    at_travels,
    flat_errors,
    from_the_limit,
    largest_opened_gap,
    nominal,
    worst_error,
)
from verification.file_errors import (
    LINEAR,
    QUADRATIC,
    at_edges,
    fine_forces,
    force_error,
    forces,
    with_kernels,
)
from verification.flat_door_reference import REACTION
from verification.flexure import bend_block
from verification.outline_errors import flat_door_seal, reaction_error
from verification.pressed_elements import CORNER, FLAT, GAP
from verification.ray_bulb import limit, ray_bulb

from figures.drawing import ROOT, picture
from figures.tables import percent, table
from seal_mdao.plotting.style import BESIDE, CYCLE, GREY, MARKERS
from seal_mdao.seals.door.door_seal import ACCURACIES, door_seal, options_of
from seal_mdao.seals.file.build import build_seal
from seal_mdao.seals.file.load_steps import one_step_each
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.outline.section_cloud import Kernels
from seal_mdao.seals.penalty_error import NORMAL, penalties_of
from seal_mdao.seals.result import analyze
from seal_mdao.seals.steps_and_penalties import (
    STEP_TOLERANCE,
    choose,
    divided,
    force_difference,
    measure_difference,
)
from seal_mdao.terms.points import CONTACT_POINTS

EXAMPLES, REFERENCES = ROOT / "examples", ROOT / "tests" / "verification" / "references"
FINER = 4
"""Times as many load steps that a path is compared with."""
PRODUCT = (1.8, 2.5)
ROUND = 2.0
BY_CELL = {"support": ROUND}, {"support": PRODUCT}
ENGINEERING = {
    name: value
    for name, value in ACCURACIES["engineering"].items()
    if name not in ("n_steps", "solver")
}
WIDE = {name: value for name, value in ENGINEERING.items() if name != "layers"}
THROUGH = WIDE | {"support": PRODUCT, "basis_order": 1}, WIDE | {"basis_order": 1}, WIDE
BASES = {1: "linear", 2: "quadratic"}
CLOUDS = ((58, 3), (58, 5), (116, 3))


def make(out: Path, reduced: bool) -> dict:
    """All figures of the page on accuracy."""
    parts = (
        _support, _layers, _bending, _integration, _refinement, _penalty, _penalties, _steps, _preset,
        _outline, _rays, _files,
    )  # fmt: skip
    return {name: value for part in parts for name, value in part(out, reduced).items()}


WORST = "worst error of the reaction (%)"


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


def _by_layers(path: Path, lines: dict, rows: list, heads, layers, words=" across the wall") -> str:
    """Write the picture of errors over the layers of particles, and return their table."""
    _lines(path, f"layers of particles{words}", lines, ticks=layers)
    return table([*heads, *(f"{n} layers" for n in layers)], rows)


def _support(out, reduced) -> dict:
    """Round supports see rows and columns of a cell alike; product ones follow its two directions."""
    supports = (1.5, 2.0) if reduced else (1.5, 1.75, 2.0, 2.5, 3.0)
    clouds = CLOUDS[:1] if reduced else CLOUDS
    lines, rows = {}, []
    for rays, layers in clouds:
        found = [worst_error(rays=rays, layers=layers, support=s) for s in supports]
        lines[f"{rays} × {layers}, round"] = supports, found
        product = worst_error(rays=rays, layers=layers, support=PRODUCT)
        rows.append([f"{rays} × {layers}", *map(percent, found), percent(product)])
    _lines(out / "error_support.png", "support of round kernels", lines)
    head = ["particles", *(f"round {s:g}" for s in supports), "product 1.8, 2.5"]
    return {"support_table": table(head, rows)}


def _layers(out, reduced) -> dict:
    """Rays and layers, for every kernel, basis, pressure and place of the contact."""
    layers = (3, 4) if reduced else (3, 4, 5, 7)
    cases = [(58, THROUGH[0])] if reduced else [
        *((rays, scheme) for scheme in BY_CELL for rays in (58, 116)),
        *((rays, scheme) for scheme in THROUGH for rays in (58, 116, 174)),
    ]  # fmt: skip
    lines, rows = {}, []
    for rays, scheme in cases:
        found = [worst_error(rays=rays, layers=n, **scheme) for n in layers]
        support = scheme["support"]
        kernel = "round 2" if np.ndim(support) == 0 else "product {:g}, {:g}".format(*support)
        basis = BASES[scheme.get("basis_order", 1)]
        pressure = scheme.get("pressure", "cell")
        if rays < 174 and scheme in (BY_CELL[0], THROUGH[0], THROUGH[2]):
            lines[f"{rays} rays, {kernel}, {basis}, {pressure}"] = layers, found
        rows.append([rays, kernel, basis, pressure, *map(percent, found)])
    heads = ["rays", "kernels", "basis", "pressure"]
    return {"layers_table": _by_layers(out / "error_layers.png", lines, rows, heads, layers)}


def _bending(out, reduced) -> dict:
    """Bending without contact: what one pressure a cell and the kernels leave."""
    across = (2, 3) if reduced else (2, 3, 4)
    lines = {}
    for name, support in (("round 2", ROUND), ("product 1.8, 2.5", PRODUCT)):
        found = [
            float(np.abs(bend_block(180.0, (30, n), n_steps=9, support=support).error).max())
            for n in across
        ]
        lines[name] = across, found
    value = "worst error of the moment (%)"
    _lines(out / "error_bending.png", "cells across the block", lines, value, across)
    rows = [[name, *map(percent, found)] for name, (_, found) in lines.items()]
    return {"bending_table": table(["kernels", *(f"{n} cells" for n in across)], rows)}


def _integration(out, reduced) -> dict:
    layers = (3, 4) if reduced else (3, 4, 5, 7)
    cases = [
        (rays, order, points)
        for order in (1, 2)
        for points in ((2, 2), (2, 3), (3, 3))
        for rays in ((58,) if reduced else (58, 116))
    ]
    lines, rows = {}, []
    for rays, order, points in cases:
        scheme = WIDE | {"basis_order": order, "n_gauss": points}
        found = [worst_error(rays=rays, layers=n, **scheme) for n in layers]
        name = "{} × {}".format(*points)
        rows.append([BASES[order], name, rays, *map(percent, found)])
        if order == 2:
            lines[f"{rays} rays, {name}"] = layers, found
    path, heads = out / "error_integration.png", ["basis", "Gauss points", "rays"]
    words = ", quadratic basis"
    return {"integration_table": _by_layers(path, lines, rows, heads, layers, words)}


def _refinement(out, reduced) -> dict:
    """Rays, layers, support and basis, with integration that matches, from the limit of elements."""
    layers = (3, 4) if reduced else (3, 4, 5, 7)
    every_rays, every = ((58,), FUNCTIONS[-1:]) if reduced else ((58, 116, 174), FUNCTIONS)
    lines, rows, errors = {}, [], []
    for functions in every:
        basis = BASES[functions["basis_order"]]
        name = "{}, {:g} and {:g}".format(basis, *functions["support"])
        for rays in every_rays:
            found = [
                float(np.abs(from_the_limit(rays=rays, layers=n, **functions)).max())
                for n in layers
            ]
            rows.append([name, rays, *map(percent, found)])
            errors.append(found)
            if rays < 174 and functions is not FUNCTIONS[1]:
                lines[f"{rays} rays, {name}"] = layers, found
    path, heads = out / "error_refinement.png", ["basis and support", "rays"]
    made = _by_layers(path, lines, rows, heads, layers)
    shares = FLAT / REACTION[:, 1] - 1.0
    limits = f"{percent(-shares.max(), 1)} to {percent(-shares.min(), 1)}"
    errors = np.reshape(errors, (len(every), len(every_rays), -1))
    changes = np.concatenate([np.diff(errors, axis=axis).ravel() for axis in range(3)])
    return {
        "refinement_table": made, "limits": limits,
        "pairs": changes.size, "better": int(np.sum(changes < 0.0)),
        "corner_force": f"{CORNER[-1]:.2f}", "corner_gap": f"{GAP:.4f}",
    }  # fmt: skip


def _penalty(out, reduced) -> dict:
    """Change of the reaction against the hardest penalty."""
    penalties = (1e3, 1e4, 1e5) if reduced else (3e2, 1e3, 3e3, 1e4, 3e4, 1e5)
    errors = np.array([flat_errors(normal_penalty=w, **ENGINEERING) for w in penalties])
    change = np.abs(errors[:-1] - errors[-1]).max(axis=1)
    figure = {"normal penalty": (np.log10(penalties[:-1]), change)}
    value = "largest change of the reaction (%)"
    _lines(out / "error_penalty.png", "log₁₀ w (kPa/mm)", figure, value)
    place = penalties.index(1e4)
    return {"penalty": percent(change[place], 3), "hardest": f"{penalties[-1]:g}"}


def _step_errors(seal, ends):
    """Differences from four times as many steps: measures, forces."""
    coarse, fine = (analyze(seal.with_ends(e)) for e in (ends, divided(np.array(ends), FINER)))
    at = np.arange(FINER - 1, FINER * len(ends), FINER)
    return measure_difference(coarse, fine), force_difference(coarse, fine, at)


def _steps(out, reduced) -> dict:
    seal = door_seal(n_steps=1, depth=3.0) if reduced else door_seal(n_steps=1)
    counts = (10, 20) if reduced else (10, 20, 35, 50, 105)
    found = [_step_errors(seal, (np.arange(1, n + 1) / n).tolist()) for n in counts]
    tolerances = (1e-2,) if reduced else (2e-2, 5e-3, 2e-3)
    chosen = [choose(seal, tolerance) for tolerance in tolerances]
    measures, forces = np.array(found).T
    lines = {
        "measures, equal steps": (counts, measures),
        "forces, equal steps": (counts, forces),
        "measures and forces, chosen steps": ([len(c.ends) for c in chosen],
                                              [c.step_error for c in chosen]),
    }  # fmt: skip
    value = "difference from four times as many (%)"
    _lines(out / "error_steps.png", "load steps", lines, value)
    rows = [[f"{n} equal", percent(m), percent(f)] for n, (m, f) in zip(counts, found, strict=True)]
    rows += [
        [f"{len(c.ends)} chosen for {percent(t, 1)}", *map(percent, _step_errors(seal, c.ends))]
        for t, c in zip(tolerances, chosen, strict=True)
    ]
    names = ["sealed_bulb"] if reduced else [path.stem for path in sorted(EXAMPLES.glob("*.toml"))]
    examples = [_chosen_for(read_seal_file(EXAMPLES / f"{name}.toml")) for name in names]
    head = [
        "file", "load steps", "longest over shortest", "measures", "forces", "solved for the choice",
    ]  # fmt: skip
    return {
        "steps_table": table(["load steps", "measures", "forces"], rows),
        "examples_steps_table": table(head, examples),
    }


def _chosen_for(file) -> list:
    """Row of a seal file whose load steps are chosen, whatever it gives."""
    fluids = tuple(replace(fluid, steps=None) for fluid in file.fluids)
    begun = replace(file, profiles=one_step_each(file.profiles), fluids=fluids, step_tolerance=None)
    seal, solved = build_seal(begun), []
    ends = choose(seal, STEP_TOLERANCE, callback=lambda step: solved.append(step.nominal)).ends
    lengths = np.diff(ends, prepend=0.0)
    return [
        f"`{file.path.stem}`", len(ends), f"{lengths.max() / lengths.min():.3g}",
        *map(percent, _step_errors(seal, ends)), len(solved),
    ]  # fmt: skip


def _penalties(out, reduced) -> dict:
    """Sections whose force independent finite elements know: error and its estimate, by penalties."""
    names = ("half_ring",) if reduced else ("half_disc", "o_ring", "bonded_gasket", "half_ring")
    rows = []
    for name in names:
        seal = build_seal(read_seal_file(REFERENCES / f"{name}.toml"))
        known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
        exact, uncertain = known["force_N_per_m"][-1], known["relative_uncertainty"][-1]
        chosen = {p.name: p.value for p in penalties_of(seal)}
        soft = dict.fromkeys(chosen, 1e2) | {n: 1e4 for n in chosen if n.endswith(NORMAL)}
        results = [analyze(seal.with_parameters(own), keep_factors=True) for own in (chosen, soft)]
        forces_of = [abs(r.path.reaction(r.seal.terms()[1].label)[-1, 1]) for r in results]
        estimates = [next(iter(r.penalty_error.values())).relative for r in results]
        cells = [percent(value) for f, e in zip(forces_of, estimates, strict=True)
                 for value in (f / exact - 1.0, e)]  # fmt: skip
        largest = max(chosen.values())
        rows.append([f"`{name}`", f"{exact:.1f}", percent(uncertain, 2), f"{largest:.2g}", *cells])
    head = [
        "section", "finite elements (N/m)", "their uncertainty", "normal penalty chosen (kPa/mm)",
        "error", "estimated part of it", "error with 10⁴, 10² kPa/mm", "estimated part of it",
    ]  # fmt: skip
    return {"sections_table": table(head, rows)}


def _preset(out, reduced) -> dict:
    """Error and time of all accuracies side by side, and the gap along the boundary."""
    seals = {name: door_seal(accuracy=name) for name in ACCURACIES}
    times = {name: [] for name in seals}
    for _ in range(1 if reduced else 5):
        for name, seal in seals.items():
            start = process_time()
            analyze(seal)
            times[name].append(process_time() - start)
    at = {
        place: percent(worst_error(**ENGINEERING | {"contact_points": place}))
        for place in CONTACT_POINTS
    }
    clouds = ((58, 4, 1), (58, 4, 2), (116, 4, 1), (116, 4, 2), (116, 5, 2), (174, 5, 2))
    refined = [
        nominal(**WIDE, layers=layers, rays=rays, refinement=parts, n_steps=105)
        for rays, layers, parts in (clouds[:1] if reduced else clouds)
    ]
    gaps = [largest_opened_gap(result) for result in refined]
    rows_of_gaps = [
        [f"{rays} × {layers}", parts, f"{gap:.4f}", percent(gap / gaps[-1] - 1.0)]
        for (rays, layers, parts), gap in zip(clouds, gaps, strict=False)
    ]
    gap_head = ["even ring", "refinement", "largest gap (mm)", "from the last"]
    rows, reached = [], {}
    for name, seal in seals.items():
        share = np.median(times[name][-4:]) / np.median(times["paper"][-4:])
        error = np.abs(flat_errors(accuracy=name, n_steps=seal.n_steps)).max()
        corner = nominal(accuracy=name)
        away = np.abs(at_travels(corner) / CORNER - 1.0).max()
        size = f"{options_of(seal).grid.rays} × {options_of(seal).layers}, {seal.n_steps} steps"
        gap = largest_opened_gap(corner)
        reached[name] = ", ".join(map(percent, (error, away, abs(gap / GAP - 1.0))))
        rows.append([
            name, size, percent(error), percent(away), f"{gap:.4f}", percent(gap / GAP - 1.0),
            f"{share:.2f}",
        ])  # fmt: skip
    head = [
        "accuracy", "particles", "worst error, flat door", "corner door", "largest gap (mm)",
        "from that of the elements", "time",
    ]  # fmt: skip
    return {
        "at_particles": at["particles"],
        "at_edges": at["edges"],
        "gap_table": table(gap_head, rows_of_gaps),
        "preset_table": table(head, rows),
        "engineering": reached["engineering"],
        "fine": reached["fine"],
    }


def _outline(out, reduced) -> dict:
    """The same section filled as that of a seal file."""
    rows = []
    for spacing in (1.2,) if reduced else (1.2, 0.9, 0.7, 0.5):
        schemes = [
            flat_door_seal(spacing, kernels)
            for kernels in (Kernels(1.8), LINEAR, Kernels(3.0), QUADRATIC)
        ]
        schemes.append(flat_door_seal(spacing, QUADRATIC, "edges"))
        found = [percent(reaction_error(scheme)) for scheme in schemes]
        rows.append([f"{spacing:g}", len(schemes[0].nominal_particles), *found])
    head = [
        "spacing (mm)", "particles", "support 1.8", "2.2, as in files", "3", "2.6, quadratic",
        "the same, at edges",
    ]  # fmt: skip
    return {"outline_table": table(head, rows)}


def _rays(out, reduced) -> dict:
    """Walls on rays: a bulb, and the door seal, touched at the particles or between them."""
    exact, apart = limit(36, 4) if reduced else limit()
    rows = []
    for rays in (24,) if reduced else (24, 36, 48, 72):
        seals = [ray_bulb(rays, 4, "engineering", points) for points in CONTACT_POINTS]
        rows.append([rays, *(percent(force_error(forces(seal), exact)) for seal in seals)])
    gaps = {
        points: largest_opened_gap(nominal(accuracy="engineering", contact_points=points))
        for points in CONTACT_POINTS
    }
    return {
        "rays_table": table(["rays", "at the particles", "at the edges"], rows),
        "rays_apart": percent(apart),
        **{f"gap_at_{points}": percent(abs(gap / GAP - 1.0)) for points, gap in gaps.items()},
    }


def _files(out, reduced) -> dict:
    """Examples against half their spacing: kernels, and where the contact is."""
    names = (
        "lip",
        "weatherstrip",
        "o_ring",
        "sealed_bulb",
        "slipping_lip",
        "o_ring_under_pressure",
    )
    rows = []
    for name in names[3:4] if reduced else names:
        file = read_seal_file(EXAMPLES / f"{name}.toml")
        seal, exact = build_seal(file), fine_forces(file)
        schemes = [with_kernels(seal, kernels) for kernels in (LINEAR, QUADRATIC)]
        if not file.fluids + file.cavities:
            schemes.append(build_seal(at_edges(file)))
        found = [percent(force_error(forces(scheme), exact)) for scheme in schemes]
        rows.append([name, len(seal.nominal_particles), *found, *["–"] * (3 - len(found))])
    head = ["file", "particles", "linear, 2.2, as in files", "quadratic, 2.6", "linear, at edges"]
    return {"files_table": table(head, rows)}
