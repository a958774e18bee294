"""Random designs of the door seal at several frictions: which complete, and how long that takes."""

import sys

import numpy as np
from _common import checked_arguments, parser, run, write_summary
from verification.random_designs import study_designs

import seal_mdao as sm


def main(arguments) -> int:
    found = {}
    for friction in arguments.friction:
        with checked_arguments():
            seal = sm.door_seal(friction=friction)
        study = study_designs(seal, arguments.count, arguments.bound, arguments.seed)
        found[friction] = {
            "completed": study.completed,
            "median_s": np.median(study.seconds),
            "slowest_over_median": study.slowest,
            "mean_critical_points": study.critical.mean(),
            "unstable": study.unstable,
            "failures": study.failures,
        }
        print(
            f"friction {friction:g}: {study.completed:.1%} of {arguments.count} completed, median "
            f"{found[friction]['median_s']:.2f} s, slowest {study.slowest:.1f} times that"
        )
        for number, text in study.failures.items():
            print(f"  design {number}: {text}")
    print(f"summary.json in {write_summary(arguments.out, found).parent}")
    return 0


def arguments_parser():
    made = parser(__doc__, "out/random_designs")
    made.add_argument("--count", type=int, default=500, help="designs at every friction")
    made.add_argument("--bound", type=float, default=0.5, help="largest offset, mm")
    made.add_argument("--seed", type=int, default=1)
    made.add_argument("--friction", type=float, nargs="+", default=[0.0, 0.05, 0.25])
    return made


if __name__ == "__main__":
    sys.exit(run(arguments_parser(), main))
