"""Quantities of the stored studies: functions of arguments that JSON can hold."""

import json
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np

from seal_mdao.file_seal import build_seal
from seal_mdao.seals.door.door_seal import door_seal
from seal_mdao.seals.file.chosen import chosen_for
from seal_mdao.seals.file.load_steps import one_step_each
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.outline.section_cloud import Kernels
from seal_mdao.seals.penalty_error import NORMAL, penalties_of
from seal_mdao.seals.refined_steps import divided, force_difference, measure_difference
from seal_mdao.seals.result import analyze
from seal_mdao.seals.steps_and_penalties import STEP_TOLERANCE, choose
from verification.difference_cases import away, case, estimate
from verification.error_sources import (
    at_travels,
    from_the_limit,
    largest_opened_gap,
    nominal,
)
from verification.file_errors import (
    LINEAR,
    QUADRATIC,
    fine_forces,
    force_error,
    forces,
    touched_at,
    with_kernels,
)
from verification.flexure import bend_block
from verification.o_ring import squeeze_ring
from verification.outline_errors import flat_door_seal, reaction_error
from verification.pressed_elements import CORNER
from verification.ray_bulb import COMPARED, limit, ray_bulb
from verification.revolution import inflation_errors, large_ring_force, pressed_ring
from verification.rings import (
    apparent_modulus,
    gent_lindley_modulus,
    ring_errors,
    ring_result,
    stage_forces,
)
from verification.seal_refinement import corner_level, flat_level
from verification.step_refinement import refine_steps

ROOT = Path(__file__).resolve().parents[2]
REFERENCES, EXAMPLES = Path(__file__).parent / "references", ROOT / "examples"
FINER = 4
"""Times as many load steps that a path is compared with."""


def limit_error(**changes) -> float:
    """Worst error of the reaction from the limit of elements with the same contact law."""
    return np.abs(from_the_limit(**changes)).max()


def bending_error(across: int, support) -> float:
    """Worst error of the moment of a block bent by half a turn, ``across`` cells thick."""
    return np.abs(bend_block(180.0, (30, across), n_steps=9, support=support).error).max()


def opened_gap(**changes) -> float:
    """Largest gap of the nominal seal within its contact, mm."""
    return largest_opened_gap(nominal(**changes))


def corner_error(accuracy: str) -> float:
    """Worst error of the reaction under the corner door."""
    return np.abs(at_travels(nominal(accuracy=accuracy)) / CORNER - 1.0).max()


def section_error(name: str, soft: bool) -> dict:
    """Error of the force on a section that finite elements know, with chosen or soft penalties."""
    seal = build_seal(touched_at(read_seal_file(REFERENCES / f"{name}.toml"), "particles"))
    known = json.loads((REFERENCES / f"{name}.json").read_text(encoding="utf-8"))
    penalties = {p.name: p.value for p in penalties_of(seal)}
    if soft:
        penalties = {n: 1e4 if n.endswith(NORMAL) else 1e2 for n in penalties}
    result = analyze(seal.with_parameters(penalties), keep_factors=True)
    force = abs(result.path.reaction(result.seal.terms()[1].label)[-1, 1])
    return {
        "penalty": max(penalties.values()),
        "error": force / known["force_N_per_m"][-1] - 1.0,
        "estimate": next(iter(result.penalty_error.values())).relative,
    }


def _step_errors(seal, ends) -> dict:
    """Differences from four times as many steps."""
    coarse, fine = (analyze(seal.with_ends(e)) for e in (ends, divided(np.array(ends), FINER)))
    at = np.arange(FINER - 1, FINER * len(ends), FINER)
    return {
        "steps": len(ends),
        "measures": measure_difference(coarse, fine),
        "forces": force_difference(coarse, fine, at),
    }


def equal_steps(steps: int) -> dict:
    """Differences of the nominal door seal with equal load steps."""
    return _step_errors(door_seal(n_steps=1), (np.arange(1, steps + 1) / steps).tolist())


def chosen_steps(tolerance: float) -> dict:
    """Those with load steps that are chosen for a tolerance, and the error that the choice finds."""
    seal = door_seal(n_steps=1)
    chosen = choose(seal, tolerance)
    return _step_errors(seal, chosen.ends) | {"own": chosen.step_error}


def example_steps(name: str) -> dict:
    """Load steps that are chosen for an example with contact at particles, whatever its file gives."""
    file = read_seal_file(EXAMPLES / f"{name}.toml")
    # bodies of revolution keep their averages
    file = file if file.axisymmetric else touched_at(file, "particles")
    fluids = tuple(replace(fluid, steps=None) for fluid in file.fluids)
    begun = replace(file, profiles=one_step_each(file.profiles), fluids=fluids, step_tolerance=None)
    seal, solved = build_seal(begun), []
    ends = choose(seal, STEP_TOLERANCE, callback=lambda step: solved.append(step.nominal)).ends
    lengths = np.diff(ends, prepend=0.0)
    ratio = lengths.max() / lengths.min()
    return _step_errors(seal, ends) | {"ratio": ratio, "solved": len(solved)}


