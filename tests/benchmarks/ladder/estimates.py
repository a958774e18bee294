"""Estimated errors of the ladder: ``python -m tests.benchmarks.ladder.estimates [RUNG ...]``.

Adds the estimates of ``seal-mdao analyze --errors`` to the clouds in ``docs/benchmarks/ladder.json``,
for quantities at the ends of paths. To be run after the command that measures the rungs.
"""

import argparse
import json
from pathlib import Path

import numpy as np

from seal_mdao.accuracy.error_estimate import estimate_errors
from seal_mdao.equilibrium.threads import one_blas_thread
from seal_mdao.file_seal import build_seal
from seal_mdao.seals.result import analyze

from .rungs import RUNGS, Rung, values_of

STORED = Path("docs/benchmarks/ladder.json")


def estimated_errors(rung: Rung, spacing: float) -> list:
    """Estimate relative errors of the quantities of a rung, None before the end of the path."""
    file = rung.described(spacing)
    result = analyze(build_seal(file))
    reaction = estimate_errors(file, result)["reaction"]
    errors = []
    for value in values_of(rung, result):
        # the measure is the force at the end
        at_end = reaction.error is not None and np.isclose(value, abs(reaction.value[0]), rtol=1e-9)
        errors.append(float(f"{reaction.error[0] / reaction.value[0]:.4g}") if at_end else None)
    return errors


def main(arguments=None) -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    quick = [name for name, rung in RUNGS.items() if rung.quick]
    parser.add_argument("rungs", nargs="*", default=quick, metavar="RUNG")
    with one_blas_thread:
        for name in parser.parse_args(arguments).rungs:
            for k, spacing in enumerate(RUNGS[name].spacings):
                errors = estimated_errors(RUNGS[name], spacing)
                print(f"{name}, {spacing:g} mm: {errors}", flush=True)
                stored = json.loads(STORED.read_text(encoding="utf-8"))
                stored["rungs"][name]["particles"][k]["estimated_error"] = errors
                STORED.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
