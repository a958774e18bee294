"""Make the pictures and numbers that the pages show.

    python docs/make_figures.py                 everything, into docs/_generated
    python docs/make_figures.py --missing       only what is not there yet
    python docs/make_figures.py --only seal     one group
    python docs/make_figures.py --reduced --out DIR   coarse and quick, for tests

Every group writes its PNG files and, at its end, ``numbers/<group>.json``: the numbers that the
pages quote.
"""

import argparse
import json
import sys
import time
from importlib import import_module
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

GROUPS = {
    "theory": "figures.theory",
    "seal": "figures.seal",
    "optimisation": "figures.optimisation",
}
"""Module of every group; its ``make(out, reduced)`` returns the numbers."""


def make(group: str, out: Path, reduced: bool) -> None:
    """Make one group."""
    start = time.perf_counter()
    numbers = import_module(GROUPS[group]).make(out, reduced)
    target = out / "numbers" / f"{group}.json"
    target.parent.mkdir(parents=True, exist_ok=True)
    target.write_text(json.dumps(numbers, indent=1, ensure_ascii=False), encoding="utf-8")
    print(f"{group}: {time.perf_counter() - start:.1f} s", flush=True)


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", nargs="+", choices=GROUPS, metavar="GROUP", default=list(GROUPS))
    parser.add_argument("--missing", action="store_true", help="skip groups that are there")
    parser.add_argument("--reduced", action="store_true", help="coarse and quick")
    parser.add_argument("--out", type=Path, default=HERE / "_generated")
    options = parser.parse_args(arguments)
    for group in options.only:
        if not (options.missing and (options.out / "numbers" / f"{group}.json").exists()):
            make(group, options.out, options.reduced)


if __name__ == "__main__":
    main()