def example_choice(name: str) -> dict:
    """Load steps and penalties that an example leaves open: keyword arguments of ``build_seal``.

    A choice analyses a path several times, a picture with the choice once.
    """
    file = read_seal_file(EXAMPLES / f"{name}.toml")
    return chosen_for(file, build_seal(file))


def squeezed_ring(spacing: float) -> dict:
    """Forces and peak pressures of the O-ring of the examples between planes."""
    return squeeze_ring(read_seal_file(EXAMPLES / "o_ring.toml"), spacing)._asdict()


SCHEMES = {
    "support 1.8": (Kernels(1.8), "particles"),
    "2.2, as in files": (LINEAR, "particles"),
    "3": (Kernels(3.0), "particles"),
    "2.6, quadratic": (QUADRATIC, "particles"),
    "the same, at edges": (QUADRATIC, "edges"),
}
"""Kernels and contact points of a section that is filled as that of a seal file."""


def outline_error(spacing: float, scheme: str) -> dict:
    """Worst error of the door seal whose section is filled as that of a seal file."""
    seal = flat_door_seal(spacing, *SCHEMES[scheme])
    return {"particles": len(seal.nominal_particles), "error": reaction_error(seal)}


bulb_limit = cache(limit)


def bulb_errors(rays: int) -> dict:
    """Errors of the force on a bulb on rays, touched at its particles or between them."""
    exact, apart = bulb_limit()
    seals = {points: ray_bulb(rays, 4, "engineering", points) for points in COMPARED}
    return {"apart": apart} | {p: force_error(forces(seal), exact) for p, seal in seals.items()}


def file_errors(name: str) -> dict:
    """Errors of the force of an example with contact at particles, from clouds of half its spacing."""
    file = touched_at(read_seal_file(EXAMPLES / f"{name}.toml"), "particles")
    seal, exact = build_seal(file), fine_forces(file)
    schemes = [with_kernels(seal, kernels) for kernels in (LINEAR, QUADRATIC)]
    if not file.fluids + file.cavities:
        schemes.append(build_seal(touched_at(file, "edges")))
    errors = [force_error(forces(scheme), exact) for scheme in schemes]
    return {"particles": len(seal.nominal_particles), "errors": errors}


def refined_steps(friction_history: str, steps: int) -> dict:
    """End of the path with a number of equal load steps: force on the door, sum of squared gaps."""
    found = refine_steps(friction_history, (steps,))
    return {"reaction": found.reaction[0], "gap_square_sum": found.gap_square_sum[0]}


def refined_corner(rays: int, layers: int) -> dict:
    """Forces and gaps under the corner door on one discretisation."""
    return corner_level(rays, layers)._asdict()


def refined_flat(rays: int, layers: int) -> dict:
    """Errors under the flat door on one discretisation."""
    return flat_level(rays, layers)._asdict()


def difference(parameter: int, seed: int | None) -> dict:
    """Derivatives of all measures of the nominal door seal, or a random one, by finite differences."""
    return estimate(case() if seed is None else away(seed), parameter)._asdict()


# ---- bodies of revolution ----


def ring_error(name: str, spacing: float) -> dict:
    """Errors of the force and the peak pressure of a ring at the ends of its stages."""
    errors, count = (
        ring_errors(name, spacing),
        len(ring_result(name, spacing).seal.nominal_particles),
    )
    # no pressure of bonded plates
    peak = errors.peak[np.isfinite(errors.peak)]
    return {
        "particles": count, "force": errors.force, "peak": peak, "uncertainty": errors.uncertainty,
    }  # fmt: skip


def disc_modulus(name: str, thickness: float) -> dict:
    """Apparent modulus of a bonded disc at 0.1 % of compression, and by Gent and Lindley, kPa."""
    rubber = read_seal_file(REFERENCES / f"{name}.toml").materials["rubber"]
    return {
        "computed": apparent_modulus(name, stage_forces(ring_result(name))[0]),
        "formula": gent_lindley_modulus(thickness, rubber.shear_modulus, rubber.bulk_modulus),
    }


def pressed_ring_error(inner: float, share: float, kind: str) -> dict:
    """Errors of a ring below a smooth plate, against a uniform state."""
    return pressed_ring(inner, share, kind)._asdict()


def inflated_error(kind: str, cells: int) -> dict:
    """Errors of an inflated tube or hemisphere."""
    return inflation_errors(kind, cells)._asdict()


def large_ring_error(radius: float) -> float:
    """Relative difference of the force of a ring of this mean radius from that of plane strain."""
    return large_ring_force(radius) / large_ring_force(None) - 1.0
