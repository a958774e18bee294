"""Ladder of benchmarks: tables and figures from the values that ``tests.benchmarks.ladder`` stored."""

import json
from pathlib import Path

import numpy as np
from benchmarks.ladder.rungs import RUNGS

from figures.drawing import ROOT, picture
from figures.tables import NONE, percent, table
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, VERMILION

STORED = ROOT / "docs" / "benchmarks" / "ladder.json"

CLEAR = 0.003
"""Least relative difference that an estimate is compared with."""


def make(out: Path, reduced: bool) -> dict:
    """All tables and figures of the page."""
    stored = json.loads(STORED.read_text(encoding="utf-8"))
    rungs = {name: own for name, own in stored["rungs"].items() if name in RUNGS}
    compared = {name: own for name, own in rungs.items() if own.get("elements")}
    _values(out / "ladder.png", compared)
    _ironing(out / "ironing.png", rungs["ironing"])
    numbers = {f"{name}_table": _table(RUNGS[name], own) for name, own in rungs.items()}
    numbers["stability_table"] = _stability(stored["sealing_stability"])
    ends = [own["end_mm"] for own in stored["sealing_elements"]]
    numbers["elements_end"] = f"{min(ends):.2f} to {max(ends):.2f} mm"
    numbers["effectivity"] = _effectivity(rungs)
    return numbers | {"summary": _summary(rungs), "times": _times(rungs)}


def reference(own: dict) -> tuple[np.ndarray, np.ndarray, str]:
    """Values that a rung is compared with, their relative uncertainty, and what they are of.

    Elements of the finest mesh, uncertain by twice the change by the last refinement; the finest cloud
    where there are no elements.
    """
    kind = "elements" if own.get("elements") else "particles"
    before, last = (np.array(row["values"], dtype=float) for row in own[kind][-2:])
    return last, 2.0 * np.abs(before / last - 1.0), kind


def errors(row: dict, exact: np.ndarray) -> np.ndarray:
    """Differences of the values of a cloud or mesh, relative."""
    return np.array(row["values"], dtype=float) / exact - 1.0


def _signed(value: float) -> str:
    return f"{100 * value:+.2f} %"


def _number(value: float) -> str:
    return f"{value:.0f}" if value > 1e4 else f"{value:.5g}"


def _table(rung, own: dict) -> str:
    """Values, differences and times of all clouds and meshes of a rung."""
    exact, uncertain, kind = reference(own)
    head = ["", "time (s)"]
    for quantity in rung.quantities:
        head += [quantity.name, "difference"]
    rows = []
    for label in ("particles", "elements", "triangles"):
        for row in own.get(label, []):
            cells = [f"{row[label]} {label}", f"{row['seconds']:.2f}"]
            last = label == kind and row is own[label][-1]
            for value, error in zip(row["values"], errors(row, exact), strict=True):
                cells += [_number(value), "reference" if last else _signed(error)]
            rows.append([*cells, _estimated(row)])
    uncertainty = ["uncertainty of the reference", ""]
    for share in uncertain:
        uncertainty += ["", percent(share)]
    rows.append([*uncertainty, ""])
    sources = dict.fromkeys(source for own in rung.quantities for _, source in own.published)
    for name in sources:
        cells = [name, ""]
        for quantity, own_value in zip(rung.quantities, exact, strict=True):
            found = [value for value, source in quantity.published if source == name]
            cells += [_number(found[0]), _signed(found[0] / own_value - 1.0)] if found else ["", ""]
        rows.append([*cells, ""])
    return table([*head, "estimated error"], rows)


def _effectivity(rungs: dict) -> str:
    """Smallest and largest ratio of estimated error and difference, of differences above ``CLEAR``."""
    ratios = []
    for own in rungs.values():
        exact, _, _ = reference(own)
        for row in own["particles"]:
            for share, error in zip(
                row.get("estimated_error", []), errors(row, exact), strict=False
            ):
                if share is not None and abs(error) > CLEAR:
                    ratios.append(share / error)
    return f"{min(ratios):.2f} to {max(ratios):.2f}" if ratios else NONE


def _estimated(row: dict) -> str:
    """Estimated errors of the quantities where the analysis gave some."""
    found = row.get("estimated_error")
    known = [_signed(share) for share in found or [] if share is not None]
    return ", ".join(known) if known else NONE


def _summary(rungs: dict) -> str:
    """Largest differences of every rung on its clouds."""
    rows = []
    for name, own in rungs.items():
        exact, uncertain, kind = reference(own)
        found = [
            f"{percent(np.abs(errors(row, exact)).max())} ({row['particles']})"
            for row in own["particles"]
        ]
        of = "finest mesh" if kind == "elements" else "finest cloud"
        rows.append([RUNGS[name].title, *found, of, percent(uncertain.max())])
    head = ["benchmark", *(f"{name} cloud" for name in ("coarse", "middle", "fine"))]
    return table([*head, "compared with", "uncertainty"], rows)


