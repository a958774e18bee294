"""Benchmarks that compare one example after the other and store what they find."""

import argparse
import json
from collections.abc import Callable
from pathlib import Path


def store(compared: Callable, names, file: str, description: str, argv=None) -> int:
    """Parse the arguments, store ``compared(name)`` for every example after it is known; exit status.

    ``file`` is that in the folder ``--out``; examples that are not named keep their entries.
    """
    made = argparse.ArgumentParser(description=description)
    made.add_argument("names", nargs="*", default=names, help="examples")
    made.add_argument("--out", type=Path, default=Path("docs/benchmarks"))
    arguments = made.parse_args(argv)
    path = arguments.out / file
    path.parent.mkdir(parents=True, exist_ok=True)
    stored = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}
    for name in arguments.names:
        stored[name] = compared(name)
        print(name, json.dumps(stored[name]), flush=True)
        path.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")
    return 0
