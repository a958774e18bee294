"""Loss of stability of the rubber sealing on its way to 2.2 mm.

``python -m tests.benchmarks.ladder.sealing_stability`` adds a table to ``docs/benchmarks/ladder.json``.
"""

import json
from dataclasses import replace
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from seal_mdao.equilibrium.eigenmodes import nearest_mode
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.creases import CREASES
from seal_mdao.seals.evaluation_points import EvaluationPoints
from seal_mdao.seals.file.read import read_seal_file
from seal_mdao.seals.instabilities import instabilities
from seal_mdao.seals.result import analyze

from .rungs import HERE

HALF, COMPLETE = HERE / "rubber_sealing.toml", HERE / "rubber_sealing_complete.toml"
TRAVEL, STEPS = 2.2, 40
"""Of the top, mm."""
SIZES = (1.0, 0.5)
"""Of the elements, mm."""
CASES = ((HALF, 0.6), (HALF, 0.4), (HALF, 0.3), (COMPLETE, 0.6))


def moved(file: Path, spacing: float):
    """The seal of a file with another spacing, its top moved by ``TRAVEL`` in one stage."""
    own = read_seal_file(file)
    (plate,) = own.moved
    stage = replace(plate.stages[0], translate=(0.0, -TRAVEL), steps=STEPS)
    section = replace(own.section, spacing=spacing)
    return build_seal(replace(own, section=section, moved=(replace(plate, stages=(stage,)),)))


def least_stretch(result) -> tuple[float, np.ndarray]:
    """Least stretch of a side of the cavity between two particles, and its undeformed middle, mm."""
    samples = EvaluationPoints(result.path)
    chains = samples.chains
    inner = np.all(np.abs(samples.undeformed[chains[:, 2]] - [0.0, 4.5]) < [5.5, 2.6], axis=1)
    ends = chains[inner][:, [0, -1]]
    # |x_b - x_a| / |X_b - X_a|
    lengths = [
        np.hypot(*(x[ends[:, 1]] - x[ends[:, 0]]).T) for x in (samples.places, samples.undeformed)
    ]
    stretch = lengths[0] / lengths[1]
    worst = int(stretch.argmin())
    return float(stretch[worst]), samples.undeformed[chains[inner][worst, 2]]


def stability(file: Path, spacing: float) -> dict:
    """Travels at which creases become possible and at which the branch ends, and eigenvalues.

    Returns
    -------
    dict
        ``crease_mm`` (interpolated), ``at`` (x, y of the side), ``end_mm`` (None without an end up to
        ``TRAVEL``), and the least eigenvalue of the tangent half way over that of the first load step.
    """
    seal = moved(file, spacing)
    result = analyze(seal, keep_factors=True)
    travel = TRAVEL / STEPS * np.arange(1, STEPS + 1)
    found = instabilities(result)
    last = found[0].fraction if found else STEPS
    stretches, places = zip(
        *(
            least_stretch(up)
            for up in result.up_to_each_step()
            if up.path.steps[-1].fraction <= last
        ),
        strict=True,
    )
    # the first load step below the threshold, interpolated; stretches fall along the branch
    below = int(np.argmax(np.array(stretches) < CREASES))
    crease = np.interp(
        -CREASES, -np.array(stretches[below - 1 : below + 1]), travel[below - 1 : below + 1]
    )
    n = result.path.discretization.layout.n_equations
    values = [
        nearest_mode(result.path.nominal_steps[k].factor, n, True)[0] for k in (0, STEPS // 2 - 1)
    ]
    return {
        "complete": file == COMPLETE,
        "spacing": spacing,
        "particles": len(result.particles),
        "crease_mm": round(float(crease), 3),
        "at": [round(float(x), 2) for x in places[below]],
        "end_mm": round(found[0].fraction * TRAVEL / STEPS, 3) if found else None,
        "eigenvalue_half_way": round(values[1] / values[0], 4),
    }


def elements_end(size: float) -> dict:
    """Last travel at which finite elements of a size (mm) have an equilibrium, load steps halved."""
    from .elements import rubber_sealing

    reached = []
    path = TRAVEL / STEPS * np.arange(1, STEPS + 1)
    cells = rubber_sealing(size, path, lambda travel, force: reached.append(travel))
    return {"size": size, "elements": cells, "end_mm": round(float(reached[-1]), 3)}


def main() -> None:
    file = Path("docs/benchmarks/ladder.json")
    found = {"sealing_stability": [], "sealing_elements": []}
    with one_blas_thread:
        for case in CASES:
            found["sealing_stability"].append(stability(*case))
            print(found["sealing_stability"][-1], flush=True)
        for size in SIZES if find_spec("felupe") else ():
            found["sealing_elements"].append(elements_end(size))
            print(found["sealing_elements"][-1], flush=True)
    stored = json.loads(file.read_text(encoding="utf-8"))
    # without FElupe the elements of an earlier run stay
    stored.update({name: rows for name, rows in found.items() if rows})
    file.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