def _times(rungs: dict) -> str:
    """Time of every cloud beside the fastest mesh that is at least as accurate."""
    rows = []
    for name, own in rungs.items():
        if not own.get("elements"):
            continue
        exact, _, _ = reference(own)
        meshes = [*own["elements"][:-1], *own.get("triangles", [])]
        for row in own["particles"]:
            error = np.abs(errors(row, exact)).max()
            able = [mesh for mesh in meshes if np.abs(errors(mesh, exact)).max() <= error]
            peer = min(able, key=lambda mesh: mesh["seconds"], default=None)
            cells = [RUNGS[name].title, "thin" if RUNGS[name].thin else "solid"]
            cells += [str(row["particles"]), percent(error), f"{row['seconds']:.2f}"]
            if peer is None:
                rows.append([*cells, "none", NONE, NONE, NONE])
                continue
            own_error = percent(np.abs(errors(peer, exact)).max())
            ratio = peer["seconds"] / row["seconds"]
            kind = "elements" if "elements" in peer else "triangles"
            cells += [f"{peer[kind]} {kind}", own_error, f"{peer['seconds']:.2f}", f"{ratio:.1f}"]
            rows.append(cells)
    head = ["benchmark", "section", "particles", "error", "time (s)"]
    return table([*head, "mesh", "error of the mesh", "time of the mesh (s)", "time ratio"], rows)


def _stability(stored: list) -> str:
    """Where the rubber sealing loses its stability, for every cloud."""
    rows = []
    for own in stored:
        end = own["end_mm"]
        rows.append([
            f"{own['particles']}, {'complete' if own['complete'] else 'half'} section",
            percent(own["eigenvalue_half_way"] - 1.0), f"{own['crease_mm']:.2f} mm",
            "({:.1f}, {:.1f}) mm".format(*own["at"]),
            "none up to 2.2 mm" if end is None else f"{end:.2f} mm",
        ])  # fmt: skip
    head = ["particles", "change of the smallest eigenvalue from the first load step to 1.1 mm"]
    head += ["travel at a stretch of 0.647", "location", "travel at the end of the branch"]
    return table(head, rows)


def _ironing(path: Path, own: dict) -> None:
    """Forces along the path of all clouds, and the ratio of the forces beside the literature."""
    with picture(path, 1, 2, width=9.0, height=3.4) as (left, right):
        for row, color in zip(own["particles"], CYCLE, strict=False):
            stage, travel, fx, fy = np.array(row["curve"]).T
            label = f"{row['particles']} particles"
            place = np.where(stage == 1, travel - travel[stage == 1].max(), travel)
            left.plot(place, 1e-3 * np.abs(fy), color=color, label=label)
            left.plot(place, 1e-3 * np.abs(fx), color=color, linestyle="--")
            drawn = stage == 2
            right.plot(travel[drawn], np.abs(fx[drawn] / fy[drawn]), color=color, label=label)
        for value, _ in RUNGS["ironing"].quantities[2].published:
            right.axhline(value, color=GREY, linewidth=0.8, linestyle=":")
        right.plot([], [], color=GREY, linestyle=":", label="literature, at 5 mm")
        left.set(
            xlabel="pressing (negative), sliding (mm)", ylabel="vertical, dashed: horizontal (kN/m)"
        )
        right.set(xlabel="sliding (mm)", ylabel="horizontal over vertical force", ylim=(0.2, 0.6))
        left.legend(fontsize=7)
        right.legend(fontsize=7)


def _values(path: Path, rungs: dict) -> None:
    """Differences of all quantities over the time, a panel for every rung."""
    count = len(rungs)
    with picture(path, -(-count // 2), 2, width=9.0, height=2.6 * -(-count // 2)) as axes:
        for axis, (name, own) in zip(np.ravel(axes), rungs.items(), strict=False):
            exact, uncertain, kind = reference(own)
            looks = ("particles", BLUE, "o"), ("elements", VERMILION, "s"), ("triangles", GREY, "^")
            for label, color, marker in looks:
                if label not in own:
                    continue
                rows = own.get(label, [])
                rows = rows[:-1] if label == kind else rows
                for k in range(len(exact)):
                    axis.plot(
                        [row["seconds"] for row in rows],
                        [100 * errors(row, exact)[k] for row in rows],
                        marker=marker, color=color, linestyle=("-", "--")[k % 2],
                        label=label if k == 0 else None,
                    )  # fmt: skip
            axis.axhspan(-100 * uncertain.max(), 100 * uncertain.max(), color=GREY, alpha=0.3)
            axis.set_xscale("log")
            axis.xaxis.set_major_formatter("{x:g}")
            axis.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "25" else "")
            axis.set(xlabel="processor time (s)", ylabel="difference (%)")
            axis.set_title(RUNGS[name].title, fontsize=8)
            axis.legend(fontsize=7)
        for axis in np.ravel(axes)[count:]:
            axis.set_visible(False)
