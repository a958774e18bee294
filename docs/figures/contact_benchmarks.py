"""Benchmarks of contact and friction: Hertz, an O-ring, a dragged block, a belt.

The forces of the O-ring are stored by ``verification.accuracy_study``.
"""

from pathlib import Path

import numpy as np
from verification.accuracy_study import SQUEEZED, stored, stored_date
from verification.hertz import press_cylinder
from verification.o_ring import SqueezedRing, lindley_force, small_force, small_squeeze
from verification.sliding import drag_block, pull_belt

import seal_mdao as sm
from figures.drawing import ROOT, captioned_body, curves, picture
from figures.tables import percent, power, table
from seal_mdao.plotting.captions import captioned, seal_text
from seal_mdao.plotting.style import BLUE, CYCLE, GREY, MARKERS, VERMILION

FRICTION = 0.3
RING = ROOT / "examples" / "o_ring.toml"


def make(out: Path, reduced: bool) -> dict:
    """Pictures, tables and numbers."""
    return _hertz(out, reduced) | _o_ring(out) | _drag(out) | _belt(out, reduced)


@captioned_body("cylinder on a plane")
def _hertz(out: Path, reduced: bool) -> dict:
    found = [press_cylinder(n) for n in ((4,) if reduced else (4, 8, 12))]
    errors = [(h.half_width / h.exact_half_width - 1, h.peak / h.exact_peak - 1) for h in found]
    rows = [
        [str(len(h.x)), *(percent(value) for value in error)]
        for h, error in zip(found, errors, strict=True)
    ]
    s = np.linspace(0.0, np.pi, 201)
    lines = [(np.cos(s), np.sin(s), "-", GREY, "Hertz")]
    lines += [
        (h.x / h.exact_half_width, h.pressure / h.exact_peak, marker, color,
         f"{len(h.x)} points in contact", {"markersize": 4})
        for h, color, marker in zip(found, CYCLE, MARKERS, strict=False)
    ]  # fmt: skip
    labels = "distance from the centre / half-width", "pressure / peak pressure"
    curves(out / "hertz.png", *labels, lines, (5.6, 3.5), {"loc": "lower center"})
    head = ["points in contact", "error of the half-width", "error of the peak pressure"]
    finest = ", ".join(percent(abs(value)) for value in errors[-1])
    return {"hertz_table": table(head, rows), "hertz": finest}


def _o_ring(out: Path) -> dict:
    chosen, spacings = (1, 3, 5, 7, 15, 23, 31, 39), SQUEEZED
    # the finest ring takes most of the time of this group
    rings = [
        SqueezedRing(**{n: _array(own) for n, own in stored("squeezed_ring", spacing=s).items()})
        for s in spacings
    ]
    rows = []
    for step in chosen:
        c, size = rings[0].squeeze[step], (rings[0].diameter, rings[0].modulus)
        known = [law(c, *size) for law in (small_force, lindley_force)]
        rows.append([percent(c), f"{rings[-1].force[step]:.0f}", *(f"{x:.0f}" for x in known)])
        law = known[0] if c <= 0.05 else known[1]
        rows[-1] += [percent(ring.force[step] / law - 1.0) for ring in rings]
        peak = small_squeeze(rings[-1].force[step], *size)[2]
        rows[-1].append(percent(rings[-1].peak[step] / peak - 1.0) if c <= 0.05 else "")
    with captioned({RING.stem: seal_text(sm.read_seal_file(RING))}, stored_date()):
        _o_ring_picture(out / "o_ring_force.png", rings[-1])
    head = [
        "squeeze", "force (N/m)", "closed form", "Lindley",
        *(f"error at {spacing:g} mm" for spacing in spacings), "error of the peak pressure",
    ]  # fmt: skip
    size = rings[-1].diameter, rings[-1].modulus
    small, large = (
        max(abs(rings[-1].force[k] / law(rings[-1].squeeze[k], *size) - 1.0) for k in steps)
        for law, steps in ((small_force, chosen[:4]), (lindley_force, chosen[4:]))
    )
    return {
        "o_ring_table": table(head, rows), "o_ring_small": percent(small),
        "o_ring_large": percent(large),
    }  # fmt: skip


