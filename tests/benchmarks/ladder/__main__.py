"""Measure the ladder: ``python -m tests.benchmarks.ladder [RUNG ...] --out docs/benchmarks``.

Particles and elements of a rung run alternately in one process with one thread; the shortest processor
time of each counts. Without FElupe the elements of an earlier run stay.
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

from .rungs import RUNGS, Rung, timed, values_of

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
    clouds: list = [None] * len(seals)
    meshes: list = [None] * (len(rung.sizes) if elements else 0)
    motion = leading_motion(seals[-1])
    n_stages = round(float(motion.ends[-1]))
    for repeat in range(repeats):
        for k, seal in enumerate(seals):
            if repeat and clouds[k]["seconds"] > LONG:
                continue
            result, seconds = timed(seal)
            # the first run compiles kernels
            best = min(seconds, clouds[k]["seconds"]) if repeat > 1 else seconds
            clouds[k] = {
                "spacing": rung.spacings[k],
                "particles": len(result.particles),
                "steps": seal.n_steps,
                "seconds": best,
                "values": [*map(rounded, values_of(rung, result))],
            }
            print(f"{name}: {clouds[k]}", flush=True)
        for k in range(len(meshes)):
            if repeat and meshes[k]["seconds"] > LONG:
                continue
            meshes[k] = with_elements(name, rung, k, seals[-1], n_stages, meshes[k])
            print(f"{name}: {meshes[k]}", flush=True)
    return {"seal_file": rung.digest, "particles": clouds} | (
        {"elements": meshes} if elements else {}
    )


def with_elements(name: str, rung: Rung, k: int, seal, n_stages: int, before) -> dict:
    """Solve a mesh of a rung, and keep the shorter time of this run and the one before."""
    from .elements import solve

    ends = [
        int(np.abs(leading_motion(seal).ends - stage).argmin()) for stage in range(1, n_stages + 1)
    ]
    cells, forces, seconds = solve(name, rung.sizes[k], seal, ends)
    # stage, travel, Fx, Fy at the ends of the stages
    table = np.zeros((n_stages, 4))
    table[:, 0], table[:, 3] = np.arange(1, n_stages + 1), forces
    values = [rounded(quantity.of(table)) for quantity in rung.quantities]
    return {
        "size": rung.sizes[k],
        "elements": cells,
        "seconds": min(seconds, before["seconds"] if before else np.inf),
        "values": values,
    }


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
    elements = not options.no_elements and find_spec("felupe") is not None
    file = options.out / "ladder.json"
    stored = json.loads(file.read_text(encoding="utf-8")) if file.exists() else {"rungs": {}}
    with one_blas_thread:
        for name in options.rungs:
            rung = RUNGS[name]
            found = measured(name, rung, max(2, options.repeats), elements and bool(rung.sizes))
            own = stored["rungs"].setdefault(name, {})
            own.update(found, date=strftime("%Y-%m-%d"))
            stored["rungs"] = {key: stored["rungs"][key] for key in RUNGS if key in stored["rungs"]}
            file.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
