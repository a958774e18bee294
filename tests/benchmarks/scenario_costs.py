"""Time of scenarios against their number and the workers: ``python tests/benchmarks/scenario_costs.py``.

Not collected by pytest. Times are processor times: that of one process in line; with workers that of
the busiest one and of the process that they serve. On an idle machine with a core for each that is what
a clock shows; on a busy one a clock shows what others do.
"""

import argparse
import json
from pathlib import Path

import numpy as np
import psutil

import seal_mdao as sm
from seal_mdao.plotting.captions import today
from seal_mdao.scenarios.evaluate import evaluate
from seal_mdao.scenarios.processes import Processes
from seal_mdao.scenarios.running import Point, run_scenarios
from seal_mdao.scenarios.task import Outcome, SealTask
from seal_mdao.seals.result import frozen_measures
from seal_mdao.tolerances.file import OF_THE_DOOR, read_tolerances
from seal_mdao.tolerances.placement import with_clearance

COUNTS, WORKERS, EMPTY = (4, 8, 16, 32), (0, 1, 2), 1000
MEASURES = ("gap_square_integral", "reaction", "patch_pressure", "stress_norm")


class Nothing:
    """A task that does nothing, with an outcome of the usual size."""

    count = 6

    def run(self, offsets, parameters):
        return Outcome(np.zeros(6), np.zeros((6, 32)), "", 0.0)


def processor_times(processes) -> np.ndarray:
    """User and system time of processes, s."""
    return np.array([sum(process.cpu_times()[:2]) for process in processes])


class Measured:
    """Processor times of this process and of its workers between two calls."""

    def __init__(self):
        self._here = psutil.Process()
        self._there = [p for p in self._here.children() if "spawn_main" in " ".join(p.cmdline())]
        self._before = self._now()

    def _now(self):
        return processor_times([self._here]), processor_times(self._there)

    def spent(self) -> tuple[float, np.ndarray]:
        here, there = self._now()
        return float((here - self._before[0])[0]), there - self._before[1]


def main(out: Path, n_steps: int) -> None:
    seal, tolerances = with_clearance(sm.door_seal(n_steps=n_steps)), read_tolerances(OF_THE_DOOR)
    varied = [name for own in tolerances.variations for name in own.parameters]
    names = tuple(dict.fromkeys((*seal.inputs, *varied)))
    task = SealTask(seal, frozen_measures(seal, MEASURES), names, derivatives=True)
    design = {name: float(seal.scalars[name].value) for name in names}
    offsets = np.zeros(seal.n_offsets)

    def run(count, workers):
        evaluate(task, tolerances.samples(seal, count), offsets, design, workers)

    rows = []
    for workers in WORKERS:
        with Processes(max(workers, 1)) as pool:
            chosen = pool if workers else 0
            run(4, chosen)  # workers start, kernels are loaded
            for count in COUNTS:
                clock = Measured()
                run(count, chosen)
                here, there = clock.spent()
                rows.append({"workers": workers, "scenarios": count,
                             "seconds": here + there.max(initial=0.0) if workers else here,
                             "all": here + there.sum() if workers else here})  # fmt: skip
                print(rows[-1], flush=True)
            if workers == WORKERS[-1]:
                points = [Point(i, offsets, np.zeros(len(names))) for i in range(EMPTY)]
                clock = Measured()
                done = len(list(run_scenarios(Nothing(), points, pool)))
                here, there = clock.spent()
    found = {
        "date": today(), "n_steps": seal.n_steps, "rows": rows,
        "overhead_ms": 1e3 * (here + there.sum()) / done,
    }  # fmt: skip
    (out / "scenario_costs.json").write_text(json.dumps(found, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("docs/benchmarks"))
    parser.add_argument("--n-steps", type=int, default=53)
    arguments = parser.parse_args()
    main(arguments.out, arguments.n_steps)
