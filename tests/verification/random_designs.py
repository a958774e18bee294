"""Do random designs complete their path? Shares, times and what is said where one does not."""

from dataclasses import dataclass
from time import process_time

import numpy as np

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
        """Share of the designs."""
        return 1.0 - len(self.failures) / len(self.seconds)

    @property
    def slowest(self) -> float:
        """Longest time over the median."""
        return float(self.seconds.max() / np.median(self.seconds))


def study_designs(seal, count: int, bound: float, seed: int, note=None) -> DesignStudy:
    """Analyse ``count`` designs with offsets within +-``bound``, mm.

    Parameters
    ----------
    note : callable, optional
        Called with the number of every design and its result.
    """
    draw = np.random.default_rng(seed).uniform(-bound, bound, (count, seal.n_offsets))
    seconds, failures, critical, unstable = [], {}, [], []
    for number, offsets in enumerate(draw):
        begun = process_time()
        # without the analysis of the drawn seal, which only gives places of measures
        result = analyze_particles(seal, seal.particles(offsets), offsets)
        seconds.append(process_time() - begun)
        critical.append(len(result.critical_points))
        if not result.converged:
            failures[number] = result.failure
        elif not seal.friction and not all(step.stable for step in result.path.steps):
            unstable.append(number)
        if note is not None:
            note(number, result)
    return DesignStudy(np.array(seconds), failures, np.array(critical), tuple(unstable))
