"""Make the pictures and numbers that the pages show.

    python docs/make_figures.py                 everything, into docs/_generated
    python docs/make_figures.py --changed       only groups whose sources have changed
    python docs/make_figures.py --only seal     one group
    python docs/make_figures.py --jobs 2        two groups at a time
    python docs/make_figures.py --reduced --out DIR   coarse and quick, for tests

Every group is made in a process of its own. It writes its PNG files and, at its end,
``numbers/<group>.json``, the numbers that the pages quote, and ``sources/<group>.json``, digests of
the files that it was made from. A line per group has its processor time.
"""

import argparse
import json
import multiprocessing
import os
import sys
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path[:0] = [str(HERE), str(HERE.parent / "tests")]  # figures, verification

from figures.sources import Record, unchanged  # noqa: E402

GROUPS = {
    "seal_files": "figures.seal_files",
    "contact": "figures.contact_benchmarks",
    "sensitivities": "figures.sensitivities",
    "stability": "figures.stability",
    "examples": "figures.examples",
    "rates": "figures.rates",
    "materials": "figures.materials",
    "cycles": "figures.cycles",
    "environment": "figures.environment",
    "leak_rate": "figures.leak_rate",
    "fluid": "figures.fluid",
    "accuracy": "figures.accuracy",
    "optimisation": "figures.optimisation",
    "refinement": "figures.refinement",
    "air": "figures.air",
    "exact": "figures.exact",
    "seal": "figures.seal",
    "drivers": "figures.drivers",
    "ageing": "figures.ageing",
    "revolution": "figures.revolution",
    "theory": "figures.theory",
    "tolerance_study": "figures.tolerance_study",
    "ladder": "figures.ladder",
    "error_estimates": "figures.error_estimates",
    "performance": "figures.performance",
}
"""Module of every group, the slowest first; its ``make(out, reduced)`` returns the numbers."""


def make(group: str, out: Path, reduced: bool) -> None:
    """Make one group, and record what it was made from."""
    stored = out / "sources" / f"{group}.json"
    stored.unlink(missing_ok=True)
    record = Record()
    numbers = import_module(GROUPS[group]).make(out, reduced)
    _write(out / "numbers" / f"{group}.json", numbers)
    _write(stored, record.digests())
    # user and system time of this process and of those that it started
    print(f"{group}: {sum(os.times()[:4]):.1f} s of a processor", flush=True)


def _write(path: Path, content: dict) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(json.dumps(content, indent=1, ensure_ascii=False), encoding="utf-8")


def make_all(groups: list[str], out: Path, reduced: bool, jobs: int) -> None:
    """Make several groups, ``jobs`` at a time."""
    tasks = [(group, out, reduced) for group in groups]
    # spawned, for numba's threads do not survive a fork; new processes, for what each reads
    with multiprocessing.get_context("spawn").Pool(jobs, maxtasksperchild=1) as pool:
        pool.starmap(make, tasks, chunksize=1)


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=GROUPS, metavar="GROUP", default=list(GROUPS))
    parser.add_argument("--changed", action="store_true", help="skip groups without a change")
    parser.add_argument("--reduced", action="store_true", help="coarse and quick")
    parser.add_argument("--jobs", type=int, default=1, metavar="N", help="groups at a time")
    parser.add_argument("--out", type=Path, default=HERE / "_generated")
    options = parser.parse_args(arguments)
    groups = options.only
    if options.changed:
        groups = [g for g in groups if not unchanged(options.out / "sources" / f"{g}.json")]
    if groups:
        make_all(groups, options.out, options.reduced, options.jobs)


if __name__ == "__main__":
    main()
