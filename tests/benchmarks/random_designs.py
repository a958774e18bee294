"""Random designs of the door seal at several frictions: which complete, and how long that takes."""

import sys
from dataclasses import dataclass
from time import process_time

import numpy as np

import seal_mdao as sm
from seal_mdao.cli.arguments import checked_arguments, parser, run, write_summary
from seal_mdao.seals.door.door_seal import options_of
from seal_mdao.seals.result import analyze_particles


@dataclass(frozen=True)
class DesignStudy:
    """What became of N designs.

    Attributes
    ----------
    seconds : ndarray, shape (N,)
        Processor time of every analysis.
    failures : dict of int to str
        What those said that were not completed, by their number.
    critical : ndarray of int, shape (N,)
        How often each lost its stability.
    unstable : tuple of int
        Completed designs without friction with a step that is not stable.
    """

    seconds: np.ndarray
    failures: dict
    critical: np.ndarray
    unstable: tuple

    @property
    def completed(self) -> float:
        """Fraction of the designs."""
        return 1.0 - len(self.failures) / len(self.seconds)

    @property
    def slowest(self) -> float:
        """Longest time over the median."""
        return float(self.seconds.max() / np.median(self.seconds))


def study_designs(seal, count: int, bound: float, seed: int) -> DesignStudy:
    """Analyse ``count`` designs with offsets within +-``bound``, mm."""
    draw = np.random.default_rng(seed).uniform(-bound, bound, (count, seal.n_offsets))
    seconds, failures, critical, unstable = [], {}, [], []
    for number, offsets in enumerate(draw):
        begun = process_time()
        # without the analysis of the nominal seal, which only gives the points of measures
        result = analyze_particles(seal, seal.particles(offsets), offsets)
        seconds.append(process_time() - begun)
        critical.append(len(result.critical_points))
        if not result.converged:
            failures[number] = result.failure
        elif not options_of(seal).friction and not all(step.stable for step in result.path.steps):
            unstable.append(number)
    return DesignStudy(np.array(seconds), failures, np.array(critical), tuple(unstable))


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