def _array(own):
    return np.array(own) if isinstance(own, list) else own


def _o_ring_picture(path: Path, ring) -> None:
    squeeze, size = np.linspace(1e-3, ring.squeeze[-1], 200), (ring.diameter, ring.modulus)
    lines = [
        (100 * squeeze, [1e-3 * law(c, *size) for c in squeeze], look, GREY, label)
        for law, label, look in (
            (small_force, "closed form, small squeeze", "--"), (lindley_force, "Lindley", "-"),
        )
    ]  # fmt: skip
    computed = "o", BLUE, "seal_mdao", {"markersize": 3.5}
    lines.append((100 * ring.squeeze, 1e-3 * ring.force, *computed))
    curves(path, "squeeze (% of the diameter)", "force (N/mm)", lines, (5.6, 3.5))


@captioned_body("dragged block")
def _drag(out: Path) -> dict:
    found = drag_block(FRICTION)
    error = np.abs(np.abs(found.ratio[found.slipping]) / FRICTION - 1.0).max()
    balance = np.abs(found.base_ratio - found.ratio).max()
    _drag_picture(out / "drag.png", found)
    return {"drag": power(error), "drag_base": power(balance)}


def _drag_picture(path: Path, found) -> None:
    with picture(path, width=5.6, height=3.4) as axes:
        for level in (-FRICTION, FRICTION):
            axes.axhline(level, color=GREY, linestyle="--", linewidth=1.0)
        axes.plot(found.travel, found.ratio, color=BLUE, linewidth=1.0, zorder=2)
        for chosen, fill, label in (
            (found.slipping, VERMILION, "all points slip"), (~found.slipping, "white", "some stick"),
        ):  # fmt: skip
            axes.plot(
                found.travel[chosen], found.ratio[chosen], "o", markerfacecolor=fill,
                markeredgecolor=BLUE, markersize=4.5, label=label, zorder=3,
            )  # fmt: skip
        axes.set_xlabel("travel of the plane / height of the block")
        axes.set_ylabel("tangential / normal force")
        axes.legend(loc="center left")


@captioned_body("belt on a cylinder")
def _belt(out: Path, reduced: bool) -> dict:
    found = [pull_belt(FRICTION, t) for t in ((0.4,) if reduced else (0.4, 0.2, 0.1))]
    rows = []
    for belt in found:
        corrected = belt.exact / (1.0 + 0.5 * belt.thickness)
        rows.append([
            f"{belt.thickness:g}", f"{belt.exponent:.4f}", percent(belt.exponent / belt.exact - 1),
            percent(belt.exponent / corrected - 1),
        ])  # fmt: skip
    numbers = {"belt_exact": f"{found[0].exact:.4f}"}
    if not reduced:
        coarse, thin = (belt.exponent / belt.exact for belt in found[-2:])
        numbers["belt"] = percent(abs(thin - 1.0))
        numbers["belt_limit"] = percent(abs(2.0 * thin - coarse - 1.0))
    thickness = np.array([belt.thickness for belt in found])
    t = np.linspace(0.0, 1.05 * thickness.max(), 51)
    corrected, exponents = found[0].exact / (1 + 0.5 * t), [belt.exponent for belt in found]
    curves(out / "belt.png", "thickness / radius", "$\\ln(T_2 / T_1)$", [
        (t, corrected, "--", GREY, "$\\mu\\varphi\\,R/(R + t/2)$"),
        (0.0, found[0].exact, "s", VERMILION, "$\\mu\\varphi$"),
        (thickness, exponents, "o", BLUE, "computed"),
    ], (5.2, 3.3))  # fmt: skip
    head = ["thickness / radius", "$\\ln(T_2/T_1)$", "against $\\mu\\varphi$",
            "against $\\mu\\varphi\\,R/(R + t/2)$"]  # fmt: skip
    return numbers | {"belt_table": table(head, rows)}
