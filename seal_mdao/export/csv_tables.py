"""Export to CSV: profiles along the path, contact along edges, boundary of a design."""

import csv
from pathlib import Path

import numpy as np

from seal_mdao.contact.friction import OPEN, SLIP
from seal_mdao.seals.cavities import cavity_pressures
from seal_mdao.seals.path_times import times_at
from seal_mdao.seals.profiles import (
    arc_length,
    contact_positions,
    contacts,
    moving_histories,
    nominal_pressure,
    true_pressure,
)

CURVE_HEADER = (
    "step", "stage", "travel_mm", "turn_deg", "x_mm", "y_mm", "angle_deg", "Fx_N_per_m", "Fy_N_per_m",
    "Fx_N_per_100mm", "Fy_N_per_100mm", "deformed_contact_width_mm", "true_peak_pressure_kPa",
    "contact_width_mm", "peak_pressure_kPa",
)  # fmt: skip
"""``time_s`` follows ``stage`` where the stages take time. ``contact_width_mm`` and
``peak_pressure_kPa`` are nominal values, per undeformed length; the excess pressure of every cavity
follows in a column of its own, ``LABEL_excess_pressure_kPa``."""
EDGE_HEADER = (
    "step", "arc_length_mm", "X_mm", "Y_mm", "x_mm", "y_mm", "gap_mm", "true_pressure_kPa",
    "pressure_kPa", "state",
)  # fmt: skip
"""``pressure_kPa`` is the nominal pressure, force over undeformed length."""

SWEEP_HEADER = ("profile", "step", "stage", "travel_mm", "Fx_N_per_m", "Fy_N_per_m")

STATE_NAMES = {OPEN: "open", SLIP: "slip"}


def in_units(header, units) -> list[str]:
    """Name the columns of forces of a header by the units of the seal."""
    return [
        name.replace("N_per_m", units.force_key) if name.endswith("N_per_m") else name
        for name in header
    ]


def write_curves(result, folder) -> list[Path]:
    """Write ``curve_NAME.csv`` for every profile and moved edges: a row for each nominal step."""
    written, cavities, units = [], cavity_pressures(result), result.seal.units
    header = (
        *in_units(CURVE_HEADER, units),
        *(f"{label}_excess_pressure_kPa" for label in cavities),
    )
    time = times_at(result.seal, [step.fraction for step in result.path.nominal_steps])
    if time is not None:
        header = (*header[:2], "time_s", *header[2:])
    for history in moving_histories(result):
        # columns in the order of CURVE_HEADER
        columns = (
            np.arange(1, len(history.stage) + 1), history.stage, *([] if time is None else [time]),
            history.travel, history.turn, *history.place.T, *history.force.T,
            *(units.per_100_mm * history.force.T), history.width, history.peak,
            history.nominal_width, history.nominal_peak, *cavities.values(),
        )  # fmt: skip
        path = Path(folder) / f"curve_{history.label}.csv"
        written.append(_write(path, header, zip(*columns, strict=True)))
    return written


def write_contact(result, folder, steps=None) -> list[Path]:
    """Write ``contact_NAME.csv`` for every profile: gap, pressures and state of every
    contact point, at nominal ``steps`` from 0 (``result.key_steps()``)."""
    steps, written = result.key_steps() if steps is None else steps, []
    for contact in contacts(result.seal):
        points, rows = contact_positions(result, contact.label), []
        arc = arc_length(result, contact.label)
        for step in steps:
            response = result.path.at_nominal(contact.label)[step]
            words = [STATE_NAMES.get(state, "stick") for state in response.state]
            # force over deformed and over undeformed length
            true = true_pressure(result, contact, step)
            nominal = nominal_pressure(contact, response)
            # columns in the order of EDGE_HEADER; steps are numbered from 1 in files
            numbers = np.column_stack([arc, points, response.x, response.gap, true, nominal])
            rows += [(step + 1, *row, word) for row, word in zip(numbers, words, strict=True)]
        path = Path(folder) / f"contact_{contact.label}.csv"
        written.append(_write(path, EDGE_HEADER, rows))
    return written


def write_boundary(seal, offsets, path) -> Path:
    """Write the boundary particles of a design, edge by edge in order.

    Parameters
    ----------
    seal : Seal
    offsets : ndarray, shape (seal.n_offsets,)
        mm.
    path : str or Path
    """
    # particles of the design X(b)
    particles, rows = seal.particles(offsets), []
    for name, edge in seal.body.edges.items():
        ring = np.append(edge.particles, edge.particles[:1]) if edge.closed else edge.particles
        # nominal and present coordinates; the columns of the file keep the name ``nominal``
        rows += [(name, *nominal, *now) for nominal, now in
                 zip(seal.nominal_particles[ring], particles[ring], strict=True)]  # fmt: skip
    return _write(Path(path), ("edge", "drawn_x_mm", "drawn_y_mm", "x_mm", "y_mm"), rows)


def write_sweep_curves(name: str, results, path) -> Path:
    """Write the load-deflection curves of a sweep: a row for every value, profile and nominal step,
    forces on a ring in N and in N per mm of its circumference.

    Parameters
    ----------
    name : str
        Of the number that varies.
    results : mapping of float to SealResult
        By its value; complete, or up to where the path ended.
    path : str or Path
    """
    rows = [
        (value, own.label, step, *numbers)
        for value, result in results.items()
        for own in moving_histories(result)
        for step, numbers in enumerate(
            np.column_stack([own.stage, own.travel, *_in_all_units(own.force, result)]).tolist(), 1
        )
    ]
    units = next(iter(results.values())).seal.units
    around = ("Fx_N_per_mm", "Fy_N_per_mm") if units.radius else ()
    return _write(Path(path), (name, *in_units(SWEEP_HEADER, units), *around), rows)


def _in_all_units(force: np.ndarray, result) -> list[np.ndarray]:
    """List the force on a profile, (n_steps, 2) in N/m or N, and that of a ring per mm, too."""
    units = result.seal.units
    return [force, units.per_mm * force] if units.radius else [force]


def travel_table(result) -> np.ndarray:
    """Tabulate travel of the leading profile (mm) and both components of the force on it (N/m or N) of
    every step, shape (n_steps, 3)."""
    # travel without noise of rounding
    return np.column_stack([np.round(result.travel, 12), result.reaction])


def reaction_tables(result) -> dict[str, list]:
    """Tabulate stage (from 1), travel in it (mm), Fx, Fy (N/m or N) of every step for every profile
    and moved edges."""
    return {
        own.label: [
            [int(stage), round(float(travel), 12), *map(float, force)]
            for stage, travel, force in zip(own.stage, own.travel, own.force, strict=True)
        ]
        for own in moving_histories(result)
    }


def _write(path: Path, header, rows) -> Path:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(header)
        writer.writerows(
            # 12 digits: beyond the accuracy of any result, without noise of rounding
            [value if isinstance(value, str) else f"{value:.12g}" for value in row]
            for row in rows
        )
    return path
