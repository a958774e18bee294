"""Measure the ladder: ``python -m tests.benchmarks.ladder [RUNG ...] --out docs/benchmarks``.

Particles and elements of a rung run alternately in one process with one thread; the shortest processor
time of each counts. Without FElupe or NGSolve their elements of an earlier run stay.
"""

import argparse
import json
import sys
from importlib.util import find_spec
from pathlib import Path
from time import strftime

import numpy as np

if __name__ == "__main__":
    sys.path.insert(0, str(Path(__file__).resolve().parents[2]))

from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.seals.profiles import leading_motion

from .rungs import RUNGS, Rung, load_path, path_table, timed, values_of

DIGITS = 7
"""Significant digits of stored values."""
LONG = 5.0
"""Processor time above which an analysis is not repeated, s: compiling no longer matters."""


def rounded(value: float) -> float | None:
    """Round to ``DIGITS`` significant digits; None for a missing value."""
    return float(f"{value:.{DIGITS}g}") if np.isfinite(value) else None


def measured(name: str, rung: Rung, repeats: int, elements: bool) -> dict:
    """Compute a rung with all clouds and meshes, alternately ``repeats`` times."""
    seals = [rung.seal(spacing) for spacing in rung.spacings]
    rows = {("particles", spacing): None for spacing in rung.spacings}
    for kind, package, sizes in (
        ("elements", "felupe", rung.sizes), ("triangles", "ngsolve", rung.triangles),
    ):  # fmt: skip
        if elements and find_spec(package):
            rows |= {(kind, size): None for size in sizes}
    for repeat in range(repeats):
        for (kind, size), before in rows.items():
            if repeat and before["seconds"] > LONG:
                continue
            if kind == "particles":
                row = with_particles(rung, size, seals[rung.spacings.index(size)])
            else:
                row = with_elements(name, rung, kind, size, seals[-1])
            # the first run compiles kernels
            if repeat > 1:
                row["seconds"] = min(row["seconds"], before["seconds"])
            rows[kind, size] = row
            print(
                f"{name}, {kind} {size:g} mm: {row['seconds']:.2f} s, {row['values']}", flush=True
            )
    found = {"seal_file": rung.digest}
    for (kind, _), row in rows.items():
        found.setdefault(kind, []).append(row)
    return found


def with_particles(rung: Rung, spacing: float, seal) -> dict:
    """Analyse a cloud of a rung."""
    result, seconds = timed(seal)
    curve = {"curve": path_table(result).round(3).tolist()} if rung.curve else {}
    return {
        "spacing": spacing,
        "particles": len(result.particles),
        "steps": seal.n_steps,
        "seconds": seconds,
        "values": [*map(rounded, values_of(rung, result))],
    } | curve


def with_elements(name: str, rung: Rung, kind: str, size: float, seal) -> dict:
    """Solve a mesh of a rung, of FElupe or NGSolve, with the load steps of a seal."""
    motion = leading_motion(seal)
    n_stages = round(float(motion.ends[-1]))
    ends = [int(np.abs(motion.ends - stage).argmin()) for stage in range(1, n_stages + 1)]
    if kind == "triangles":
        from .triangles import rubber_sealing

        cells, along, seconds = rubber_sealing(size, load_path(seal))
        forces = [along[k] for k in ends]
    else:
        from .elements import solve

        cells, forces, seconds = solve(name, size, seal, ends)
    # stage, travel, Fx, Fy at the ends of the stages
    table = np.zeros((n_stages, 4))
    table[:, 0], table[:, 3] = np.arange(1, n_stages + 1), forces
    values = [rounded(quantity.of(table)) for quantity in rung.quantities]
    return {"size": size, kind: cells, "seconds": seconds, "values": values}


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("rungs", nargs="*", default=[*RUNGS], metavar="RUNG", help=", ".join(RUNGS))
    parser.add_argument("--out", type=Path, default=Path("docs/benchmarks"))
    parser.add_argument("--repeats", type=int, default=3, help="at least 2: the first compiles")
    parser.add_argument("--no-elements", action="store_true")
    options = parser.parse_args(arguments)
    for name in options.rungs:
        if name not in RUNGS:
            parser.error(f"unknown rung {name!r}; there are {', '.join(RUNGS)}")
    file = options.out / "ladder.json"
    stored = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {"rungs": {}}
    with one_blas_thread:
        for name in options.rungs:
            rung = RUNGS[name]
            found = measured(name, rung, max(2, options.repeats), not options.no_elements)
            own = stored["rungs"].setdefault(name, {})
            own.update(found, date=strftime("%Y-%m-%d"))
            stored["rungs"] = {key: stored["rungs"][key] for key in RUNGS if key in stored["rungs"]}
            file.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
