"""Bodies of revolution: errors stored by ``verification.accuracy_study``."""

from pathlib import Path

from verification.accuracy_study import DISCS, INNER, RING_RADII, RINGS, WALL_CELLS, stored

from figures.tables import NONE, percent, power, table

TITLES = {
    "ring_disc_2": "bonded disc, 2 mm thick: 0.1, 10, 20 %",
    "ring_disc_5": "bonded disc, 5 mm thick: 0.1, 10, 20 %",
    "ring_squeezed": "O-ring: 10, 20 %",
    "ring_sleeve": "sleeve: 10, 25 %",
    "ring_foam": "bonded foam disc, 5 mm thick: 10, 20 %",
    "shaft_lip": "lip on a shaft: 0.6 mm",
}
"""Bodies and their compression at the ends of the stages."""


def make(out: Path, reduced: bool) -> dict:
    """Tables and numbers."""
    return _elements() | _discs() | _exact()


def _elements() -> dict:
    """Errors of seal files against finite elements."""
    rows = []
    for name, spacings in RINGS.items():
        for spacing in spacings:
            own = stored("ring_error", name=name, spacing=spacing)
            # the pressure at the corners of the sleeve is singular
            peak = own["peak"] if name in ("ring_squeezed", "shaft_lip") else []
            rows.append([
                TITLES[name], f"{spacing:g} mm, {own['particles']}", _listed(own["force"]),
                _listed(peak) or NONE, _listed(own["uncertainty"]),
            ])  # fmt: skip
    head = [
        "body and compression", "spacing, particles", "error of the force",
        "error of the peak pressure", "uncertainty of the finite element force",
    ]  # fmt: skip
    return {"elements_table": table(head, rows)}


def _listed(values) -> str:
    return ", ".join(percent(value) for value in values)


def _discs() -> dict:
    """Apparent moduli of the bonded discs."""
    rows = []
    for name, thickness in DISCS.items():
        own = stored("disc_modulus", name=name, thickness=thickness)
        found, formula = own["computed"], own["formula"]
        rows.append([
            f"{5.0 / thickness:g}", f"{1e-3 * found:.3f}", f"{1e-3 * formula:.3f}",
            percent(found / formula - 1.0),
        ])  # fmt: skip
    head = ["shape factor", "apparent modulus (MPa)", "Gent and Lindley (MPa)", "difference"]
    return {"modulus_table": table(head, rows)}


def _exact() -> dict:
    """Errors against exact solutions and plane strain."""
    pressed = {
        kind: [
            stored("pressed_ring_error", inner=r, share=share, kind=kind)
            for r in INNER for share in (0.0, 0.3)
        ]
        for kind in ("averages", "particles")
    }  # fmt: skip
    inflated = [
        [f"{kind}, {cells} cells", power(own["displacement"], 2), power(own["force"], 2)]
        for kind in ("tube", "sphere")
        for cells in WALL_CELLS
        for own in [stored("inflated_error", kind=kind, cells=cells)]
    ]
    large = [
        [f"{radius:g}", power(stored("large_ring_error", radius=radius), 2)]
        for radius in RING_RADII
    ]
    return {
        "inflated_table": table(["body", "error of the displacement", "of the force"], inflated),
        "large_table": table(["mean radius (mm)", "difference of the force"], large),
        "pressed": power(max(own["force"] for own in pressed["averages"])),
        "pressed_pressure": power(max(own["pressure"] for own in pressed["averages"])),
        "pressed_particles": percent(max(own["force"] for own in pressed["particles"])),
        "pressure_particles": percent(max(own["pressure"] for own in pressed["particles"]), 0),
    }
