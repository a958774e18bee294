"""Make the pictures and numbers that the pages show.

    python docs/make_figures.py                 everything, into docs/_generated
    python docs/make_figures.py --missing       only what is not there yet
    python docs/make_figures.py --only seal     one group
    python docs/make_figures.py --jobs 2        two groups at a time
    python docs/make_figures.py --reduced --out DIR   coarse and quick, for tests

Every group writes its PNG files and, at its end, ``numbers/<group>.json``: the numbers that the
pages quote.
"""

import argparse
import json
import multiprocessing
import sys
import time
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]  # figures, verification

GROUPS = {
    "sensitivities": "figures.sensitivities",
    "refinement": "figures.refinement",
    "rates": "figures.rates",
    "accuracy": "figures.accuracy",
    "examples": "figures.examples",
    "exact": "figures.exact",
    "stability": "figures.stability",
    "contact": "figures.contact_benchmarks",
    "optimisation": "figures.optimisation",
    "materials": "figures.materials",
    "seal_files": "figures.seal_files",
    "air": "figures.air",
    "fluid": "figures.fluid",
    "self_contact": "figures.self_contact",
    "cycles": "figures.cycles",
    "seal": "figures.seal",
    "theory": "figures.theory",
    "drivers": "figures.drivers",
    "performance": "figures.performance",
    "tolerance_study": "figures.tolerance_study",
}
"""Module of every group, the slowest first; its ``make(out, reduced)`` returns the numbers."""


def make(group: str, out: Path, reduced: bool) -> None:
    """Make one group."""
    start = time.perf_counter()
    numbers = import_module(GROUPS[group]).make(out, reduced)
    target = out / "numbers" / f"{group}.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(numbers, indent=1, ensure_ascii=False), encoding="utf-8")
    print(f"{group}: {time.perf_counter() - start:.1f} s", flush=True)


def make_all(groups: list[str], out: Path, reduced: bool, jobs: int) -> None:
    """Make several groups, ``jobs`` at a time."""
    tasks = [(group, out, reduced) for group in groups]
    if jobs == 1:
        for task in tasks:
            make(*task)
        return
    # a process of its own for every group; spawned, for numba's threads do not survive a fork
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=1) as pool:
        pool.starmap(make, tasks, chunksize=1)


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=GROUPS, metavar="GROUP", default=list(GROUPS))
    parser.add_argument("--missing", action="store_true", help="skip groups that are there")
    parser.add_argument("--reduced", action="store_true", help="coarse and quick")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="groups at a time")
    parser.add_argument("--out", type=Path, default=HERE / "_generated")
    options = parser.parse_args(arguments)
    there = options.out / "numbers"
    groups = [g for g in options.only if not (options.missing and (there / f"{g}.json").exists())]
    make_all(groups, options.out, options.reduced, options.jobs)


if __name__ == "__main__":
    main()
